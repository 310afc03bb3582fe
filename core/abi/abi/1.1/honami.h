/* honami.h - the contract between honami and its plugins, ABI 1.1.
 *
 * A plugin is a shared library that exports ONE function, honami_library_v1, and carries its manifest (JSON: names,
 * kinds, parameters) as an ELF note, so that it can be listed and its form drawn without running any of its code.
 * examples/null_tracker.c is a complete plugin. Everything here is plain C99, valid C++11, and needs no library.
 *
 * GROWTH. Within major 1 this file only grows. Structs begin with struct_size, the size that their maker knew; new
 * fields come at the end and are read behind HONAMI_HAS. Structs without struct_size (honami_column, honami_value)
 * are array elements and fixed. New abilities are new interface ids; new columns and manifest keys need no new ABI:
 * a reader ignores those it does not know. Fields called reserved are 0.
 *
 * TAGS. Every function says when it may be called:
 *   [any]           any thread, at any time while the call that it belongs to has not returned
 *   [call]          only the thread that the host called on, before it returns
 *   [control]       the host calls it from any thread, but never two at once for one instance
 *   [.. & idle]     only before begin, or after end or a cancelled call
 *   [.. & run]      only between begin and end, or after prepare
 *   [library]       any thread, one at a time for a library
 * Two instances of one library work at once only if the manifest says "parallel_instances": true.
 *
 * OWNERSHIP. What the host passes in is the host's, read-only, and gone when the call returns: copy what you keep.
 * What a plugin returns by pointer (library, instance, interface) is the plugin's; a library and its interfaces live
 * for ever (the host never unloads), an instance until its destroy. Results are written into memory of the host's
 * (reserve, fill, commit). Nothing is ever freed across the border. Strings are UTF-8 and end with NUL.
 *
 * ERRORS. A negative code means that the call did nothing that counts; say why with call->fail. After a negative code
 * an instance has failed and only destroy is legal, with three exceptions: a refused set_params keeps the former values,
 * a refused save or load leaves the stream as it was, and HONAMI_E_CANCELLED leaves the instance idle. A lost point is no
 * error: it is a row with status lost.
 * No exception and no panic may cross the border.
 *
 * MANNERS. At most max_threads threads work at a time; they have stopped before the call returns. Leave alone: file
 * descriptors 0-2, signals, locale, environment, working directory, floating-point mode. No fork, no exit.
 * The same input, parameters and seed give the same bits, with one thread and with many, unless the manifest says
 * "deterministic": false.
 */
#ifndef HONAMI_H
#define HONAMI_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define HONAMI_ABI_MAJOR 1
#define HONAMI_ABI_MINOR 1

/* Size of struct T up to and including field f: what a maker who knew f, but nothing after it, writes to struct_size. */
#define HONAMI_SIZE_TO(T, f) ((uint32_t)(offsetof(T, f) + sizeof(((T *)0)->f)))
/* Whether the struct at p has field f. */
#define HONAMI_HAS(p, T, f) ((p) != NULL && (p)->struct_size >= HONAMI_SIZE_TO(T, f))

#if defined(__GNUC__)
#define HONAMI_EXPORT __attribute__((visibility("default")))
#else
#define HONAMI_EXPORT
#endif

#if defined(__GNUC__) && defined(__ELF__)
/* Puts the manifest, a string literal, into the library's note (owner "honami", type 1, the text with its NUL) and names
 * it honami_note; use once, at file scope. */
#define HONAMI_MANIFEST(json)                                                                                        \
  static const struct {                                                                                              \
    uint32_t name_len, text_len, type;                                                                               \
    char name[8], text[sizeof(json)];                                                                                \
  } honami_note __attribute__((used, aligned(4), section(".note.honami"))) = {7, sizeof(json), 1, "honami", json}
#endif

/* ---------------------------------------------------------------------------------------------------- codes --- */

