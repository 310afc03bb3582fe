//! The words of scripts, and what each does.

use honami_host::{HostError, Kind, Values};
use honami_model::correct::{self, Correction, Drawn, Played, Refused, Shown, Stroke};
use honami_model::document::RunId;
use honami_model::edit::{Edit, Transaction};
use honami_model::judgement::{Effort, Judgement, Verdict};
use honami_model::track::{Status, TrackId};

use super::arguments::Arguments;
use super::{Act, ScriptError, Word};
use crate::correct::{Step, prepare};
use crate::error::WorkbenchError;
use crate::ground::Ground;
use crate::regroup;
use crate::retrack::{self, RetrackRequest, Way};
use crate::session::Session;
use crate::shape::{self, Listed, Shape};

type Outcome = Result<Act, ScriptError>;

/// Every word of a script, in the order of the help.
pub const WORDS: &[Word] = &[
    Word { name: "add", takes: "FRAME X Y", does: "place a new track", act: add },
    Word {
        name: "key",
        takes: "TRACK FRAME X Y",
        does: "move a sample, which becomes a key-frame; those beside it stay",
        act: key,
    },
    Word {
        name: "confirm",
        takes: "TRACK FRAME",
        does: "find a sample right; it becomes a key-frame",
        act: confirm,
    },
    Word {
        name: "clear",
        takes: "TRACK FRAME",
        does: "give a key-frame back to the runs below it",
        act: clear,
    },
    Word {
        name: "linear",
        takes: "TRACK FRAME X Y",
        does: "move a sample; straight lines to the key-frames beside it",
        act: |session, given| moved(session, given, correct::linear),
    },
    Word {
        name: "hermite",
        takes: "TRACK FRAME X Y",
        does: "move a sample; a smooth curve through the key-frames beside it",
        act: |session, given| moved(session, given, correct::hermite),
    },
    Word {
        name: "space",
        takes: "TRACK FRAME X Y",
        does: "move a sample; those up to the key-frames beside it move along",
        act: |session, given| moved(session, given, correct::space),
    },
    Word {
        name: "time",
        takes: "TRACK FRAME SECONDS",
        does: "slide samples along the curve, later or (-) earlier",
        act: time,
    },
    Word {
        name: "sketch",
        takes: "TRACK FRAME RATE S,X,Y…",
        does: "lay a stroke: drawn S seconds after the clip played from FRAME at RATE",
        act: sketch,
    },
    Word {
        name: "retrack",
        takes: "TRACK forward|backward|both FIRST LAST [TRACKER] [K=V…]",
        does: "track again from the key-frames in a range; hand work stays",
        act: retrack,
    },
    Word {
        name: "mark",
        takes: "lost|occluded|outside|seen TRACK FIRST LAST",
        does: "say what is known of the feature in a range",
        act: mark,
    },
    Word {
        name: "range-delete",
        takes: "TRACK FIRST LAST",
        does: "take the samples of a range away",
        act: range_delete,
    },
    Word {
        name: "take",
        takes: "TRACK RUN FIRST LAST",
        does: "lay what a run found in a range over what is shown; key-frames stay",
        act: take,
    },
    Word { name: "split", takes: "TRACK FRAME", does: "cut a track in two: a new one goes on", act: split },
    Word { name: "swap", takes: "TRACK TRACK FIRST LAST", does: "exchange two tracks in a range", act: swap },
    Word {
        name: "join",
        takes: "TRACK TRACK",
        does: "fill a track with another one, which is deleted",
        act: join,
    },
    Word { name: "duplicate", takes: "TRACK", does: "make a track like this one", act: duplicate },
    Word { name: "average", takes: "TRACK…", does: "make a track that is the mean of these", act: average },
    Word {
        name: "name", takes: "TRACK [NAME…]", does: "name a track; without a name, forget it", act: name
    },
    Word {
        name: "judge",
        takes: "TRACK FIRST LAST accepted|fixed|occluded|lost|rejected|later",
        does: "a reviewer's word on a range",
        act: judge,
    },
    Word { name: "unjudge", takes: "TRACK FIRST", does: "take a judgement back", act: unjudge },
    Word {
        name: "delete",
        takes: "TRACK…",
        does: "delete tracks; their work is kept",
        act: |_, given| Ok(Act::Commit(Transaction::delete_tracks(given.tracks(0)?))),
    },
    Word {
        name: "restore",
        takes: "TRACK…",
        does: "take deleted tracks back",
        act: |_, given| Ok(Act::Commit(Transaction::restore_tracks(given.tracks(0)?))),
    },
    Word {
        name: "cut",
        takes: "K",
        does: "cut the shown clustering into K groups, those made by hand among them",
        act: cut,
    },
    Word {
        name: "group-merge",
        takes: "GROUP GROUP",
        does: "make one group of two, which stays so wherever the cut is",
        act: |session, given| regrouped(session, &regroup::Step::Merge(given.group(0)?, given.group(1)?)),
    },
    Word {
        name: "group-split",
        takes: "GROUP",
        does: "make two groups of one, as they were merged",
        act: |session, given| regrouped(session, &regroup::Step::Split(given.group(0)?)),
    },
    Word {
        name: "group-take",
        takes: "GROUP TRACK…",
        does: "take tracks out of their groups into this one",
        act: |session, given| regrouped(session, &regroup::Step::Take(given.tracks(1)?, given.group(0)?)),
    },
    Word {
        name: "group-name",
        takes: "GROUP [NAME…]",
        does: "name a group; without a name, forget it",
        act: group_name,
    },
    Word {
        name: "group-release",
        takes: "",
        does: "forget groups made by hand: they are those of the cut again",
        act: |session, _| regrouped(session, &regroup::Step::Release),
    },
    Word {
        name: "shape-root",
        takes: "X Y",
        does: "place the root of skeletons",
        act: |session, given| shaped(session, &shape::Step::Root(Some(given.root(0)?))),
    },
    Word {
        name: "shape-bone",
        takes: "GROUPS PLANE LEAN GAIN",
        does: "shape the bone that bears these groups (3, 3,4, 1-4): degrees, degrees, times",
        act: shape_bone,
    },
    Word {
        name: "shape-release",
        takes: "[root|GROUPS]",
        does: "leave the root, a bone, or all of the skeleton as it grows",
        act: shape_release,
    },
    Word { name: "undo", takes: "", does: "take the last edit back", act: |_, _| Ok(Act::Undo) },
    Word { name: "redo", takes: "", does: "do again what was undone", act: |_, _| Ok(Act::Redo) },
];

