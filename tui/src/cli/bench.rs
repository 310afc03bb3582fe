//! `bench`: how fast it is here what the thesis has tables of.

use honami_model::brief::counted;
use honami_workbench::mechanics::Roof;
use honami_workbench::plant::bench::cells::{Cell, TABLE_6_1, TABLE_6_2};
use honami_workbench::plant::bench::{self, Boundary, Rate, Runs, Speed};
use honami_workbench::plant::{self, forms};
use honami_workbench::plugins::Kind;
use serde_json::{Value, json};

use super::args::Common;
use super::args::plant::{BenchBending, BenchForest};
use super::{Answer, report, simulate, told_options, want};

/// Forests of which less is moved where it is farther away.
const IN_VIEW: &str = "in_view";
/// The cell in which what a plugin costs is measured, unless others are asked for.
const BOUNDARY: Cell = (1000, 1000, 25, None);

/// Measures both tables, or the cells that were asked for.
pub(super) fn forest(args: &BenchForest, common: &Common) -> anyhow::Result<Answer> {
    want(args.seconds.is_finite() && args.seconds >= 0.0, || {
        format!("a run lasts 0 s or more, not {:?} s", args.seconds)
    })?;
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let n_threads = args.threads.unwrap_or(cores);
    let runs = Runs { n_runs: args.runs as usize, seconds: args.seconds, n_threads };
    // Before a minute is spent on what needs none.
    let options = told_options(common);
    let registry = options.registry();
    let plugin = registry.find(Kind::Simulator, simulate::DEFAULT)?;
    let roof = bench::roof(n_threads)?;
    let known = [&TABLE_6_1[..], &TABLE_6_2].concat();
    let given: Vec<Cell> = args.cells.iter().map(|cell| bench::of_thesis(&known, cell.0)).collect();
    let mut tables: Vec<(&str, &str, &[Cell])> = if given.is_empty() {
        vec![
            ("table_6_1", "table 6.1: 25 modes", &TABLE_6_1),
            ("table_6_2", "table 6.2: 3437 nodes", &TABLE_6_2),
            (IN_VIEW, "less of what is farther away, nothing of what is out of view", &bench::IN_VIEW),
        ]
    } else {
        vec![("cells", "cells", &given)]
    };
    let seen: Vec<Cell> =
        given.iter().map(|&(k, n, m, _)| bench::of_thesis(&bench::IN_VIEW, [k, n, m])).collect();
    if args.in_view {
        tables.push((
            IN_VIEW,
            "the same, with less of what is farther away, nothing of what is out of view",
            &seen,
        ));
    }
    let mut text = format!(
        "{}: {:.0} GFLOP/s at most, {:.1} GB/s written at most",
        counted(n_threads, "thread"),
        roof.flops / 1e9,
        roof.written / 1e9
    );
    let mut json = json!({
        "threads": n_threads,
        "roof": { "gflops": roof.flops / 1e9, "gb_per_s": roof.written / 1e9 },
    });
    for (key, title, cells) in tables {
        let measure = if key == IN_VIEW { bench::seen } else { bench::speeds };
        let speeds = measure(cells, &runs, &report::Bar::new())?;
        text += &format!("\n\n{title}\n{}", report::table(&rows(&speeds, &roof)));
        if key == IN_VIEW {
            speeds.iter().for_each(|speed| text += &format!("\n{}", made_out(speed)));
        }
        json[key] = speeds.iter().map(|speed| entry(speed, &roof)).collect();
    }
    let cell = given.first().copied().unwrap_or(BOUNDARY);
    let boundary = bench::boundary(&cell, &runs, &options.host, plugin)?;
    text += &format!("\n\n{}", across(&cell, &boundary));
    json["boundary"] = json!({
        "trees": cell.0,
        "nodes": cell.1,
        "modes": cell.2,
        "direct_ms": boundary.direct_s * 1e3,
        "plugin_ms": boundary.plugin_s * 1e3,
        "ratio": boundary.ratio,
    });
    text += "\n\nfps: frames per second, the median of the runs; s: the arc tangent of a mode, and its powers; turns: of segments";
    text += "\nof limit: the greater share of multiplications and of writing; state: share of the frame that modes take";
    Ok(Answer { json, text, done: true })
}

