//! What OpenCV's trackers need to be built, which the rest of honami does not: headers, libraries and clang.
//!
//! Debian's packages for developers bring windows, codecs and map formats along, 400 MB. So only the libraries are
//! installed, and the headers of the few modules that are used are unpacked into the target folder.

use std::fs;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, ensure};

use crate::shell::{Step, cargo, target_dir};
use crate::system;

/// The plugin that is built with it.
const PLUGIN: [&str; 4] = ["-p", "honami-tracker-opencv", "--features", "opencv"];

/// Modules whose headers the bindings are made from.
const MODULES: [&str; 5] = ["core", "flann", "imgproc", "features2d", "video"];

/// Where OpenCV is, in the words of the `opencv` crate.
pub(crate) struct Kit {
    env: Vec<(&'static str, String)>,
}

impl Kit {
    /// What is there already: what the environment names, what was unpacked before, or a whole installation.
    pub(crate) fn find() -> Option<Self> {
        let is_named = std::env::var_os("OPENCV_LINK_LIBS").is_some();
        let is_whole = || Step::new("pkg-config").args(["--exists", "opencv4"]).output().is_ok();
        if is_named || (has_clang() && is_whole()) {
            return Some(Self { env: Vec::new() });
        }
        let kit = Self::unpacked(&sysroot().ok()?)?;
        has_clang().then_some(kit)
    }

    /// What is there, else what can be installed; says what is skipped where it cannot.
    pub(crate) fn want() -> Option<Self> {
        let kit = Self::find().or_else(|| {
            let installed = install().map_err(|error| eprintln!("could not install OpenCV: {error:#}"));
            installed.ok().and_then(|()| Self::find())
        });
        if kit.is_none() {
            eprintln!(
                "skipped: OpenCV's trackers (plugins/tracker-opencv) are neither built nor tested. \
                 To have them: apt-get install libopencv-dev clang libclang-dev"
            );
        }
        kit
    }

    /// What cargo has to know to build with it.
    pub(crate) fn env(&self) -> &[(&'static str, String)] {
        &self.env
    }

    /// Headers in this folder, whose libraries are installed.
    fn unpacked(sysroot: &Path) -> Option<Self> {
        let libraries = multiarch(&sysroot.join("usr/lib"))?;
        let is_there = |&module: &&str| libraries.join(library(module)).exists();
        if !MODULES.iter().all(is_there) {
            return None;
        }
        let include = sysroot.join("usr/include");
        let headers = [include.join("opencv4"), multiarch(&include)?.join("opencv4")];
        let headers: Vec<_> = headers.iter().map(|folder| folder.display().to_string()).collect();
        let names: Vec<_> = MODULES.iter().map(|module| format!("opencv_{module}")).collect();
        Some(Self {
            env: vec![
                ("OPENCV_LINK_LIBS", names.join(",")),
                ("OPENCV_LINK_PATHS", libraries.display().to_string()),
                ("OPENCV_INCLUDE_PATHS", headers.join(",")),
                ("OPENCV_DISABLE_PROBES", "pkg_config,cmake,vcpkg_cmake,vcpkg".to_owned()),
            ],
        })
    }
}

/// Builds the plugin to be used, beside the program.
pub(crate) fn build() -> anyhow::Result<()> {
    system::need_compiler()?;
    let kit = Kit::want().context("OpenCV is not there")?;
    let build = cargo(&["build", "--release"]).args(PLUGIN);
    kit.env.iter().fold(build, |build, (name, value)| build.env(name, value)).run()
}

fn sysroot() -> anyhow::Result<PathBuf> {
    Ok(target_dir()?.join("opencv"))
}

fn library(module: &str) -> String {
    format!("libopencv_{module}.so")
}

/// The folder below that is named for the machine, as `x86_64-linux-gnu`.
fn multiarch(folder: &Path) -> Option<PathBuf> {
    let entries = fs::read_dir(folder).ok()?.flatten().map(|entry| entry.path());
    entries.filter(|path| path.is_dir()).find(|path| path.to_string_lossy().ends_with("-linux-gnu"))
}

/// Whether there is a clang to ask, and its library to read headers with, for the bindings.
fn has_clang() -> bool {
    let versions = fs::read_dir("/usr/lib").into_iter().flatten().flatten().map(|entry| entry.path());
    versions.filter(|path| path.to_string_lossy().contains("/llvm-")).any(|llvm| {
        let libraries = fs::read_dir(llvm.join("lib")).into_iter().flatten().flatten();
        let mut names = libraries.map(|entry| entry.file_name().to_string_lossy().into_owned());
        llvm.join("bin/clang").exists()
            && names.any(|name| name.starts_with("libclang-") && name.contains(".so"))
    })
}

/// Installs the libraries and clang, and unpacks the headers.
fn install() -> anyhow::Result<()> {
    let apt = system::Apt::find().context("that needs root and apt-get")?;
    apt.run(&["update"])?;
    // `clang` stands for the clang of this release; its library has a package of its own.
    let clang = depends("clang")?.into_iter().find(|name| name.starts_with("clang-")).context("no clang")?;
    let mut packages = vec![clang.replace("clang-", "libclang1-"), clang];
    for module in MODULES {
        packages.extend(depends(&developer(module))?.into_iter().filter(|name| is_library(module, name)));
    }
    let mut install = vec!["install", "--no-install-recommends"];
    install.extend(packages.iter().map(String::as_str));
    apt.run(&install)?;
    unpack(&sysroot()?)
}

/// The package with a module's headers.
fn developer(module: &str) -> String {
    format!("libopencv-{module}-dev")
}

/// Whether a package is a module's library: its name goes on with the version, as `libopencv-video406`.
fn is_library(module: &str, package: &str) -> bool {
    let rest = package.strip_prefix("libopencv-").and_then(|name| name.strip_prefix(module));
    rest.is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit()))
}

