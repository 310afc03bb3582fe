//! Multiscale tree graphs: small ones by hand, and real ones.

use super::{Options, parse};

const HEAD: &str = "CODE:\tFORM-A\n\nCLASSES:\nSYMBOL\tSCALE\tDECOMPOSITION\n$\t0\tFREE\nP\t1\tFREE\nA\t2\tFREE\nS\t3\tFREE\nU\t3\tFREE\n\nFEATURES:\nNAME\tTYPE\nXX\tREAL\n\nMTG:\n\nENTITY-CODE\t\t\tXX\tYY\tZZ\tTopDia\n";

fn file(lines: &[&str]) -> String {
    format!("{HEAD}\n{}\n", lines.join("\n"))
}

/// Parent and height in centimetres of every node, and the notes.
type Read = (Vec<(Option<u32>, f64)>, Vec<String>);

fn tree(lines: &[&str], options: &Options) -> Result<Read, String> {
    let measured = parse(&file(lines), options).map_err(|error| error.to_string())?;
    let nodes = measured.plant.nodes().iter();
    Ok((nodes.map(|node| (node.parent, (node.position[2] * 100.0).round())).collect(), measured.notes))
}

#[test]
fn columns_and_carets_say_what_grows_on_what() {
    let lines = [
        "/P1",
        "\t/A1\t\t0\t0\t0\t40",
        "\t^/S1\t\t0\t0\t10\t30",
        "\t\t+A1\t0\t0\t11\t12",
        "\t\t^/S1\t0\t0\t15\t10",
        "\t^<S2\t\t0\t0\t20\t20",
        "\t^<U3\t\t0\t0\t30\t10",
        "\t\t+A2/S1\t0\t0\t33\t5",
    ];
    let all = Options::default();
    // Base; S1; the branch on S1; S2 on S1; U3; the branch on U3.
    let wanted = vec![
        (None, 0.0),
        (Some(0), 10.0),
        (Some(1), 15.0),
        (Some(1), 20.0),
        (Some(3), 30.0),
        (Some(4), 33.0),
    ];
    assert_eq!(tree(&lines, &all), Ok((wanted, vec![])));
    // Without shoots what they bear stands on what bears them.
    let wood = Options { classes: vec!["S".into()], ..all };
    let (nodes, notes) = tree(&lines, &wood).unwrap();
    assert_eq!(nodes, [(None, 0.0), (Some(0), 10.0), (Some(1), 15.0), (Some(1), 20.0), (Some(3), 33.0)]);
    assert_eq!(notes, ["1 part of other classes left out"]);
}

#[test]
fn a_series_has_a_place_at_its_end_alone() {
    let lines = ["/P1", "\t/A1\t\t0\t0\t0\t40", "\t^/S1<<S5\t\t0\t0\t50\t20", "\t^<S6\t\t0\t0\t60\t\t"];
    let (nodes, notes) = tree(&lines, &Options::default()).unwrap();
    assert_eq!(nodes, [(None, 0.0), (Some(0), 50.0), (Some(1), 60.0)]);
    assert_eq!(
        notes,
        [
            "4 parts without a position left out: what they bear stands on what bears them",
            "1 part without a diameter taken as thick as the part before"
        ]
    );
}

#[test]
fn what_is_no_plant_is_named_with_its_line() {
    let orphan = ["/P1", "\t/A1/S1\t\t0\t0\t10\t4", "\t^<S2\t\t0\t0\t20\t4", "/P2", "\t/A1/S1\t\t9\t9\t9\t4"];
    let (nodes, notes) = tree(&orphan, &Options::default()).unwrap();
    assert_eq!(nodes, [(None, 10.0), (Some(0), 20.0)]);
    assert_eq!(notes, ["1 more tree of 1 node left out: on nothing that the largest stands on"]);
    let cases: [(&[&str], &str); 10] = [
        (&["/P1", "\t\t+S1\t0\t0\t1\t1"], "line 20: \"+S1\" stands under nothing"),
        (
            &["/P1", "\t/S1\t\t0\t0\t1\t1", "\t\t\t\t+S9\t0"],
            "line 21: \"+S9\" stands beyond the 3 columns that the header has for parts",
        ),
        (&["/P1", "\tS1"], "line 20: \"S1\" is no word such as /S1, <S2 or +A1"),
        (&["/P1", "\t/X1"], "line 20: class \"X\" is not declared"),
        (&["/P1", "\t/S5<<S2"], "line 20: <<S2 is no series from S6 on"),
        (&["/P1", "\t/S1\t\t0\tzero\t1\t1"], "line 20: \"zero\" is no number"),
        (&["/P1", "\t/S1\t\t0\tinf\t1\t1"], "line 20: \"inf\" is no number"),
        (
            &["/P1", "\t/S1\t\t0\t0\t1\t-4"],
            "line 20: a diameter is 0, where it was not measured, or more, not -4",
        ),
        (&["/P1", "\t/S1\t\t0\t0\t1\t0"], "line 20: the first part of an axis has a diameter, S1 has none"),
        (&["/P1", "\t/S1\t\t0\t0\t1\t1"], "a plant has two nodes at least, this one has 1"),
    ];
    for (lines, wanted) in cases {
        assert_eq!(tree(lines, &Options::default()), Err(wanted.to_owned()));
    }
    let sound = ["/P1", "\t/A1/S1\t\t0\t0\t10\t4", "\t^<S2\t\t0\t0\t20\t4", "\t^<U3\t\t0\t0\t30\t4"];
    for class in ["X", "s", "A", ""] {
        let options = Options { classes: vec!["S".into(), class.into()], ..Options::default() };
        let wanted = format!("no part is of class {class}: there are S (2), U (1)");
        assert_eq!(tree(&sound, &options), Err(wanted));
    }
    for (text, wanted) in [
        ("", "a multiscale tree graph has a table CLASSES, this file has none"),
        (
            "CLASSES:\nSYMBOL\tSCALE\nP\t1\n\nMTG:\nENTITY-CODE\t\tXX\tYY\tTopDia",
            "the parts have no column ZZ; there are: ENTITY-CODE  XX YY TopDia",
        ),
    ] {
        assert_eq!(
            parse(text, &Options::default()).map_err(|error| error.to_string()),
            Err(wanted.to_owned())
        );
    }
}
