// A forest: sky and ground, shadows of crowns, wood, leaves.
// with copies
// with light

struct Look {
    matrix: mat4x4f,
    eye: vec3f,
    time: f32,
    right: vec3f,
    height: f32,
    up: vec3f,
    // Half of the length of a crown's shadow along the sun's way, and of its width.
    along: f32,
    forward: vec3f,
    pixel: f32,
    // Where the sun stands, of length 1.
    sun: vec3f,
    wide: f32,
    // Where the middle of a crown's shadow is from the root, and how much of the sun leaves take.
    middle: vec2f,
    dense: f32,
    filler: f32,
}

// A ring of vertices about a node; see the body of a scene.
struct Ring {
    rest: vec3f,
    radius: f32,
    side: vec3f,
    open: f32,
    other: vec3f,
    node: u32,
    along_before: vec3f,
    base_before: u32,
    along_after: vec3f,
    tip_before: u32,
    base_after: u32,
    tip_after: u32,
}

struct Leaf {
    base: vec3f,
    length: f32,
    tip: vec3f,
    breadth: f32,
    up: vec3f,
    open: f32,
    ring: u32,
    chance: f32,
}

@group(0) @binding(0) var<uniform> look: Look;
@group(1) @binding(0) var<storage, read> copies: array<Copy>;
@group(1) @binding(1) var<storage, read> firsts: array<u32>;
@group(1) @binding(2) var<storage, read> airs: array<f32>;
@group(1) @binding(3) var<storage, read> seen: array<u32>;
@group(1) @binding(4) var<storage, read> moved: array<f32>;
@group(1) @binding(5) var<storage, read> rings: array<Ring>;
@group(1) @binding(6) var<storage, read> leaves: array<Leaf>;
@group(1) @binding(7) var<uniform> level: Level;

const TAU = 6.2831853;

// Metres in which haze takes most of what is seen, in heights of the plant.
const HAZY = 170.0;

fn hazed(light: vec3f, distance: f32) -> vec3f {
    let clear = exp(-distance / (HAZY * look.height));
    return mix(HAZE, light, clear);
}

// By chance, 0 to 1, the same for the same place.
fn chance_at(at: vec2f) -> f32 {
    let p = vec2u(vec2i(floor(at)));
    var h = p.x * 0x9E3779B1u ^ p.y * 0x85EBCA77u;
    h = (h ^ (h >> 15u)) * 0x2C1B3C6Du;
    h = (h ^ (h >> 12u)) * 0x297A2D39u;
    return f32((h ^ (h >> 15u)) >> 8u) / 16777216.0;
}

// The same between places, without edges.
fn noise(at: vec2f) -> f32 {
    let f = fract(at);
    let s = f * f * (3.0 - 2.0 * f);
    let low = mix(chance_at(at), chance_at(at + vec2f(1.0, 0.0)), s.x);
    let high = mix(chance_at(at + vec2f(0.0, 1.0)), chance_at(at + vec2f(1.0, 1.0)), s.x);
    return mix(low, high, s.y);
}

// ---- Sky and ground.

struct Seen {
    @builtin(position) position: vec4f,
    @location(0) ray: vec3f,
}

@vertex
fn over_all(@builtin(vertex_index) k: u32) -> Seen {
    let at = vec2f(f32(k & 1u) * 4.0 - 1.0, f32(k >> 1u) * 4.0 - 1.0);
    // Behind all that is drawn.
    return Seen(vec4f(at, 0.0, 1.0), look.forward + look.right * at.x + look.up * at.y);
}

fn sky(way: vec3f) -> vec3f {
    let up = clamp(way.z, 0.0, 1.0);
    let sun = max(dot(way, look.sun), 0.0);
    let blue = mix(HAZE, vec3f(0.13, 0.30, 0.62), 1.0 - exp(-4.5 * up));
    return blue + vec3f(0.22, 0.16, 0.09) * pow(sun, 6.0) + vec3f(0.9, 0.75, 0.5) * pow(sun, 80.0);
}

