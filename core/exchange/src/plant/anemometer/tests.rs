//! Recordings of wind, right and wrong.

use super::{Recording, parse};

#[test]
fn a_table_of_two_or_three_components_is_a_recording() {
    let wanted = Recording { step: 0.5, samples: vec![[1.0, -2.0, 0.0], [3.0, 4.0, 0.0]] };
    for text in [
        "t_s,x,y\n0,1,-2\n0.5,3,4\n",
        "0 1 -2\n\n0.5 3 4",
        "# a remark\n0;1;-2\n0.5;3;4",
        "# a remark\n\nt x y\n0\t1 -2\n0.5 3\t4",
    ] {
        assert_eq!(parse(text).unwrap(), wanted);
    }
    let wanted = Recording { step: 1.0, samples: vec![[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]] };
    assert_eq!(parse("t,u,v,w\n0,1,2,3\n1,4,5,6").unwrap(), wanted);
}

#[test]
fn what_is_no_recording_is_named_with_its_line() {
    let cases = [
        ("", "a recording of wind has two rows at least, this has none"),
        ("0,1,2", "a recording of wind has two rows at least, this has one"),
        ("t,x,y\n0,1,2\n1,NaN,2", "line 3: \"NaN\" is no number: fill in what is missing, or cut it off"),
        ("t,x,y\n0,1,2\n1,one,2", "line 3: \"one\" is no number: fill in what is missing, or cut it off"),
        ("0,1,2\n1,,2", "line 2: wanted a time and two or three components of the wind, came 2"),
        ("t,x\n0,1\n1,2", "line 2: wanted a time and two or three components of the wind, came 2"),
        (
            "# at 10 m\nt,x,y\n0,1,2\n1,1,2\n2,1,2\n7,1,2\n8,1,2",
            "line 6: 5.0000 s after the row before, where rows are 1.0000 s apart: a gap is filled in, or cut off",
        ),
        ("1,1,2\n0,1,2", "line 2: time 0 s does not come after 1 s, the row before"),
        ("0,1,2\n1,1,2\n1,1,2", "line 3: time 1 s does not come after 1 s, the row before"),
    ];
    for (text, wanted) in cases {
        assert_eq!(parse(text).map_err(|error| error.to_string()), Err(wanted.to_owned()), "{text:?}");
    }
}

#[test]
fn no_wind_is_as_fast_as_what_stands_for_a_missing_value() {
    for (wild, told) in [
        ("1,-9999", "1, -9999, 0"),
        ("1,-999", "1, -999, 0"),
        ("999.9,1,1", "999.9, 1, 1"),
        ("1,1e300", "1, 1e300, 0"),
        ("200.1,0", "200.1, 0, 0"),
        // None of these is, and all together are.
        ("150,150", "150, 150, 0"),
        ("120,-120,120", "120, -120, 120"),
    ] {
        let said = parse(&format!("t,x,y\n0,1,2\n1,{wild}")).unwrap_err().to_string();
        let begins = said.starts_with(&format!("line 3: a wind of {told} m/s, and none is faster than 200"));
        assert!(begins && said.contains("stands for what is missing, as -999 and -9999 do"), "{said}");
    }
    let wanted = Recording { step: 1.0, samples: vec![[-120.0, 160.0, 0.0], [0.0; 3]] };
    assert_eq!(parse("0,-120,160\n1,0,0").unwrap(), wanted);
}