/* What a call returns. An unknown negative code is read as HONAMI_E_FAILED, an unknown positive one as HONAMI_OK. */
typedef int32_t honami_code;
#define HONAMI_OK 0
#define HONAMI_AGAIN 2           /* accepted; the result of this frame comes later (trackers with latency) */
#define HONAMI_E_FAILED (-1)       /* it did not work; the text says why */
#define HONAMI_E_UNSUPPORTED (-2)  /* not offered by this plugin, or not for this input */
#define HONAMI_E_ARGUMENT (-3)     /* the caller broke this contract */
#define HONAMI_E_STATE (-4)        /* not legal now, or poisoned by an earlier panic */
#define HONAMI_E_DATA (-5)         /* the input cannot be worked on: too few points, nothing moves, ... */
#define HONAMI_E_MEMORY (-6)       /* no memory, or reserve was refused */
#define HONAMI_E_IO (-7)           /* a file of the plugin's own could not be used */
#define HONAMI_E_CANCELLED (-8)    /* progress said stop */
#define HONAMI_E_INTERNAL (-10)    /* a fault of the plugin's own: a caught panic or exception */

/* Severity of a log line. */
#define HONAMI_LOG_DEBUG 0
#define HONAMI_LOG_INFO 1
#define HONAMI_LOG_WARNING 2
#define HONAMI_LOG_ERROR 3

/* --------------------------------------------------------------------------------------------------- tables --- */

/* Element types of columns, little-endian. */
#define HONAMI_U8 1
#define HONAMI_I32 2
#define HONAMI_U32 3
#define HONAMI_I64 4
#define HONAMI_U64 5
#define HONAMI_F32 6
#define HONAMI_F64 7

/* A named, typed, contiguous column: rows * ncomp elements, row-major, aligned to its element type (reserved ones to 64
 * bytes). Fixed for major 1. */
typedef struct honami_column {
  const char *name;
  uint32_t dtype;  /* HONAMI_U8 ... */
  uint32_t ncomp;  /* elements a row, at least 1 */
  void *data;      /* read-only in tables that the host passes in */
  uint64_t rows;   /* the table's rows, unless the schema says otherwise */
} honami_column;

/* Columns that belong together. */
typedef struct honami_table {
  uint32_t struct_size;
  uint32_t ncols;
  const char *schema;  /* HONAMI_POINTS ... */
  const honami_column *cols;
  uint64_t rows;
} honami_table;

/* Schemas: the columns that must be there; more may be. Numbers are finite in both directions: no NaN, no infinity.
 * Image coordinates: x right, y down, pixels; (0,0) is the CENTRE of the top-left pixel. */

/* id u32, x f32, y f32, status u8. Optional: fb f32, ncc f32, frame i64. An id occurs once a frame.
 *   fb   forward-backward error of the step that led here, pixels; HONAMI_FB_NONE where it was not measured
 *   ncc  normalised cross-correlation with the template, -1..1; HONAMI_NCC_NONE where it was not measured
 * A quality that a tracker never measures is left out as a whole column.
 *   frame  index of the frame that the row belongs to; only from trackers with latency, see honami_tracker_v1 */
#define HONAMI_POINTS "honami.points/1"
/* x f32, y f32, score f32; best first, at most as many rows as were asked for. */
#define HONAMI_FEATURES "honami.features/1"
/* u f32, v f32: displacement in pixels at each node of a grid, (ny, nx) row-major; nx * ny rows. Optional: known u8, 0
 * where nothing could be measured, u and v are 0 there; without it all nodes are known. */
#define HONAMI_VECTORS "honami.vectors/1"
/* gx f32, gy f32, step f32, nx u32, ny u32; one row: node (i,j) of the grid lies at (gx + i*step, gy + j*step). */
#define HONAMI_GRID "honami.grid/1"
/* A row a track: id u32, frame0 i64, len u32, offset u64. Samples of all tracks one after the other, in columns with
 * rows of their own: x f32, y f32, status u8; optional fb f32, ncc f32. Track k has the samples offset[k] ..
 * offset[k] + len[k] - 1, one a frame from frame0[k] on; where it was not seen, its status says so. */
#define HONAMI_TRACKS "honami.tracks/1"
/* frame i64, time_s f64: a row a frame, ascending without gaps, from the first to the last frame of the tracks. */
#define HONAMI_TIMES "honami.times/1"
/* a u32, b u32, height f64, size u32; n-1 rows over n leaves (0 rows for n < 2). Leaf k is row k of the tracks, merge
 * r makes cluster n+r of `size` leaves: SciPy's linkage matrix. A flat grouping is a tree with two heights, 0 and 1. */