// Grass from far: patches of many sizes, each gone before it is smaller than a pixel.
fn grass(at: vec2f, width: f32) -> vec3f {
    var light = 0.0;
    var size = 0.9 * look.height;
    var much = 0.5;
    for (var k = 0; k < 5; k++) {
        let fade = clamp(1.5 - 3.0 * width / size, 0.0, 1.0);
        light += much * fade * (noise(at / size + f32(k) * 17.3) - 0.5);
        size *= 0.37;
        much *= 0.72;
    }
    return vec3f(0.088, 0.112, 0.042) * (1.0 + 0.9 * light) + vec3f(0.026, 0.014, 0.0) * light;
}

// Of a pixel on the ground: it is longer than wide by as much as it is seen flat.
fn width_on_ground(at: vec2f) -> f32 {
    let way = vec3f(at, 0.0) - look.eye;
    let distance = length(way);
    return look.pixel * distance / sqrt(max(-way.z / distance, 1e-4));
}

// The ground where so much of the sun is seen, from so far.
fn ground(at: vec2f, distance: f32, sunlit: f32) -> vec4f {
    let way = normalize(vec3f(at, 0.0) - look.eye);
    let width = width_on_ground(at);
    let light = SUNLIGHT * look.sun.z * sunlit + ambient(vec3f(0.0, 0.0, 1.0)) * (0.6 + 0.4 * sunlit);
    let clear = exp(-distance / (HAZY * look.height));
    return vec4f(shown(mix(sky(vec3f(way.xy, 0.0)), grass(at, width) * light, clear)), 1.0);
}

@fragment
fn sky_and_ground(seen: Seen) -> @location(0) vec4f {
    let way = normalize(seen.ray);
    if way.z >= -1e-4 || look.eye.z <= 0.0 {
        return vec4f(shown(sky(way)), 1.0);
    }
    let distance = -look.eye.z / way.z;
    return ground(look.eye.xy + way.xy * distance, distance, 1.0);
}

// ---- Shadows on the ground. Where several fall the darkest is seen.

// That of a crown in the sun, soft, and the darker foot.
struct Shade {
    @builtin(position) position: vec4f,
    // In radii of the crown, along the sun's way over the ground and across; and metres from the root.
    @location(0) at: vec2f,
    @location(1) foot: vec2f,
    @location(2) place: vec2f,
    @location(3) @interpolate(flat) chance: f32,
}

@vertex
fn shadow_at(@builtin(vertex_index) corner: u32, @builtin(instance_index) k: u32) -> Shade {
    let copy = copies[k];
    let size = copy.scale;
    let away = normalize(-look.sun.xy);
    let across = vec2f(-away.y, away.x);
    let middle = length(look.middle) * size;
    let along = look.along * size;
    let wide = look.wide * size;
    let side = vec2f(f32(corner & 1u) * 2.0 - 1.0, f32(corner >> 1u) * 2.0 - 1.0);
    // From behind the foot to beyond the crown's end.
    let begin = -wide * 0.5;
    let end = middle + 1.3 * along;
    let go = mix(begin, end, side.x * 0.5 + 0.5);
    let beside = side.y * wide * 1.3;
    let at = copy.place + away * go + across * beside;
    var shade: Shade;
    shade.position = look.matrix * vec4f(at, 0.0, 1.0);
    shade.at = vec2f((go - middle) / along, beside / wide);
    shade.foot = vec2f(go, beside) / (look.height * size);
    shade.place = at;
    shade.chance = copy.chance;
    return shade;
}

@fragment
fn shadow(shade: Shade) -> @location(0) vec4f {
    let edge = length(shade.at) + 0.35 * (noise(shade.at * 3.1 + shade.chance * 57.0) - 0.5)
        + 0.18 * (noise(shade.at * 9.7 + shade.chance * 31.0) - 0.5);
    let crown = 0.78 * look.dense * (1.0 - smoothstep(0.50, 1.15, edge));
    let foot = 0.6 * look.dense * exp(-dot(shade.foot, shade.foot) * 260.0);
    let sunlit = (1.0 - crown) * (1.0 - foot);
    return ground(shade.place, distance(look.eye, vec3f(shade.place, 0.0)), sunlit);
}

