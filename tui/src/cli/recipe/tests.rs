//! What is a recipe, and what is none.

use std::path::Path;

use super::many::clips;
use super::{Line, Recipe};

fn line(text: &str) -> Result<Line, String> {
    Line::read(text, Path::new("/lab/recipes"))
}

#[test]
fn steps_are_lines_of_the_command_line() {
    for good in [
        "track",
        "track --with klt --set radius=12 --every 50 --region 1,2,300,200",
        "track --mask {recipe}/masks/{clip}.png",
        "track --set model={recipe}/net.onnx",
        "cluster --groups 6",
        "grow '{clip} a.bvh' b.svg",
        "export tracks sub/{clip}.csv",
        "simulate --seconds 2 --out s.csv",
        "compare --with klt --with anchored --svg c.svg",
    ] {
        assert_eq!(line(good).map(|line| line.text), Ok(good.to_owned()));
    }
    for (bad, why) in [
        ("", "a step is a command"),
        ("new", "new is no step; steps are track, cluster"),
        ("run x.toml", "run is no step"),
        ("track --set 'a", "a quotation mark"),
        ("track --resume", "--resume is for who is there"),
        ("track --watch", "--watch is for who is there"),
        ("track --radius 3", "unexpected argument '--radius' found"),
        ("cluster --groups many", "invalid value 'many' for '--groups <K>'"),
        ("export tracks", "required arguments were not provided"),
        ("export tracks /etc/x.csv", "do not leave the folder of the clip"),
        ("export tracks ../x.csv", "do not leave the folder of the clip"),
        ("export tracks {recipe}/x.csv", "{recipe} is where files are read from"),
        ("track --mask {recipe}/../m.png", "do not leave the folder of the clip"),
        ("track --mask=/lab/m.png", "do not leave the folder of the clip"),
        ("export tracks /lab/a=b.csv", "do not leave the folder of the clip"),
        ("export tracks ../x=y.csv", "do not leave the folder of the clip"),
        ("simulate --wind /lab/w.csv+vortex:strength=3", "do not leave the folder of the clip"),
        ("export tracks a\u{1b}[2J.csv", "without control characters"),
        ("track --set model=/lab/net.onnx", "do not leave the folder of the clip"),
    ] {
        let told = line(bad).unwrap_err();
        assert!(told.contains(why), "{bad:?}: {told}");
    }
}

#[test]
fn a_recipe_says_what_is_wrong_with_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("r.toml");
    for (text, why) in [
        ("steps = []", "a recipe has steps"),
        ("step = [\"track\"]", "unknown field `step`"),
        ("fps = -3\nsteps = [\"track\"]", "fps wants frames per second"),
        ("steps = [\"track\", \"clusters\"]", "step 2, \"clusters\": clusters is no step"),
        ("steps = \"track\"", "invalid type: string"),
    ] {
        std::fs::write(&path, text).unwrap();
        let told = format!("{:#}", Recipe::read(&path).unwrap_err());
        assert!(told.contains("r.toml: ") && told.contains(why), "{text}: {told}");
    }
    std::fs::write(&path, "fps = 120\nsteps = [\"track --mask {recipe}/m.png\"]").unwrap();
    let recipe = Recipe::read(&path).unwrap();
    assert_eq!(recipe.fps, Some(120.0));
    assert_eq!(recipe.steps[0].inputs("a"), [folder.path().canonicalize().unwrap().join("m.png")]);
}

#[test]
fn clips_have_names_of_their_own() {
    let names = |named: &[&str]| {
        let named: Vec<String> = named.iter().map(|&word| word.to_owned()).collect();
        clips(&named, Path::new("out"))
            .map(|clips| clips.into_iter().map(|clip| clip.name).collect::<Vec<_>>())
    };
    let good = names(&["a/x.mp4", "b/y.tar.mov", "day=b/x.mp4", "walnut/frame_%04d.png"]).unwrap();
    assert_eq!(good, ["x", "y.tar", "day", "walnut"]);
    for (bad, why) in [
        (&["a/x.mp4", "b/x.mov"][..], "would both be called x: say NAME=CLIP"),
        (&["../..=x.mp4"], "a name that a folder can have"),
        (&["{recipe}.mp4"], "a name that a folder can have"),
        (&["a\u{1b}]52;c;x\u{7}.mp4"], "a name that a folder can have"),
        (&["=x.mp4"], "a name that a folder can have"),
    ] {
        let told = names(bad).unwrap_err().to_string();
        assert!(told.contains(why), "{bad:?}: {told}");
    }
}
