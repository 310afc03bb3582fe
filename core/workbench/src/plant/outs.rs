//! What is written of a motion: nothing has its name before all of it is there.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use honami_exchange::glb::is_own;
use honami_exchange::plant::{BeamRow, PointCache, SwayRow};
use honami_exchange::{AtomicFile, Writer};

use super::Vibrating;
use super::glb::{Made, Scene};
use super::sway::Motion;
use crate::error::WorkbenchError;
use crate::progress::Progress;

/// Bytes that are worth a word before they are written.
const MANY: u64 = 1_000_000_000;
/// Bytes of a row of a table of sensors or beams, about.
const ROW: u64 = 80;
/// Of a point in a cache, and before all points.
const POINT: u64 = 12;
const HEAD: u64 = 32;

/// Files that are wanted.
#[derive(Clone, Copy, Debug, Default)]
pub struct Outs<'a> {
    /// A table: where its sensors are, a row a sensor and frame.
    pub table: Option<&'a Path>,
    /// A point cache: where all nodes of all copies are.
    pub cache: Option<&'a Path>,
    /// The plant with its motion, and all copies.
    pub glb: Option<&'a Path>,
    /// The beams of the plant.
    pub beams: Option<&'a Path>,
}

/// Files that are begun, and leave nothing behind until they are finished.
pub(super) struct Files {
    pub(super) table: Option<Writer<SwayRow>>,
    pub(super) cache: Option<PointCache>,
    glb: Option<AtomicFile>,
    beams: Option<Writer<BeamRow>>,
}

impl Files {
    /// Begins them all.
    pub(super) fn create(plant: &Vibrating, motion: &Motion, outs: Outs<'_>) -> Result<Self, WorkbenchError> {
        let n_points = motion.n_copies * plant.beams.len();
        let cache = |path: &Path| PointCache::create(path, n_points, motion.n_frames);
        Ok(Self {
            table: outs.table.map(Writer::create).transpose()?,
            cache: outs.cache.map(cache).transpose()?,
            glb: outs.glb.map(|path| AtomicFile::create(path, |_head| is_own(path))).transpose()?,
            beams: outs.beams.map(|path| beams(plant, path)).transpose()?,
        })
    }

    /// Gives them their names; what became of the scene that is in one of them.
    pub(super) fn finish(self, scene: Option<&Scene>) -> Result<Option<Made>, WorkbenchError> {
        let made = scene.zip(self.glb).map(|(scene, file)| scene.write(file)).transpose()?;
        self.table.map(Writer::finish).transpose()?;
        self.cache.map(PointCache::finish).transpose()?;
        self.beams.map(Writer::finish).transpose()?;
        Ok(made)
    }
}

impl<'a> Outs<'a> {
    /// What is written frame by frame, and how many bytes that becomes; of a .glb its own writer knows.
    fn sizes(&self, n_points: u64, n_sensors: u64, n_frames: u32) -> Vec<(&'a Path, u64)> {
        let of = |n: u64, bytes: u64| n.saturating_mul(u64::from(n_frames)).saturating_mul(bytes);
        let table = self.table.map(|path| (path, of(n_sensors, ROW)));
        let cache = self.cache.map(|path| (path, of(n_points, POINT).saturating_add(HEAD)));
        table.into_iter().chain(cache).collect()
    }
}

/// Says what is large before it is written.
///
/// # Errors
/// [`WorkbenchError::Disk`] where a folder has less room, by what `free` says.
pub(super) fn check_room(
    outs: &Outs<'_>,
    [n_points, n_sensors]: [usize; 2],
    n_frames: u32,
    free: impl Fn(&Path) -> u64,
    progress: &dyn Progress,
) -> Result<(), WorkbenchError> {
    let sizes = outs.sizes(n_points as u64, n_sensors as u64, n_frames);
    let mut wanted = BTreeMap::<PathBuf, u64>::new();
    for (path, bytes) in &sizes {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let there = free(folder);
        let wanted = wanted.entry(folder.to_owned()).or_default();
        *wanted = wanted.saturating_add(*bytes);
        if *wanted > there {
            return Err(WorkbenchError::Disk { path: (*path).to_owned(), bytes: *wanted, there });
        }
    }
    sizes.iter().filter_map(|(path, bytes)| large(path, *bytes)).for_each(|line| progress.say(&line));
    Ok(())
}

/// Bytes that are free in a folder; as many as one likes where the system does not say.
pub(super) fn free_in(folder: &Path) -> u64 {
    rustix::fs::statvfs(folder).map_or(u64::MAX, |there| there.f_bavail.saturating_mul(there.f_frsize))
}

fn large(path: &Path, bytes: u64) -> Option<String> {
    (bytes > MANY).then(|| format!("{}: {:.1} GB will be written", path.display(), bytes as f64 / 1e9))
}

/// The beams of a plant as a table, to be finished.
pub(super) fn beams(plant: &Vibrating, path: &Path) -> Result<Writer<BeamRow>, WorkbenchError> {
    let mut table = Writer::create(path)?;
    for node in 0..plant.beams.len() {
        let at = plant.beams.position(node);
        let (parent, radius) = (plant.beams.parent(node), plant.beams.radius(node));
        table.write(&BeamRow { node: node as u32, parent, x: at.x, y: at.y, z: at.z, radius })?;
    }
    Ok(table)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::Flow;
    use std::sync::Mutex;

    #[derive(Default)]
    struct Said(Mutex<Vec<String>>);

    impl Progress for Said {
        fn report(&self, _done: u64, _total: u64, _what: &str) -> Flow {
            Flow::Continue
        }

        fn say(&self, line: &str) {
            self.0.lock().unwrap().push(line.to_owned());
        }
    }

    #[test]
    fn what_is_large_is_told_and_what_has_no_room_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let [table, cache] = ["a.csv", "a.pc2"].map(|name| folder.path().join(name));
        let outs = Outs { table: Some(&table), cache: Some(&cache), ..Outs::default() };
        let ask = |points: usize, sensors: usize, frames: u32| {
            let said = Said::default();
            check_room(&outs, [points, sensors], frames, |_| 2_000_000_000, &said)
                .map(|()| said.0.into_inner().unwrap())
        };
        assert_eq!(ask(1000, 12, 500).unwrap(), [""; 0]);
        assert!(free_in(folder.path()) > 0);
        let lines = ask(1_000_000, 12, 100).unwrap();
        assert_eq!(lines, [format!("{}: 1.2 GB will be written", cache.display())]);
        let (table, cache) = (table.display(), cache.display());
        for (points, sensors, frames, wanted) in [
            (1_000_000, 1, 200, format!("{cache}: 2.4 GB would be written there, and 2.0 are free")),
            // Each alone would do.
            (1_000_000, 100_000, 150, format!("{cache}: 3.0 GB would be written there, and 2.0 are free")),
            (1, usize::MAX, 2, format!("{table}: 18446744073.7 GB would be written there")),
        ] {
            let said = ask(points, sensors, frames).unwrap_err().to_string();
            assert!(said.starts_with(&wanted), "{said}");
        }
    }
}
