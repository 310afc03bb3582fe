/* honami.hpp - trackers in C++17, over honami.h: derive from honami::Tracker, and name the class in HONAMI_LIBRARY.
 * examples/template_tracker.cpp is a complete plugin:
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
 * Whatever a member function throws ends the stream, and is told to the user in the words of its what(): honami::Error
 * for input that cannot be worked on, anything else for a fault of the plugin's own. Call::progress throws when the
 * user wants to stop: let that pass. What a function is given is gone when it returns: copy what you keep.
 */
#ifndef HONAMI_HPP
#define HONAMI_HPP

#include "honami.h"

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

/* ------------------------------------------------------------------------------------- what a plugin declares --- */

/* What a plugin is called. The last part of the id is its short name; the id is yours for ever. */
struct Info {
  const char *id, *name;
  const char *doc = "";
  bool deterministic = true, parallel_instances = true;
};

/* One of several, by the id that projects keep. */
struct Entry {
  const char *id, *label;
};

/* A parameter; made by integer, number, flag, choice and file. */
struct Param {
  const char *id;
  uint32_t kind;
  double standard, min, max;
  const char *unit, *doc;
  const Entry *entries;
  std::size_t n_entries;
};

constexpr Param integer(const char *id, int standard, int min, int max, const char *unit, const char *doc) {
  return {id, HONAMI_INT, double(standard), double(min), double(max), unit, doc, nullptr, 0};
}
constexpr Param number(const char *id, double standard, double min, double max, const char *unit, const char *doc) {
  return {id, HONAMI_FLOAT, standard, min, max, unit, doc, nullptr, 0};
}
constexpr Param flag(const char *id, bool standard, const char *doc) {
  return {id, HONAMI_BOOL, standard ? 1.0 : 0.0, 0, 1, "", doc, nullptr, 0};
}
/* The first entry is the default. */
template <std::size_t N> constexpr Param choice(const char *id, const Entry (&entries)[N], const char *doc) {
  return {id, HONAMI_TEXT, 0, 0, 0, "", doc, entries, N};
}
/* A file that the plugin reads; it can open no others. */
constexpr Param file(const char *id, const char *doc) { return {id, HONAMI_TEXT, 0, 0, 0, "", doc, nullptr, 0}; }

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

/* Points to follow: for (auto [id, x, y] : points). */
class Points {
public:
  explicit Points(const honami_table *table) : n(table->rows) {
    for (uint32_t i = 0; i < table->ncols; i++) {
      const honami_column &c = table->cols[i];
      if (!std::strcmp(c.name, "id") && c.dtype == HONAMI_U32) ids = static_cast<const uint32_t *>(c.data);
      if (!std::strcmp(c.name, "x") && c.dtype == HONAMI_F32) xs = static_cast<const float *>(c.data);
      if (!std::strcmp(c.name, "y") && c.dtype == HONAMI_F32) ys = static_cast<const float *>(c.data);
    }
    if (n && !(ids && xs && ys)) throw Error("points need id, x and y", HONAMI_E_ARGUMENT);
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
    rows.push_back({id, x, y, fb, ncc, status});
    has_fb = has_fb || fb != HONAMI_FB_NONE;
    has_ncc = has_ncc || ncc != HONAMI_NCC_NONE;
  }

  /* Lays them into the host's memory. */
  honami_code commit(const honami_call *call) const {
    honami_column columns[6] = {column("id", HONAMI_U32), column("x", HONAMI_F32), column("y", HONAMI_F32),
                                column("status", HONAMI_U8)};
    uint32_t n = 4;
    const uint32_t fb = has_fb ? n++ : 0, ncc = has_ncc ? n++ : 0;
    if (has_fb) columns[fb] = column("fb", HONAMI_F32);
    if (has_ncc) columns[ncc] = column("ncc", HONAMI_F32);
    const honami_code code = call->reserve(call, HONAMI_POINTS, rows.size(), n, columns);
    if (code < 0) return code;
    for (std::size_t k = 0; k < rows.size(); k++) {
      static_cast<uint32_t *>(columns[0].data)[k] = rows[k].id;
      static_cast<float *>(columns[1].data)[k] = rows[k].x;
      static_cast<float *>(columns[2].data)[k] = rows[k].y;
      static_cast<uint8_t *>(columns[3].data)[k] = rows[k].status;
      if (has_fb) static_cast<float *>(columns[fb].data)[k] = rows[k].fb;
      if (has_ncc) static_cast<float *>(columns[ncc].data)[k] = rows[k].ncc;
    }
    return call->commit(call, HONAMI_POINTS, rows.size());
  }

private:
  struct Row {
    uint32_t id;
    float x, y, fb, ncc;
    uint8_t status;
  };
  static honami_column column(const char *name, uint32_t dtype) { return {name, dtype, 1, nullptr, 0}; }
  std::vector<Row> rows;
  bool has_fb = false, has_ncc = false;
};

