//! `simulate`: modes of a plant, and how it moves in the wind.

use std::path::{Path, PathBuf};

use honami_model::brief::counted;
use honami_model::plant::RadiusRule;
use honami_workbench::mechanics::{Damping, Form, Integrator, Leaves, Material, Options, Oscillator};
use honami_workbench::plant::glb::Made;
use honami_workbench::plant::mover::{Mover, Way};
use honami_workbench::plant::outs::Outs;
use honami_workbench::plant::spans::Spans;
use honami_workbench::plant::sway::{self, Motion, Moved};
use honami_workbench::plant::told::{self, Chosen};
use honami_workbench::plant::weather::{self, Typed};
use honami_workbench::plant::{self, Vibrating, Wish};
use honami_workbench::plugins::Kind;
use serde_json::json;

use super::args::Common;
use super::args::plant::{Bend, Method, Plant, Radius, Simulate};
use super::{Answer, report, told_options, want};

/// The simulator that is used unless one is named.
pub(super) const DEFAULT: &str = "modal";
/// Modes that are listed for people; all of them are in `--json`.
const LISTED: usize = 30;

/// Finds the modes; where anything moves, moves the plant.
pub(super) fn simulate(args: &Simulate, common: &Common) -> anyhow::Result<Answer> {
    let n_frames = (args.seconds * args.fps).round();
    want((1.0..=1e8).contains(&n_frames), || {
        format!(
            "a motion has 1 to 100000000 frames, {:?} s at {:?} a second are {n_frames:?}",
            args.seconds, args.fps
        )
    })?;
    want(args.sensors > 0, || "one sensor at least is wanted".to_owned())?;
    let is_round = args.method == Method::Spectrum;
    want(!is_round || args.pull == 0.0, || {
        "what goes round by --method spectrum has no beginning at which it could be pulled: leave out --pull, or the method"
            .to_owned()
    })?;
    want(!is_round || (args.plugin.with.is_none() && args.plugin.set.is_empty()), || {
        "--method spectrum moves a plant by its own modes, not by a simulator: leave out --with and --set"
            .to_owned()
    })?;
    let wind = weather::read(&args.wind)?;
    let replaced = replaced(args, &wind)?;
    let (mut wish, mut motion) = (wish(&args.plant), motion(args, n_frames as u32));
    motion.check()?;
    let options = told_options(common);
    let registry = options.registry();
    let mut simulator = None;
    // Modes alone are found without one, unless it is one that is asked.
    let is_wanted = args.plugin.with.is_some() || !args.plugin.set.is_empty();
    if !is_round && (is_wanted || is_moved(args, &motion)) {
        let plugin = registry.find(Kind::Simulator, args.plugin.with.as_deref().unwrap_or(DEFAULT))?;
        let told = told::told(&wish, &motion, plugin, Chosen::Only(&args.typed.0), &args.plugin.set)?;
        (wish, motion) = (told.wish, told.motion);
        simulator = Some((plugin, told.values, told.notes));
    }
    let bar = report::Bar::with(common);
    let plant = plant::vibrate(&wish, &bar)?;
    let (mut text, mut json) = describe(&wish, &plant, &motion.damping);
    if is_moved(args, &motion) {
        let way = simulator.as_ref().map_or(Way::Spectrum, |(plugin, values, _)| {
            Way::Steps(Mover { host: &options.host, plugin, values })
        });
        let [table, cache, glb, beams] =
            [&args.out, &args.cache, &args.glb, &args.beams].map(|path| path.as_deref());
        let outs = Outs { table, cache, glb, beams };
        let again = wind.again(f64::from(motion.n_frames - 1) / motion.fps);
        let ground = weather::ground(&plant, &motion);
        let wind = wind.over(&if is_round { ground.round() } else { ground })?;
        let mut moved = sway::sway(&plant, &way, &*wind, &motion, outs, &bar)?;
        let notes = simulator.iter().flat_map(|(_, _, notes)| notes.clone());
        // What goes round is drawn to its own length.
        moved.warnings.splice(0..0, notes.chain(again.into_iter().filter(|_| !is_round)));
        let spans = Spans::of(&plant, &motion);
        let told = told(args, &motion, &moved, &spans);
        text += &format!("\n{}", report::with_warnings(&told, &moved.warnings));
        if let Some(too_far) = moved.too_far.take() {
            report::say(&format!("warning: {too_far}"));
            moved.warnings.push(too_far);
        }
        json["motion"] = entry(&motion, &moved, args);
        json["motion"]["copies_span"] =
            json!({ "hz": spans.hz, "height_m": spans.height, "kg": spans.kilograms });
        json["motion"]["simulator"] = simulator.map(|(plugin, ..)| plugin.id.clone()).into();
        json["motion"]["goes_round"] = is_round.into();
    } else if let Some(beams) = &args.beams {
        plant::write_beams(&plant, beams)?;
    }
    if !replaced.is_empty() {
        let shown: Vec<String> = replaced.iter().map(|path| path.display().to_string()).collect();
        text += &format!("\nin place of what had this name: {}", shown.join(", "));
        json["replaced"] = json!(replaced);
    }
    Ok(Answer { json, text, done: true })
}

