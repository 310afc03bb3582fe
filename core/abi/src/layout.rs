//! Where every field of every struct lies: the one table behind the assertions in Rust (here) and in C (the tests).
//!
//! Numbers are those of 64-bit machines. Fields follow each other without padding, so nothing can hide between them.

/// A struct as both languages must lay it out.
#[derive(Clone, Copy, Debug)]
pub struct Struct {
    /// Its name in C.
    pub c_name: &'static str,
    /// Bytes.
    pub size: usize,
    /// Bytes.
    pub align: usize,
    /// In order.
    pub fields: &'static [Field],
}

/// A field of a [`Struct`].
#[derive(Clone, Copy, Debug)]
pub struct Field {
    /// Its name in C.
    pub c_name: &'static str,
    /// Bytes from the start of the struct.
    pub offset: usize,
    /// Bytes.
    pub size: usize,
}

/// Size of the field that a closure picks.
#[doc(hidden)]
#[must_use]
pub const fn size_of_field<T, F>(_: fn(&T) -> &F) -> usize {
    size_of::<F>()
}

macro_rules! c_field {
    (this) => {
        "self"
    };
    ($field:ident) => {
        stringify!($field)
    };
}

macro_rules! layout {
    ($($list:ident { $($rust:path = $c:literal, $size:literal, $align:literal
        { $($field:ident $offset:literal $bytes:literal,)* })* })*) => { $(
        #[doc = concat!("The structs of ", stringify!($list), ".")]
        pub const $list: &[Struct] = &[$(
            Struct { c_name: $c, size: $size, align: $align, fields: &[$(
                Field { c_name: c_field!($field), offset: $offset, size: $bytes },
            )*] },
        )*];
        #[cfg(target_pointer_width = "64")]
        const _: () = { $(
            assert!(size_of::<$rust>() == $size && align_of::<$rust>() == $align, $c);
            let mut end = 0;
            $(
                assert!(core::mem::offset_of!($rust, $field) == $offset, concat!($c, ".", stringify!($field)));
                assert!(size_of_field(|s: &$rust| &s.$field) == $bytes, concat!($c, ".", stringify!($field)));
                assert!(end == $offset, concat!("padding before ", $c, ".", stringify!($field)));
                end = $offset + $bytes;
            )*
            assert!(end == $size, concat!("padding at the end of ", $c));
        )* };
    )* };
}