// A piece of wood at rest: its ends, and how thick it is there.
struct Piece {
    @location(0) from_: vec4f,
    @location(1) to: vec4f,
}

// Its shadow, a stroke that is the more blurred the farther it has come.
struct Stroke {
    @builtin(position) position: vec4f,
    @location(0) place: vec2f,
    // From edge to edge -1 to 1, and how much of it is wood.
    @location(1) across: f32,
    @location(2) full: f32,
}

// Half of how blurred a shadow is, of how far it has come: the sun is half a degree wide.
const BLUR = 0.0047;

// The two triangles of a stroke: to its left or right, at its beginning or its end.
const CORNERS = array<vec2f, 6>(
    vec2f(-1.0, -1.0), vec2f(1.0, -1.0), vec2f(-1.0, 1.0), vec2f(-1.0, 1.0), vec2f(1.0, -1.0), vec2f(1.0, 1.0));

@vertex
fn stroke_at(@builtin(vertex_index) k: u32, piece: Piece) -> Stroke {
    let copy = copies[k / 6u];
    let fall = look.sun.xy / look.sun.z;
    let corner = CORNERS[k % 6u];
    let end = select(piece.from_, piece.to, corner.y > 0.0) * copy.scale;
    let along = in_world(copy, piece.to.xyz - piece.from_.xyz);
    let gap = along.xy - fall * along.z;
    let way = gap / max(length(gap), 1e-6);
    let middle = copy.place + in_world(copy, end.xyz).xy - fall * end.z;
    let radius = end.w;
    let blur = BLUR * max(end.z, 0.0) / look.sun.z;
    // Never so thin that the middles of pixels miss it, but as faint as it is thin.
    let half = max(radius + blur, 1.2 * width_on_ground(middle));
    // Over the bend between one piece and the next.
    let beyond = 0.4 * half * corner.y;
    var stroke: Stroke;
    stroke.place = middle + way * beyond + vec2f(-way.y, way.x) * half * corner.x;
    stroke.position = look.matrix * vec4f(stroke.place, 0.0, 1.0);
    stroke.across = corner.x;
    stroke.full = 2.0 * radius / half;
    return stroke;
}

@fragment
fn stroke(stroke: Stroke) -> @location(0) vec4f {
    let dark = 1.0 - smoothstep(clamp(stroke.full - 1.0, 0.0, 0.95), 1.0, abs(stroke.across));
    let sunlit = 1.0 - 0.75 * min(stroke.full, 1.0) * dark;
    return ground(stroke.place, distance(look.eye, vec3f(stroke.place, 0.0)), sunlit);
}

// ---- What moves: wood and leaves.

// By how much a node of a copy is moved, in the plant's own axes and size.
fn move_of(first: u32, node: u32) -> vec3f {
    let k = 3u * (first + node);
    return vec3f(moved[k], moved[k + 1u], moved[k + 2u]);
}

// By what a ring turns, radians about an axis.
fn turn_of(first: u32, ring: Ring) -> vec3f {
    let before = move_of(first, ring.tip_before) - move_of(first, ring.base_before);
    let after = move_of(first, ring.tip_after) - move_of(first, ring.base_after);
    return 0.5 * (cross(ring.along_before, before) + cross(ring.along_after, after));
}

// A way turned (Rodrigues).
fn turned(turn: vec3f, way: vec3f) -> vec3f {
    let square = dot(turn, turn);
    if square < 1e-12 {
        return way + cross(turn, way);
    }
    let angle = sqrt(square);
    let axis = turn / angle;
    let across = cross(axis, way);
    return way + sin(angle) * across + (1.0 - cos(angle)) * cross(axis, across);
}

// From the plant's own axes to the world's.
fn in_world(copy: Copy, way: vec3f) -> vec3f {
    return vec3f(copy.turn.y * way.x - copy.turn.x * way.y, copy.turn.x * way.x + copy.turn.y * way.y, way.z);
}

