//! TrackMate's whole file: spots, and the edges that make tracks of them.
//!
//! A TrackMate track may split and merge. Ours may not: it is cut there, the earliest branch goes on as the
//! track and the others become tracks of their own; how many is said.

use std::collections::{BTreeMap, BTreeSet};
use std::io::BufRead;

use honami_model::track::Sample;

use super::super::draft::{self, Draft, Room};
use super::super::xml::{Node, Tag, Xml};
use super::super::{Flaw, ForeignTracks, Tally};
use super::frame;
use crate::origin::Raster;

/// Spots by their id.
type Spots = BTreeMap<u64, (u32, Sample)>;

/// A track of the file: edges between spots, the earlier one first.
struct Graph {
    number: u32,
    name: Option<String>,
    edges: Vec<[u64; 2]>,
}

#[derive(Default)]
struct File {
    spots: Vec<(u64, u32, [f64; 2])>,
    graphs: Vec<Graph>,
    shown: Option<BTreeSet<u32>>,
    image: Option<([u32; 2], f64)>,
}

pub(super) fn parse<R: BufRead>(
    mut xml: Xml<R>,
    raster: Raster,
    pixel_size: Option<f64>,
) -> Result<ForeignTracks, Flaw> {
    let (mut file, mut room, mut tally) = (File::default(), Room::new(), Tally::default());
    while let Some(node) = xml.next()? {
        if let Node::Open(tag) = node {
            file.take(&tag, &mut room)?;
        }
    }
    let pixel_size = pixel_size.or(file.image.map(|(_, width)| width)).unwrap_or(1.0);
    let mut spots = Spots::new();
    for (id, frame, [x, y]) in file.spots {
        let at = super::narrow(raster.to_ours([x / pixel_size, y / pixel_size]));
        let at = at.ok_or_else(|| Flaw::wrong(format!("spot {id}"), "a position", "none in pixels"))?;
        if spots.insert(id, (frame, super::seen(at, None))).is_some() {
            return Err(Flaw::wrong("<Spot>", "every ID once", &id.to_string()));
        }
    }
    let mut room = Room::new();
    let (mut drafts, mut used) = (Vec::new(), BTreeSet::new());
    for graph in file.graphs {
        if file.shown.as_ref().is_some_and(|shown| !shown.contains(&graph.number)) {
            tally.add("tracks that TrackMate's filter hides");
            continue;
        }
        drafts.extend(chains(&graph, &spots, &mut used, &mut room, &mut tally)?);
    }
    (used.len()..spots.len()).for_each(|_| tally.add("spots of no shown track"));
    let size = file.image.map(|(size, _)| size);
    Ok(ForeignTracks { tracks: draft::all(drafts)?, size, dropped: tally.lines() })
}

impl File {
    /// Takes what an element says.
    fn take(&mut self, tag: &Tag, room: &mut Room) -> Result<(), Flaw> {
        let id = |name: &str| tag.need::<u64>(name, "the ID of a spot");
        match tag.name.as_str() {
            "ImageData" => {
                let side = |name: &str| tag.need::<u32>(name, "a number of pixels");
                let width = tag.number("pixelwidth")?;
                if width <= 0.0 {
                    return Err(tag.wrong("pixelwidth", "a positive number", &width.to_string()));
                }
                self.image = Some(([side("width")?, side("height")?], width));
            }
            "Spot" => {
                room.take(1)?;
                let at = [tag.number("POSITION_X")?, tag.number("POSITION_Y")?];
                self.spots.push((id("ID")?, frame(tag, "FRAME")?, at));
            }
            "Track" => {
                let number = tag.need("TRACK_ID", "a whole number of 0 or more")?;
                // TrackMate calls its tracks Track_0, Track_1, …: a number, no name.
                let name = tag.get("name").filter(|&name| name != format!("Track_{number}"));
                self.graphs.push(Graph { number, name: name.map(str::to_owned), edges: Vec::new() });
            }
            "Edge" => {
                room.take(1)?;
                let edge = [id("SPOT_SOURCE_ID")?, id("SPOT_TARGET_ID")?];
                let wrong = || tag.wrong("Edge", "a <Track> around it", "none");
                self.graphs.last_mut().ok_or_else(wrong)?.edges.push(edge);
            }
            "FilteredTracks" => self.shown = Some(BTreeSet::new()),
            "TrackID" => {
                let number = tag.need("TRACK_ID", "a whole number of 0 or more")?;
                self.shown.get_or_insert_default().insert(number);
            }
            _ => {}
        }
        Ok(())
    }
}

/// The unbranched pieces of a track, the one that begins first at their head.
fn chains(
    graph: &Graph,
    spots: &Spots,
    used: &mut BTreeSet<u64>,
    room: &mut Room,
    tally: &mut Tally,
) -> Result<Vec<Draft>, Flaw> {
    let frame_of = |id: u64| {
        let at = format!("edges of track {}", graph.number);
        spots.get(&id).map(|spot| spot.0).ok_or_else(|| Flaw::wrong(at, "a spot", &id.to_string()))
    };
    let mut next: BTreeMap<u64, u64> = BTreeMap::new();
    let mut led_to: BTreeSet<u64> = BTreeSet::new();
    let mut edges = Vec::new();
    for &[a, b] in &graph.edges {
        let (from, to) = if frame_of(a)? <= frame_of(b)? { (a, b) } else { (b, a) };
        if frame_of(from)? == frame_of(to)? {
            let at = format!("edges of track {}", graph.number);
            return Err(Flaw::wrong(at, "spots of two frames", &format!("{from} and {to}")));
        }
        edges.push((frame_of(from)?, frame_of(to)?, from, to));
    }
    edges.sort_unstable();
    edges.dedup();
    for (_, _, from, to) in &edges {
        if next.contains_key(from) || !led_to.insert(*to) {
            tally.add("splits and merges: the track is cut there");
            continue;
        }
        next.insert(*from, *to);
    }
    let ids: BTreeSet<u64> = edges.iter().flat_map(|&(_, _, from, to)| [from, to]).collect();
    let mut starts = Vec::new();
    for &id in ids.iter().filter(|id| !led_to.contains(id)) {
        starts.push((frame_of(id)?, id));
    }
    starts.sort_unstable();
    let mut drafts = Vec::new();
    for (_, start) in starts {
        let first = drafts.is_empty();
        let number = Some(graph.number).filter(|_| first);
        let mut draft = Draft { number, name: graph.name.clone(), ..Draft::default() };
        let mut at = Some(start);
        while let Some((frame, sample)) = at.and_then(|id| spots.get(&id)) {
            draft.put(room, *frame, *sample)?;
            used.extend(at);
            at = at.and_then(|id| next.get(&id).copied());
        }
        drafts.push(draft);
    }
    Ok(drafts)
}
