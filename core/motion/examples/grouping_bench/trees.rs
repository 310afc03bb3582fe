//! Trees whose branches are known, and their groups of tips.

use honami_exchange::plant::{mtg, qsm};
use honami_mechanics::{Beams, Material, Options};
use honami_model::plant::{Node, Plant};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::error::Error;
use std::f64::consts::TAU;
use std::fmt;
use std::path::PathBuf;

/// How a tree is built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Habit {
    /// Forks again and again: the tree of honami's synth.
    Forking,
    /// One stem up to the top, with whorls of branches.
    Conifer,
    /// Many stems from the ground.
    Shrub,
    /// A walnut that was digitised (Sinoquet and others 1997).
    Walnut,
    /// An ash, a maple or an oak that was scanned (Jackson and others 2019), by its number.
    Wytham(&'static str),
}

impl fmt::Display for Habit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Forking => "forking",
            Self::Conifer => "conifer",
            Self::Shrub => "shrub",
            Self::Walnut => "walnut",
            Self::Wytham(number) => return write!(f, "Wytham {number}"),
        })
    }
}

impl Habit {
    /// Whether it is grown, or measured and the folder of measured ones is named.
    pub(crate) fn is_there(self) -> bool {
        !matches!(self, Self::Walnut | Self::Wytham(_)) || std::env::var_os(DATA).is_some()
    }
}

/// Names the folder of trees that were measured.
const DATA: &str = "HONAMI_DATA";
/// Radius of a twig, metres; towards the root areas add up.
const TWIG: f64 = 0.0025;
/// Groups of fewer tips are not scored.
const FEWEST: usize = 5;

/// Beams of a tree with at least so many tips.
pub(crate) fn grow(habit: Habit, n_tips: usize, seed: u64) -> Result<Beams, Box<dyn Error>> {
    let mut n_nodes = 3 * n_tips;
    loop {
        let plant = match habit {
            Habit::Forking => honami_synth::tree(n_nodes, seed)?,
            Habit::Conifer => conifer(n_nodes, seed)?,
            Habit::Shrub => shrub(n_nodes, seed)?,
            Habit::Walnut | Habit::Wytham(_) => return measured(habit),
        };
        let beams = Beams::new(&plant, &Options::default())?;
        if beams.ends().len() >= n_tips {
            return Ok(beams);
        }
        n_nodes += n_nodes / 8;
    }
}

/// A tree from the folder that `HONAMI_DATA` names.
fn measured(habit: Habit) -> Result<Beams, Box<dyn Error>> {
    let data = PathBuf::from(std::env::var_os(DATA).ok_or("HONAMI_DATA is not set")?);
    if let Habit::Wytham(number) = habit {
        let file = data.join(format!("trees/wytham_qsm/cyl_data_{number}_Validation_1_1.mat"));
        let plant = qsm::parse_mat(&std::fs::read(file)?)?.plant;
        let material = Material { young: 7e9, density: 800.0, ..Material::default() };
        return Ok(Beams::new(&plant, &Options { material, ..Default::default() })?);
    }
    let text = std::fs::read_to_string(data.join("trees/openalea_mtg/noylum2.mtg"))?;
    Ok(Beams::new(&mtg::parse(&text, &mtg::Options::default())?.plant, &Options::default())?)
}

/// Whorls on a stem of 12 m; the lower they are the longer their branches, with twigs of twigs to both sides.
fn conifer(n_nodes: usize, seed: u64) -> Result<Plant, Box<dyn Error>> {
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut nodes = vec![Node { parent: None, position: [0.0; 3], radius: TWIG }];
    // Whorls bear some 50 branches; each node of one bears two twigs of two nodes.
    let longest = (n_nodes as f64 / (50.0 * 5.0 * 0.55)).round().max(3.0);
    let mut stem = 0;
    for level in 1..=24 {
        let [x, y, _] = nodes[stem as usize].position;
        let [dx, dy]: [f64; 2] = std::array::from_fn(|_| rng.random_range(-0.02..0.02));
        stem = add(&mut nodes, stem, [x + dx, y + dy, 0.5 * f64::from(level)]);
        if level < 4 {
            continue;
        }
        let share = 1.0 - f64::from(level - 4) / 21.0;
        let n_branches = rng.random_range(2..=3);
        let turn = rng.random_range(0.0..TAU);
        for branch in 0..n_branches {
            let angle = turn + TAU * f64::from(branch) / f64::from(n_branches) + rng.random_range(-0.2..0.2);
            let mut at = stem;
            for step in 0..(longest * share).ceil() as u32 {
                at = out(&mut nodes, at, angle, 0.3, -0.06 * f64::from(step), &mut rng);
                for side in [-0.9, 0.9] {
                    let twig = out(&mut nodes, at, angle + side, 0.2, 0.0, &mut rng);
                    out(&mut nodes, twig, angle + side, 0.15, 0.0, &mut rng);
                }
            }
        }
    }
    thicken(&mut nodes);
    Ok(Plant::new(nodes)?)
}

