//! Shaders by their names, with what several of them share.

/// Files in the folder beside this one.
const FILES: [(&str, &str); 7] = [
    ("copies", include_str!("shaders/copies.wgsl")),
    ("cull", include_str!("shaders/cull.wgsl")),
    ("forest", include_str!("shaders/forest.wgsl")),
    ("light", include_str!("shaders/light.wgsl")),
    ("pose", include_str!("shaders/pose.wgsl")),
    ("skeleton", include_str!("shaders/skeleton.wgsl")),
    ("step", include_str!("shaders/step.wgsl")),
];

/// Lines that begin so are followed by the name of another file, which stands in their place.
const WITH: &str = "// with ";

/// A shader's text, whole.
///
/// # Panics
/// When there is none of this name.
#[must_use]
#[track_caller]
pub fn text(name: &str) -> String {
    let file = FILES.iter().find(|(known, _)| *known == name).map(|(_, text)| text);
    let file = file.unwrap_or_else(|| panic!("no shader is named {name}"));
    let whole = |line: &str| line.strip_prefix(WITH).map_or_else(|| format!("{line}\n"), text);
    file.lines().map(whole).collect()
}

/// A shader for a device.
///
/// # Panics
/// When there is none of this name.
#[must_use]
#[track_caller]
pub fn module(device: &wgpu::Device, name: &str) -> wgpu::ShaderModule {
    let source = wgpu::ShaderSource::Wgsl(text(name).into());
    device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(name), source })
}

#[cfg(test)]
mod tests {
    use super::{FILES, text};
    use naga::valid::{Capabilities, ValidationFlags, Validator};
    use std::path::Path;

    /// Without a graphics card.
    #[test]
    fn every_shader_of_the_folder_is_listed_and_valid() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/shaders");
        let mut names = Vec::new();
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            assert_eq!(path.extension().unwrap(), "wgsl", "{}", path.display());
            names.push(path.file_stem().unwrap().to_str().unwrap().to_owned());
        }
        names.sort();
        assert_eq!(names, FILES.map(|(name, _)| name), "the folder, by name, and the table");
        for name in names {
            let text = text(&name);
            let module = naga::front::wgsl::parse_str(&text)
                .unwrap_or_else(|error| panic!("{name}: {}", error.emit_to_string(&text)));
            let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
            validator
                .validate(&module)
                .unwrap_or_else(|error| panic!("{name}: {}", error.emit_to_string(&text)));
        }
    }

    #[test]
    fn a_wrong_shader_is_told() {
        let told = naga::front::wgsl::parse_str("fn f() -> f32 { return light; }").is_err();
        assert!(told);
    }
}
