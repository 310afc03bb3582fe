// A step of all modes of all copies; see the forests of honami-mechanics, whose numbers these are.

struct Size {
    n_copies: u32,
    n_modes: u32,
    // From one row of copies to the next.
    row: u32,
}

// What a copy feels: |v| v in its own axes, and what T is to be multiplied by.
struct Felt {
    pressed: array<f32, 3>,
    held: array<f32, 6>,
}

@group(0) @binding(0) var<uniform> size: Size;
@group(0) @binding(1) var<storage, read> steps: array<f32>;
@group(0) @binding(2) var<storage, read> basis: array<f32>;
@group(0) @binding(3) var<storage, read> tensors: array<f32>;
@group(0) @binding(4) var<storage, read> kinds: array<u32>;
@group(0) @binding(5) var<storage, read> felt: array<Felt>;
// Amplitudes and speeds, (n_copies, n_modes).
@group(0) @binding(6) var<storage, read_write> state: array<vec2f>;

// e^-x of 0 and above.
fn fade(taken: f32) -> f32 {
    let x = max(taken, 0.0) / 4.0;
    let rest = 1.0 + x / 4.0 * (1.0 + x / 5.0 * (1.0 + x / 6.0));
    let root = 1.0 + x * (1.0 + x / 2.0 * (1.0 + x / 3.0 * rest));
    let square = root * root;
    return 1.0 / (square * square);
}

@compute @workgroup_size(64)
fn step_modes(@builtin(global_invocation_id) id: vec3u) {
    let k = id.y * size.row + id.x;
    let n = size.n_modes;
    if k >= size.n_copies * n {
        return;
    }
    let copy = k / n;
    let mode = k % n;
    let own = felt[copy];
    let force = own.pressed[0] * basis[mode] + own.pressed[1] * basis[n + mode] + own.pressed[2] * basis[2u * n + mode];
    var taken = 0.0;
    for (var row = 0u; row < 6u; row++) {
        taken += tensors[row * n + mode] * own.held[row];
    }
    let left = fade(taken);
    let first = 6u * n * kinds[copy] + mode;
    let q = state[k].x;
    let speed = state[k].y * left;
    state[k] = vec2f(
        steps[first] * q + steps[first + n] * speed + steps[first + 2u * n] * force,
        (steps[first + 3u * n] * q + steps[first + 4u * n] * speed + steps[first + 5u * n] * force) * left,
    );
}