/// Eight stems that lean out, each a small forking tree.
fn shrub(n_nodes: usize, seed: u64) -> Result<Plant, Box<dyn Error>> {
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut nodes = vec![Node { parent: None, position: [0.0; 3], radius: TWIG }];
    for stem in 0..8 {
        let one = honami_synth::tree(n_nodes / 8, 1000 * seed + stem)?;
        let size = rng.random_range(0.25..0.4);
        let (lean, way) =
            (rng.random_range(0.2..0.6_f64), TAU * stem as f64 / 8.0 + rng.random_range(-0.3..0.3));
        let first = nodes.len() as u32;
        for node in one.nodes() {
            let [x, y, z] = node.position.map(|v| size * v);
            // Leaned about a level axis.
            let (along, across) = (x * way.cos() + y * way.sin(), y * way.cos() - x * way.sin());
            let (along, up) = (along * lean.cos() + z * lean.sin(), z * lean.cos() - along * lean.sin());
            let along = along + 0.15;
            let position =
                [along * way.cos() - across * way.sin(), along * way.sin() + across * way.cos(), up];
            let parent = Some(node.parent.map_or(0, |parent| first + parent));
            nodes.push(Node { parent, position, radius: TWIG });
        }
    }
    thicken(&mut nodes);
    Ok(Plant::new(nodes)?)
}

fn add(nodes: &mut Vec<Node>, parent: u32, position: [f64; 3]) -> u32 {
    nodes.push(Node { parent: Some(parent), position, radius: TWIG });
    nodes.len() as u32 - 1
}

/// A segment outward and up, a little by chance.
fn out(nodes: &mut Vec<Node>, from: u32, angle: f64, length: f64, rise: f64, rng: &mut Pcg64) -> u32 {
    let angle = angle + rng.random_range(-0.15..0.15);
    let rise = rise + 0.25 + rng.random_range(-0.1..0.1);
    let [x, y, z] = nodes[from as usize].position;
    add(nodes, from, [x + length * angle.cos(), y + length * angle.sin(), z + length * rise])
}

fn thicken(nodes: &mut [Node]) {
    let mut areas = vec![0.0; nodes.len()];
    for row in (0..nodes.len()).rev() {
        let area = f64::max(areas[row], TWIG * TWIG);
        nodes[row].radius = area.sqrt();
        if let Some(parent) = nodes[row].parent {
            areas[parent as usize] += area;
        }
    }
}

/// Which group each tip is in: the most populous subtree is split until there are so many of 5 tips or more, or a few more;
/// `None` for tips of smaller ones, or where the tree has too few branches of 5 tips.
pub(crate) fn groups(beams: &Beams, tips: &[u32], n_groups: usize) -> Option<Vec<Option<u32>>> {
    let n = beams.len();
    let mut children = vec![Vec::new(); n];
    let mut n_below = vec![0_usize; n];
    tips.iter().for_each(|tip| n_below[*tip as usize] += 1);
    for node in (0..n).rev() {
        if let Some(parent) = beams.parent(node) {
            children[parent as usize].push(node);
            n_below[parent as usize] += n_below[node];
        }
    }
    let mut tops = vec![0_usize];
    while tops.iter().filter(|top| n_below[**top] >= FEWEST).count() < n_groups {
        let most = (0..tops.len()).max_by_key(|k| n_below[tops[*k]])?;
        if n_below[tops[most]] < FEWEST {
            return None;
        }
        let top = tops.swap_remove(most);
        tops.extend(children[top].iter().filter(|child| n_below[**child] > 0));
    }
    let mut group_of = vec![None; n];
    for (group, top) in (0_u32..).zip(tops.into_iter().filter(|top| n_below[*top] >= FEWEST)) {
        let mut open = vec![top];
        while let Some(node) = open.pop() {
            group_of[node] = Some(group);
            open.extend(&children[node]);
        }
    }
    Some(tips.iter().map(|tip| group_of[*tip as usize]).collect())
}