fn add(session: &mut Session, given: &Arguments<'_>) -> Outcome {
    let (frame, [x, y]) = given.place(0, session)?;
    let track = new(session)?;
    Ok(Act::Commit(Transaction::add_track(track, frame, x, y)))
}

fn key(session: &mut Session, given: &Arguments<'_>) -> Outcome {
    let (frame, to) = given.place(1, session)?;
    let track = given.track(0)?;
    let from = session.project.shown(track)?.and_then(|span| span.get(frame).map(|at| [at.x, at.y]));
    Ok(Act::Commit(Transaction::set_key(track, frame, to, from)))
}

fn confirm(session: &mut Session, given: &Arguments<'_>) -> Outcome {
    let (track, frame) = (given.track(0)?, given.whole(1, "frame")?);
    let span = session.project.shown(track)?;
    let sample = span.and_then(|span| span.get(frame).copied()).ok_or(Refused::NoSample { track, frame })?;
    Ok(Act::Commit(Transaction::confirm_key(track, frame, &sample)?))
}

fn clear(_: &mut Session, given: &Arguments<'_>) -> Outcome {
    Ok(Act::Commit(Transaction::clear_key(given.track(0)?, given.whole(1, "frame")?)))
}

/// A sample is moved, with what the tool makes of those beside it.
fn moved(
    session: &Session,
    given: &Arguments<'_>,
    tool: fn(&Shown<'_>, u32, [f32; 2]) -> Result<Correction, Refused>,
) -> Outcome {
    let (frame, to) = given.place(1, session)?;
    on_track(session, given.track(0)?, |shown| tool(shown, frame, to))
}

fn time(session: &mut Session, given: &Arguments<'_>) -> Outcome {
    let frame = given.whole(1, "frame")?;
    let shift_s = given.number(2, "a shift in seconds")?;
    on_track(session, given.track(0)?, |shown| Ok(correct::time(shown, frame, shift_s)?.correction))
}

fn sketch(session: &mut Session, given: &Arguments<'_>) -> Outcome {
    let frame = given.whole(1, "frame")?;
    let beyond = || given.wrong(1, "a frame of the clip");
    let from_s = session.media.clip().times.get(frame).ok_or_else(beyond)?;
    let rate = given.number(2, "a rate, 1 for real time")?;
    let drawn = given.rest(3).iter().enumerate().map(|(at, word)| {
        let numbers: Option<Vec<f64>> = word.split(',').map(|number| number.parse().ok()).collect();
        match numbers.as_deref() {
            Some(&[elapsed_s, x, y]) => Ok(Drawn { elapsed_s, at: [x, y] }),
            _ => Err(given.wrong(at + 3, "a point of the stroke as S,X,Y")),
        }
    });
    let drawn = drawn.collect::<Result<Vec<Drawn>, _>>()?;
    let stroke = Stroke { played: Played::under_hand(from_s, rate, 0.0), drawn };
    on_track(session, given.track(0)?, |shown| correct::sketch(shown, &[stroke]))
}

fn retrack(session: &mut Session, given: &Arguments<'_>) -> Outcome {
    let way = match given.text(1) {
        "forward" => Way::Forward,
        "backward" => Way::Backward,
        "both" => Way::Both,
        _ => return Err(given.wrong(1, "forward, backward or both")),
    };
    let (track, frames) = (given.track(0)?, given.frames(2)?);
    let with = match given.rest(4) {
        [] => None,
        [name, set @ ..] => {
            let plugin = session.registry.find(Kind::Tracker, name).map_err(WorkbenchError::from)?;
            let mut values = Values::defaults(&plugin.params);
            for assignment in set {
                values
                    .set_text(&plugin.params, assignment)
                    .map_err(HostError::from)
                    .map_err(WorkbenchError::from)?;
            }
            Some((plugin.id.clone(), values))
        }
    };
    let request =
        RetrackRequest { track, way, frames: frames.start..=frames.end - 1, keys: Vec::new(), with };
    let done = retrack::prepare(session, &request)?.run(&())?;
    Ok(Act::Committed(retrack::finish(session, done)?.entry))
}

fn mark(session: &mut Session, given: &Arguments<'_>) -> Outcome {
    let status = match given.text(0) {
        "lost" => Status::Lost,
        "occluded" => Status::Occluded,
        "outside" => Status::Outside,
        "seen" => Status::Tracked,
        _ => return Err(given.wrong(0, "lost, occluded, outside or seen")),
    };
    let (tracks, frames) = (given.track(1)?.into(), given.frames(2)?);
    stepped(session, &Step::Mark { tracks, frames, status })
}

fn range_delete(session: &mut Session, given: &Arguments<'_>) -> Outcome {
    stepped(session, &Step::DeleteRange { tracks: given.track(0)?.into(), frames: given.frames(1)? })
}

fn take(session: &mut Session, given: &Arguments<'_>) -> Outcome {
    let (tracks, run) = (given.track(0)?.into(), RunId(given.whole(1, "run")?));
    stepped(session, &Step::Take { tracks, frames: given.frames(2)?, run })
}

fn split(session: &mut Session, given: &Arguments<'_>) -> Outcome {
    stepped(session, &Step::Split { track: given.track(0)?, frame: given.whole(1, "frame")? })
}

fn swap(session: &mut Session, given: &Arguments<'_>) -> Outcome {
    let tracks = [given.track(0)?, given.track(1)?];
    stepped(session, &Step::Swap { tracks, frames: given.frames(2)? })
}

fn join(session: &mut Session, given: &Arguments<'_>) -> Outcome {
    stepped(session, &Step::Join { track: given.track(0)?, with: given.track(1)? })
}

fn duplicate(session: &mut Session, given: &Arguments<'_>) -> Outcome {
    stepped(session, &Step::Duplicate(given.track(0)?))
}

fn average(session: &mut Session, given: &Arguments<'_>) -> Outcome {
    stepped(session, &Step::Average(given.tracks(0)?))
}

fn name(_: &mut Session, given: &Arguments<'_>) -> Outcome {
    let name = given.rest(1).join(" ");
    Ok(Act::Commit(Transaction::name_track(given.track(0)?, (!name.is_empty()).then_some(name))))
}

fn judge(session: &mut Session, given: &Arguments<'_>) -> Outcome {
    let (track, frames) = (given.track(0)?, given.frames(1)?);
    let verdict = Verdict::ALL.into_iter().find(|verdict| verdict.word() == given.text(3));
    let words = Verdict::ALL.map(Verdict::word).join(", ");
    let verdict = verdict.ok_or_else(|| given.wrong(3, &format!("one of {words}")))?;
    let reviewer = session.project.holder().map_or_else(String::new, |holder| holder.user.clone());
    let seal = session.project.shown(track)?.map(|span| span.seal(frames.clone()));
    let judgement = Judgement {
        end_frame: frames.end,
        verdict,
        reasons: Vec::new(),
        reviewer,
        time: honami_store::now(),
        effort: Effort::default(),
        seal,
    };
    Ok(Act::Commit(Transaction::judge(track, frames.start, judgement)))
}

fn unjudge(_: &mut Session, given: &Arguments<'_>) -> Outcome {
    let (track, first_frame) = (given.track(0)?, given.whole(1, "first frame")?);
    let label = format!("track {track}: judgement from frame {first_frame} taken back");
    let edit = Edit::Judge { track, first_frame, judgement: None };
    Ok(Act::Commit(Transaction::new(label, vec![edit])))
}

fn cut(session: &mut Session, given: &Arguments<'_>) -> Outcome {
    let groups = given.whole(0, "number of groups")?;
    let grouping = session.project.grouping()?;
    let n_tracks = grouping.map_or(u32::MAX as usize, |grouping| grouping.group_of.len());
    if groups as usize > n_tracks {
        return Err(ScriptError::Groups { groups, n_tracks });
    }
    Ok(Act::Commit(Transaction::set_cut(groups)))
}

fn group_name(session: &mut Session, given: &Arguments<'_>) -> Outcome {
    let name = given.rest(1).join(" ");
    regrouped(session, &regroup::Step::Name(given.group(0)?, (!name.is_empty()).then_some(name)))
}

fn regrouped(session: &Session, step: &regroup::Step) -> Outcome {
    Ok(Act::Commit(regroup::prepare(&session.project, step)?))
}

fn shape_bone(session: &mut Session, given: &Arguments<'_>) -> Outcome {
    let Listed { bone, .. } = shape::bone(&session.project, &given.groups(0)?)?;
    let shape = Shape {
        plane_rad: given.number(1, "the turn of its plane in degrees")?.to_radians(),
        lean_rad: given.number(2, "how it leans, in degrees")?.to_radians(),
        gain: given.number(3, "a gain, 1 for as it was seen")?,
    };
    shaped(session, &shape::Step::Bone(bone, shape))
}

fn shape_release(session: &mut Session, given: &Arguments<'_>) -> Outcome {
    let step = match given.text(0) {
        "" => shape::Step::Release,
        "root" => shape::Step::Root(None),
        _ => {
            let bone = shape::bone(&session.project, &given.groups(0)?)?.bone;
            shape::Step::Bone(bone, Shape::default())
        }
    };
    shaped(session, &step)
}

fn shaped(session: &Session, step: &shape::Step) -> Outcome {
    Ok(Act::Commit(shape::prepare(&session.project, step)?))
}

/// The number of a new track.
fn new(session: &mut Session) -> Result<TrackId, ScriptError> {
    Ok(TrackId(session.project.reserve_tracks(1)?.start))
}

fn on_track(
    session: &Session,
    track: TrackId,
    tool: impl FnOnce(&Shown<'_>) -> Result<Correction, Refused>,
) -> Outcome {
    let ground = Ground::of(&session.project, track)?;
    Ok(Act::Commit(tool(&ground.shown(&session.project.clip().clip.times))?.transaction))
}

fn stepped(session: &mut Session, step: &Step) -> Outcome {
    Ok(Act::Commit(prepare(&mut session.project, step)?.0))
}