#define HONAMI_DENDROGRAM "honami.dendrogram/1"
/* frame i64, outlier u8 (0 or 1), distance f64 (how far the frame lies from the others, at least 0). */
#define HONAMI_FRAMES "honami.frames/1"
/* Of plants: metres, z up, right-handed; angles in radians. Since 1.1.
 * parent i32, x f32, y f32, z f32, radius f32; a row a node. Optional: track i32 (row of the tracks it was grown from,
 * or -1). The parent's row comes before its own (-1: the root, row 0 and no other), so cycles cannot be written. */
#define HONAMI_SKELETON "honami.skeleton/1"
/* The tree that a hierarchy of tracks was cut into, since 1.1. parent i32; a row a group, each after the one that it is
 * part of (-1: the whole, row 0 and no other). In a column with rows of its own, a row a track: group i32, the group that
 * it is in, which has no parts, or -1 for none. A group without parts has one track at least. */
#define HONAMI_GROUPS "honami.groups/1"
/* Of skeletons that move as filmed, since 1.1: pixels; x right, y away from the camera, z up, right-handed, so that a
 * place is seen in the picture at (x, -z). Six tables say one: joints, root, pose, bears; and leaves and offsets.
 * parent i32, length f64 (of the bone that ends there, above 0; 0 of the root); a row a joint, at least 2. The parent's
 * row comes before its own (-1: the root, row 0 and no other), so cycles cannot be written. */
#define HONAMI_JOINTS "honami.joints/1"
/* x f64, y f64, z f64; one row: where the root stands, in all frames. */
#define HONAMI_ROOT "honami.root/1"
/* d f64 x 3: the way a bone points, of length 1 (to 1e-6); joint after joint in frame after frame, as in the times. What
 * stands for the root, which has no bone, says nothing. */
#define HONAMI_POSE "honami.pose/1"
/* joint u32, group u32: a row a group that a joint has become, each pair once; of groups with parts it need not be said.
 * A group may have no joint, or several that are copies, of which the first is the one in the picture. */
#define HONAMI_BEARS "honami.bears/1"
/* joint u32, track u32 (row of the tracks); a row a leaf, a track that a joint carries. */
#define HONAMI_LEAVES "honami.leaves/1"
/* d f64 x 3: from the joint of a leaf to it, pixels; frame after frame of leaf after leaf. */
#define HONAMI_OFFSETS "honami.offsets/1"
/* yaw f32 (turned about z, from x towards y), scale f32 (of all lengths, above 0: a plant of the same shape and
 * material), mass f32 (times that of the plant, above 0); a row a copy. */
#define HONAMI_INSTANCES "honami.instances/1"
/* time_s f64, ascending from the last reset on. In a column with rows of its own: wind f32 x 3, m/s in the world, a row a
 * time for all copies alike, or (time, copy) row-major. Between two times straight, before the first and after the last
 * as there. */
#define HONAMI_WIND "honami.wind/1"
/* nodes u32, modes u32; a row a copy: how much of it is wanted, see honami_simulator_v1.step. */
#define HONAMI_DETAIL "honami.detail/1"
/* d f32 x 3: how far a node is from where it rests, in the axes and the size of the plant, whatever its copy's yaw and
 * scale: who shows a copy turns and scales it; a row a node, copy after copy. What is reserved for it is NOT zeroed: it
 * holds what the last step left. */
#define HONAMI_MOTION "honami.motion/1"
/* hz f64 (above 0, rising), residual f64 (|K x - w2 M x| over |K x|); a row a mode. Optional: certified u8, 1 where it was
 * proved that there is no other mode below. */
#define HONAMI_MODES "honami.modes/1"

/* Status of a point in a frame. */
#define HONAMI_LOST 0      /* the tracker has lost it; the position is its last guess */
#define HONAMI_TRACKED 1   /* seen and followed */
#define HONAMI_OCCLUDED 2  /* hidden; the position is predicted */
#define HONAMI_OUTSIDE 3   /* has left the picture */
#define HONAMI_REJECTED 4  /* judged wrong */
#define HONAMI_NEWBORN 5   /* born in this frame by the tracker itself */

