/* honami_types.hpp - what plugins in C++ are given, and what they hand back; part of honami.hpp. */
#ifndef HONAMI_TYPES_HPP
#define HONAMI_TYPES_HPP

#include "honami_manifest.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

namespace honami {

/* Why it cannot be done, for the user. */
class Error : public std::runtime_error {
public:
  explicit Error(const std::string &why, honami_code code = HONAMI_E_DATA) : std::runtime_error(why), code(code) {}
  honami_code code;
};

/* The user wants to stop. No std::exception, so that nobody catches it unawares. */
struct Cancelled {};

/* The host, during one call. */
class Call {
public:
  explicit Call(const honami_call *call) : call(call) {}
  /* Says how far the work is, 0 to 1; at least every 250 ms of work. Throws Cancelled. */
  void progress(double fraction, const char *text = nullptr) const {
    if (call->progress && call->progress(call, fraction, text)) throw Cancelled();
  }
  /* Writes a line to the plugin's log. */
  void log(const std::string &text, int32_t level = HONAMI_LOG_INFO) const {
    if (call->log) call->log(call, level, text.c_str());
  }

private:
  const honami_call *call;
};

/* Values of the parameters, by id. */
class Values {
public:
  template <std::size_t N> explicit Values(const Param (&declared)[N]) : declared(declared), n(N), values(N) {
    reset();
  }
  Values() = default;

  int integer(const char *id) const { return int(at(id, HONAMI_INT).number); }
  double number(const char *id) const { return at(id, HONAMI_FLOAT).number; }
  bool flag(const char *id) const { return at(id, HONAMI_BOOL).number != 0; }
  /* The id of an entry, or the path of a file. */
  const std::string &text(const char *id) const { return at(id, HONAMI_TEXT).text; }

  /* Sets all of them: those that are not listed take their defaults, unknown ones are ignored. */
  void set(const honami_value *given, uint32_t n_given) {
    reset();
    for (uint32_t i = 0; i < n_given; i++)
      for (std::size_t k = 0; k < n; k++)
        if (std::strcmp(declared[k].id, given[i].id) == 0) values[k] = of(declared[k], given[i]);
  }

  /* Adds what was chosen to a sum. */
  template <class Sum> void add_to(Sum &sum) const {
    for (const Value &value : values) sum.number(value.number), sum.text(value.text);
  }

private:
  struct Value {
    double number = 0;
    std::string text;
  };
  static Value of(const Param &param, const honami_value &given) {
    if (given.kind != param.kind)
      throw Error(std::string("parameter ") + param.id + " is of another kind", HONAMI_E_ARGUMENT);
    if (given.kind == HONAMI_TEXT) return {0, given.text ? given.text : ""};
    return {given.kind == HONAMI_FLOAT ? given.f[0] : double(given.i), ""};
  }
  void reset() {
    for (std::size_t k = 0; k < n; k++)
      values[k] = {declared[k].standard, declared[k].entries ? declared[k].entries->id : ""};
  }
  const Value &at(const char *id, uint32_t kind) const {
    for (std::size_t k = 0; k < n; k++)
      if (std::strcmp(declared[k].id, id) == 0 && declared[k].kind == kind) return values[k];
    throw std::logic_error(std::string("no parameter ") + id + " of that kind is declared");
  }
  const Param *declared = nullptr;
  std::size_t n = 0;
  std::vector<Value> values;
};

/* What is known of a stream before its first frame; see honami_stream_info. */
using Stream = honami_stream_info;

/* A picture, a byte a pixel; (0, 0) is the centre of the top-left one. */
struct Frame {
  int width, height;
  std::ptrdiff_t stride;
  const uint8_t *data;
  int64_t index;
  double time_s;
  const honami_frame *raw; /* with the colour, behind HONAMI_HAS */

