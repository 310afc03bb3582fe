//! What a tracker carries: saved and loaded, it goes on as if nothing had been.

use honami_abi::code;

use super::Picture;
use crate::testing::{cx, stream};
use crate::tracker::{Point, Points, Seed, Stream, Tracker};
use crate::{Error, Result, State, state};

const SIZE: [u32; 2] = [160, 120];

/// Saves in every frame of a stream; what is loaded from that tells the rest as the one that was never saved does.
/// Bytes that are not those are refused.
pub(super) fn carried<T: Tracker>(params: &T::Params) -> Result<()> {
    let Some(offered) = T::STATE else { return Ok(()) };
    let births = 5000..6000;
    let stream = Stream { births, max_threads: 2, ..stream(SIZE[0], SIZE[1]) };
    let setting = state::Setting { params: 7, stream: stream.clone() };
    let mut tracker = T::begin(params, &stream, &cx())?;
    let mut others: Vec<T> = Vec::new();
    let grid = (0..150_u32).map(|id| {
        let (x, y) = ((id % 15) as f32 * 10.3 + 4.3, (id / 15) as f32 * 11.1 + 3.7);
        Seed { id, x, y }
    });
    tracker.seed(&grid.collect::<Vec<_>>(), &cx())?;
    for t in 0..6 {
        let rows = step(&mut tracker, t)?;
        for (n, other) in others.iter_mut().enumerate() {
            if step(other, t)? != rows {
                return Err(Error::data(format!("loaded as saved in frame {n}, it differs in frame {t}")));
            }
        }
        let bytes = saved(&offered, &setting, &tracker)?;
        if saved(&offered, &setting, &tracker)? != bytes {
            return Err(Error::data(format!("saving twice in frame {t} gave different bytes")));
        }
        others.push(state::load(&offered, params, &setting, &bytes)?);
        refuses(&offered, params, &setting, &bytes)?;
    }
    Ok(())
}

/// Pushes a frame, and seeds and retires some points in the midst.
fn step<T: Tracker>(tracker: &mut T, t: usize) -> Result<Vec<Point>> {
    let mut out = Points::default();
    out.restart(t as i64);
    tracker.push(&Picture::moving(SIZE[0], SIZE[1], t).frame(t), &mut out, &cx())?;
    match t {
        2 => tracker.seed(&[Seed { id: 12, x: 30.0, y: 20.0 }, Seed { id: 777, x: 90.0, y: 9.0 }], &cx())?,
        3 => tracker.retire(&[12, 3, 999]),
        _ => {}
    }
    Ok(out.rows().to_vec())
}

fn saved<T: Tracker>(offered: &State<T>, setting: &state::Setting, tracker: &T) -> Result<Vec<u8>> {
    let own = (offered.save)(tracker)?;
    Ok([state::tracker_head(offered, setting, &own).as_slice(), &own].concat())
}

/// Cut and strange bytes: a refusal, and never worse. What the SDK would not let through, `load` must bear all the same.
fn refuses<T: Tracker>(
    offered: &State<T>,
    params: &T::Params,
    setting: &state::Setting,
    bytes: &[u8],
) -> Result<()> {
    let n_own = bytes.len() - (offered.save)(&state::load(offered, params, setting, bytes)?)?.len();
    for n in [0, 1, n_own, bytes.len() / 2, bytes.len() - 1] {
        match state::load(offered, params, setting, &bytes[..n]) {
            Err(error) if error.code() == code::DATA => {}
            Err(error) => return Err(Error::data(format!("{n} bytes of what it saved: {error}"))),
            Ok(_) => return Err(Error::data(format!("{n} bytes of what it saved are loaded"))),
        }
        let noise: Vec<u8> = (0..n as u64).map(|k| (state::mix(k, &[7]) >> 56) as u8).collect();
        for strange in [&bytes[n_own.min(n)..n], noise.as_slice()] {
            drop((offered.load)(params, &setting.stream, strange));
        }
    }
    Ok(())
}