layout! {
    STABLE {
        crate::Column = "honami_column", 32, 8 { name 0 8, dtype 8 4, ncomp 12 4, data 16 8, rows 24 8, }
        crate::Table = "honami_table", 32, 8 { struct_size 0 4, ncols 4 4, schema 8 8, cols 16 8, rows 24 8, }
        crate::Value = "honami_value", 64, 8 { id 0 8, kind 8 4, reserved 12 4, i 16 8, f 24 32, text 56 8, }
        crate::Call = "honami_call", 64, 8 {
            struct_size 0 4, reserved 4 4, host 8 8, progress 16 8, log 24 8, fail 32 8, reserve 40 8, commit 48 8,
            host_ext 56 8,
        }
        crate::HostInfo = "honami_host_info", 24, 8 { struct_size 0 4, abi_minor 4 4, name 8 8, version 16 8, }
        crate::Instance = "honami_instance", 40, 8 {
            struct_size 0 4, reserved 4 4, this 8 8, destroy 16 8, set_params 24 8, get_interface 32 8,
        }
        crate::Library = "honami_library", 32, 8 {
            struct_size 0 4, abi_minor 4 4, manifest 8 8, manifest_len 16 8, create 24 8,
        }
        crate::Frame = "honami_frame", 88, 8 {
            struct_size 0 4, pixel 4 4, width 8 4, height 12 4, stride 16 8, data 24 8, index 32 8, time_s 40 8,
            cb 48 8, cr 56 8, chroma_stride 64 8, range 72 4, reserved 76 4, chroma_width 80 4, chroma_height 84 4,
        }
        crate::StreamInfo = "honami_stream_info", 56, 8 {
            struct_size 0 4, pixel 4 4, width 8 4, height 12 4, fps 16 8, nframes 24 8, direction 32 4,
            max_threads 36 4, seed 40 8, birth_first 48 4, birth_count 52 4,
        }
        crate::TrackerV1 = "honami_tracker_v1", 48, 8 {
            struct_size 0 4, latency 4 4, begin 8 8, seed 16 8, retire 24 8, push 32 8, end 40 8,
        }
        crate::DetectInput = "honami_detect_input", 56, 8 {
            struct_size 0 4, max_features 4 4, frame 8 8, mask 16 8, mask_stride 24 8, points 32 8, max_threads 40 4,
            reserved 44 4, seed 48 8,
        }
        crate::DetectV1 = "honami_detect_v1", 16, 8 { struct_size 0 4, reserved 4 4, detect 8 8, }
        crate::FieldInput = "honami_field_input", 24, 8 { struct_size 0 4, max_threads 4 4, from 8 8, to 16 8, }
        crate::FieldV1 = "honami_field_v1", 16, 8 { struct_size 0 4, reserved 4 4, field 8 8, }
        crate::StateV1 = "honami_state_v1", 24, 8 { struct_size 0 4, reserved 4 4, save 8 8, load 16 8, }
        crate::ClustererInput = "honami_clusterer_input", 40, 8 {
            struct_size 0 4, max_threads 4 4, width 8 4, height 12 4, seed 16 8, tracks 24 8, times 32 8,
        }
        crate::ClustererV1 = "honami_clusterer_v1", 16, 8 { struct_size 0 4, reserved 4 4, run 8 8, }
        crate::StructureInput = "honami_structure_input", 72, 8 {
            struct_size 0 4, max_threads 4 4, width 8 4, height 12 4, seed 16 8, tracks 24 8, times 32 8, groups 40 8,
            root 48 8, mask 56 8, mask_stride 64 8,
        }
        crate::StructureV1 = "honami_structure_v1", 16, 8 { struct_size 0 4, reserved 4 4, run 8 8, }
        crate::SimulatorInput = "honami_simulator_input", 32, 8 {
            struct_size 0 4, max_threads 4 4, seed 8 8, skeleton 16 8, instances 24 8,
        }
        crate::StepInput = "honami_step_input", 32, 8 { struct_size 0 4, n_steps 4 4, dt 8 8, wind 16 8, detail 24 8, }
        crate::SimulatorV1 = "honami_simulator_v1", 32, 8 {
            struct_size 0 4, reserved 4 4, prepare 8 8, reset 16 8, step 24 8,
        }
    }
}

