// Where the nodes of a copy are: segments turned by all modes together, each on the tip of the one before. A workgroup a
// copy; see the turns of honami-mechanics, whose series these are.
// with copies

struct Plant {
    n_nodes: u32,
    n_modes: u32,
    n_ranks: u32,
}

// Nodes in a row, each borne by the one before it; the first by `bearer`.
struct Chain {
    first: u32,
    n: u32,
    bearer: u32,
}

@group(0) @binding(0) var<uniform> plant: Plant;
@group(0) @binding(1) var<uniform> level: Level;
// By what a unit of a mode's amplitude turns the segment of a node: x, y and z of all nodes, mode after mode. At the end, as if
// of another mode, the segments at rest.
@group(0) @binding(2) var<storage, read> turns: array<f32>;
@group(0) @binding(3) var<storage, read> chains: array<Chain>;
// Nodes of chains, chain after chain; then, after `n_nodes` of them, where the chains of each rank begin, and where the last
// rank ends. Chains are borne by those of lower ranks.
@group(0) @binding(4) var<storage, read> nodes: array<u32>;
@group(0) @binding(5) var<storage, read> state: array<vec2f>;
@group(0) @binding(6) var<storage, read> seen: array<u32>;
@group(0) @binding(7) var<storage, read> groups: array<Groups>;
@group(0) @binding(8) var<storage, read_write> firsts: array<u32>;
@group(0) @binding(9) var<storage, read_write> moved: array<f32>;

const WIDE = 128u;
const ROW = 32768u;
const FARTHEST = 3.14159265;

fn cosine(x: f32) -> f32 {
    return 0.99999995 + x * (-0.49999905 + x * (0.041663573 + x * (-0.001385363 + x * 2.3152417e-5)));
}

fn sine(x: f32) -> f32 {
    return 1.0 + x * (-0.16666658 + x * (0.00833305 + x * (-1.980901e-4 + x * 2.6051076e-6)));
}

// Where the tip of a segment goes, as seen from its base.
fn way_gone(rest: vec3f, wanted: vec3f) -> vec3f {
    var turn = wanted;
    var square = dot(turn, turn);
    if square > FARTHEST * FARTHEST {
        // Scaled first: its square may be more than there is.
        let large = max(abs(turn.x), max(abs(turn.y), abs(turn.z)));
        turn = FARTHEST * normalize(turn / large);
        square = FARTHEST * FARTHEST;
    }
    let half = square * 0.25;
    let v = turn * (sine(half) * 0.5);
    let across = cross(v, rest);
    return 2.0 * (cosine(half) * across + cross(v, across));
}

@compute @workgroup_size(128)
fn pose(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) k: u32) {
    let row = group.y * ROW + group.x;
    let own = groups[level.level];
    if row >= own.n {
        return;
    }
    let copy = seen[level.list + row];
    let first = own.first + row * level.n_nodes;
    if k == 0u {
        firsts[copy] = first;
    }
    let q = copy * plant.n_modes;
    let all = plant.n_nodes;
    for (var node = k; node < level.n_nodes; node += WIDE) {
        var turn = vec3f(0.0);
        for (var mode = 0u; mode < level.n_modes; mode++) {
            let at = 3u * mode * all + node;
            turn += state[q + mode].x * vec3f(turns[at], turns[at + all], turns[at + 2u * all]);
        }
        let at = 3u * plant.n_modes * all + node;
        let rest = vec3f(turns[at], turns[at + all], turns[at + 2u * all]);
        put(first + node, way_gone(rest, turn));
    }
    storageBarrier();
    for (var rank = 0u; rank < plant.n_ranks; rank++) {
        let end = nodes[all + rank + 1u];
        for (var chain = nodes[all + rank] + k; chain < end; chain += WIDE) {
            along(chains[chain], first);
        }
        storageBarrier();
    }
}

fn put(row: u32, way: vec3f) {
    moved[3u * row] = way.x;
    moved[3u * row + 1u] = way.y;
    moved[3u * row + 2u] = way.z;
}

fn place_of(row: u32) -> vec3f {
    return vec3f(moved[3u * row], moved[3u * row + 1u], moved[3u * row + 2u]);
}

// Sums along a chain, as far as its nodes are moved: they come before one another.
fn along(chain: Chain, first: u32) {
    if chain.bearer >= level.n_nodes {
        return;
    }
    var sum = place_of(first + chain.bearer);
    for (var k = chain.first; k < chain.first + chain.n; k++) {
        let node = nodes[k];
        if node >= level.n_nodes {
            return;
        }
        sum += place_of(first + node);
        put(first + node, sum);
    }
}