/// What a package depends on.
fn depends(package: &str) -> anyhow::Result<Vec<String>> {
    let text = Step::new("apt-cache").args(["depends", package]).output()?;
    Ok(text.lines().filter_map(|line| line.trim().strip_prefix("Depends: ")).map(str::to_owned).collect())
}

/// Unpacks the headers, and points the linker's names at the libraries that are installed.
fn unpack(sysroot: &Path) -> anyhow::Result<()> {
    fs::create_dir_all(sysroot).with_context(|| format!("cannot make {}", sysroot.display()))?;
    // Under a user of its own apt-get could not write here.
    let download = ["-qq", "-o", "APT::Sandbox::User=root", "download"];
    Step::new("apt-get").args(download).args(MODULES.map(developer)).within(sysroot).run()?;
    let archives = fs::read_dir(sysroot)?.flatten().map(|entry| entry.path());
    for archive in archives.filter(|path| path.extension().is_some_and(|end| end == "deb")) {
        Step::new("dpkg").arg("-x").arg(&archive).arg(sysroot).run()?;
        fs::remove_file(&archive)?;
    }
    let libraries = multiarch(&sysroot.join("usr/lib")).context("the packages hold no libraries")?;
    let installed = Path::new("/usr/lib").join(libraries.file_name().unwrap_or_default());
    for module in MODULES {
        let link = libraries.join(library(module));
        let target = fs::read_link(&link).with_context(|| format!("{} is no link", link.display()))?;
        let target = installed.join(target.file_name().unwrap_or_default());
        ensure!(target.exists(), "{} is not installed", target.display());
        fs::remove_file(&link)?;
        symlink(&target, &link).with_context(|| format!("cannot link {}", link.display()))?;
    }
    // The static libraries are large, and would be taken first.
    for file in fs::read_dir(&libraries)?.flatten().map(|entry| entry.path()) {
        if file.extension().is_some_and(|end| end == "a") {
            fs::remove_file(&file)?;
        }
    }
    Ok(())
}