#define HONAMI_FB_NONE (-1.0f)
#define HONAMI_NCC_NONE (-2.0f)

/* --------------------------------------------------------------------------------------------------- values --- */

/* Kinds of parameter values, with the member that holds them. */
#define HONAMI_BOOL 1   /* i, 0 or 1 */
#define HONAMI_INT 2    /* i */
#define HONAMI_FLOAT 3  /* f[0] */
#define HONAMI_TEXT 4   /* text: an enum entry's id, a string or a path */
#define HONAMI_VEC2 5   /* f[0], f[1]: x, y */
#define HONAMI_RECT 6   /* f[0] .. f[3]: x, y, width, height */
#define HONAMI_SEED 7   /* i, the bits of a uint64_t */

/* One parameter. Fixed for major 1. */
typedef struct honami_value {
  const char *id;  /* as in the manifest */
  uint32_t kind;   /* HONAMI_BOOL ... */
  uint32_t reserved;
  int64_t i;
  double f[4];
  const char *text;
} honami_value;

/* --------------------------------------------------------------------------------------------- one call's host --- */

/* What the host offers during ONE call; dead, and refused, when the call returns. */
typedef struct honami_call honami_call;
struct honami_call {
  uint32_t struct_size;
  uint32_t reserved;
  void *host;  /* the host's own */

  /* Says how far the work is (0..1, or negative if unknown) and asks whether to go on: non-zero means stop, clean up
   * and return HONAMI_E_CANCELLED. Call it at least every 250 ms of work. text may be NULL.  [any] */
  int32_t (*progress)(const honami_call *call, double fraction, const char *text);

  /* Writes a line to the plugin's log.  [any] */
  void (*log)(const honami_call *call, int32_t level, const char *text);

  /* Gives the reason of a failure and returns `code`, for `return call->fail(call, HONAMI_E_DATA, "...")`.  [call] */
  honami_code (*fail)(const honami_call *call, honami_code code, const char *text);

  /* Asks for memory for a result: `ncols` columns of `rows` rows. The plugin sets name, dtype and ncomp of each; the
   * host sets data (zeroed, the host's, writable until the call returns) and rows. Asking again for a schema drops
   * what was reserved for it. HONAMI_OK, HONAMI_E_MEMORY, or HONAMI_E_ARGUMENT for columns the schema forbids. [call] */
  honami_code (*reserve)(const honami_call *call, const char *schema, uint64_t rows, uint32_t ncols,
                         honami_column *cols);

  /* Hands over the first `rows` rows of what was reserved for the schema; once a schema and call.  [call] */
  honami_code (*commit)(const honami_call *call, const char *schema, uint64_t rows);

  /* A further service of the host by id, or NULL. NULL is always possible and no error.  [any] */
  const void *(*host_ext)(const honami_call *call, const char *id);
};

/* -------------------------------------------------------------------------------------------- library, instance --- */

/* Who is asking. */
typedef struct honami_host_info {
  uint32_t struct_size;
  uint32_t abi_minor;   /* the newest minor of major 1 that the host knows */
  const char *name;     /* "honami" */
  const char *version;  /* for the log only: decide by struct_size and interface ids */
} honami_host_info;

/* One plugin at work, with parameters and state of its own. */
typedef struct honami_instance honami_instance;
struct honami_instance {
  uint32_t struct_size;
  uint32_t reserved;
  void *self;  /* the plugin's own */

  /* Frees the instance; legal in every state, and nothing of it may run afterwards.  [control] */
  void (*destroy)(honami_instance *instance);

  /* Sets every parameter at once: those not listed take their defaults, unknown ids are ignored. A simulator takes those
   * that affect "step" in mid-motion; where others change it forgets its plant.  [control & idle; simulators: control] */
  honami_code (*set_params)(honami_instance *instance, const honami_call *call, const honami_value *values,
                            uint32_t n);

  /* The interface with this id, or NULL if the plugin has none; the same pointer every time.  [control] */
  const void *(*get_interface)(honami_instance *instance, const char *id);
};

