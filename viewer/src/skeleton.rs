//! Skeletons: bones in the colours of their groups, over the clip that they were found in, or in space.

mod drawn;
mod lens;
mod pipelines;
mod room;
#[cfg(test)]
mod tests;

use std::collections::BTreeSet;

use honami_media::{Media, MediaError, OpenOptions, Rect};
use honami_scene::control::Chosen;
use honami_scene::{Orbit, SkeletonScene};

use self::drawn::Drawn;
use self::lens::Lens;
use self::pipelines::Pipelines;
use self::room::Room;
use crate::gpu::Gpu;
use crate::offscreen::{Picture, Shot};
use crate::target::Target;

/// Frames that begin so much later have begun, seconds.
const SAME_S: f64 = 1e-6;
/// Between the upper and the lower edge of the clip, radians.
const ANGLE: f32 = 0.5;

/// A part of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, clap::ValueEnum)]
pub enum Part {
    /// Bones and joints.
    Bones,
    /// Ellipsoids about groups.
    Ellipsoids,
    /// Tracks that joints carry.
    Leaves,
    /// Where tips have been during the last second.
    Trails,
    /// The frame of the clip, from the front.
    Clip,
    /// Copies round the plant.
    Copies,
}

impl Part {
    /// All of them, in the order in which they are listed.
    pub const ALL: [Self; 6] =
        [Self::Bones, Self::Ellipsoids, Self::Leaves, Self::Trails, Self::Clip, Self::Copies];

    /// These, or the usual ones where none are named.
    #[must_use]
    pub fn these(named: &[Self]) -> BTreeSet<Self> {
        if named.is_empty() { Self::usual() } else { named.iter().copied().collect() }
    }

    /// Those that are shown unless told otherwise.
    #[must_use]
    pub fn usual() -> BTreeSet<Self> {
        Self::ALL.into_iter().filter(|part| *part != Self::Ellipsoids).collect()
    }

    /// As it is called.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Bones => "bones",
            Self::Ellipsoids => "ellipsoids",
            Self::Leaves => "leaves",
            Self::Trails => "trails",
            Self::Clip => "clip",
            Self::Copies => "copies",
        }
    }
}

/// A skeleton that is drawn.
pub struct SkeletonPicture {
    /// What it is.
    pub scene: SkeletonScene,
    /// What of it is drawn.
    pub parts: BTreeSet<Part>,
    /// What is chosen.
    pub chosen: Option<Chosen>,
    /// Why the clip is not behind it, though it should be.
    pub without_clip: Option<String>,
    media: Option<Media>,
    /// What all of its frames take.
    room: Room,
    /// The clip's frame that is on the card, and how large.
    on_card: Option<(u32, [u32; 2])>,
    /// What draws, for targets with so many samples.
    pipelines: Option<(u32, Pipelines)>,
}

impl SkeletonPicture {
    /// A skeleton with some of its parts, over its clip where that is to be had.
    #[must_use]
    pub fn new(scene: SkeletonScene, parts: BTreeSet<Part>) -> Self {
        let (media, without_clip) = match open(&scene) {
            Ok(media) => (media, None),
            Err(why) => (None, Some(why)),
        };
        let room = Room::of(&scene);
        Self { scene, parts, chosen: None, without_clip, media, room, on_card: None, pipelines: None }
    }

    /// What to say where the parts that are on have nothing to draw.
    #[must_use]
    pub fn why_empty(&self) -> Option<String> {
        let scene = &self.scene;
        let has_axes =
            || scene.groups.iter().any(|group| group.half_axes.as_flattened().iter().any(|v| *v != 0.0));
        let has = |part: &Part| match part {
            Part::Bones | Part::Trails => scene.joints.len() > 1,
            Part::Ellipsoids => has_axes(),
            Part::Leaves => !scene.leaves.is_empty(),
            Part::Clip => self.media.is_some(),
            // Of the other parts.
            Part::Copies => false,
        };
        let names: Vec<&str> = self.parts.iter().map(|part| part.name()).collect();
        let shown = if names.is_empty() {
            "no part is on".to_owned()
        } else {
            format!("it has no {}", names.join(", no "))
        };
        (!self.parts.iter().any(has)).then(|| format!("nothing is seen of the skeleton: {shown}"))
    }

    /// Another skeleton of the same clip takes its place.
    pub fn take(&mut self, scene: SkeletonScene) {
        if scene.clip != self.scene.clip {
            *self = Self { chosen: self.chosen, ..Self::new(scene, std::mem::take(&mut self.parts)) };
            return;
        }
        self.room = Room::of(&scene);
        self.scene = scene;
    }

    /// The row of its own frames that is shown so many seconds from its first: the last that has begun.
    #[must_use]
    pub fn row_at(&self, time: f64) -> usize {
        // Times of movies are sums of their own, off by rounding.
        self.scene.times.partition_point(|at| *at <= time + SAME_S).saturating_sub(1)
    }

    /// How places are seen in a picture.
    fn lens(&self, shot: &Shot, target: &Target) -> Lens {
        let clip = &self.scene.clip;
        let (aspect, clip_aspect) = (target.aspect(), clip.width as f32 / clip.height as f32);
        Lens::new(&self.room.fit(&shot.camera, aspect, clip_aspect), aspect, clip_aspect)
    }

    /// Where a place is seen in a picture, pixels from its upper left corner; `None` behind the eye.
    #[must_use]
    pub fn seen(&self, shot: &Shot, target: &Target, place: [f32; 3]) -> Option<[f32; 2]> {
        let size = target.size();
        let [right, up] = self.lens(shot, target).seen(place)?;
        Some([(right + 1.0) / 2.0 * size.width as f32, (1.0 - up) / 2.0 * size.height as f32])
    }