  static Frame of(const honami_frame *raw) {
    return {int(raw->width), int(raw->height), std::ptrdiff_t(raw->stride), raw->data, raw->index, raw->time_s, raw};
  }
  const uint8_t *row(int y) const { return data + y * stride; }
  uint8_t at(int x, int y) const { return row(y)[x]; }
  /* Pixels of the window of radius r around the pixel nearest to (x, y), row by row; none where it leaves the frame. */
  std::vector<uint8_t> window(double x, double y, int r) const {
    std::vector<uint8_t> pixels;
    x = std::floor(x + 0.5) - r, y = std::floor(y + 0.5) - r;
    if (!(x >= 0 && y >= 0 && x + 2 * r < width && y + 2 * r < height)) return pixels;
    for (int j = 0; j <= 2 * r; j++) {
      const uint8_t *start = row(int(y) + j) + int(x);
      pixels.insert(pixels.end(), start, start + 2 * r + 1);
    }
    return pixels;
  }
};

/* A frame that is kept: its gray pixels. */
class Picture {
public:
  explicit Picture(const Frame &frame) : view(frame) {
    for (int y = 0; y < frame.height; y++) pixels.insert(pixels.end(), frame.row(y), frame.row(y) + frame.width);
    view.stride = frame.width;
    view.raw = nullptr;
  }
  Frame frame() const {
    Frame frame = view;
    frame.data = pixels.data();
    return frame;
  }

private:
  Frame view;
  std::vector<uint8_t> pixels;
};

/* A point to follow. */
struct Point {
  uint32_t id;
  float x, y;
};

namespace detail {

inline uint32_t dtype(uint8_t) { return HONAMI_U8; }
inline uint32_t dtype(int32_t) { return HONAMI_I32; }
inline uint32_t dtype(uint32_t) { return HONAMI_U32; }
inline uint32_t dtype(int64_t) { return HONAMI_I64; }
inline uint32_t dtype(uint64_t) { return HONAMI_U64; }
inline uint32_t dtype(float) { return HONAMI_F32; }
inline uint32_t dtype(double) { return HONAMI_F64; }

/* The column of this name, which must be there. */
template <class T> const T *column(const honami_table *table, const char *name) {
  for (uint32_t i = 0; i < table->ncols; i++) {
    const honami_column &c = table->cols[i];
    if (!std::strcmp(c.name, name) && c.dtype == dtype(T())) return static_cast<const T *>(c.data);
  }
  throw Error(std::string(table->schema) + " needs a column " + name, HONAMI_E_ARGUMENT);
}

/* A column that is to be handed over. */
struct Column {
  template <class T>
  Column(const char *name, const std::vector<T> &values, uint32_t ncomp = 1)
      : name(name), dtype(detail::dtype(T())), ncomp(ncomp), data(values.data()), rows(values.size() / ncomp),
        bytes(values.size() * sizeof(T)) {}
  const char *name;
  uint32_t dtype, ncomp;
  const void *data;
  std::size_t rows, bytes;
};

/* Lays a table into the host's memory. */
inline honami_code lay(const honami_call *call, const char *schema, const std::vector<Column> &columns) {
  std::vector<honami_column> out;
  for (const Column &column : columns) {
    if (column.rows != columns[0].rows) throw std::logic_error(std::string("columns of ") + schema + " differ in length");
    out.push_back({column.name, column.dtype, column.ncomp, nullptr, 0});
  }
  const honami_code code = call->reserve(call, schema, columns[0].rows, uint32_t(out.size()), out.data());
  if (code < 0) return code;
  for (std::size_t k = 0; k < out.size(); k++)
    if (columns[k].bytes) std::memcpy(out[k].data, columns[k].data, columns[k].bytes);
  return call->commit(call, schema, columns[0].rows);
}

} // namespace detail

/* Points to follow: for (auto [id, x, y] : points). */
class Points {
public:
  explicit Points(const honami_table *table) : n(table ? table->rows : 0) {
    if (n == 0) return;
    ids = detail::column<uint32_t>(table, "id");
    xs = detail::column<float>(table, "x");
    ys = detail::column<float>(table, "y");
  }
  std::size_t size() const { return std::size_t(n); }
  Point operator[](std::size_t k) const { return {ids[k], xs[k], ys[k]}; }