/* A library of plugins. */
typedef struct honami_library {
  uint32_t struct_size;
  uint32_t abi_minor;    /* the minor it was built for */
  const char *manifest;  /* the same text as in the note */
  uint64_t manifest_len; /* without the NUL */

  /* Makes an instance of the plugin with this id, with default parameters; NULL, and a reason by call->fail, if there
   * is none or it cannot work here.  [library] */
  honami_instance *(*create)(const honami_host_info *host, const honami_call *call, const char *plugin_id);
} honami_library;

/* The one exported symbol. May be called more than once and returns the same pointer; NULL refuses the host.
 * Does nothing that takes time.  [library] */
HONAMI_EXPORT const honami_library *honami_library_v1(const honami_host_info *host);
typedef const honami_library *(*honami_library_v1_fn)(const honami_host_info *host);
#define HONAMI_LIBRARY_SYMBOL "honami_library_v1"

/* -------------------------------------------------------------------------------------------------- trackers --- */

#define HONAMI_GRAY8 1  /* a byte a pixel: luma as coded */

#define HONAMI_RANGE_LIMITED 1  /* 16 is black and 235 white, chroma reaches from 16 to 240 */
#define HONAMI_RANGE_FULL 2     /* 0 is black and 255 white, chroma reaches over the whole byte */

/* A picture. Row y begins at data + y * stride. Not to be kept after the call. */
typedef struct honami_frame {
  uint32_t struct_size;
  uint32_t pixel;  /* HONAMI_GRAY8 */
  uint32_t width;
  uint32_t height;
  int64_t stride;  /* bytes from a row to the next, at least a row of pixels */
  const uint8_t *data;
  int64_t index;   /* frame number in the clip, from 0 */
  double time_s;   /* presentation time, seconds */

  /* From here on since 1.1: HONAMI_HAS(frame, honami_frame, chroma_height).
   * Blue and red difference as coded, a byte a sample, 128 is none; both NULL where the clip has no colour. Row j begins
   * at cb + j * chroma_stride; pixel (x, y) has the sample (x * chroma_width / width, y * chroma_height / height), both
   * rounded down. */
  const uint8_t *cb;
  const uint8_t *cr;
  int64_t chroma_stride;  /* bytes from a row to the next of either plane, at least a row of samples */
  uint32_t range;         /* what the bytes mean: HONAMI_RANGE_LIMITED ..., or 0 where that is not known */
  uint32_t reserved;
  uint32_t chroma_width;  /* samples, at most the frame's pixels; today half of them, rounded up (4:2:0) */
  uint32_t chroma_height;
} honami_frame;

/* What is known of a stream before its first frame. Frames may be left out, but their order is the direction's. */
typedef struct honami_stream_info {
  uint32_t struct_size;
  uint32_t pixel;  /* of every frame, HONAMI_GRAY8 */
  uint32_t width;
  uint32_t height;
  double fps;         /* nominal rate, 0 if unknown; exact times are in the frames */
  int64_t nframes;    /* frames to come, -1 if unknown */
  int32_t direction;  /* 1: index and time rise; -1: a reversed stream, both fall */
  uint32_t max_threads;
  uint64_t seed;          /* of every random choice */
  uint32_t birth_first;   /* ids that the tracker may give to points of its own: */
  uint32_t birth_count;   /* birth_first .. birth_first + birth_count - 1; 0: no births */
} honami_stream_info;

/* Follows points through a stream; every plugin of kind "tracker" has it.
 *
 *   begin, push(frame 0), seed, push(frame 1), push, seed, retire, push, ... end
 *
 * Seeded points hold in the frame pushed LAST; seeded before the first push, in the first frame, where they are then
 * reported as seeded. An id is live from its seed or birth until it is retired, or until a push has no row for it: that
 * is how a tracker ends a point for good. Lost, occluded and outside points are still live.
 * Seeding a live id moves it there (a correction), seeding an ended one brings it back. */
