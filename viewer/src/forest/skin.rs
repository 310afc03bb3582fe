//! Vertices of all that is seen, worked out on the processor's cores: drivers that do without a card have one thread for
//! vertices, and are slow to read buffers there. What the shaders of `forest.wgsl` do for a vertex is done here once a ring
//! and once a leaf.

use std::sync::{Mutex, PoisonError};

use bytemuck::{Pod, Zeroable};
use honami_mechanics::Stand;
use honami_scene::ForestScene;
use honami_scene::body::{Leaf, Level, Ring};
use honami_scene::forest::live::Seen;
use honami_scene::vector::{cross, dot, unit};

/// A vertex of wood or of a leaf.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(super) struct Vertex {
    /// Metres in the world; and of wood how far along its branch.
    place: [f32; 4],
    /// Of length 1, in 127ths; the last of nothing.
    normal: [i8; 4],
    /// Across a leaf likewise; the last is what chance made of the copy.
    across: [i8; 4],
    /// Across a leaf or about the branch, along the leaf, how much of the sky it sees, its hue.
    at: [i8; 4],
}

/// How a vertex is read by shaders.
pub(super) const LAYOUT: wgpu::VertexBufferLayout<'_> = wgpu::VertexBufferLayout {
    array_stride: size_of::<Vertex>() as u64,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &wgpu::vertex_attr_array![0 => Float32x4, 1 => Snorm8x4, 2 => Snorm8x4, 3 => Snorm8x4],
};

/// A copy that is drawn: its level, and where its vertices begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Drawn {
    pub(super) level: usize,
    pub(super) wood: u32,
    pub(super) leaves: u32,
}

/// From where and when it is seen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Eye {
    pub(super) eye: [f32; 3],
    /// Metres that a pixel is wide a metre away.
    pub(super) pixel: f32,
    pub(super) time: f32,
}

/// Columns of what turns.
type Turned = [[f32; 3]; 3];

/// A copy as it stands.
struct Standing {
    place: [f32; 2],
    turn: [f32; 2],
    scale: f32,
    chance: f32,
    /// Metres per second.
    air: f32,
}

