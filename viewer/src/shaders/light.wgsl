// What light does: a low sun, the sky, haze; from what shines to what a screen shows.

const SUNLIGHT = vec3f(2.35, 2.12, 1.78);
const SKYLIGHT = vec3f(0.62, 0.74, 0.92);
// What comes back from the ground.
const GROUNDLIGHT = vec3f(0.26, 0.24, 0.19);
const HAZE = vec3f(0.62, 0.70, 0.76);

// From all of the sky and the ground, to where a surface looks.
fn ambient(normal: vec3f) -> vec3f {
    return mix(GROUNDLIGHT, SKYLIGHT, normal.z * 0.5 + 0.5);
}

// What shines, as a screen shows it: bright things never burn out, and sRGB.
fn shown(light: vec3f) -> vec3f {
    let bent = (light * (2.51 * light + 0.03)) / (light * (2.43 * light + 0.59) + 0.14);
    let v = clamp(bent, vec3f(0.0), vec3f(1.0));
    return select(1.055 * pow(v, vec3f(1.0 / 2.4)) - 0.055, 12.92 * v, v <= vec3f(0.0031308));
}