#define HONAMI_TRACKER "honami.tracker/1"
#define HONAMI_LATENCY_ALL 0xffffffffu
typedef struct honami_tracker_v1 {
  uint32_t struct_size;
  /* By how many frames results lag behind. 0: each push commits its frame's points and returns HONAMI_OK.
   * n: a push may return HONAMI_AGAIN and commit nothing; rows carry column frame; all rows of a frame come in one
   * table, frames in the order of the stream, each at most n frames late. HONAMI_LATENCY_ALL: all come in end. */
  uint32_t latency;

  /* Starts a stream with no points.  [control & idle] */
  honami_code (*begin)(honami_instance *instance, const honami_call *call, const honami_stream_info *stream);

  /* Adds or moves points: honami.points/1 with id, x, y.  [control & run] */
  honami_code (*seed)(honami_instance *instance, const honami_call *call, const honami_table *points);

  /* Forgets points; ids that are not live are ignored.  [control & run] */
  honami_code (*retire)(honami_instance *instance, const honami_call *call, const uint32_t *ids, uint64_t n);

  /* Follows all live points into this frame; commits honami.points/1, a row a live point, newborn ones included.
   * With no live points it commits 0 rows or nothing.  [control & run] */
  honami_code (*push)(honami_instance *instance, const honami_call *call, const honami_frame *frame);

  /* Ends the stream; commits what is still due under latency.  [control & run, then idle] */
  honami_code (*end)(honami_instance *instance, const honami_call *call);
} honami_tracker_v1;

/* Where to put features. */
typedef struct honami_detect_input {
  uint32_t struct_size;
  uint32_t max_features;  /* at most so many, the best ones */
  const honami_frame *frame;
  const uint8_t *mask;         /* a byte a pixel of the frame, non-zero where features may be; NULL: everywhere */
  int64_t mask_stride;         /* bytes from a row of the mask to the next */
  const honami_table *points;  /* honami.points/1 with id, x, y: keep your distance from these; NULL: none */
  uint32_t max_threads;
  uint32_t reserved;
  uint64_t seed;
} honami_detect_input;

/* Optional for trackers. The host numbers the features that it takes. */
#define HONAMI_DETECT "honami.detect/1"
typedef struct honami_detect_v1 {
  uint32_t struct_size;
  uint32_t reserved;
  /* Commits honami.features/1. Legal before begin and between pushes, and changes nothing that push sees.  [control] */
  honami_code (*detect)(honami_instance *instance, const honami_call *call, const honami_detect_input *input);
} honami_detect_v1;

/* Dense motion between two frames. */
typedef struct honami_field_input {
  uint32_t struct_size;
  uint32_t max_threads;
  const honami_frame *from;
  const honami_frame *to;  /* of the same size, in either order of time */
} honami_field_input;

/* Optional for trackers. */
#define HONAMI_FIELD "honami.field/1"
typedef struct honami_field_v1 {
  uint32_t struct_size;
  uint32_t reserved;
  /* Commits honami.vectors/1 and honami.grid/1: what lies at p in `from` lies at p + (u,v) in `to`. Legal before begin and
   * between pushes, and changes nothing that push sees.  [control] */
  honami_code (*field)(honami_instance *instance, const honami_call *call, const honami_field_input *input);
} honami_field_v1;

/* Optional for trackers and simulators, since 1.1: what is carried from frame to frame, or from step to step, as bytes of
 * the plugin's own. The host keeps them for the case that the plugin's process dies, and to go on with another build. The
 * table that save commits has the same id: bytes u8, a row a byte. */
#define HONAMI_STATE "honami.state/1"
typedef struct honami_state_v1 {
  uint32_t struct_size;
  uint32_t reserved;

  /* Commits honami.state/1 with all that later frames depend on: with it the rest of the stream has the same bits as
   * without. Changes nothing; the same state gives the same bytes.  [control & run] */
  honami_code (*save)(honami_instance *instance, const honami_call *call);

  /* Goes on where save was called: comes directly after begin, with the same parameters and of the same stream, or after
   * prepare, with the same plant and the same parameters but for those that affect "step". Bytes that
   * are not what save gave - cut, damaged, of another version - are refused with HONAMI_E_DATA, whatever is in them.
   * [control & run] */
  honami_code (*load)(honami_instance *instance, const honami_call *call, const uint8_t *bytes, uint64_t n);
} honami_state_v1;

/* ------------------------------------------------------------------------------------------------- clusterers --- */

/* What there is to group. */
typedef struct honami_clusterer_input {
  uint32_t struct_size;
  uint32_t max_threads;
  uint32_t width;   /* of the frames, pixels */
  uint32_t height;
  uint64_t seed;
  const honami_table *tracks;  /* honami.tracks/1 */
  const honami_table *times;   /* honami.times/1 */
} honami_clusterer_input;

