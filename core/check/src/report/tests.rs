//! Reports of checks that were never run.

use super::*;
use crate::checks;

fn report(findings: &[(u8, Finding)], level: Option<u8>) -> Report {
    let outcome = |(level, finding): &(u8, Finding)| Outcome {
        check: Check { level: *level, ..checks()[0] },
        finding: finding.clone(),
        took: Duration::from_millis(1500),
        repeat: "again <&> \"again\"".into(),
    };
    Report {
        name: "mine".into(),
        plugin: "org.me.mine".into(),
        sha256: Some("0".into()),
        seed: 1,
        level,
        outcomes: findings.iter().map(outcome).collect(),
        took: Duration::from_secs(18),
    }
}

#[test]
fn the_level_reached_lies_below_the_first_failure_and_none_is_reached_by_a_choice() {
    let (holds, fails) = (Finding::Holds(String::new()), Finding::Fails("no".into()));
    let doubtful = Finding::Doubtful("hm".into());
    let beside = Finding::Beside("no file".into());
    for (findings, wanted, reached, status) in [
        (vec![(1, holds.clone()), (9, holds.clone())], Some(9), Some(9), Status::Passed),
        (vec![(1, holds.clone()), (3, holds.clone()), (9, beside.clone())], Some(9), Some(3), Status::Passed),
        (vec![(1, beside)], Some(9), Some(0), Status::Passed),
        (vec![(1, holds.clone()), (2, doubtful.clone())], Some(2), Some(2), Status::Doubtful),
        (
            vec![(1, holds.clone()), (3, doubtful), (4, fails.clone()), (7, fails.clone())],
            Some(9),
            Some(3),
            Status::Failed,
        ),
        (vec![(1, fails)], None, None, Status::Failed),
        (vec![(1, holds)], None, None, Status::Passed),
    ] {
        let report = report(&findings, wanted);
        assert_eq!((report.reached(), report.status()), (reached, status), "{findings:?}");
    }
}

#[test]
fn a_plugin_is_told_in_a_line_and_in_xml_that_holds_any_text() {
    let findings = [
        (1, Finding::Holds(String::new())),
        (2, Finding::Beside("b".into())),
        (3, Finding::Fails("a < b\u{7} & c".into())),
    ];
    let report = report(&findings, Some(9));
    assert_eq!(report.line(), "mine: level 1, 3 checks, 1 failed, 1 beside, 18 s");
    let xml = junit(&[report]);
    assert!(xml.contains("tests=\"3\" failures=\"1\" skipped=\"1\" time=\"18.000\""), "{xml}");
    assert!(xml.contains("a &lt; b &amp; c\nagain &lt;&amp;&gt; &quot;again&quot;</failure>"), "{xml}");
}