  struct Iterator {
    const Points *points;
    std::size_t k;
    Point operator*() const { return (*points)[k]; }
    Iterator &operator++() { return ++k, *this; }
    bool operator!=(const Iterator &other) const { return k != other.k; }
  };
  Iterator begin() const { return {this, 0}; }
  Iterator end() const { return {this, size()}; }

private:
  uint64_t n;
  const uint32_t *ids = nullptr;
  const float *xs = nullptr, *ys = nullptr;
};

/* What is known of a point in a frame. */
enum Status : uint8_t {
  LOST = HONAMI_LOST,
  TRACKED = HONAMI_TRACKED,
  OCCLUDED = HONAMI_OCCLUDED,
  OUTSIDE = HONAMI_OUTSIDE,
  REJECTED = HONAMI_REJECTED,
  NEWBORN = HONAMI_NEWBORN
};

/* What a push hands back: a row a live point. */
class Rows {
public:
  /* Positions are finite, also of lost points. If measured: fb, error there and back, pixels; ncc, likeness, -1 to 1. */
  void add(uint32_t id, float x, float y, Status status, float fb = HONAMI_FB_NONE, float ncc = HONAMI_NCC_NONE) {
    ids.push_back(id), xs.push_back(x), ys.push_back(y), states.push_back(status), fbs.push_back(fb), nccs.push_back(ncc);
    has_fb = has_fb || fb != HONAMI_FB_NONE;
    has_ncc = has_ncc || ncc != HONAMI_NCC_NONE;
  }

  /* Lays them into the host's memory. */
  honami_code commit(const honami_call *call) const {
    std::vector<detail::Column> columns{{"id", ids}, {"x", xs}, {"y", ys}, {"status", states}};
    if (has_fb) columns.emplace_back("fb", fbs);
    if (has_ncc) columns.emplace_back("ncc", nccs);
    return detail::lay(call, HONAMI_POINTS, columns);
  }

private:
  std::vector<uint32_t> ids;
  std::vector<float> xs, ys, fbs, nccs;
  std::vector<uint8_t> states;
  bool has_fb = false, has_ncc = false;
};

/* Where features are wanted. */
struct Wanted {
  Frame frame;
  std::size_t max_features; /* at most so many, the best ones first; more are left out */
  Points points;            /* keep your distance from these */
  uint32_t max_threads;
  uint64_t seed;
  const uint8_t *mask; /* null: everywhere */
  std::ptrdiff_t mask_stride;

  bool may(int x, int y) const { return !mask || mask[y * mask_stride + x]; }
};

/* A place worth following: the larger the score, the better. */
struct Feature {
  float x, y, score;
};

/* Dense motion: node (i, j) of the grid lies at (x + i * step, y + j * step), and what is there moves by (u, v), pixels. */
struct Field {
  Field(float x, float y, float step, uint32_t nx, uint32_t ny)
      : x(x), y(y), step(step), nx(nx), ny(ny), u(std::size_t(nx) * ny), v(u.size()), known(u.size(), 1) {}
  float x, y, step;
  uint32_t nx, ny;
  std::vector<float> u, v;    /* row by row */
  std::vector<uint8_t> known; /* 0 where nothing could be measured */

  void set(uint32_t i, uint32_t j, float right, float down) {
    u[std::size_t(j) * nx + i] = right, v[std::size_t(j) * nx + i] = down;
  }
};

/* A track: a sample a frame, from frame `first` on. */
struct Track {
  uint32_t id;
  int64_t first;
  std::size_t n;
  const float *x, *y;
  const uint8_t *status;

