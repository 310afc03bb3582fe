// Which copies are seen, and by which level: as the views and details of honami-mechanics have it. Then where the
// displacements of each begin, and how often what is drawn.
// with copies

struct Eye {
    eye: vec3f,
    n_copies: u32,
    forward: vec3f,
    n_levels: u32,
    right: vec3f,
    // Of the picture's edges, by the way forward.
    slope_right: f32,
    up: vec3f,
    slope_up: f32,
    far: f32,
    // Of the plant, metres: half its height, and the ball about it.
    middle: f32,
    reach: f32,
    // How many displacements there is room for.
    n_rows: u32,
    // So many times as far away as usual levels begin.
    sharper: f32,
}

// What draws something: how many indices, how many times.
struct Call {
    n_indices: u32,
    n_copies: u32,
    first_index: u32,
    base_vertex: i32,
    first_copy: u32,
}

// Levels are as far apart as adapters want what they bind.
struct Row {
    level: Level,
    filler: array<u32, 56>,
}

@group(0) @binding(0) var<uniform> eye: Eye;
@group(0) @binding(1) var<storage, read> copies: array<Copy>;
@group(0) @binding(2) var<storage, read> levels: array<Row>;
@group(0) @binding(3) var<storage, read_write> seen: array<u32>;
@group(0) @binding(4) var<storage, read_write> calls: array<Call>;
@group(0) @binding(5) var<storage, read_write> groups: array<Groups>;

const WIDE = 256u;
// Workgroups in a row, of which an adapter has no more than so many.
const ROW = 32768u;

var<workgroup> ranks: array<u32, 256>;

// The level of a copy, or as many as there are of one that is not seen.
fn level_of(copy: Copy) -> u32 {
    let centre = vec3f(copy.place, eye.middle * copy.scale);
    let radius = eye.reach * copy.scale;
    let at = centre - eye.eye;
    let depth = dot(at, eye.forward);
    let right = (abs(dot(at, eye.right)) - depth * eye.slope_right) / sqrt(1.0 + eye.slope_right * eye.slope_right);
    let up = (abs(dot(at, eye.up)) - depth * eye.slope_up) / sqrt(1.0 + eye.slope_up * eye.slope_up);
    if depth < -radius || depth > eye.far + radius || right > radius || up > radius {
        return eye.n_levels;
    }
    let distance = length(at) / copy.scale;
    var level = 0u;
    for (var k = 1u; k < eye.n_levels; k++) {
        if distance >= levels[k].level.from_metres * eye.sharper {
            level = k;
        }
    }
    return level;
}

// A workgroup a level makes its list, in the order of the copies: the same on every run.
@compute @workgroup_size(256)
fn list(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) k: u32) {
    let level = group.x;
    let begin = levels[level].level.list;
    var n = 0u;
    for (var first = 0u; first < eye.n_copies; first += WIDE) {
        let copy = first + k;
        var is_own = 0u;
        if copy < eye.n_copies {
            is_own = u32(level_of(copies[copy]) == level);
        }
        ranks[k] = is_own;
        workgroupBarrier();
        for (var step = 1u; step < WIDE; step *= 2u) {
            var before = 0u;
            if k >= step {
                before = ranks[k - step];
            }
            workgroupBarrier();
            ranks[k] += before;
            workgroupBarrier();
        }
        if is_own == 1u {
            seen[begin + n + ranks[k] - 1u] = copy;
        }
        n += ranks[WIDE - 1u];
        workgroupBarrier();
    }
    if k == 0u {
        calls[2u * level].n_copies = n;
    }
}

// How many copies of each level there is room for, where their displacements begin: near ones first. Where some have none,
// nothing is drawn, and whoever asked for them is told.
@compute @workgroup_size(1)
fn share() {
    var row = 0u;
    for (var level = 0u; level < eye.n_levels; level++) {
        let n_nodes = levels[level].level.n_nodes;
        let n_seen = calls[2u * level].n_copies;
        let n = min(n_seen, (eye.n_rows - row) / n_nodes);
        calls[2u * level].n_copies = n;
        calls[2u * level + 1u].n_copies = n;
        groups[level] = Groups(min(n, ROW), (n + ROW - 1u) / ROW, 1u, row, n, n_seen);
        row += n * n_nodes;
    }
}