    /// The place of the clip, pixels (right, down), that is seen at a place of a picture, pixels from its upper left corner: as
    /// it is from the front.
    #[must_use]
    pub fn placed(&self, shot: &Shot, target: &Target, [x, y]: [f32; 2]) -> [f64; 2] {
        let (size, lens) = (target.size(), self.lens(shot, target));
        let (right, up) = (2.0 * x / size.width as f32 - 1.0, 1.0 - 2.0 * y / size.height as f32);
        let eye = shot.camera.eye;
        let place = [eye[0] + right * lens.half * target.aspect(), -(eye[2] + up * lens.half)];
        place.map(|v| f64::from((v * 10.0).round()) / 10.0)
    }

    /// The node of the bone whose end is seen nearest to a place of a picture, within so many pixels.
    #[must_use]
    pub fn nearest(&self, shot: &Shot, target: &Target, at: [f32; 2], within: f32) -> Option<u32> {
        let places = self.scene.frame(self.row_at(shot.time));
        let joints = self.scene.joints.iter().zip(places).filter(|(joint, _)| joint.copy_of.is_none());
        let ends = joints.filter_map(|(joint, place)| {
            let [x, y] = self.seen(shot, target, *place)?;
            Some(((x - at[0]).hypot(y - at[1]), joint.bone?.node))
        });
        let near = ends.filter(|(off, _)| *off <= within).min_by(|a, b| a.0.total_cmp(&b.0));
        near.map(|(_, node)| node)
    }

    /// Puts a frame of the clip on the card, as large as the picture needs it.
    fn film(&mut self, gpu: &Gpu, target: &Target, frame: u32) -> Result<(), MediaError> {
        let (Some(media), Some((_, pipelines))) = (&self.media, &mut self.pipelines) else { return Ok(()) };
        let clip = &self.scene.clip;
        let share = (f64::from(target.size().height) / f64::from(clip.height)).min(1.0);
        let [width, height] =
            [clip.width, clip.height].map(|side| (f64::from(side) * share).round().max(1.0) as u32);
        let wanted = Some((frame, [width, height]));
        if self.on_card == wanted {
            return Ok(());
        }
        let pixels = media.rgb_area(frame, Rect::whole(clip.width, clip.height), width, height)?;
        pipelines.show_film(gpu, &pixels, width, height);
        self.on_card = wanted;
        Ok(())
    }
}

impl Picture for SkeletonPicture {
    fn orbit(&self) -> Orbit {
        front(&self.scene)
    }

    fn filmed(&self) -> Option<(f64, u32)> {
        let times = &self.scene.times;
        let long = times.last().zip(times.first()).map_or(0.0, |(last, first)| last - first);
        let fps = if long > 0.0 { (times.len() - 1) as f64 / long } else { crate::args::FPS };
        Some((fps, u32::try_from(times.len()).unwrap_or(u32::MAX)))
    }

    fn draw(&mut self, gpu: &Gpu, target: &Target, shot: &Shot) -> anyhow::Result<()> {
        let samples = target.size().samples;
        if self.pipelines.as_ref().is_none_or(|(of, _)| *of != samples) {
            self.pipelines = Some((samples, Pipelines::new(gpu, samples)));
            self.on_card = None;
        }
        let row = self.row_at(shot.time);
        let lens = self.lens(shot, target);
        let mut is_filmed = self.media.is_some() && self.parts.contains(&Part::Clip) && lens.depth < 1.0;
        if is_filmed && let Err(error) = self.film(gpu, target, self.scene.first_frame + row as u32) {
            // The skeleton is worth seeing without it.
            let why = format!("the clip is not shown from here on: {error}");
            crate::say(&why);
            (self.media, self.without_clip, is_filmed) = (None, Some(why), false);
        }
        let drawn = Drawn::of(self, row, &lens, target, is_filmed);
        if let Some((_, pipelines)) = &self.pipelines {
            pipelines.draw(gpu, target, &drawn);
        }
        Ok(gpu.check()?)
    }
}

/// From the front, as high as the clip. The middle of its upper left pixel is where it begins to count.
#[must_use]
pub fn front(scene: &SkeletonScene) -> Orbit {
    let (width, height) = (scene.clip.width as f32, scene.clip.height as f32);
    Orbit {
        target: [(width - 1.0) / 2.0, 0.0, (1.0 - height) / 2.0],
        distance: height / 2.0 / (ANGLE / 2.0).tan(),
        azimuth: 0.0,
        elevation: 0.0,
        angle: ANGLE,
    }
}

/// The clip where there is one, and why it is not behind where it does not open.
fn open(scene: &SkeletonScene) -> Result<Option<Media>, String> {
    let Some(path) = &scene.clip.path else { return Ok(None) };
    let options = OpenOptions { fps: scene.clip.fps, ..OpenOptions::default() };
    let media =
        honami_media::open(path, &options).map_err(|error| format!("the clip is not shown: {error}"))?;
    let (clip, film) = (media.clip(), &scene.clip);
    if film.sha256.as_ref().is_some_and(|sha256| *sha256 != media.sha256()) {
        return Err(format!("the clip is not shown: another lies at {}", path.display()));
    }
    match (clip.width, clip.height) == (film.width, film.height) && clip.n_frames() >= film.n_frames {
        true => Ok(Some(media)),
        false => Err(format!(
            "the clip is not shown: {} has {} frames of {}x{}, and {} of {}x{} were wanted",
            path.display(),
            clip.n_frames(),
            clip.width,
            clip.height,
            film.n_frames,
            film.width,
            film.height
        )),
    }
}
