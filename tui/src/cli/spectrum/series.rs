//! Series that are no tracks: strain, tilt, the sensors of `simulate`.

use honami_workbench::sways::{Manner, Series, Sways, Swing, Told};
use serde_json::json;

use super::aliased;
use super::curves::{Curve, Curves, half_power, written};
use crate::cli::args::spectrum::Spectrum;
use crate::cli::{Answer, report};

/// What is steady has no damping within so many standard errors.
const SURE: f64 = 3.0;

/// What each swings at, and how soon it comes to rest.
pub(super) fn swings(sways: &Sways, args: &Spectrum) -> anyhow::Result<Answer> {
    let at_s = |sample: usize| sways.start_s + sample as f64 / sways.fps;
    let heads = ["", "Hz", "damping %", "log decrement", "swings", "from s", ""];
    let mut rows = vec![heads.map(str::to_owned).to_vec()];
    let cells = |name: &str, swing: &Swing| {
        let Told { value, error } = swing.hz;
        let damping = damped(swing, swing.ratio, 100.0, 2);
        let decrement = damped(swing, swing.log_decrement(), 1.0, 3);
        let from = format!("{:.2}", at_s(swing.first));
        let swings = format!("{:.1}", swing.n_cycles);
        let hz = format!("{value:.4}±{error:.4}");
        [name.to_owned(), hz, damping, decrement, swings, from, manner(swing.manner).to_owned()].to_vec()
    };
    let of_many = sways.median.filter(|_| sways.series.len() > 1);
    rows.extend(of_many.iter().map(|swing| cells("median", swing)));
    let mut none = Vec::new();
    for series in &sways.series {
        match &series.swing {
            Ok(swing) => rows.push(cells(&series.name, swing)),
            Err(why) => none.push(format!("{}: {why}", series.name)),
        }
    }
    let n = sways.n_samples;
    let mut text = format!(
        "{n} samples, {:.2} a second, {:.2} to {:.2} s; looked for above {:.3} Hz",
        sways.fps,
        sways.start_s,
        at_s(n - 1),
        sways.lowest_hz
    );
    if sways.median.is_some() {
        text += &format!("\n{}", report::table(&rows));
        text += "\nHz: natural, without damping; ±: standard errors; swings: those above the noise";
    }
    none.iter().for_each(|why| text += &format!("\n{why}"));
    let is_calm = sways.median.is_some_and(|swing| swing.manner != Manner::Driven);
    if args.above == 0.0 && !is_calm {
        text += "\nGusts may hide a swing that is faster: --above HZ leaves out what is slower.";
    }
    let alias = sways.may_be_alias();
    if let Some((hz, aliases)) = &alias {
        text += &format!("\n{}", aliased(*hz, aliases));
    }
    let curves = curves(sways, args);
    let files = written(curves.as_ref(), args)?;
    text += &curves.as_ref().map_or_else(String::new, Curves::text);
    files.iter().for_each(|path| text += &format!("\n{}", path.display()));
    let series = sways.series.iter().map(|series| {
        let told = series.swing.as_ref().ok().map(|swing| swung(swing, sways.start_s, sways.fps));
        json!({
            "name": series.name,
            "swing": told,
            "why_none": series.swing.as_ref().err().map(ToString::to_string),
            "half_power": sways.half_power(series).as_ref().map(half_power),
        })
    });
    let json = json!({
        "fps": sways.fps,
        "samples": n,
        "from_s": sways.start_s,
        "to_s": at_s(n - 1),
        "lowest_hz": sways.lowest_hz,
        "median": sways.median.map(|swing| swung(&swing, sways.start_s, sways.fps)),
        "may_be_alias": alias.is_some(),
        "series": series.collect::<Vec<_>>(),
        "welch": curves.as_ref().map(Curves::json),
        "files": files,
    });
    Ok(Answer { json, text, done: true })
}

/// The densities of all series; `None` of a record that is too short for them.
fn curves<'a>(sways: &'a Sways, args: &Spectrum) -> Option<Curves<'a>> {
    let curve = |series: &'a Series| {
        let (name, density) = (series.name.clone(), series.density.as_ref()?);
        Some(Curve { name, density, peak: sways.half_power(series) })
    };
    Some(Curves {
        unit: sways.unit.unwrap_or("unit"),
        window: args.window,
        piece_s: sways.piece_s?,
        told: sways.series.iter().filter_map(curve).collect(),
        more: Vec::new(),
    })
}

/// A damping and its standard error; of what is steady how near to none it is.
pub(super) fn damped(swing: &Swing, told: Told, scale: f64, digits: usize) -> String {
    let (value, error) = (scale * told.value, scale * told.error);
    match swing.manner {
        Manner::Steady => format!("0 within {:.digits$}", SURE * error),
        _ => format!("{value:.digits$}±{error:.digits$}"),
    }
}

fn manner(manner: Manner) -> &'static str {
    match manner {
        Manner::LetGo => "let go",
        Manner::Steady => "steady",
        Manner::Growing => "growing",
        Manner::Driven => "driven",
    }
}

pub(super) fn swung(swing: &Swing, start_s: f64, fps: f64) -> serde_json::Value {
    let decrement = swing.log_decrement();
    json!({
        "manner": manner(swing.manner),
        "hz": swing.hz.value,
        "hz_error": swing.hz.error,
        "damped_hz": swing.damped_hz(),
        "damping": swing.ratio.value,
        "damping_error": swing.ratio.error,
        "log_decrement": decrement.value,
        "log_decrement_error": decrement.error,
        "cycles": swing.n_cycles,
        "from_s": start_s + swing.first as f64 / fps,
    })
}
