// Skeletons: bones, joints, ellipsoids, points and lines of a width, the clip behind them, the ground below.

struct Frame {
    // From places to what is clipped and divided.
    matrix: mat4x4f,
    // The camera's right, up and forward; in their fourth: how much of the clip is seen, of the ground, of both axes of the
    // picture in pixels.
    right: vec4f,
    up: vec4f,
    forward: vec4f,
    size: vec4f,
    // Where the ground is, and how far it is seen.
    ground: vec4f,
    // The picture's left, upper, right and lower edge, pixels of the clip.
    clip: vec4f,
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var film: texture_2d<f32>;
@group(0) @binding(2) var smoothly: sampler;

const TURN = 6.2831853;
const TUBE_SIDES = 20u;
const BALL_SIDES = 24u;
const BALL_RINGS = 14u;

// The corners of the two triangles between one side and the next.
const CORNERS = array<vec2u, 6>(vec2u(0, 0), vec2u(1, 0), vec2u(1, 1), vec2u(0, 0), vec2u(1, 1), vec2u(0, 1));

struct Solid {
    @builtin(position) at: vec4f,
    @location(0) normal: vec3f,
    @location(1) colour: vec4f,
}

struct Tube {
    @location(0) from_: vec4f,
    @location(1) to: vec4f,
    @location(2) colour: vec4f,
}

@vertex
fn tube(@builtin(vertex_index) n: u32, tube: Tube) -> Solid {
    let corner = CORNERS[n % 6u];
    let angle = TURN * f32((n / 6u + corner.x) % TUBE_SIDES) / f32(TUBE_SIDES);
    let along = tube.to.xyz - tube.from_.xyz;
    let axis = along / max(length(along), 1e-6);
    let aside = select(vec3f(0.0, 0.0, 1.0), vec3f(1.0, 0.0, 0.0), abs(axis.z) > 0.9);
    let side = normalize(cross(axis, aside));
    let normal = cos(angle) * side + sin(angle) * cross(axis, side);
    let foot = mix(tube.from_, tube.to, f32(corner.y));
    return Solid(frame.matrix * vec4f(foot.xyz + foot.w * normal, 1.0), normal, tube.colour);
}

struct Ball {
    @location(0) centre: vec4f,
    @location(1) a: vec4f,
    @location(2) b: vec4f,
    @location(3) c: vec4f,
    @location(4) colour: vec4f,
}

@vertex
fn ball(@builtin(vertex_index) n: u32, ball: Ball) -> Solid {
    let corner = CORNERS[n % 6u];
    let quad = n / 6u;
    let round = TURN * f32((quad % BALL_SIDES + corner.x) % BALL_SIDES) / f32(BALL_SIDES);
    let rise = 0.5 * TURN * (f32(quad / BALL_SIDES + corner.y) / f32(BALL_RINGS) - 0.5);
    let unit = vec3f(cos(rise) * cos(round), cos(rise) * sin(round), sin(rise));
    let place = ball.centre.xyz + unit.x * ball.a.xyz + unit.y * ball.b.xyz + unit.z * ball.c.xyz;
    // Axes are at right angles: what a sphere's normal becomes when it is stretched along them.
    let normal = unit.x * ball.a.xyz / dot(ball.a.xyz, ball.a.xyz) + unit.y * ball.b.xyz / dot(ball.b.xyz, ball.b.xyz)
        + unit.z * ball.c.xyz / dot(ball.c.xyz, ball.c.xyz);
    return Solid(frame.matrix * vec4f(place, 1.0), normalize(normal), ball.colour);
}

// From the upper left, before the plant, wherever it is seen from.
fn lit(normal: vec3f, colour: vec3f) -> vec3f {
    let light = normalize(-0.45 * frame.right.xyz + 0.65 * frame.up.xyz - 0.62 * frame.forward.xyz);
    let half_way = normalize(light - frame.forward.xyz);
    let day = 0.5 + 0.5 * dot(normal, light);
    let gloss = 0.22 * pow(max(dot(normal, half_way), 0.0), 24.0);
    return colour * (0.34 + 0.74 * day * day) + vec3f(gloss);
}

@fragment
fn solid(in: Solid) -> @location(0) vec4f {
    return vec4f(lit(normalize(in.normal), in.colour.rgb), 1.0);
}

// What is about solid things, so that they stand out before whatever is behind them.
@fragment
fn outline(in: Solid) -> @location(0) vec4f {
    return vec4f(in.colour.rgb, 1.0);
}

// Denser where it is seen from the side, as a thin shell is.
@fragment
fn shell(in: Solid) -> @location(0) vec4f {
    let normal = normalize(in.normal);
    let edge = 1.0 - abs(dot(normal, frame.forward.xyz));
    return vec4f(lit(normal, in.colour.rgb), in.colour.a * (0.32 + 0.68 * edge * edge));
}

struct Stroke {
    // Places, and half of the width in pixels of the picture.
    @location(0) from_: vec4f,
    @location(1) to: vec4f,
    @location(2) start: vec4f,
    @location(3) end: vec4f,
    // The colour of the rim, and how much of the radius it is.
    @location(4) rim: vec4f,
}

struct Stroked {
    @builtin(position) at: vec4f,
    // Pixels: from the first end to here, along and across, and to the second end.
    @location(0) place: vec2f,
    @location(1) @interpolate(flat) long: f32,
    @location(2) @interpolate(flat) half: vec2f,
    @location(3) @interpolate(flat) start: vec4f,
    @location(4) @interpolate(flat) end: vec4f,
    @location(5) @interpolate(flat) rim: vec4f,
}

@vertex
fn stroke(@builtin(vertex_index) n: u32, stroke: Stroke) -> Stroked {
    let pixels = 0.5 * frame.size.xy;
    let a = frame.matrix * vec4f(stroke.from_.xyz, 1.0);
    let b = frame.matrix * vec4f(stroke.to.xyz, 1.0);
    let from_ = a.xy / a.w * pixels;
    let to = b.xy / b.w * pixels;
    let long = distance(from_, to);
    let along = select(vec2f(1.0, 0.0), (to - from_) / max(long, 1e-6), long > 1e-3);
    let across = vec2f(-along.y, along.x);
    // A pixel more, for smooth edges.
    let reach = max(stroke.from_.w, stroke.to.w) + 1.0;
    let corner = vec2f(CORNERS[n].yx);
    let place = vec2f(mix(-reach, long + reach, corner.x), mix(-reach, reach, corner.y));
    let end = mix(a, b, corner.x);
    let seen = (from_ + place.x * along + place.y * across) / pixels;
    let at = vec4f(seen * end.w, end.z, end.w);
    return Stroked(at, place, long, vec2f(stroke.from_.w, stroke.to.w), stroke.start, stroke.end, stroke.rim);
}

@fragment
fn stroked(in: Stroked) -> @location(0) vec4f {
    let on = clamp(in.place.x, 0.0, in.long);
    let share = select(0.0, on / in.long, in.long > 1e-3);
    let half = mix(in.half.x, in.half.y, share);
    let off = distance(in.place, vec2f(on, 0.0));
    var colour = mix(in.start, in.end, share);
    if (in.rim.a > 0.0) {
        let inner = half * (1.0 - in.rim.a);
        colour = vec4f(mix(colour.rgb, in.rim.rgb, smoothstep(inner - 0.5, inner + 0.5, off)), colour.a);
    }
    return vec4f(colour.rgb, colour.a * clamp(half + 0.5 - off, 0.0, 1.0));
}

struct Behind {
    @builtin(position) at: vec4f,
    @location(0) place: vec2f,
}

// Less than a step of brightness, so that steps are not seen: by where it is alone, the same in every frame.
fn grain(at: vec2f) -> f32 {
    return (fract(52.9829189 * fract(dot(floor(at), vec2f(0.06711056, 0.00583715)))) - 0.5) / 255.0;
}

// All of the picture.
@vertex
fn sky(@builtin(vertex_index) n: u32) -> Behind {
    let corner = vec2f(CORNERS[n]);
    return Behind(vec4f(2.0 * corner - 1.0, 0.0, 1.0), corner);
}

@fragment
fn calm(in: Behind) -> @location(0) vec4f {
    let colour = mix(vec3f(0.075, 0.090, 0.102), vec3f(0.165, 0.190, 0.208), in.place.y);
    return vec4f(colour + grain(in.at.xy), 1.0);
}

// The frame of the clip, exactly where it was filmed.
@vertex
fn screen(@builtin(vertex_index) n: u32) -> Behind {
    let corner = vec2f(CORNERS[n]);
    let seen = mix(frame.clip.xy, frame.clip.zw, corner);
    return Behind(frame.matrix * vec4f(seen.x, 0.0, -seen.y, 1.0), corner);
}

@fragment
fn filmed(in: Behind) -> @location(0) vec4f {
    let colour = textureSample(film, smoothly, in.place).rgb;
    return vec4f(colour * 0.86, frame.right.w);
}

@vertex
fn ground(@builtin(vertex_index) n: u32) -> Behind {
    let corner = 2.0 * vec2f(CORNERS[n]) - 1.0;
    let place = frame.ground.xyz + frame.ground.w * vec3f(corner, 0.0);
    return Behind(frame.matrix * vec4f(place, 1.0), corner);
}

// A disc that is lost in the dark, with the shadow of the foot on it.
@fragment
fn earth(in: Behind) -> @location(0) vec4f {
    let off = length(in.place);
    let shadow = exp(-40.0 * off * off);
    let seen = frame.up.w * (1.0 - smoothstep(0.15, 1.0, off));
    return vec4f(vec3f(0.29, 0.31, 0.30) * (1.0 - 0.55 * shadow) + 2.0 * grain(in.at.xy), 0.75 * seen);
}