/// How many vertices there are of copies.
pub(super) fn n_vertices(scene: &ForestScene, seen: &[Seen<'_>]) -> u64 {
    seen.iter().map(|seen| of_level(&scene.body.levels[seen.level]) as u64).sum()
}

/// Vertices of a copy.
fn of_level(level: &Level) -> usize {
    level.n_vertices() as usize + 4 * level.leaves.len()
}

/// The vertices of copies, no more than 2³², one after the other, by so many threads; `airs`: how fast the air is at every copy.
pub(super) fn skin(
    scene: &ForestScene,
    seen: &[Seen<'_>],
    eye: &Eye,
    airs: &[f32],
    (n_threads, vertices): (usize, &mut Vec<Vertex>),
) -> Vec<Drawn> {
    let mut n = 0;
    let place = |seen: &Seen<'_>| {
        let level = &scene.body.levels[seen.level];
        let (wood, leaves) = (n, n + level.n_vertices());
        n = leaves + 4 * level.leaves.len() as u32;
        Drawn { level: seen.level, wood, leaves }
    };
    let drawn: Vec<Drawn> = seen.iter().map(place).collect();
    vertices.resize(n as usize, Vertex::default());
    let mut rest = vertices.as_mut_slice();
    let pieces = seen.iter().zip(&drawn).map(|(seen, drawn)| {
        let level = &scene.body.levels[drawn.level];
        let (own, others) = std::mem::take(&mut rest).split_at_mut(of_level(level));
        rest = others;
        let (at, stand) = (scene.places[seen.copy], &scene.stands[seen.copy]);
        (level, seen.motion, Standing::new(seen.copy, at, stand, airs[seen.copy]), own)
    });
    let pieces = Mutex::new(pieces.collect::<Vec<_>>().into_iter());
    let next = || pieces.lock().unwrap_or_else(PoisonError::into_inner).next();
    let all = || {
        while let Some((level, moved, copy, vertices)) = next() {
            copy.put(level, moved, eye, vertices);
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..n_threads {
            scope.spawn(all);
        }
        all();
    });
    drawn
}

impl Standing {
    fn new(copy: usize, place: [f32; 2], stand: &Stand, air: f32) -> Self {
        let (sin, cos) = stand.turn.sin_cos();
        Self { place, turn: [sin, cos], scale: stand.scale, chance: super::stage::chance(copy), air }
    }

    /// Rings and leaves of a level whose nodes are moved so.
    fn put(&self, level: &Level, moved: &[[f32; 3]], eye: &Eye, vertices: &mut [Vertex]) {
        let n_sides = level.n_sides as usize;
        let round: Vec<[f32; 2]> = (0..n_sides)
            .map(|k| (std::f32::consts::TAU * k as f32 / n_sides as f32).sin_cos().into())
            .collect();
        let of = |node: u32| moved[node as usize];
        let frames: Vec<(Turned, [f32; 3])> = level
            .rings
            .iter()
            .map(|ring| (self.turned(ring.turn(of)), add(ring.rest, of(ring.node))))
            .collect();
        let (wood, leaves) = vertices.split_at_mut(level.n_vertices() as usize);
        for ((ring, frame), vertices) in level.rings.iter().zip(&frames).zip(wood.chunks_exact_mut(n_sides)) {
            self.ring(ring, frame, &round, eye, vertices);
        }
        for (leaf, vertices) in level.leaves.iter().zip(leaves.chunks_exact_mut(4)) {
            self.leaf(leaf, &frames[leaf.ring as usize], eye, vertices);
        }
    }

    /// A turn in the plant's own axes, and then that of the copy.
    fn turned(&self, turn: [f32; 3]) -> Turned {
        let square = dot(turn, turn);
        let (sine, rest) = if square < 1e-12 {
            (1.0, 0.5)
        } else {
            let angle = square.sqrt();
            (angle.sin() / angle, (1.0 - angle.cos()) / square)
        };
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|axis| {
            let across = cross(turn, axis);
            let twice = cross(turn, across);
            self.in_world(std::array::from_fn(|k| axis[k] + sine * across[k] + rest * twice[k]))
        })
    }

    fn in_world(&self, [x, y, z]: [f32; 3]) -> [f32; 3] {
        let [sin, cos] = self.turn;
        [cos * x - sin * y, sin * x + cos * y, z]
    }

    /// Where a place of the plant is in the world.
    fn place(&self, own: [f32; 3]) -> [f32; 3] {
        let [x, y, z] = self.in_world(own);
        [self.place[0] + self.scale * x, self.place[1] + self.scale * y, self.scale * z]
    }

    fn ring(
        &self,
        ring: &Ring,
        (turned, middle): &(Turned, [f32; 3]),
        round: &[[f32; 2]],
        eye: &Eye,
        vertices: &mut [Vertex],
    ) {
        let middle = self.place(*middle);
        let [side, other] = [ring.side, ring.other].map(|way| apply(turned, way));
        let away: [f32; 3] = std::array::from_fn(|k| middle[k] - eye.eye[k]);
        // Never much thinner than a pixel: far twigs do not flicker.
        let radius = (self.scale * ring.radius).max(0.3 * eye.pixel * dot(away, away).sqrt());
        let along = ring.rest.iter().sum();
        for (k, ([sin, cos], vertex)) in round.iter().zip(vertices).enumerate() {
            let normal: [f32; 3] = std::array::from_fn(|axis| side[axis] * cos + other[axis] * sin);
            let [x, y, z] = std::array::from_fn(|axis| middle[axis] + radius * normal[axis]);
            *vertex = Vertex {
                place: [x, y, z, along],
                normal: small([normal[0], normal[1], normal[2], 0.0]),
                across: small([0.0, 0.0, 0.0, self.chance]),
                at: small([k as f32 / round.len() as f32, 0.0, ring.open, 0.0]),
            };
        }
    }

    /// Flutter is that of `leaf_at` in the shader.
    fn leaf(&self, leaf: &Leaf, (turned, middle): &(Turned, [f32; 3]), eye: &Eye, vertices: &mut [Vertex]) {
        let much = 0.03 + 0.55 * (1.0 - (-self.air / 9.0).exp());
        let pace = eye.time * (2.5 + 0.45 * self.air.min(12.0));
        let chance = leaf.chance;
        let roll = much * (pace * (0.8 + 0.5 * chance) * 2.1 + chance * 91.0).sin();
        let nod = 0.6 * much * (pace * (0.7 + 0.4 * (chance * 7.0).fract()) * 1.7 + chance * 57.0).sin();
        let up = leaf.up;
        let beside = cross(leaf.tip, up);
        let tip = unit(std::array::from_fn(|k| leaf.tip[k] + nod * up[k]));
        let across = unit(std::array::from_fn(|k| beside[k] + roll * up[k]));
        let normal = apply(turned, cross(across, tip));
        let base = self.place(*middle);
        let length = self.scale * leaf.length;
        let base = add(base, apply(turned, leaf.base).map(|v| v * self.scale));
        let along = apply(turned, tip).map(|v| v * length);
        let half = apply(turned, across).map(|v| v * length * 0.5 * leaf.breadth);
        let across = apply(turned, across);
        let hue = (chance + 0.35 * (self.chance - 0.5)).clamp(0.0, 1.0);
        for (k, vertex) in vertices.iter_mut().enumerate() {
            let (x, y) = ((k % 2) as f32 * 2.0 - 1.0, (k / 2) as f32);
            let at: [f32; 3] = std::array::from_fn(|axis| base[axis] + along[axis] * y + half[axis] * x);
            *vertex = Vertex {
                place: [at[0], at[1], at[2], 0.0],
                normal: small([normal[0], normal[1], normal[2], 0.0]),
                across: small([across[0], across[1], across[2], self.chance]),
                at: small([x, y, leaf.open, hue]),
            };
        }
    }
}

/// From -1 to 1 in 127ths.
fn small(numbers: [f32; 4]) -> [i8; 4] {
    numbers.map(|v| (v * 127.0).round() as i8)
}

fn apply(turned: &Turned, way: [f32; 3]) -> [f32; 3] {
    std::array::from_fn(|k| turned[0][k] * way[0] + turned[1][k] * way[1] + turned[2][k] * way[2])
}

fn add(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    std::array::from_fn(|k| a[k] + b[k])
}
