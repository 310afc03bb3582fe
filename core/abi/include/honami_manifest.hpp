/* honami_manifest.hpp - what a plugin in C++ declares, and the manifest that the compiler writes from it; part of
 * honami.hpp, which includes it.
 */
#ifndef HONAMI_MANIFEST_HPP
#define HONAMI_MANIFEST_HPP

#include "honami.h"

#include <type_traits>

namespace honami {

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

/* What a class has beside what its base wants. */
template <class T, class = void> inline constexpr bool has_params = false;
template <class T> inline constexpr bool has_params<T, std::void_t<decltype(T::params)>> = true;
template <class T, class = void> inline constexpr bool has_detect = false;
template <class T> inline constexpr bool has_detect<T, std::void_t<decltype(&T::detect)>> = true;
template <class T, class = void> inline constexpr bool has_field = false;
template <class T> inline constexpr bool has_field<T, std::void_t<decltype(&T::field)>> = true;
template <class T, class = void> inline constexpr bool has_state = false;
template <class T> inline constexpr bool has_state<T, std::void_t<decltype(&T::save), decltype(&T::load)>> = true;

template <class T, std::size_t N> constexpr void write_params(Json<N> &json) {
  if constexpr (has_params<T>) {
    bool is_first = true;
    for (const Param &param : T::params) {
      if (!is_first) json.byte(',');
      json.param(param);
      is_first = false;
    }
  }
}

template <class T, std::size_t N> constexpr void write_plugin(Json<N> &json, bool is_first) {
  json.raw(is_first ? "{\"id\":" : ",{\"id\":");
  json.string(T::info.id);
  json.member("kind", T::kind);
  json.member("name", T::info.name);
  json.member("doc", T::info.doc);
  json.raw(",\"interfaces\":[\"honami.");
  json.raw(T::kind);
  json.raw("/1\"");
  if (has_detect<T>) json.raw(",\"" HONAMI_DETECT "\"");
  if (has_field<T>) json.raw(",\"" HONAMI_FIELD "\"");
  if (has_state<T>) json.raw(",\"" HONAMI_STATE "\"");
  json.raw("],");
  json.raw("\"caps\":{\"latency\":0,\"pixels\":[\"gray8\"],\"deterministic\":");
  json.raw(T::info.deterministic ? "true" : "false");
  json.raw(T::info.parallel_instances ? ",\"parallel_instances\":true}" : ",\"parallel_instances\":false}");
  json.raw(",\"params\":[");
  write_params<T>(json);
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

} // namespace detail
} // namespace honami

#endif
