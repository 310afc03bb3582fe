//! The door: null pointers, calls out of order, and the poison after a panic.

use super::*;
use crate::Cx;
use crate::tracker::{Frame, Points, Seed, Stream, Tracker};
use honami_abi::{Instance, StreamInfo, TrackerV1, interface};
use std::ptr::{null, null_mut};

/// Panics when it is seeded.
struct Bomb;

impl Tracker for Bomb {
    type Params = ();
    const INFO: Info = Info { id: "org.example.bomb", name: "Bomb", ..Info::NEW };
    fn begin((): &(), _: &Stream, _: &Cx<'_>) -> Result<Self> {
        Ok(Self)
    }
    fn seed(&mut self, _: &[Seed], _: &Cx<'_>) -> Result<()> {
        panic!("boom")
    }
    fn retire(&mut self, _: &[u32]) {}
    fn push(&mut self, _: &Frame<'_>, _: &mut Points, _: &Cx<'_>) -> Result<()> {
        Ok(())
    }
}

/// A host of an earlier day: it has none of the functions.
const BARE: Call = Call {
    struct_size: size_of::<Call>() as u32,
    reserved: 0,
    host: null_mut(),
    progress: None,
    log: None,
    fail: None,
    reserve: None,
    commit: None,
    host_ext: None,
};

/// Makes a bomb and passes it with its functions.
fn with_bomb(f: impl FnOnce(*mut Instance, &TrackerV1)) {
    let bomb = (tracker::<Bomb>().create)();
    // SAFETY: just made; the table is a constant.
    unsafe {
        let table = ((*bomb).get_interface.unwrap())(bomb, interface::TRACKER.as_ptr());
        f(bomb, &*table.cast::<TrackerV1>());
        ((*bomb).destroy.unwrap())(bomb);
    }
}

fn gray(width: u32) -> StreamInfo {
    StreamInfo {
        struct_size: size_of::<StreamInfo>() as u32,
        pixel: honami_abi::GRAY8,
        width,
        height: 1,
        fps: 0.0,
        nframes: -1,
        direction: 1,
        max_threads: 1,
        seed: 0,
        birth_first: 0,
        birth_count: 0,
    }
}

fn no_points() -> honami_abi::Table {
    let column = |name: &'static CStr, dtype| honami_abi::Column {
        name: name.as_ptr(),
        dtype,
        ncomp: 1,
        data: null_mut(),
        rows: 0,
    };
    let (id, float) = (honami_abi::dtype::U32, honami_abi::dtype::F32);
    let cols = Box::leak(Box::new([column(c"id", id), column(c"x", float), column(c"y", float)]));
    let struct_size = size_of::<honami_abi::Table>() as u32;
    honami_abi::Table { struct_size, ncols: 3, schema: null(), cols: cols.as_ptr(), rows: 0 }
}

#[test]
fn null_pointers_and_calls_out_of_order_are_refused() {
    with_bomb(|bomb, table| {
        // SAFETY: null is what the door is tested with; everything else is alive.
        unsafe {
            assert_eq!((table.begin.unwrap())(null_mut(), &BARE, &gray(1)), code::ARGUMENT);
            assert_eq!((table.begin.unwrap())(bomb, null(), &gray(1)), code::ARGUMENT);
            assert_eq!((table.begin.unwrap())(bomb, &BARE, null()), code::ARGUMENT);
            assert_eq!((table.seed.unwrap())(bomb, &BARE, &no_points()), code::STATE);
            assert_eq!((table.end.unwrap())(bomb, &BARE), code::STATE);
            assert_eq!(
                (table.begin.unwrap())(bomb, &BARE, &StreamInfo { pixel: 99, ..gray(1) }),
                code::UNSUPPORTED
            );
            assert_eq!((table.begin.unwrap())(bomb, &BARE, &gray(1)), code::OK);
            assert_eq!((table.begin.unwrap())(bomb, &BARE, &gray(1)), code::STATE);
            assert_eq!(((*bomb).set_params.unwrap())(bomb, &BARE, null(), 0), code::STATE);
            assert_eq!((table.push.unwrap())(bomb, &BARE, null()), code::ARGUMENT);
            assert_eq!((table.retire.unwrap())(bomb, &BARE, null(), 1), code::ARGUMENT);
            assert!(((*bomb).get_interface.unwrap())(bomb, null()).is_null());
            assert!(((*bomb).get_interface.unwrap())(bomb, c"honami.tracker/10".as_ptr()).is_null());
        }
    });
}

#[test]
fn a_panic_poisons_the_instance() {
    with_bomb(|bomb, table| {
        // SAFETY: everything is alive.
        unsafe {
            assert_eq!((table.begin.unwrap())(bomb, &BARE, &gray(1)), code::OK);
            assert_eq!((table.seed.unwrap())(bomb, &BARE, &no_points()), code::INTERNAL);
            assert_eq!((table.end.unwrap())(bomb, &BARE), code::STATE);
            assert_eq!((table.begin.unwrap())(bomb, &BARE, &gray(1)), code::STATE);
        }
    });
}