struct Wood {
    @builtin(position) position: vec4f,
    @location(0) normal: vec3f,
    @location(1) place: vec3f,
    // About the branch and along it, metres.
    @location(2) bark: vec2f,
    @location(3) open: f32,
    @location(4) @interpolate(flat) chance: f32,
}

@vertex
fn wood_at(@builtin(vertex_index) k: u32, @builtin(instance_index) row: u32) -> Wood {
    let index = seen[level.list + row];
    let copy = copies[index];
    let ring = rings[level.first_ring + k / level.n_sides];
    let first = firsts[index];
    let angle = TAU * f32(k % level.n_sides) / f32(level.n_sides);
    let outward = turned(turn_of(first, ring), ring.side * cos(angle) + ring.other * sin(angle));
    let normal = in_world(copy, outward);
    let middle = vec3f(copy.place, 0.0) + copy.scale * in_world(copy, ring.rest + move_of(first, ring.node));
    // Never much thinner than a pixel: far twigs do not flicker.
    let least = 0.3 * look.pixel * distance(look.eye, middle);
    let place = middle + max(copy.scale * ring.radius, least) * normal;
    var wood: Wood;
    wood.position = look.matrix * vec4f(place, 1.0);
    wood.normal = normal;
    wood.place = place;
    wood.bark = vec2f(angle, dot(ring.rest, vec3f(1.0)));
    wood.open = ring.open;
    wood.chance = copy.chance;
    return wood;
}

@fragment
fn wood(wood: Wood) -> @location(0) vec4f {
    let normal = normalize(wood.normal);
    let distance = distance(look.eye, wood.place);
    // Ridges, as long as the plant is high by a hundredth, gone where they are as thin as pixels.
    let near = clamp(1.5 - 400.0 * look.pixel * distance / look.height, 0.0, 1.0);
    let ridges = noise(vec2f(wood.bark.x * 5.0, wood.bark.y * 40.0 / look.height)) - 0.5;
    let patches = noise(vec2f(wood.bark.x * 0.7, wood.bark.y * 9.0 / look.height) + wood.chance * 9.0) - 0.5;
    let bark = vec3f(0.165, 0.128, 0.098) * (1.0 + 0.5 * ridges * near + 0.35 * patches);
    let sun = max(dot(normal, look.sun), 0.0) * smoothstep(0.15, 0.75, wood.open);
    let light = SUNLIGHT * sun + ambient(normal) * (0.25 + 0.75 * wood.open);
    return vec4f(shown(hazed(bark * light, distance)), 1.0);
}

// A vertex that was worked out elsewhere: see the skin of the viewer's forest.
struct Skinned {
    @location(0) place: vec4f,
    @location(1) normal: vec4f,
    @location(2) across: vec4f,
    @location(3) at: vec4f,
}

@vertex
fn wood_skinned(v: Skinned) -> Wood {
    let position = look.matrix * vec4f(v.place.xyz, 1.0);
    return Wood(position, v.normal.xyz, v.place.xyz, vec2f(TAU * v.at.x, v.place.w), v.at.z, v.across.w);
}

struct Blade {
    @builtin(position) position: vec4f,
    // Across the leaf from -1 to 1, along it from 0 to 1.
    @location(0) at: vec2f,
    // As they are shown: its halves, which a fold along the midrib has look two ways.
    @location(1) @interpolate(flat) left: vec3f,
    @location(2) @interpolate(flat) right: vec3f,
}