/// Compares the ways in which nodes can follow modes.
pub(super) fn bending(args: &BenchBending) -> anyhow::Result<Answer> {
    let plant = plant::vibrate(&simulate::wish(&args.plant), &report::Bar::new())?;
    let rows = forms::forms(&plant);
    let head = |what: &str| forms::DEFLECTIONS.map(|share| format!("{what} {:.0} %", 100.0 * share));
    let mut table =
        vec![[vec!["lengths, off, %".to_owned()], head("mode 1,").into(), head("wind,").into()].concat()];
    for row in &rows {
        let cells = row.alone.iter().chain(&row.in_wind);
        let cells = cells.map(|cell| format!("{} {}", percent(cell.stretch), percent(cell.off)));
        table.push(std::iter::once(row.form.to_owned()).chain(cells).collect());
    }
    let text = format!(
        "{} nodes, {} modes; the node that is moved most by so much of the height, by the slowest mode or by all in a wind\n{}\n\
         lengths: errors of segments; off: from where turning segments have nodes; roots of mean squares",
        plant.beams.len(),
        plant.modes.len(),
        report::table(&table)
    );
    let cells = |cells: &[forms::Cell]| -> Vec<Value> {
        let cells = cells.iter().zip(forms::DEFLECTIONS);
        cells
            .map(|(cell, share)| json!({ "deflection": share, "stretch": cell.stretch, "off": cell.off }))
            .collect()
    };
    let entry = |row: &forms::Row| json!({ "form": row.form, "slowest_mode": cells(&row.alone), "in_wind": cells(&row.in_wind) });
    let json = json!({ "height_m": plant.height, "forms": rows.iter().map(entry).collect::<Vec<_>>() });
    Ok(Answer { json, text, done: true })
}

/// Of a share, with two digits.
fn percent(share: f64) -> String {
    match 100.0 * share {
        percent if percent < 1e-4 => "0".to_owned(),
        percent if percent < 0.1 => format!("{percent:.4}"),
        percent if percent < 10.0 => format!("{percent:.2}"),
        percent => format!("{percent:.1}"),
    }
}

/// What of a forest is moved, in a line.
fn made_out(speed: &Speed) -> String {
    let Rate { n_in_view, n_moved, .. } = speed.linear;
    let all = speed.n_copies * speed.n_nodes;
    let share = 100.0 * n_moved as f64 / all as f64;
    format!(
        "of {} trees {n_in_view} are in view: {n_moved} of {all} nodes are moved ({share:.1} %)",
        speed.n_copies
    )
}

/// What a plugin costs, in a line.
fn across(cell: &Cell, Boundary { direct_s, plugin_s, ratio }: &Boundary) -> String {
    let [least, median, most] = ratio.map(|ratio| 100.0 * (ratio - 1.0));
    format!(
        "{} trees of {} nodes with {} modes, with and without the plugin in turns: a frame takes {:.3} ms, {:.3} ms through the plugin: {median:+.1} % \
         ({least:+.1} to {most:+.1} %)",
        cell.0,
        cell.1,
        cell.2,
        direct_s * 1e3,
        plugin_s * 1e3
    )
}

/// How near a rate is to the most that the machine can do.
fn share(rate: &Rate, roof: &Roof) -> f64 {
    (rate.flops / roof.flops).max(rate.written / roof.written)
}

fn rows(speeds: &[Speed], roof: &Roof) -> Vec<Vec<String>> {
    let head = [
        "trees",
        "nodes",
        "modes",
        "thesis fps",
        "linear fps",
        "of limit",
        "s,s2 fps",
        "of limit",
        "s,s2,s3 fps",
        "of limit",
        "turns fps",
        "of limit",
        "state",
    ];
    let row = |speed: &Speed| {
        let thesis = speed.thesis_fps.map_or_else(String::new, |fps| format!("{fps:.0}"));
        let mut row =
            vec![speed.n_copies.to_string(), speed.n_nodes.to_string(), speed.n_modes.to_string(), thesis];
        for rate in [&speed.linear, &speed.squared, &speed.cubed, &speed.turned] {
            row.push(format!("{:.1}", rate.fps));
            row.push(format!("{:.0} %", 100.0 * share(rate, roof)));
        }
        row.push(format!("{:.1} %", 100.0 * speed.turned.state_share));
        row
    };
    std::iter::once(head.map(str::to_owned).to_vec()).chain(speeds.iter().map(row)).collect()
}

fn entry(speed: &Speed, roof: &Roof) -> Value {
    let rate = |rate: &Rate| {
        json!({
            "fps": rate.fps,
            "of_limit": share(rate, roof),
            "of_flops": rate.flops / roof.flops,
            "of_writing": rate.written / roof.written,
            "state_share": rate.state_share,
            "in_view": rate.n_in_view,
            "nodes_moved": rate.n_moved,
        })
    };
    json!({
        "trees": speed.n_copies,
        "nodes": speed.n_nodes,
        "modes": speed.n_modes,
        "thesis_fps": speed.thesis_fps,
        "fps": speed.linear.fps,
        "corrected_fps": speed.squared.fps,
        "linear": rate(&speed.linear),
        "squared": rate(&speed.squared),
        "cubed": rate(&speed.cubed),
        "turned": rate(&speed.turned),
    })
}
