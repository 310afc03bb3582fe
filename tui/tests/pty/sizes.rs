//! Terminals whose size changes faster than anybody paints.

use std::time::{Duration, Instant};

use super::{PATIENCE, Terminal, folder, size};

/// A terminal gets another size: first it, then the program, as in life.
fn resize(terminal: &mut Terminal, (columns, rows): (u16, u16)) {
    let screen = terminal.emulator.screen_mut();
    screen.set_size(rows.try_into().unwrap(), columns.try_into().unwrap());
    terminal.pty.resize(size(columns, rows)).unwrap();
}

/// What is on the screen, cell by cell, but for the figures of the link at the right of the title.
fn cells(screen: &vt100::Screen) -> Vec<(String, vt100::Color, vt100::Color, bool)> {
    let (rows, columns) = screen.size();
    let (rows, columns) = (rows.get(), columns.get());
    let in_figures = |row: u16, column: u16| row == 0 && column >= columns / 2;
    let all = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
    all.filter(|&(row, column)| !in_figures(row, column))
        .filter_map(|(row, column)| screen.cell(row, column))
        .map(|cell| {
            // Blank is blank, whether it was painted or erased, with whichever pen, and what has the colour of its ground.
            let is_unseen = cell.fgcolor() != vt100::Color::Default && cell.fgcolor() == cell.bgcolor();
            let is_blank = (cell.contents().trim().is_empty() || is_unseen) && !cell.inverse();
            let pen = if is_blank { vt100::Color::Default } else { cell.fgcolor() };
            let text = if is_blank { " " } else { cell.contents() };
            (text.to_owned(), pen, cell.bgcolor(), cell.inverse())
        })
        .collect()
}

/// The clip's square in frame 3 on a screen of 80 by 24, with sharp edges.
fn is_square(screen: &vt100::Screen) -> bool {
    let colour = |column, row| screen.cell(row, column).map(vt100::Cell::bgcolor);
    let is = |column, row, level| colour(column, row) == Some(vt100::Color::Rgb(level, level, level));
    (24..34).all(|column| (8..13).all(|row| is(column, row, 255)))
        && (8..13).all(|row| is(20, row, 0) && is(38, row, 0))
}

#[test]
fn after_a_storm_of_sizes_the_screen_is_as_if_there_had_been_none() {
    let last = (80, 24);
    let steep = [(200, 60), (20, 5), (1, 1), last];
    let wild = [(1, 1), (2, 40), (300, 1), (3, 3), (132, 43), last];
    let near = [(81, 24), last, (79, 24), last, (80, 25), last, (80, 1), last];
    let calm_folder = folder();
    let mut calm = Terminal::honami(calm_folder.path(), last, true);
    calm.wait_for_text("0/11");
    calm.press("3gf");
    for (storm, n_times, is_heard) in
        [(&steep[..], 1, true), (&steep, 25, false), (&wild, 10, true), (&near, 40, false)]
    {
        let folder = folder();
        let mut terminal = Terminal::honami(folder.path(), (120, 40), true);
        terminal.wait_for_text("0/11");
        terminal.press(" ");
        terminal.wait_for("that it plays", |s| !s.contents().contains("\n0/11"));
        for &to in storm.iter().cycle().take(n_times * storm.len()) {
            resize(&mut terminal, to);
            // Now the program paints between two sizes, now nobody looks until the end.
            if is_heard {
                terminal.listen(Duration::from_millis(3));
            }
        }
        terminal.press("3gf");
        let until = Instant::now() + PATIENCE;
        let screens = |terminals: [&Terminal; 2]| terminals.map(|t| t.emulator.screen().clone());
        loop {
            let [after, without] = screens([&terminal, &calm]);
            if is_square(&after) && cells(&after) == cells(&without) {
                break;
            }
            if Instant::now() >= until {
                let differ = cells(&after).into_iter().zip(cells(&without)).find(|(a, b)| a != b);
                panic!("{}\nis sharp: {}; differs in {differ:?}", after.contents(), is_square(&after));
            }
            for terminal in [&mut terminal, &mut calm] {
                terminal.listen(Duration::from_millis(20));
            }
        }
        terminal.press("q");
        assert!(terminal.wait_for_end());
        terminal.assert_restored();
    }
}
