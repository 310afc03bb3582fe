//! `simulate`: modes of a plant, and how it moves in the wind.

use honami_model::plant::RadiusRule;
use honami_workbench::mechanics::{Damping, Form, Integrator, Material, Options};
use honami_workbench::plant::sway::{self, Motion, Moved};
use honami_workbench::plant::{self, Vibrating, Wish, weather};
use serde_json::json;

use super::args::plant::{Bend, Method, Plant, Radius, Simulate};
use super::{Answer, report, want};

/// Modes that are listed for people; all of them are in `--json`.
const LISTED: usize = 30;

/// Finds the modes; where anything moves, moves the plant.
pub(super) fn simulate(args: &Simulate) -> anyhow::Result<Answer> {
    let n_frames = (args.seconds * args.fps).round();
    want((1.0..=1e8).contains(&n_frames), || {
        format!(
            "a motion has 1 to 100000000 frames, {} s at {} a second are {n_frames}",
            args.seconds, args.fps
        )
    })?;
    want(args.sensors > 0, || "one sensor at least is wanted".to_owned())?;
    let wind = weather::blow(&args.wind)?;
    let wish = wish(&args.plant);
    let plant = plant::vibrate(&wish)?;
    if let Some(beams) = &args.beams {
        plant::write_beams(&plant, beams)?;
    }
    let damping = Damping { alpha: args.alpha, beta: args.beta, mass: args.heavier };
    let (mut text, mut json) = describe(&wish, &plant, &damping);
    let is_moved =
        args.wind != "still" || args.pull.abs() > 0.0 || args.forest.is_some() || args.out.is_some();
    if is_moved {
        let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        let motion = Motion {
            n_copies: args.forest.unwrap_or(1) as usize,
            n_frames: n_frames as u32,
            fps: args.fps,
            n_substeps: args.substeps,
            integrator: match args.method {
                Method::Exact => Integrator::Exact,
                Method::Symplectic => Integrator::Symplectic,
                Method::Newmark => Integrator::Newmark,
            },
            damping,
            form: match args.bend {
                Bend::Linear => Form::Linear,
                Bend::S2 => Form::Mode(2),
                Bend::S3 => Form::Mode(3),
            },
            pull: args.pull,
            n_sensors: args.sensors as usize,
            seed: args.seed,
            n_threads: args.threads.unwrap_or(cores).max(1),
        };
        let moved = sway::sway(&plant, &*wind, &motion, args.out.as_deref(), &report::Bar::new())?;
        text += &format!("\n{}", told(args, &motion, &moved));
        json["motion"] = entry(&motion, &moved, args);
    }
    Ok(Answer { json, text, done: true })
}

/// What is asked for of a plant.
pub(super) fn wish(args: &Plant) -> Wish {
    let rule = match args.radius {
        Radius::Mean => RadiusRule::Mean,
        Radius::Tip => RadiusRule::Tip,
    };
    let material = Material { young: args.young, poisson: args.poisson, density: args.density };
    Wish {
        source: args.source.clone(),
        unit: args.unit,
        diameters: args.diameters,
        classes: args.classes.clone(),
        beams: Options { rule, material, longest: args.longest },
        leaf_mass: args.leaf_mass,
        leaf_drag: args.leaf_drag,
        ..Wish::of(&args.source, args.modes as usize)
    }
}

fn describe(wish: &Wish, plant: &Vibrating, damping: &Damping) -> (String, serde_json::Value) {
    let Vibrating { modes, beams, notes, .. } = plant;
    let rule = plant::words(wish.beams.rule);
    let mut text = format!(
        "{}: {:.2} m high, {} nodes measured, {} nodes of beams; radius of a beam: {rule}",
        wish.source,
        plant.height,
        plant.n_measured,
        beams.len()
    );
    notes.iter().for_each(|note| text += &format!("\nnote: {note}"));
    let heavier = damping.mass.sqrt();
    let ratio = |omega: f64| {
        let omega = omega / heavier;
        (damping.alpha + damping.beta * omega.powi(2)) / (2.0 * omega)
    };
    let head = ["mode", "Hz", "damping %", "residual", "by wind x", "y", "z"];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for mode in 0..modes.len().min(LISTED) {
        let force = plant.basis.forces[mode];
        let mut row = vec![
            (mode + 1).to_string(),
            format!("{:.4}", modes.hz(mode) / heavier),
            format!("{:.2}", 100.0 * ratio(modes.omegas[mode])),
            format!("{:.0e}", modes.residuals[mode]),
        ];
        row.extend(force.iter().map(|p| format!("{p:.4}")));
        rows.push(row);
    }
    text += &format!("\n{}", report::table(&rows));
    if modes.len() > LISTED {
        text += &format!("\n… and {} more modes: --json", modes.len() - LISTED);
    }
    text += &format!(
        "\n{} modes in {:.0} ms; the count of pivots says that none below {:.4} Hz was missed",
        modes.len(),
        plant.seconds * 1e3,
        modes.hz(modes.len() - 1) / heavier
    );
    let entries: Vec<_> = (0..modes.len())
        .map(|mode| {
            let (hz, residual) = (modes.hz(mode) / heavier, modes.residuals[mode]);
            let wind: Vec<f64> = plant.basis.forces[mode].iter().copied().collect();
            json!({ "hz": hz, "residual": residual, "damping": ratio(modes.omegas[mode]), "wind": wind })
        })
        .collect();
    let json = json!({
        "modes": entries,
        // A search that is not certain is an error.
        "certified": true,
        "height_m": plant.height,
        "nodes": plant.n_measured,
        "beam_nodes": beams.len(),
        "radius": rule,
        "material": {
            "young": wish.beams.material.young,
            "poisson": wish.beams.material.poisson,
            "density": wish.beams.material.density,
        },
        "notes": notes,
        "seconds": plant.seconds,
    });
    (text, json)
}

fn told(args: &Simulate, motion: &Motion, moved: &Moved) -> String {
    let copies =
        if motion.n_copies == 1 { "it".to_owned() } else { format!("each of {} copies", motion.n_copies) };
    let mut text = format!(
        "{} frames of {copies}: the highest end deviates by {:.3} m from its mean place, {:.3} m at most from rest",
        moved.n_frames, moved.deviation, moved.farthest
    );
    text += &format!(
        "\n{:.2} ms a frame on {} threads, {:.1} MB",
        moved.frame_s * 1e3,
        motion.n_threads,
        moved.bytes as f64 / 1e6
    );
    if let Some(out) = &args.out {
        text += &format!("\n{}: where {} ends of branches are", out.display(), moved.sensors.len());
    }
    text
}

fn entry(motion: &Motion, moved: &Moved, args: &Simulate) -> serde_json::Value {
    json!({
        "frames": moved.n_frames,
        "fps": motion.fps,
        "copies": motion.n_copies,
        "wind": args.wind,
        "sensors": moved.sensors,
        "deviation_m": moved.deviation,
        "farthest_m": moved.farthest,
        "frame_ms": moved.frame_s * 1e3,
        "threads": motion.n_threads,
        "bytes": moved.bytes,
        "out": args.out,
    })
}
