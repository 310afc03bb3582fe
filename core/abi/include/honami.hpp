/* honami.hpp - plugins in C++17, over honami.h: derive from honami::Tracker or honami::Clusterer, and name the class in
 * HONAMI_LIBRARY. examples/template_tracker.cpp is a complete plugin:
 *
 *   c++ -std=c++17 -O2 -shared -fPIC -fvisibility=hidden -fvisibility-inlines-hidden template_tracker.cpp -o t.so
 *
 * The manifest is written by the compiler from what the class declares:
 *
 *   class Mine : public honami::Tracker {
 *   public:
 *     static constexpr honami::Info info{"org.me.mine", "My tracker"};
 *     static constexpr honami::Param params[] = {honami::integer("radius", 7, 2, 30, "px", "Half the side.")};
 *     Mine(const honami::Values &values, const honami::Stream &stream);   // a stream begins
 *
 * A tracker may have more, which the manifest then says:
 *
 *     static std::vector<honami::Feature> detect(const honami::Values &, const honami::Wanted &, const honami::Call &);
 *     static honami::Field field(const honami::Values &, const honami::Frame &from, const honami::Frame &to,
 *                                const honami::Call &);
 *     std::string save() const;               // all that later frames depend on: when its process has died, another,
 *     void load(const std::string &saved);    // which has just begun, goes on from there with the same numbers
 *     static constexpr uint32_t state_version = 1;   // another one when the bytes mean something else; 0 if left out
 *
 * A clusterer has a constructor from the values, and run:
 *
 *     class Groups : public honami::Clusterer {
 *     public:
 *       static constexpr honami::Info info{"org.me.groups", "My groups"};
 *       explicit Groups(const honami::Values &values);
 *       honami::Tree run(const honami::Tracks &tracks, const honami::Call &call) override;
 *
 * Whatever a member function throws ends the stream, and is told to the user in the words of its what(): honami::Error
 * for input that cannot be worked on, anything else for a fault of the plugin's own. Call::progress throws when the
 * user wants to stop: let that pass. What a function is given is gone when it returns: copy what you keep.
 */
#ifndef HONAMI_HPP
#define HONAMI_HPP

#include "honami_manifest.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace honami {

/* --------------------------------------------------------------------------------------- what a plugin is given --- */

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
  Column(const char *name, const std::vector<T> &values)
      : name(name), dtype(detail::dtype(T())), data(values.data()), rows(values.size()), bytes(rows * sizeof(T)) {}
  const char *name;
  uint32_t dtype;
  const void *data;
  std::size_t rows, bytes;
};