  bool is_seen(std::size_t k) const { return status[k] == TRACKED || status[k] == NEWBORN; }
};

/* Tracks to group or to grow from. */
class Tracks {
public:
  template <class Input>
  explicit Tracks(const Input *input)
      : width(input->width), height(input->height), max_threads(input->max_threads), seed(input->seed),
        n(std::size_t(input->tracks->rows)), n_times(std::size_t(input->times->rows)) {
    frames = detail::column<int64_t>(input->times, "frame");
    times = detail::column<double>(input->times, "time_s");
    ids = detail::column<uint32_t>(input->tracks, "id");
    firsts = detail::column<int64_t>(input->tracks, "frame0");
    lens = detail::column<uint32_t>(input->tracks, "len");
    offsets = detail::column<uint64_t>(input->tracks, "offset");
    xs = detail::column<float>(input->tracks, "x");
    ys = detail::column<float>(input->tracks, "y");
    states = detail::column<uint8_t>(input->tracks, "status");
  }
  std::size_t size() const { return n; }
  Track operator[](std::size_t k) const {
    const std::size_t at = std::size_t(offsets[k]);
    return {ids[k], firsts[k], lens[k], xs + at, ys + at, states + at};
  }
  /* Frames, from the first to the last of the tracks: the number and the time of each. */
  std::size_t n_frames() const { return n_times; }
  int64_t frame(std::size_t k) const { return frames[k]; }
  double time_s(std::size_t k) const { return times[k]; }

  const uint32_t width, height, max_threads;
  const uint64_t seed;

private:
  std::size_t n, n_times;
  const int64_t *frames, *firsts;
  const double *times;
  const uint32_t *ids, *lens;
  const uint64_t *offsets;
  const float *xs, *ys;
  const uint8_t *states;
};

/* What a clusterer hands back: n - 1 merges over n tracks. Track k is cluster k, and merge r makes cluster n + r: SciPy's
 * linkage matrix. Frames may be judged: all of those in the tracks' times, in their order. */
class Tree {
public:
  void merge(std::size_t a, std::size_t b, double height) {
    as.push_back(uint32_t(a)), bs.push_back(uint32_t(b)), heights.push_back(height);
  }
  void judge(int64_t frame, bool is_outlier, double distance) {
    frames.push_back(frame), outliers.push_back(is_outlier), distances.push_back(distance);
  }

  /* Lays it into the host's memory. */
  honami_code commit(const honami_call *call) const {
    const std::size_t n = as.size() + 1;
    std::vector<uint32_t> sizes(n, 1);
    for (std::size_t r = 0; r < as.size(); r++) sizes.push_back(sizes.at(as[r]) + sizes.at(bs[r]));
    sizes.erase(sizes.begin(), sizes.begin() + std::ptrdiff_t(n));
    const honami_code code =
        detail::lay(call, HONAMI_DENDROGRAM, {{"a", as}, {"b", bs}, {"height", heights}, {"size", sizes}});
    if (code < 0 || frames.empty()) return code;
    return detail::lay(call, HONAMI_FRAMES, {{"frame", frames}, {"outlier", outliers}, {"distance", distances}});
  }

private:
  std::vector<uint32_t> as, bs;
  std::vector<double> heights, distances;
  std::vector<int64_t> frames;
  std::vector<uint8_t> outliers;
};

/* The tree that a hierarchy of tracks was cut into. */
class Groups {
public:
  explicit Groups(const honami_table *table)
      : n(std::size_t(table->rows)), parents(detail::column<int32_t>(table, "parent")),
        groups(detail::column<int32_t>(table, "group")) {}
  std::size_t size() const { return n; }
  /* The group that it is part of, which comes before it; -1 for the whole, which is group 0. */
  int32_t parent(std::size_t group) const { return parents[group]; }
  bool has_parts(std::size_t group) const { return std::find(parents, parents + n, int32_t(group)) != parents + n; }
  /* The group of a track, one without parts; -1 for none. */
  int32_t of(std::size_t track) const { return groups[track]; }

private:
  std::size_t n;
  const int32_t *parents, *groups;
};

/* What a structure builder draws on. */
struct Filmed {
  Tracks tracks;
  Groups groups;
  const double *root;  /* x, y: where the plant leaves the ground, pixels; null: nobody has said */
  const uint8_t *mask; /* null: everywhere */
  std::ptrdiff_t mask_stride;