// A leaf in the light: once a vertex, for pixels of small leaves are many, and light is the same all over one.
fn blade_at(place: vec3f, at: vec2f, normal: vec3f, across: vec3f, open: f32, hue: f32) -> Blade {
    let towards = look.eye - place;
    let distance = length(towards);
    let green = mix(vec3f(0.040, 0.088, 0.016), vec3f(0.092, 0.140, 0.022), hue);
    let sunlit = smoothstep(0.10, 0.80, open);
    var blade: Blade;
    blade.position = look.matrix * vec4f(place, 1.0);
    blade.at = at;
    for (var side = 0; side < 2; side++) {
        let fold = select(0.32, -0.32, side == 0);
        var looks = normalize(normal - fold * across);
        // The side that is seen is the one that counts.
        looks *= select(-1.0, 1.0, dot(looks, towards) >= 0.0);
        let towards_sun = dot(looks, look.sun);
        let facing = max(towards_sun, 0.0);
        let through = 0.55 * max(-towards_sun, 0.0);
        let glow = vec3f(1.55, 1.75, 0.55) * green;
        let bright = 0.035 * pow(max(dot(reflect(-look.sun, looks), towards / distance), 0.0), 18.0);
        var light = SUNLIGHT * sunlit * (green * facing + glow * through + vec3f(bright));
        light += green * ambient(looks) * (0.18 + 0.95 * open);
        let colour = shown(hazed(light, distance));
        if side == 0 {
            blade.left = colour;
        } else {
            blade.right = colour;
        }
    }
    return blade;
}

@vertex
fn leaf_at(@builtin(vertex_index) k: u32, @builtin(instance_index) row: u32) -> Blade {
    let index = seen[level.list + row];
    let copy = copies[index];
    let leaf = leaves[level.first_leaf + k / 4u];
    let ring = rings[level.first_ring + leaf.ring];
    let first = firsts[index];
    let turn = turn_of(first, ring);
    let corner = vec2f(f32(k & 1u) * 2.0 - 1.0, f32((k >> 1u) & 1u));
    // Flutter, for the eye alone: each leaf nods and rolls at its own time, the more the faster the air.
    let air = airs[index];
    let much = 0.03 + 0.55 * (1.0 - exp(-air / 9.0));
    let pace = look.time * (2.5 + 0.45 * min(air, 12.0));
    let roll = much * sin(pace * (0.8 + 0.5 * leaf.chance) * 2.1 + leaf.chance * 91.0);
    let nod = 0.6 * much * sin(pace * (0.7 + 0.4 * fract(leaf.chance * 7.0)) * 1.7 + leaf.chance * 57.0);
    let flat_across = cross(leaf.tip, leaf.up);
    let tip = normalize(leaf.tip + nod * leaf.up);
    let across = normalize(flat_across + roll * leaf.up);
    let at = leaf.base + leaf.length * (tip * corner.y + across * (0.5 * leaf.breadth * corner.x));
    let own = ring.rest + move_of(first, ring.node) + turned(turn, at);
    let place = vec3f(copy.place, 0.0) + copy.scale * in_world(copy, own);
    let hue = clamp(leaf.chance + 0.35 * (copy.chance - 0.5), 0.0, 1.0);
    let normal = in_world(copy, turned(turn, cross(across, tip)));
    return blade_at(place, corner, normal, in_world(copy, turned(turn, across)), leaf.open, hue);
}

@vertex
fn leaf_skinned(v: Skinned) -> Blade {
    return blade_at(v.place.xyz, v.at.xy, v.normal.xyz, v.across.xyz, v.at.z, v.at.w);
}

// Half the breadth of a leaf, of the most: widest below the middle, with a point.
fn outline(along: f32) -> f32 {
    let a = clamp(along, 0.0, 1.0);
    return 2.6 * sqrt(a * sqrt(a)) * (1.0 - a) * (1.0 - 0.1 * a);
}

@fragment
fn leaf(blade: Blade) -> @location(0) vec4f {
    // How much of the pixel is leaf: distance from the outline, in pixels.
    let beside = abs(blade.at.x);
    let inside = outline(blade.at.y) - beside;
    let cover = clamp(inside / max(fwidth(inside), 1e-4) + 0.5, 0.0, 1.0);
    let fine = clamp(1.4 - 70.0 * fwidth(blade.at.y), 0.0, 1.0);
    if cover < 0.1 {
        discard;
    }
    let rib = 1.0 - smoothstep(0.02, 0.07, beside);
    let veins = abs(fract((blade.at.y - 0.35 * beside) * 7.0) - 0.5) * 2.0;
    let colour = select(blade.right, blade.left, blade.at.x < 0.0);
    return vec4f(colour * (1.0 + fine * (0.20 * rib - 0.05 * veins)), cover);
}