/* Follows points through a stream; one object a stream. The order of calls: push (frame 0), seed, push (frame 1), push,
 * seed, retire, push. Seeds hold in the frame pushed last; those that come before the first push hold in the first
 * frame, where push reports them as they were seeded. Seeding a live id moves it: a correction by hand. */
class Tracker {
public:
  virtual ~Tracker() = default;
  /* Adds points, or moves those that are live. */
  virtual void seed(const Points &points, const Call &call) = 0;
  /* Forgets a point; ids that are not live are ignored. */
  virtual void retire(uint32_t id) = 0;
  /* Follows all live points into this frame: a row each. One that is left out is ended for good. */
  virtual void push(const Frame &frame, Rows &out, const Call &call) = 0;
};

/* --------------------------------------------------------------------------------------------------- the border --- */

namespace detail {

/* JSON under construction, by the compiler. With N = 0 it only counts, which gives the N of the second pass. */
template <std::size_t N> struct Json {
  char text[N + 1] = {};
  std::size_t n = 0;

  constexpr void byte(char c) {
    if (n < N) text[n] = c;
    n++;
  }
  constexpr void raw(const char *s) {
    while (*s) byte(*s++);
  }
  constexpr void string(const char *s) {
    byte('"');
    for (; *s; s++) {
      if (*s == '\n') {
        raw("\\n");
        continue;
      }
      if (*s == '"' || *s == '\\') byte('\\');
      byte(*s);
    }
    byte('"');
  }
  constexpr void member(const char *key, const char *value) {
    byte(',');
    string(key);
    byte(':');
    string(value);
  }
  constexpr void whole(unsigned long long v) {
    if (v > 9) whole(v / 10);
    byte(char('0' + v % 10));
  }
  /* With 15 digits, which every decimal number of so many comes back from. */
  constexpr void real(double v) {
    if (v < 0) byte('-'), v = -v;
    int exponent = 0;
    if (v > 0) {
      for (; v >= 10; v /= 10) exponent++;
      for (; v < 1; v *= 10) exponent--;
    }
    const auto digits = static_cast<unsigned long long>(v * 1e14 + 0.5);
    whole(digits / 100000000000000);
    byte('.');
    unsigned long long rest = digits % 100000000000000;
    for (unsigned long long unit = 10000000000000; unit; rest %= unit, unit /= 10) byte(char('0' + rest / unit));
    byte('e');
    if (exponent < 0) byte('-');
    whole(static_cast<unsigned long long>(exponent < 0 ? -exponent : exponent));
  }
  constexpr void member(const char *key, double value, bool is_whole) {
    byte(',');
    string(key);
    byte(':');
    if (!is_whole) return real(value);
    if (value < 0) byte('-');
    whole(static_cast<unsigned long long>(value < 0 ? -value : value));
  }
  constexpr void param(const Param &p) {
    raw("{\"id\":");
    string(p.id);
    const bool is_whole = p.kind == HONAMI_INT;
    if (p.kind == HONAMI_BOOL) {
      raw(",\"type\":\"bool\",\"default\":");
      raw(p.standard != 0 ? "true" : "false");
    } else if (p.entries) choice(p);
    else if (p.kind == HONAMI_TEXT) raw(",\"type\":\"path\",\"mode\":\"open\",\"default\":\"\"");
    else {
      raw(is_whole ? ",\"type\":\"int\"" : ",\"type\":\"float\"");
      member("default", p.standard, is_whole);
      member("min", p.min, is_whole);
      member("max", p.max, is_whole);
      member("unit", p.unit);
    }
    member("doc", p.doc);
    byte('}');
  }
  constexpr void choice(const Param &p) {
    raw(",\"type\":\"enum\"");
    member("default", p.entries[0].id);
    raw(",\"entries\":[");
    for (std::size_t k = 0; k < p.n_entries; k++) {
      raw(k ? ",{\"id\":" : "{\"id\":");
      string(p.entries[k].id);
      member("label", p.entries[k].label);
      byte('}');
    }
    byte(']');
  }
};

template <class T, class = void> struct Declared {
  template <std::size_t N> static constexpr void write(Json<N> &) {}
  static Values values() { return Values(); }
};
template <class T> struct Declared<T, std::void_t<decltype(T::params)>> {
  template <std::size_t N> static constexpr void write(Json<N> &json) {
    bool is_first = true;
    for (const Param &param : T::params) {
      if (!is_first) json.byte(',');
      json.param(param);
      is_first = false;
    }
  }
  static Values values() { return Values(T::params); }
};

template <class T, std::size_t N> constexpr void write_plugin(Json<N> &json, bool is_first) {
  json.raw(is_first ? "{\"id\":" : ",{\"id\":");
  json.string(T::info.id);
  json.member("kind", "tracker");
  json.member("name", T::info.name);
  json.member("doc", T::info.doc);
  json.raw(",\"interfaces\":[\"" HONAMI_TRACKER "\"],");
  json.raw("\"caps\":{\"latency\":0,\"pixels\":[\"gray8\"],\"deterministic\":");
  json.raw(T::info.deterministic ? "true" : "false");
  json.raw(T::info.parallel_instances ? ",\"parallel_instances\":true}" : ",\"parallel_instances\":false}");
  json.raw(",\"params\":[");
  Declared<T>::write(json);
  json.raw("]}");
}

template <std::size_t N, class About, class... Plugins> constexpr Json<N> manifest() {
  Json<N> json;
  json.raw("{\"honami\":1,\"abi\":[");
  json.whole(HONAMI_ABI_MAJOR);
  json.byte(',');
  json.whole(HONAMI_ABI_MINOR);
  json.raw("],\"library\":{\"id\":");
  json.string(About::id);
  json.member("version", About::version);
  json.member("license", About::license);
  json.raw("},\"plugins\":[");
  bool is_first = true;
  ((write_plugin<Plugins>(json, is_first), is_first = false), ...);
  json.raw("]}");
  return json;
}

template <class About, class... Plugins> constexpr std::size_t manifest_len = manifest<0, About, Plugins...>().n;

/* The ELF note that carries the manifest. */
template <std::size_t N> struct Note {
  uint32_t name_len, text_len, type;
  char name[8], text[N + 1];
};

template <class About, class... Plugins> constexpr auto note() {
  constexpr std::size_t n = manifest_len<About, Plugins...>;
  const Json<n> json = manifest<n, About, Plugins...>();
  Note<n> note{7, n + 1, 1, "honami", {}};
  for (std::size_t k = 0; k < n; k++) note.text[k] = json.text[k];
  return note;
}

/* A tracker at work, as honami.h sees it. */
template <class T> class Instance {
public:
  static honami_instance *create() { return &(new Instance)->face; }

private:
  Instance() : values(Declared<T>::values()) {
    face = {HONAMI_SIZE_TO(honami_instance, get_interface), 0, this, destroy, set_params, get_interface};
  }
  static Instance &of(honami_instance *instance) { return *static_cast<Instance *>(instance->self); }

  /* The one door: nothing is thrown through it, and what ended a stream once has ended it. */
  template <class F> static honami_code guard(honami_instance *instance, const honami_call *call, F work) noexcept {
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
    self.running.reset();
    self.has_failed = code == HONAMI_E_INTERNAL;
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
      const Frame view{int(frame->width), int(frame->height), std::ptrdiff_t(frame->stride),
                       frame->data,       frame->index,       frame->time_s,
                       frame};
      Rows rows;
      self.stream().push(view, rows, Call(call));
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

  static const void *get_interface(honami_instance *, const char *id) noexcept {
    static const honami_tracker_v1 tracker = {HONAMI_SIZE_TO(honami_tracker_v1, end), 0, begin, seed, retire, push,
                                              end};
    return std::strcmp(id, HONAMI_TRACKER) == 0 ? &tracker : nullptr;
  }

  honami_instance face;
  Values values;
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