  bool may(int x, int y) const { return !mask || mask[y * mask_stride + x]; }
};

/* What a structure builder hands back; pixels, x right, y away from the camera, z up: a place is seen in the picture at
 * (x, -z). Joint 0 is the root, which has no bone. Every bone is pointed in every frame; it points up else. */
class Skeleton {
public:
  Skeleton(std::size_t n_frames, double x, double y, double z) : n_frames(n_frames), root{x, y, z} { add(-1, 0); }
  /* Another joint, at the end of a bone of this length, above 0, on an earlier one. */
  std::size_t joint(std::size_t parent, double length) { return add(int32_t(parent), length); }
  /* Points the bone of a joint in a frame; of any finite length above 0. */
  void point(std::size_t joint, std::size_t frame, double x, double y, double z) {
    const double length = std::hypot(std::hypot(x, y), z);
    in_reach("joint", joint, ways.size(), frame);
    if (!(length > 0 && std::isfinite(length)))
      throw std::domain_error("joint " + std::to_string(joint) + " is pointed nowhere in frame " + std::to_string(frame) +
                              ": a direction of a finite length above 0 was wanted");
    double *const d = &ways[joint][3 * frame];
    d[0] = x / length, d[1] = y / length, d[2] = z / length;
  }
  /* A joint has become a group; of those with parts it need not be said. */
  void bear(std::size_t joint, std::size_t group) {
    bearers.push_back(uint32_t(joint)), borne.push_back(uint32_t(group));
  }
  /* A joint carries a track. Where it is, from the joint, is said of every frame; it is at the joint else. */
  std::size_t leaf(std::size_t joint, std::size_t track) {
    carriers.push_back(uint32_t(joint)), carried.push_back(uint32_t(track));
    offsets.resize(offsets.size() + 3 * n_frames);
    return carried.size() - 1;
  }
  void place(std::size_t leaf, std::size_t frame, double x, double y, double z) {
    in_reach("leaf", leaf, carried.size(), frame);
    double *const d = &offsets[3 * (leaf * n_frames + frame)];
    d[0] = x, d[1] = y, d[2] = z;
  }

  /* Lays it into the host's memory. */
  honami_code commit(const honami_call *call) const {
    std::vector<double> pose;
    for (std::size_t frame = 0; frame < n_frames; frame++)
      for (const std::vector<double> &way : ways) pose.insert(pose.end(), &way[3 * frame], &way[3 * frame] + 3);
    const std::vector<double> x{root[0]}, y{root[1]}, z{root[2]};
    honami_code code = detail::lay(call, HONAMI_JOINTS, {{"parent", parents}, {"length", lengths}});
    if (code >= 0) code = detail::lay(call, HONAMI_ROOT, {{"x", x}, {"y", y}, {"z", z}});
    if (code >= 0) code = detail::lay(call, HONAMI_POSE, {{"d", pose, 3}});
    if (code >= 0) code = detail::lay(call, HONAMI_BEARS, {{"joint", bearers}, {"group", borne}});
    if (code < 0 || carried.empty()) return code;
    code = detail::lay(call, HONAMI_LEAVES, {{"joint", carriers}, {"track", carried}});
    return code < 0 ? code : detail::lay(call, HONAMI_OFFSETS, {{"d", offsets, 3}});
  }

private:
  /* What is not there is an error of the plugin's, and nothing beside it is written over. */
  void in_reach(const char *what, std::size_t k, std::size_t n, std::size_t frame) const {
    if (k < n && frame < n_frames) return;
    throw std::out_of_range(std::string(what) + " " + std::to_string(k) + " of " + std::to_string(n) + " was placed in frame " +
                            std::to_string(frame) + " of " + std::to_string(n_frames));
  }
  std::size_t add(int32_t parent, double length) {
    parents.push_back(parent), lengths.push_back(length);
    ways.emplace_back(3 * n_frames);
    for (std::size_t frame = 0; frame < n_frames; frame++) ways.back()[3 * frame + 2] = 1;
    return ways.size() - 1;
  }
  std::size_t n_frames;
  double root[3];
  std::vector<int32_t> parents;
  std::vector<double> lengths, offsets;
  std::vector<std::vector<double>> ways;
  std::vector<uint32_t> bearers, borne, carriers, carried;
};

} // namespace honami

#endif