/// Every whole number of the header beside the mirror's value for it.
pub const NUMBERS: &[(&str, i64)] = &[
    ("HONAMI_ABI_MAJOR", crate::ABI_MAJOR as i64),
    ("HONAMI_ABI_MINOR", crate::ABI_MINOR as i64),
    ("HONAMI_OK", crate::code::OK as i64),
    ("HONAMI_AGAIN", crate::code::AGAIN as i64),
    ("HONAMI_E_FAILED", crate::code::FAILED as i64),
    ("HONAMI_E_UNSUPPORTED", crate::code::UNSUPPORTED as i64),
    ("HONAMI_E_ARGUMENT", crate::code::ARGUMENT as i64),
    ("HONAMI_E_STATE", crate::code::STATE as i64),
    ("HONAMI_E_DATA", crate::code::DATA as i64),
    ("HONAMI_E_MEMORY", crate::code::MEMORY as i64),
    ("HONAMI_E_IO", crate::code::IO as i64),
    ("HONAMI_E_CANCELLED", crate::code::CANCELLED as i64),
    ("HONAMI_E_INTERNAL", crate::code::INTERNAL as i64),
    ("HONAMI_LOG_DEBUG", crate::log::DEBUG as i64),
    ("HONAMI_LOG_INFO", crate::log::INFO as i64),
    ("HONAMI_LOG_WARNING", crate::log::WARNING as i64),
    ("HONAMI_LOG_ERROR", crate::log::ERROR as i64),
    ("HONAMI_U8", crate::dtype::U8 as i64),
    ("HONAMI_I32", crate::dtype::I32 as i64),
    ("HONAMI_U32", crate::dtype::U32 as i64),
    ("HONAMI_I64", crate::dtype::I64 as i64),
    ("HONAMI_U64", crate::dtype::U64 as i64),
    ("HONAMI_F32", crate::dtype::F32 as i64),
    ("HONAMI_F64", crate::dtype::F64 as i64),
    ("HONAMI_LOST", crate::status::LOST as i64),
    ("HONAMI_TRACKED", crate::status::TRACKED as i64),
    ("HONAMI_OCCLUDED", crate::status::OCCLUDED as i64),
    ("HONAMI_OUTSIDE", crate::status::OUTSIDE as i64),
    ("HONAMI_REJECTED", crate::status::REJECTED as i64),
    ("HONAMI_NEWBORN", crate::status::NEWBORN as i64),
    ("HONAMI_BOOL", crate::kind::BOOL as i64),
    ("HONAMI_INT", crate::kind::INT as i64),
    ("HONAMI_FLOAT", crate::kind::FLOAT as i64),
    ("HONAMI_TEXT", crate::kind::TEXT as i64),
    ("HONAMI_VEC2", crate::kind::VEC2 as i64),
    ("HONAMI_RECT", crate::kind::RECT as i64),
    ("HONAMI_SEED", crate::kind::SEED as i64),
    ("HONAMI_GRAY8", crate::GRAY8 as i64),
    ("HONAMI_RANGE_LIMITED", crate::range::LIMITED as i64),
    ("HONAMI_RANGE_FULL", crate::range::FULL as i64),
    ("HONAMI_LATENCY_ALL", crate::LATENCY_ALL as i64),
];

/// Every number of the header that is not whole by type, beside the mirror's value for it.
pub const FLOATS: &[(&str, f32)] =
    &[("HONAMI_FB_NONE", crate::FB_NONE), ("HONAMI_NCC_NONE", crate::NCC_NONE)];

/// Every id of the header beside the mirror's value for it.
pub const IDS: &[(&str, &core::ffi::CStr)] = &[
    ("HONAMI_LIBRARY_SYMBOL", crate::LIBRARY_SYMBOL),
    ("HONAMI_POINTS", crate::schema::POINTS),
    ("HONAMI_FEATURES", crate::schema::FEATURES),
    ("HONAMI_VECTORS", crate::schema::VECTORS),
    ("HONAMI_GRID", crate::schema::GRID),
    ("HONAMI_TRACKS", crate::schema::TRACKS),
    ("HONAMI_TIMES", crate::schema::TIMES),
    ("HONAMI_DENDROGRAM", crate::schema::DENDROGRAM),
    ("HONAMI_FRAMES", crate::schema::FRAMES),
    ("HONAMI_TRACKER", crate::interface::TRACKER),
    ("HONAMI_DETECT", crate::interface::DETECT),
    ("HONAMI_FIELD", crate::interface::FIELD),
    ("HONAMI_STATE", crate::interface::STATE),
    ("HONAMI_CLUSTERER", crate::interface::CLUSTERER),
    ("HONAMI_SKELETON", crate::schema::SKELETON),
    ("HONAMI_INSTANCES", crate::schema::INSTANCES),
    ("HONAMI_WIND", crate::schema::WIND),
    ("HONAMI_DETAIL", crate::schema::DETAIL),
    ("HONAMI_MOTION", crate::schema::MOTION),
    ("HONAMI_MODES", crate::schema::MODES),
    ("HONAMI_SIMULATOR", crate::interface::SIMULATOR),
    ("HONAMI_GROUPS", crate::schema::GROUPS),
    ("HONAMI_JOINTS", crate::schema::JOINTS),
    ("HONAMI_ROOT", crate::schema::ROOT),
    ("HONAMI_POSE", crate::schema::POSE),
    ("HONAMI_BEARS", crate::schema::BEARS),
    ("HONAMI_LEAVES", crate::schema::LEAVES),
    ("HONAMI_OFFSETS", crate::schema::OFFSETS),
    ("HONAMI_STRUCTURE", crate::interface::STRUCTURE),
];
