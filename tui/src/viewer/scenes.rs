//! What the viewer is shown of a project, and the files through which it is.

use std::path::PathBuf;

use anyhow::Context as _;
use honami_model::unfinished::Unfinished;
use honami_workbench::WorkbenchError;
use honami_workbench::grow::GrowRequest;
use honami_workbench::media;
use honami_workbench::plugins::{Host, PluginInfo};
use honami_workbench::progress::Progress;
use honami_workbench::scene::{Scene, SkeletonScene, file};
use honami_workbench::store::Project;
use honami_workbench::view;
use tempfile::TempDir;

/// A picture is so high unless it was said how large, pixels.
const HEIGHT: f64 = 720.0;

/// So many scenes are there at once.
pub(super) const KEPT: u32 = 4;

/// The skeleton of a project as it is now, and what is to be said of it; `is_writable` where what is done to it can be kept.
///
/// # Errors
/// As [`view::skeleton`].
pub(crate) fn skeleton(
    project: &Project,
    (host, plugin): (&Host, &PluginInfo),
    request: &GrowRequest,
    is_writable: bool,
    progress: &dyn Progress,
) -> Result<(SkeletonScene, Vec<String>), WorkbenchError> {
    let clip = Some(project.media_path()).filter(|path| path.exists());
    // The viewer says so where another lies there.
    let clip = clip.or_else(|| {
        project
            .find_media(|path| {
                media::open(path, &media::OpenOptions::default()).ok().map(|clip| clip.sha256())
            })
            .ok()
    });
    let is_missing = clip.is_none();
    let shown = view::skeleton(project, host, plugin, request, clip, progress)?;
    let mut notes = shown.notes;
    if is_missing {
        notes.push(
            "the clip is not where it was, and is not shown: `honami relink` says where it is".to_owned(),
        );
    }
    // Where what is shown is not what the project has, what would be done to it is not what is seen.
    let shut = match request {
        _ if !is_writable => Some("the project is open elsewhere, or not to be written"),
        request if request.as_grown => Some("hand work is left out (--as-grown)"),
        request if request.groups.is_some() => {
            Some("these are not the groups that the project has (--groups)")
        }
        _ => None,
    };
    Ok((SkeletonScene { shut: shut.map(str::to_owned), ..shown.scene }, notes))
}

/// So many pixels high, and as wide as the clip has it; even, as movies want it.
pub(crate) fn usual_size(scene: &SkeletonScene) -> [u32; 2] {
    let aspect = f64::from(scene.clip.width) / f64::from(scene.clip.height.max(1));
    [(HEIGHT * aspect / 2.0).round().clamp(1.0, 8192.0) as u32 * 2, HEIGHT as u32]
}

/// The files through which a viewer is shown scenes: in a folder with the caches, which goes with this.
#[derive(Debug)]
pub(crate) struct Scenes {
    pub(super) folder: TempDir,
    /// Whoever is ended by a signal removes it.
    _unfinished: Unfinished,
    /// How many were written.
    n: u32,
}

impl Scenes {
    /// None yet.
    ///
    /// # Errors
    /// Where there is no room for them.
    pub(crate) fn new() -> anyhow::Result<Self> {
        let caches = media::cache_folder().unwrap_or_else(std::env::temp_dir);
        let failed = || format!("cannot write a scene into {}", caches.display());
        std::fs::create_dir_all(&caches).with_context(failed)?;
        let begun = Unfinished::begin(|| {
            tempfile::Builder::new().prefix("scene-").tempdir_in(&caches).map(|folder| {
                let name = folder.path().to_owned();
                (folder, name)
            })
        });
        let (folder, unfinished) = begun.with_context(failed)?;
        Ok(Self { folder, _unfinished: unfinished, n: 0 })
    }

    /// Writes one. The last few stay: who is slow to read skips all but the last that it was told of.
    ///
    /// # Errors
    /// What the disk met.
    pub(crate) fn write(&mut self, scene: &Scene) -> anyhow::Result<PathBuf> {
        let path = self.folder.path().join(format!("{}.scene", self.n));
        file::write(&path, scene)?;
        if let Some(older) = self.n.checked_sub(KEPT) {
            std::fs::remove_file(path.with_file_name(format!("{older}.scene"))).unwrap_or_default();
        }
        self.n += 1;
        Ok(path)
    }
}