/* Lays a table into the host's memory. */
inline honami_code lay(const honami_call *call, const char *schema, const std::vector<Column> &columns) {
  std::vector<honami_column> out;
  for (const Column &column : columns) {
    if (column.rows != columns[0].rows) throw std::logic_error(std::string("columns of ") + schema + " differ in length");
    out.push_back({column.name, column.dtype, 1, nullptr, 0});
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

/* Tracks to group. */
class Tracks {
public:
  explicit Tracks(const honami_clusterer_input *input)
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

/* Follows points through a stream; one object a stream. The order of calls: push (frame 0), seed, push (frame 1), push,
 * seed, retire, push. Seeds hold in the frame pushed last; those that come before the first push hold in the first
 * frame, where push reports them as they were seeded. Seeding a live id moves it: a correction by hand. */
class Tracker {
public:
  static constexpr const char *kind = "tracker";
  virtual ~Tracker() = default;
  /* Adds points, or moves those that are live. */
  virtual void seed(const Points &points, const Call &call) = 0;
  /* Forgets a point; ids that are not live are ignored. */
  virtual void retire(uint32_t id) = 0;
  /* Follows all live points into this frame: a row each. One that is left out is ended for good. */
  virtual void push(const Frame &frame, Rows &out, const Call &call) = 0;
};

/* Groups tracks; one object a grouping. */
class Clusterer {
public:
  static constexpr const char *kind = "clusterer";
  virtual ~Clusterer() = default;
  /* The hierarchy of these tracks. */
  virtual Tree run(const Tracks &tracks, const Call &call) = 0;
};

/* --------------------------------------------------------------------------------------------------- the border --- */

namespace detail {

template <class T> Values values_of() {
  if constexpr (has_params<T>) return Values(T::params);
  else return Values();
}

template <class T, class = void> inline constexpr uint32_t state_version = 0;
template <class T> inline constexpr uint32_t state_version<T, std::void_t<decltype(T::state_version)>> = T::state_version;

/* FNV-1a, by 64 bits: no byte can be changed without the sum. */
class Sum {
public:
  void bytes(const void *data, std::size_t n) {
    for (std::size_t k = 0; k < n; k++) sum = (sum ^ static_cast<const uint8_t *>(data)[k]) * 1099511628211u;
  }
  void text(const std::string &text) { bytes(text.c_str(), text.size() + 1); }
  template <class N> void number(N number) { bytes(&number, sizeof number); }
  uint64_t sum = 14695981039346656037u;
};

/* A plugin at work, as honami.h sees it. */
template <class T> class Instance {
public:
  static honami_instance *create() { return &(new Instance)->face; }

private:
  Instance() : values(values_of<T>()) {
    face = {HONAMI_SIZE_TO(honami_instance, get_interface), 0, this, destroy, set_params, get_interface};
  }
  static Instance &of(honami_instance *instance) { return *static_cast<Instance *>(instance->self); }

  /* The one door: nothing is thrown through it, and what ended a stream once has ended it. Of what `is_aside` a refusal
   * leaves the stream as it is. */
  template <class F>
  static honami_code guard(honami_instance *instance, const honami_call *call, F work, bool is_aside = false) noexcept {
    Instance &self = of(instance);
    if (self.has_failed) return call->fail(call, HONAMI_E_STATE, "has failed before");
    honami_code code = HONAMI_E_INTERNAL;
    try {
      return work(self);
    } catch (const Cancelled &) {
      code = HONAMI_E_CANCELLED;
    } catch (const Error &error) {
      code = call->fail(call, error.code, error.what());
    } catch (const std::bad_alloc &) {
      code = call->fail(call, HONAMI_E_MEMORY, "no memory");
    } catch (const std::exception &error) {
      code = call->fail(call, HONAMI_E_INTERNAL, error.what());
    } catch (...) {
      code = call->fail(call, HONAMI_E_INTERNAL, "threw what is no std::exception");
    }
    self.has_failed = code == HONAMI_E_INTERNAL;
    if (!is_aside || self.has_failed) self.running.reset();
    return code;
  }
  T &stream() {
    if (!running) throw Error("there is no stream: begin comes first", HONAMI_E_STATE);
    return *running;
  }

  static void destroy(honami_instance *instance) noexcept { delete &of(instance); }

  static honami_code set_params(honami_instance *instance, const honami_call *call, const honami_value *given,
                                uint32_t n) noexcept {
    if (of(instance).running) return call->fail(call, HONAMI_E_STATE, "parameters are set before begin");
    return guard(instance, call, [&](Instance &self) {
      Values values = self.values;
      values.set(given, n);
      self.values = std::move(values);
      return HONAMI_OK;
    });
  }

  static honami_code begin(honami_instance *instance, const honami_call *call,
                           const honami_stream_info *stream) noexcept {
    return guard(instance, call, [&](Instance &self) {
      if (stream->pixel != HONAMI_GRAY8) throw Error("only 8-bit gray frames", HONAMI_E_UNSUPPORTED);
      if (self.running) throw Error("a stream is running: end it first", HONAMI_E_STATE);
      self.running = std::make_unique<T>(self.values, *stream);
      self.begun = *stream;
      return HONAMI_OK;
    });
  }

  static honami_code seed(honami_instance *instance, const honami_call *call, const honami_table *table) noexcept {
    return guard(instance, call, [&](Instance &self) {
      self.stream().seed(Points(table), Call(call));
      return HONAMI_OK;
    });
  }

  static honami_code retire(honami_instance *instance, const honami_call *call, const uint32_t *ids,
                            uint64_t n) noexcept {
    return guard(instance, call, [&](Instance &self) {
      for (uint64_t i = 0; i < n; i++) self.stream().retire(ids[i]);
      return HONAMI_OK;
    });
  }

  static honami_code push(honami_instance *instance, const honami_call *call, const honami_frame *frame) noexcept {
    return guard(instance, call, [&](Instance &self) {
      Rows rows;
      self.stream().push(Frame::of(frame), rows, Call(call));
      return rows.commit(call);
    });
  }

  static honami_code end(honami_instance *instance, const honami_call *call) noexcept {
    return guard(instance, call, [&](Instance &self) {
      self.stream();
      self.running.reset();
      return HONAMI_OK;
    });
  }

  static honami_code detect(honami_instance *instance, const honami_call *call,
                            const honami_detect_input *input) noexcept {
    return guard(instance, call, [&](Instance &self) {
      const Wanted wanted{Frame::of(input->frame), input->max_features, Points(input->points),
                          input->max_threads,      input->seed,         input->mask,
                          std::ptrdiff_t(input->mask_stride)};
      std::vector<Feature> found = T::detect(self.values, wanted, Call(call));
      if (found.size() > wanted.max_features) found.erase(found.begin() + std::ptrdiff_t(wanted.max_features), found.end());
      std::vector<float> x, y, score;
      for (const Feature &feature : found)
        x.push_back(feature.x), y.push_back(feature.y), score.push_back(feature.score);
      return lay(call, HONAMI_FEATURES, {{"x", x}, {"y", y}, {"score", score}});
    });
  }

  static honami_code field(honami_instance *instance, const honami_call *call,
                           const honami_field_input *input) noexcept {
    return guard(instance, call, [&](Instance &self) {
      const Field found = T::field(self.values, Frame::of(input->from), Frame::of(input->to), Call(call));
      const honami_code code =
          lay(call, HONAMI_VECTORS, {{"u", found.u}, {"v", found.v}, {"known", found.known}});
      if (code < 0) return code;
      const std::vector<float> gx{found.x}, gy{found.y}, step{found.step};
      const std::vector<uint32_t> nx{found.nx}, ny{found.ny};
      return lay(call, HONAMI_GRID, {{"gx", gx}, {"gy", gy}, {"step", step}, {"nx", nx}, {"ny", ny}});
    });
  }

  /* Whose saved bytes are, and under which parameters and stream. */
  uint64_t setting() const {
    Sum sum;
    sum.text(T::info.id);
    sum.number(state_version<T>);
    values.add_to(sum);
    sum.number(begun.width), sum.number(begun.height), sum.number(begun.direction), sum.number(begun.seed);
    sum.number(begun.birth_first), sum.number(begun.birth_count);
    return sum.sum;
  }

  /* Before the plugin's own bytes lie the setting, and the sum of both. */
  static honami_code save(honami_instance *instance, const honami_call *call) noexcept {
    return guard(instance, call, [&](Instance &self) {
      const std::string own = self.stream().save();
      const uint64_t setting = self.setting();
      Sum sum;
      sum.number(setting);
      sum.bytes(own.data(), own.size());
      std::vector<uint8_t> bytes(2 * sizeof(uint64_t) + own.size());
      std::memcpy(bytes.data(), &sum.sum, sizeof(uint64_t));
      std::memcpy(bytes.data() + sizeof(uint64_t), &setting, sizeof(uint64_t));
      std::copy(own.begin(), own.end(), bytes.begin() + 2 * sizeof(uint64_t));
      return lay(call, HONAMI_STATE, {{"bytes", bytes}});
    }, true);
  }

  static honami_code load(honami_instance *instance, const honami_call *call, const uint8_t *bytes,
                          uint64_t n) noexcept {
    return guard(instance, call, [&](Instance &self) {
      self.stream();
      uint64_t head[2] = {0, 0};
      if (n < sizeof head) throw Error("what was saved is cut");
      std::memcpy(head, bytes, sizeof head);
      Sum sum;
      sum.bytes(bytes + sizeof(uint64_t), std::size_t(n) - sizeof(uint64_t));
      if (sum.sum != head[0]) throw Error("what was saved is cut or damaged");
      if (head[1] != self.setting())
        throw Error("what was saved is of another plugin or version, of other parameters or another stream");
      auto loaded = std::make_unique<T>(self.values, self.begun);
      loaded->load(std::string(bytes + sizeof head, bytes + n));
      self.running = std::move(loaded);
      return HONAMI_OK;
    }, true);
  }

  static honami_code run(honami_instance *instance, const honami_call *call,
                         const honami_clusterer_input *input) noexcept {
    return guard(instance, call, [&](Instance &self) {
      return T(self.values).run(Tracks(input), Call(call)).commit(call);
    });
  }

  static const void *get_interface(honami_instance *, const char *id) noexcept {
    const auto is = [&](const char *known) { return std::strcmp(id, known) == 0; };
    if constexpr (std::is_base_of_v<Clusterer, T>) {
      static const honami_clusterer_v1 clusterer = {HONAMI_SIZE_TO(honami_clusterer_v1, run), 0, run};
      return is(HONAMI_CLUSTERER) ? &clusterer : nullptr;
    } else {
      static const honami_tracker_v1 tracker = {HONAMI_SIZE_TO(honami_tracker_v1, end), 0, begin, seed, retire, push,
                                                end};
      if (is(HONAMI_TRACKER)) return &tracker;
    }
    if constexpr (has_detect<T>) {
      static const honami_detect_v1 detecting = {HONAMI_SIZE_TO(honami_detect_v1, detect), 0, detect};
      if (is(HONAMI_DETECT)) return &detecting;
    }
    if constexpr (has_field<T>) {
      static const honami_field_v1 measuring = {HONAMI_SIZE_TO(honami_field_v1, field), 0, field};
      if (is(HONAMI_FIELD)) return &measuring;
    }
    if constexpr (has_state<T>) {
      static const honami_state_v1 saving = {HONAMI_SIZE_TO(honami_state_v1, load), 0, save, load};
      if (is(HONAMI_STATE)) return &saving;
    }
    return nullptr;
  }

  honami_instance face;
  Values values;
  Stream begun{};
  std::unique_ptr<T> running;
  bool has_failed = false;
};

template <class... Plugins>
honami_instance *create(const honami_host_info *, const honami_call *call, const char *id) noexcept {
  honami_instance *made = nullptr;
  try {
    const bool is_known = ((std::strcmp(id, Plugins::info.id) == 0 && (made = Instance<Plugins>::create())) || ...);
    if (!is_known) call->fail(call, HONAMI_E_UNSUPPORTED, "no such plugin");
  } catch (const std::exception &error) {
    call->fail(call, HONAMI_E_INTERNAL, error.what());
  } catch (...) {
    call->fail(call, HONAMI_E_INTERNAL, "threw what is no std::exception");
  }
  return made;
}

} // namespace detail
} // namespace honami

/* Makes the library of these plugins: its one exported function, and its manifest. Use once, at file scope. */
#define HONAMI_LIBRARY(ID, VERSION, LICENSE, ...)                                                                     \
  struct honami_about {                                                                                              \
    static constexpr const char *id = ID, *version = VERSION, *license = LICENSE;                                    \
  };                                                                                                                 \
  __attribute__((used, aligned(4), section(".note.honami"))) static constexpr auto honami_note =                     \
      honami::detail::note<honami_about, __VA_ARGS__>();                                                             \
  const honami_library *honami_library_v1(const honami_host_info *) {                                                \
    static const honami_library library = {HONAMI_SIZE_TO(honami_library, create), HONAMI_ABI_MINOR,                 \
                                           honami_note.text, sizeof(honami_note.text) - 1,                           \
                                           honami::detail::create<__VA_ARGS__>};                                     \
    return &library;                                                                                                 \
  }                                                                                                                  \
  static_assert(true, "a semicolon follows")

#endif