/// Whether more than modes is wanted.
fn is_moved(args: &Simulate, motion: &Motion) -> bool {
    let is_written = args.out.is_some() || args.cache.is_some() || args.glb.is_some();
    args.wind != "still" || motion.pull.abs() > 0.0 || args.stand.forest.is_some() || is_written
}

/// Files that are wanted, with what each is and how its name ends.
fn outs(args: &Simulate) -> impl Iterator<Item = (&Path, &'static str, &'static str)> {
    let known = [
        (&args.out, "a table of where sensors are", "csv"),
        (&args.cache, "a point cache", "pc2"),
        (&args.glb, "a plant with its motion", "glb"),
        (&args.beams, "a table of beams", "csv"),
    ];
    known.into_iter().filter_map(|(path, what, ending)| Some((path.as_deref()?, what, ending)))
}

/// Nothing that is written takes the place of what is read, or of what else is written; all say by their names what they are.
/// Those that take the place of what was written before.
fn replaced(args: &Simulate, wind: &Typed) -> anyhow::Result<Vec<PathBuf>> {
    let read = std::iter::once(Path::new(&args.plant.source)).chain(wind.files());
    let mut taken: Vec<_> = read.map(place).collect();
    for (out, what, ending) in outs(args) {
        let shown = out.display();
        want(out.extension().is_some_and(|e| e.eq_ignore_ascii_case(ending)), || {
            format!("{what} is written as .{ending}, not as {shown}")
        })?;
        want(!taken.contains(&place(out)), || {
            format!("{shown} is read or written already: choose another name")
        })?;
        taken.push(place(out));
    }
    Ok(outs(args).map(|(out, ..)| out.to_owned()).filter(|out| out.exists()).collect())
}

/// Where a file is, or would be.
fn place(path: &Path) -> PathBuf {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let beside = || Some(folder.canonicalize().ok()?.join(path.file_name()?));
    path.canonicalize().ok().or_else(beside).unwrap_or_else(|| path.to_owned())
}

/// What is asked for of a motion.
fn motion(args: &Simulate, n_frames: u32) -> Motion {
    Motion {
        n_frames,
        fps: args.fps,
        n_substeps: args.substeps,
        integrator: match args.method {
            // What goes round takes no step.
            Method::Exact | Method::Spectrum => Integrator::Exact,
            Method::Symplectic => Integrator::Symplectic,
            Method::Newmark => Integrator::Newmark,
        },
        form: match args.bend {
            Bend::Turn => Form::Turn,
            Bend::Linear => Form::Linear,
            Bend::S2 => Form::Mode(2),
            Bend::S3 => Form::Mode(3),
        },
        pull: args.pull,
        n_sensors: args.sensors as usize,
        sensors: args.nodes.clone(),
        n_threads: args.threads.unwrap_or(honami_workbench::track::threads() as usize),
        ..args.stand.motion()
    }
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
        leaves: Leaves { mass: args.leaf_mass, drag: args.leaf_drag },
        drag: args.drag,
        air_density: args.air_density,
        ..Wish::of(&args.source, args.modes.map(|modes| modes as usize))
    }
}

