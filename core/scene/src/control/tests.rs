//! What is said comes over the pipe as it was said, and what says nothing is told.

use super::*;

#[test]
fn commands_are_read_as_they_are_written_and_as_people_type_them() {
    let seat = Seat { azimuth_deg: Some(30.0), ..Seat::default() };
    let scene = Command::Scene { protocol: PROTOCOL, path: "/tmp/a b.scene".into() };
    for (command, written, typed) in [
        (Command::Play, r#""play""#, "play"),
        (Command::Pause, r#""pause""#, r#"{"pause":null}"#),
        (Command::Frame(12), r#"{"frame":12}"#, " frame 12 "),
        (
            scene,
            r#"{"scene":{"protocol":1,"path":"/tmp/a b.scene"}}"#,
            r#"scene {"protocol":1,"path":"/tmp/a b.scene"}"#,
        ),
        (Command::Cut(8), r#"{"cut":8}"#, "cut 8"),
        (
            Command::Wind("storm:seed=2 gust".into()),
            r#"{"wind":"storm:seed=2 gust"}"#,
            "wind storm:seed=2 gust",
        ),
        (Command::Camera(seat), r#"{"camera":{"azimuth_deg":30.0}}"#, r#"camera {"azimuth_deg":30}"#),
        (Command::Select(Some(Chosen::Track(7))), r#"{"select":{"track":7}}"#, r#"select {"track":7}"#),
        (Command::Select(Some(Chosen::Bone(3))), r#"{"select":{"bone":3}}"#, r#"select {"bone": 3}"#),
        (Command::Select(None), r#"{"select":null}"#, "select"),
        (Command::Say("a line".into()), r#"{"say":"a line"}"#, "say a line"),
        (Command::Say("12".into()), r#"{"say":"12"}"#, "say 12"),
        (Command::Capture("/tmp/a.png".into()), r#"{"capture":"/tmp/a.png"}"#, "capture /tmp/a.png"),
        (Command::Quit, r#""quit""#, "quit"),
    ] {
        assert_eq!(line(&command), format!("{written}\n"));
        assert_eq!(super::command(written), Ok(command.clone()));
        assert_eq!(super::command(typed), Ok(command), "{typed}");
    }
}

#[test]
fn events_are_read_as_they_are_written() {
    let shape = Event::Shape { node: 9, plane_deg: -30.5, lean_deg: 0.0, gain: 1.25 };
    for (event, written) in [
        (Event::Ready { protocol: 1, adapter: "it".into() }, r#"{"ready":{"protocol":1,"adapter":"it"}}"#),
        (Event::Frame(3), r#"{"frame":3}"#),
        (Event::Passing(3), r#"{"passing":3}"#),
        (Event::Playing(true), r#"{"playing":true}"#),
        (Event::Selected(None), r#"{"selected":null}"#),
        (shape, r#"{"shape":{"node":9,"plane_deg":-30.5,"lean_deg":0.0,"gain":1.25}}"#),
        (Event::Root(Some([1.5, -2.0])), r#"{"root":[1.5,-2.0]}"#),
        (Event::Root(None), r#"{"root":null}"#),
        (Event::Cut(4), r#"{"cut":4}"#),
        (Event::Undo, r#""undo""#),
        (Event::Redo, r#""redo""#),
        (Event::Captured("a.png".into()), r#"{"captured":"a.png"}"#),
        (Event::Closed, r#""closed""#),
        (Event::Failed("why\nnot".into()), r#"{"failed":"why\nnot"}"#),
    ] {
        assert_eq!(line(&event), format!("{written}\n"), "on one line");
        assert_eq!(super::event(written), Ok(event));
    }
}

#[test]
fn what_says_nothing_is_told_by_its_line() {
    for text in [
        "",
        "jump",
        "frame",
        "frame twelve",
        "frame -1",
        "play 3",
        r#"{"frame":1.5}"#,
        r#"{"frame":12"#,
        r#"{"frame":1,"cut":2}"#,
        r#"{"camera":{"roll_deg":1}}"#,
        r#"{"scene":{"path":"a"}}"#,
        r#"{"select":{"leaf":1}}"#,
        "\u{0}\u{ff}",
    ] {
        let garbled = command(text).unwrap_err();
        assert_eq!(garbled.line, text.trim(), "{text}");
        assert!(!garbled.why.is_empty());
    }
    assert_eq!(command(&"x".repeat(500)).unwrap_err().line.len(), TOLD_CHARS);
    assert!(event("ready").is_err() && event(r#"{"ready":{"protocol":1}}"#).is_err());
}
