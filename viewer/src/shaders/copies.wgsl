// Copies of a plant, and how much of it is drawn from how far.

struct Copy {
    place: vec2f,
    turn: vec2f,
    scale: f32,
    chance: f32,
    filler: vec2u,
}

struct Level {
    list: u32,
    first_ring: u32,
    first_leaf: u32,
    n_sides: u32,
    from_metres: f32,
    n_nodes: u32,
    n_modes: u32,
    level: u32,
}

// Workgroups that pose a level, a copy each; where its displacements begin, how many copies it
// has room for, and how many are seen.
struct Groups {
    wide: u32,
    high: u32,
    deep: u32,
    first: u32,
    n: u32,
    n_seen: u32,
}
