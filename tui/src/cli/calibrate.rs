//! `calibrate`: cameras from pictures of a chessboard, or from tracks of targets.

use std::path::{Path, PathBuf};

use honami_workbench::calibrate::{self, Calibrated, Cameras, Filmed, KnownCamera, Tracked, file, rig};
use honami_workbench::cameras::Stereo;
use honami_workbench::cameras::camera::NUMBERS;
use honami_workbench::session::{Session, SessionOptions};

use super::args::Common;
use super::args::cameras::Calibrate;
use super::sync::two_views;
use super::{Answer, Usage, report, there, told_options, want};
use crate::app::opening::where_is_the_clip;

/// Finds the target in all views, and the cameras that took them.
pub(super) fn calibrate(args: &Calibrate, common: &Common) -> anyhow::Result<Answer> {
    if let ([left, ..], [right, ..]) = (&args.images[..], &args.right[..]) {
        two_views([left, right])?;
    }
    let cameras = match &args.rig {
        Some(path) => {
            want(args.images.len() == 1 && args.right.len() <= 1, || {
                "--rig takes one project a camera: LEFT.honami --right RIGHT.honami".to_owned()
            })?;
            let rig = rig::read(path)?;
            let right = args.right.first().map(|path| opened(path, common)).transpose()?;
            let tracked = Tracked {
                left: &opened(&args.images[0], common)?,
                right: right.as_ref(),
                rig: &rig,
                known: known(&args.known)?,
                n_views: args.views,
            };
            calibrate::by_rig(&tracked, &report::Bar::with(common))?
        }
        None => calibrate::by_board(&filmed(args), &report::Bar::with(common))?,
    };
    let mut answer = describe(&cameras);
    if let Some(out) = &args.out {
        file::write(&cameras, out)?;
        answer.text += &format!("\nwritten: {}", out.display());
    }
    Ok(answer)
}

/// Both cameras, of one file or of one each.
fn known(paths: &[PathBuf]) -> anyhow::Result<Option<[KnownCamera; 2]>> {
    let each: Vec<Vec<KnownCamera>> =
        paths.iter().map(|path| file::read_each(path)).collect::<Result<_, _>>()?;
    match each.as_slice() {
        [] => Ok(None),
        [left, right] => Ok(Some([left[0], right[0]])),
        [both] if both.len() == 2 => Ok(Some([both[0], both[1]])),
        _ => Err(Usage("--known takes a file of two cameras, or two files: LEFT.json RIGHT.json".to_owned())
            .into()),
    }
}

fn opened(path: &Path, common: &Common) -> anyhow::Result<Session> {
    there(path)?;
    let options = SessionOptions { read_only: true, ..told_options(common) };
    Session::open(path, &options).map_err(|error| where_is_the_clip(error, path))
}

fn filmed(args: &Calibrate) -> Filmed {
    Filmed {
        left: args.images.clone(),
        right: args.right.clone(),
        board: args.board.0,
        square: args.square.value,
        unit: args.square.unit,
        window: args.window,
        held: args.hold.clone(),
        n_views: args.views,
    }
}

fn describe(cameras: &Cameras) -> Answer {
    let json = file::json(cameras);
    let mut text = String::new();
    match &cameras.right {
        None => say(&mut text, "", &cameras.left),
        Some((right, stereo)) => {
            say(&mut text, "left: ", &cameras.left);
            say(&mut text, "right: ", right);
            say_pair(&mut text, stereo, cameras.unit.map_or("of the target's unit", calibrate::Unit::name));
        }
    }
    if let Some([fx, rms]) = cameras.by_squares {
        text += &format!(
            "\nwindows that fit the squares (--window squares) agree better: fx {fx:.2}, rms {rms:.3} px"
        );
    }
    Answer { json, text: text.trim_end().to_owned(), done: true }
}

fn say(text: &mut String, side: &str, calibrated: &Calibrated) {
    /// More pictures than these are not named.
    const MOST_NAMED: usize = 6;
    let Calibrated { calibration, shown, n_shown, left_out, middles, .. } = calibrated;
    let n =
        if shown.len() < *n_shown { format!("{} of {n_shown}", shown.len()) } else { n_shown.to_string() };
    *text += &format!("{side}{n} views of the target, rms {:.3} px", calibration.rms_px);
    let values = calibration.camera.numbers().into_iter().zip(calibration.errors);
    let mut rows = vec![["", "", "±"].map(str::to_owned).to_vec()];
    for (name, (value, error)) in NUMBERS.iter().zip(values) {
        let digits = if name.starts_with(['f', 'c']) { 2 } else { 5 };
        // Bars tell no more than a focal length, and what is known is not looked for.
        let error = if error > 0.0 { format!("{error:.digits$}") } else { "taken as given".to_owned() };
        rows.push(vec![(*name).to_owned(), format!("{value:.digits$}"), error]);
    }
    *text += &format!("\n{}\n", report::table(&rows));
    let worst = calibration.views.iter().zip(shown).max_by(|a, b| a.0.rms_px.total_cmp(&b.0.rms_px));
    if let Some((view, name)) = worst {
        *text += &format!("worst: {name}, rms {:.3} px, {:.2} px at most\n", view.rms_px, view.worst_px);
    }
    if let Some([measured, tracked]) = middles {
        *text += &format!("middles of targets: {measured} measured, {tracked} as the tracks have them\n");
    }
    left_out.iter().take(MOST_NAMED).for_each(|(name, why)| *text += &format!("left out: {name}: {why}\n"));
    if left_out.len() > MOST_NAMED {
        *text += &format!("left out: {} more (--json names them)\n", left_out.len() - MOST_NAMED);
    }
}

fn say_pair(text: &mut String, stereo: &Stereo, unit: &str) {
    let Stereo { baseline, baseline_error, rms_px, epipolar_px, .. } = stereo;
    *text += &format!(
        "both: rms {rms_px:.3} px, {epipolar_px:.3} px from the epipolar lines; {baseline:.3}±{baseline_error:.3} {unit} apart"
    );
}