/* Groups tracks; every plugin of kind "clusterer" has it. */
#define HONAMI_CLUSTERER "honami.clusterer/1"
typedef struct honami_clusterer_v1 {
  uint32_t struct_size;
  uint32_t reserved;
  /* Commits honami.dendrogram/1, and honami.frames/1 if it judges frames.  [control & idle] */
  honami_code (*run)(honami_instance *instance, const honami_call *call, const honami_clusterer_input *input);
} honami_clusterer_v1;

/* ------------------------------------------------------------------------------------------------- structures --- */

/* What a structure builder may draw on. Its options are its parameters. */
typedef struct honami_structure_input {
  uint32_t struct_size;
  uint32_t max_threads;
  uint32_t width;   /* of the frames, pixels */
  uint32_t height;
  uint64_t seed;
  const honami_table *tracks;  /* honami.tracks/1 */
  const honami_table *times;   /* honami.times/1 */
  const honami_table *groups;  /* honami.groups/1 over the tracks */
  const double *root;          /* x, y: where the plant leaves the ground in the picture; NULL: nobody has said */
  const uint8_t *mask;         /* a byte a pixel of the frames, non-zero where branches may be; NULL: everywhere */
  int64_t mask_stride;         /* bytes from a row of the mask to the next */
} honami_structure_input;

/* Grows the branches behind grouped tracks; every plugin of kind "structure" has it. Since 1.1. */
#define HONAMI_STRUCTURE "honami.structure/1"
typedef struct honami_structure_v1 {
  uint32_t struct_size;
  uint32_t reserved;
  /* Commits honami.joints/1, honami.root/1, honami.pose/1 and honami.bears/1; with leaves, also honami.leaves/1 and
   * honami.offsets/1.  [control & idle] */
  honami_code (*run)(honami_instance *instance, const honami_call *call, const honami_structure_input *input);
} honami_structure_v1;

/* ------------------------------------------------------------------------------------------------- simulators --- */

/* What a simulator moves. */
typedef struct honami_simulator_input {
  uint32_t struct_size;
  uint32_t max_threads;
  uint64_t seed;
  const honami_table *skeleton;   /* honami.skeleton/1, at rest */
  const honami_table *instances;  /* honami.instances/1, at least one; NULL: one copy as it is */
} honami_simulator_input;

/* How far it is to go. */
typedef struct honami_step_input {
  uint32_t struct_size;
  uint32_t n_steps;            /* 0: only where everything is now */
  double dt;                   /* seconds a step, above 0 */
  const honami_table *wind;    /* honami.wind/1; NULL: still air */
  const honami_table *detail;  /* honami.detail/1; NULL: everything of every copy */
} honami_step_input;

/* Moves copies of a plant in the wind; every plugin of kind "simulator" has it. Since 1.1.
 *
 *   prepare, step, step, set_params (what affects "step"), step, reset, step, ... prepare, ...
 */
#define HONAMI_SIMULATOR "honami.simulator/1"
typedef struct honami_simulator_v1 {
  uint32_t struct_size;
  uint32_t reserved;

  /* Takes the plant, every copy at rest at time 0, and forgets an earlier one. May commit honami.modes/1.  [control] */
  honami_code (*prepare)(honami_instance *instance, const honami_call *call, const honami_simulator_input *input);

  /* Back to rest at time 0.  [control & run] */
  honami_code (*reset)(honami_instance *instance, const honami_call *call);

  /* Goes n_steps steps and commits where the last one led as honami.motion/1: the nodes of the first copy, then those of
   * the next. n steps at once give the same bits as n times one. Of a copy with a detail only its first `nodes` nodes
   * are written (parents come before children, so these are a tree; 0: none of it), moved by its first `modes` modes, if
   * the method has such; both are at most what there is. What is not wanted moves on all the same. A dt that the method
   * cannot take is refused with HONAMI_E_DATA and a text that says the largest that it can.  [control & run] */
  honami_code (*step)(honami_instance *instance, const honami_call *call, const honami_step_input *input);
} honami_simulator_v1;

#ifdef __cplusplus
}
#endif
#endif
