/* honami.hpp - plugins in C++17, over honami.h: derive from honami::Tracker, honami::Clusterer or honami::Structure, and
 * name the class in HONAMI_LIBRARY. examples/template_tracker.cpp is a complete plugin:
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
 * and so has a structure builder:
 *
 *       honami::Skeleton run(const honami::Filmed &filmed, const honami::Call &call) override;
 *
 * Whatever a member function throws ends the stream, and is told to the user in the words of its what(): honami::Error
 * for input that cannot be worked on, anything else for a fault of the plugin's own. Call::progress throws when the
 * user wants to stop: let that pass. What a function is given is gone when it returns: copy what you keep.
 */
#ifndef HONAMI_HPP
#define HONAMI_HPP

#include "honami_types.hpp"

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

/* Grows the branches behind grouped tracks; one object a skeleton. */
class Structure {
public:
  static constexpr const char *kind = "structure";
  virtual ~Structure() = default;
  virtual Skeleton run(const Filmed &filmed, const Call &call) = 0;
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

  static honami_code grow(honami_instance *instance, const honami_call *call,
                          const honami_structure_input *input) noexcept {
    return guard(instance, call, [&](Instance &self) {
      const Filmed filmed{Tracks(input), Groups(input->groups), input->root, input->mask,
                          std::ptrdiff_t(input->mask_stride)};
      return T(self.values).run(filmed, Call(call)).commit(call);
    });
  }

  static const void *get_interface(honami_instance *, const char *id) noexcept {
    const auto is = [&](const char *known) { return std::strcmp(id, known) == 0; };
    if constexpr (std::is_base_of_v<Clusterer, T>) {
      static const honami_clusterer_v1 clusterer = {HONAMI_SIZE_TO(honami_clusterer_v1, run), 0, run};
      return is(HONAMI_CLUSTERER) ? &clusterer : nullptr;
    } else if constexpr (std::is_base_of_v<Structure, T>) {
      static const honami_structure_v1 structure = {HONAMI_SIZE_TO(honami_structure_v1, run), 0, grow};
      return is(HONAMI_STRUCTURE) ? &structure : nullptr;
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