fn describe(wish: &Wish, plant: &Vibrating, damping: &Damping) -> (String, serde_json::Value) {
    let Vibrating { modes, beams, notes, .. } = plant;
    let rule = plant::words(wish.beams.rule);
    let mut text = format!(
        "{}: {:.2} m high, {} measured, {} of beams; radius of a beam: {rule}",
        wish.source,
        plant.height,
        counted(plant.n_measured, "node"),
        counted(beams.len(), "node")
    );
    notes.iter().for_each(|note| text += &format!("\nnote: {note}"));
    let heavier = damping.mass.sqrt();
    let ratio = |omega: f64| Oscillator::new(omega, damping).damping();
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
        text += &format!("\n… and {}: --json", counted(modes.len() - LISTED, "more mode"));
    }
    text += &format!(
        "\n{} in {:.0} ms; the count of pivots says that none below {:.4} Hz was missed",
        counted(modes.len(), "mode"),
        plant.seconds * 1e3,
        modes.hz(modes.len() - 1) / heavier
    );
    let creeping = modes.omegas.iter().filter(|omega| ratio(**omega) >= 1.0).count();
    if creeping > 0 {
        text += &format!(
            "\nnote: {} damped by 100 % or more, beyond critical: pulled, {} back and {} not swing",
            if creeping == 1 { "1 mode is".to_owned() } else { format!("{creeping} modes are") },
            if creeping == 1 { "it creeps" } else { "they creep" },
            if creeping == 1 { "does" } else { "do" },
        );
    }
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

fn told(args: &Simulate, motion: &Motion, moved: &Moved, spans: &Spans) -> String {
    let copies =
        if motion.n_copies == 1 { "it".to_owned() } else { format!("each of {} copies", motion.n_copies) };
    let who = args.nodes.first().map_or("the highest end".to_owned(), |node| format!("node {node}"));
    let mut text = format!(
        "{} of {copies}: {who} deviates by {:.3} m from its mean place, {:.3} m at most from rest",
        counted(moved.n_frames as usize, "frame"),
        moved.deviation,
        moved.farthest
    );
    if motion.n_copies > 1 {
        let [hz, metres, kg] = [spans.hz, spans.height, spans.kilograms].map(|[least, most]| {
            if most - least <= 1e-6 * most {
                format!("{most:.4}")
            } else {
                format!("{least:.4} to {most:.4}")
            }
        });
        text += &format!("\ncopies: slowest mode {hz} Hz, {metres} m high, {kg} kg");
    }
    if args.method == Method::Spectrum {
        let seconds = f64::from(moved.n_frames) / motion.fps;
        text += &format!("\nit goes round: after {seconds} s it is where it begins, and as fast");
    }
    text += &format!(
        "\n{:.2} ms a frame on {}, {:.1} MB",
        moved.frame_s * 1e3,
        counted(motion.n_threads, "thread"),
        moved.bytes as f64 / 1e6
    );
    if let Some(out) = &args.out {
        let followed = match moved.sensors.len() {
            1 => "1 node is".to_owned(),
            n => format!("{n} nodes are"),
        };
        text += &format!("\n{}: where {followed}, metres from the foot, z up", out.display());
    }
    if let Some(cache) = &args.cache {
        text += &format!("\n{}: where all nodes of all copies are, metres, z up", cache.display());
    }
    if let (Some(path), Some(made)) = (&args.glb, &moved.glb) {
        text += &format!(
            "\n{}: a mesh of {} with {}, {:.1} MB; at most {:.2} mm from where it moved",
            path.display(),
            counted(made.n_vertices, "vertex"),
            counted(made.n_targets, "morph target"),
            made.bytes as f64 / 1e6,
            made.off * 1e3
        );
    }
    text
}

fn entry(motion: &Motion, moved: &Moved, args: &Simulate) -> serde_json::Value {
    let glb = moved.glb.map(|made: Made| {
        json!({ "file": args.glb, "vertices": made.n_vertices, "targets": made.n_targets, "bytes": made.bytes, "off_m": made.off })
    });
    json!({
        "frames": moved.n_frames,
        "fps": motion.fps,
        "copies": motion.n_copies,
        "wind": args.wind,
        "sensors": moved.sensors,
        "deviation_m": moved.deviation,
        "farthest_m": moved.farthest,
        "farthest_of_height": moved.share,
        "frame_ms": moved.frame_s * 1e3,
        "threads": motion.n_threads,
        "bytes": moved.bytes,
        "warnings": moved.warnings,
        "out": args.out,
        "cache": args.cache,
        "glb": glb,
    })
}
