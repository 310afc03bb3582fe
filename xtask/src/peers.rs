//! Other programs that tests hold honami against, in the target folder: OpenSees, bvhio, c3d, ezc3d, pygltflib, trimesh and USD
//! for Python, glTF's validator for node.

use std::ffi::OsString;
use std::fs;
use std::path::Path;

use anyhow::Context as _;

use crate::shell::{Step, target_dir};
use crate::system;

/// What Python is to have, and what it imports.
const PACKAGES: [&str; 8] =
    ["openseespy", "bvhio", "c3d", "ezc3d", "numpy", "pygltflib", "trimesh", "usd-core"];
const IMPORTS: &str = "import openseespy.opensees, bvhio, c3d, ezc3d, numpy, pygltflib, trimesh, pxr";
const VALIDATOR: &str = "gltf-validator";

/// What tests must be told to find them.
pub(crate) type Env = Vec<(&'static str, OsString)>;

/// Finds or installs them; says what is skipped where it cannot. `HONAMI_PYTHON` names a Python that has its packages.
pub(crate) fn want() -> Option<Env> {
    let made = target_dir().and_then(|target| {
        let folder = target.join("peers");
        fs::create_dir_all(&folder)?;
        let python = std::env::var_os("HONAMI_PYTHON").map_or_else(|| python(&folder), Ok)?;
        Step::new(&python).args(["-c", IMPORTS]).output()?;
        let modules = folder.join("node_modules");
        if !modules.join(VALIDATOR).is_dir() {
            if !system::is_there("npm") {
                system::install("npm");
            }
            let npm = Step::new("npm").args(["install", "--silent", "--no-audit", "--no-fund", "--prefix"]);
            npm.arg(&folder).arg(VALIDATOR).run()?;
        }
        Ok(vec![("HONAMI_PYTHON", python), ("NODE_PATH", modules.into())])
    });
    made.map_err(|error| {
        eprintln!("skipped: what OpenSees, readers of rigs and glTF's validator say is not asked: {error:#}");
    })
    .ok()
}

/// Installs them, and says what to set for tests that are run without this program.
pub(crate) fn tell() -> anyhow::Result<()> {
    for (name, value) in want().context("not all of them could be installed")? {
        println!("export {name}={}", value.display());
    }
    Ok(())
}

/// A Python of its own, with the packages.
fn python(folder: &Path) -> anyhow::Result<OsString> {
    let venv = folder.join("venv");
    let python = venv.join("bin/python");
    if Step::new(&python).args(["-c", IMPORTS]).output().is_err() {
        if Step::new("python3").args(["-c", "import venv, ensurepip"]).output().is_err() {
            system::install("python3-venv");
        }
        Step::new("python3").args(["-m", "venv"]).arg(&venv).run()?;
        Step::new(&python).args(["-m", "pip", "install", "--quiet"]).args(PACKAGES).run()?;
    }
    Ok(python.into())
}