#[test]
fn only_what_the_host_knew_is_read() {
    with_bomb(|bomb, table| {
        // SAFETY: everything is alive; the last call is of a host that knew neither reserve nor what follows.
        unsafe {
            let short = StreamInfo { struct_size: 52, ..gray(1) };
            assert_eq!((table.begin.unwrap())(bomb, &BARE, &short), code::ARGUMENT);
            let none = Call { struct_size: 8, ..BARE };
            assert_eq!((table.begin.unwrap())(bomb, &none, &gray(1)), code::ARGUMENT);
            let size = std::mem::offset_of!(Call, reserve);
            let mut start = vec![0_u64; size / 8];
            let words = start.as_mut_ptr();
            words.cast::<u32>().write(size as u32);
            assert_eq!((table.begin.unwrap())(bomb, words.cast(), &gray(1)), code::OK);
        }
    });
}

/// Two threads panic before either is asked what it said; a third passes on the panic of another.
#[test]
fn a_panic_is_reported_where_it_is_caught() {
    let both = std::sync::Barrier::new(2);
    let caught = |said: &'static str| {
        panics::keep(format!("panicked at a place: {said}"));
        both.wait();
        panics::report(&said)
    };
    std::thread::scope(|scope| {
        let threads = ["one", "two"].map(|said| {
            let caught = &caught;
            scope.spawn(move || caught(said))
        });
        let told = threads.map(|thread| thread.join().unwrap());
        assert_eq!(told, ["panicked at a place: one", "panicked at a place: two"]);
    });
    assert_eq!(panics::report(&"three"), "three");
    std::thread::scope(|scope| {
        scope.spawn(|| panics::keep("panicked at a place: four".into())).join().unwrap()
    });
    assert_eq!(panics::report(&"four".to_owned()), "panicked at a place: four");
}

/// Says in its failure what colour a frame came with.
struct Painter;

impl Tracker for Painter {
    type Params = ();
    const INFO: Info = Info { id: "org.example.painter", name: "Painter", ..Info::NEW };
    fn begin((): &(), _: &Stream, _: &Cx<'_>) -> Result<Self> {
        Ok(Self)
    }
    fn seed(&mut self, _: &[Seed], _: &Cx<'_>) -> Result<()> {
        Ok(())
    }
    fn retire(&mut self, _: &[u32]) {}
    fn push(&mut self, frame: &Frame<'_>, _: &mut Points, _: &Cx<'_>) -> Result<()> {
        let corner = frame.chroma_at(frame.gray.width - 1, frame.gray.height - 1);
        Err(Error::data(format!("{corner:?} {:?}", frame.range)))
    }
}

/// Pushes one frame to a painter; what it says.
fn painted(frame: &honami_abi::Frame) -> (Code, String) {
    thread_local! { static SAID: std::cell::RefCell<String> = const { std::cell::RefCell::new(String::new()) }; }
    unsafe extern "C" fn hear(_: *const Call, code: Code, text: *const c_char) -> Code {
        // SAFETY: the plugin gives a string.
        SAID.set(unsafe { CStr::from_ptr(text) }.to_str().unwrap().to_owned());
        code
    }
    let call = Call { fail: Some(hear), ..BARE };
    let painter = (tracker::<Painter>().create)();
    // SAFETY: just made; the table is a constant; the frame and what it points to are alive.
    unsafe {
        let table = ((*painter).get_interface.unwrap())(painter, interface::TRACKER.as_ptr());
        let table = &*table.cast::<TrackerV1>();
        assert_eq!((table.begin.unwrap())(painter, &call, &gray(frame.width)), code::OK);
        let code = (table.push.unwrap())(painter, &call, frame);
        ((*painter).destroy.unwrap())(painter);
        (code, SAID.take())
    }
}

#[test]
fn a_host_that_knew_no_colour_gives_none_whatever_lies_behind_its_frame() {
    let (luma, plane) = ([7_u8; 5], [10_u8, 20, 30]);
    let frame = honami_abi::Frame {
        struct_size: size_of::<honami_abi::Frame>() as u32,
        pixel: honami_abi::GRAY8,
        width: 5,
        height: 1,
        stride: 5,
        data: luma.as_ptr(),
        index: 0,
        time_s: 0.0,
        cb: plane.as_ptr(),
        cr: plane.as_ptr(),
        chroma_stride: 3,
        range: 2,
        reserved: 0,
        chroma_width: 3,
        chroma_height: 1,
    };
    assert_eq!(painted(&frame), (code::DATA, "Some([30, 30]) Some(Full)".into()));
    let none = honami_abi::Frame { cb: null(), cr: null(), range: 9, ..frame };
    assert_eq!(painted(&none), (code::DATA, "None None".into()));

    // What a host of 1.0 does not know is not its own: addresses that nobody may read.
    let nowhere = std::ptr::without_provenance(1);
    let known = std::mem::offset_of!(honami_abi::Frame, cb) as u32;
    for struct_size in known..size_of::<honami_abi::Frame>() as u32 {
        let old = honami_abi::Frame { struct_size, cb: nowhere, cr: nowhere, ..frame };
        assert_eq!(painted(&old), (code::DATA, "None None".into()), "a frame of {struct_size} bytes");
    }
    for torn in [
        honami_abi::Frame { cr: null(), ..frame },
        honami_abi::Frame { chroma_stride: 2, ..frame },
        honami_abi::Frame { chroma_width: 0, ..frame },
    ] {
        assert_eq!(painted(&torn).0, code::ARGUMENT);
    }
}
