// template_structure.cpp - a structure builder in C++: a bone from the root to the middle of every group.
//
//   c++ -std=c++17 -O2 -shared -fPIC -fvisibility=hidden -fvisibility-inlines-hidden template_structure.cpp -o s.so
#include "honami.hpp"
#include <array>
#include <optional>

class Fan : public honami::Structure {
public:
  static constexpr honami::Info info{"org.honami.fan", "Fan", "A bone from the root to the middle of every group."};
  static constexpr honami::Param params[] = {
      honami::flag("leaves", true, "Whether every bone carries the tracks of its group.")};

  explicit Fan(const honami::Values &values) : has_leaves(values.flag("leaves")) {}

  honami::Skeleton run(const honami::Filmed &filmed, const honami::Call &call) override {
    const honami::Groups &groups = filmed.groups;
    std::vector<Bone> bones;
    for (std::size_t group = 0; group < groups.size(); group++) {
      call.progress(double(group) / double(groups.size()), "following groups");
      if (!groups.has_parts(group)) bones.push_back({group, middle(filmed, group)});
    }
    const Place root = filmed.root ? Place{filmed.root[0], filmed.root[1]} : below(bones);
    honami::Skeleton fan(filmed.tracks.n_frames(), root[0], 0, -root[1]);
    for (const Bone &bone : bones) add(fan, filmed, root, bone);
    return fan;
  }

private:
  using Place = std::array<double, 2>; // pixels, right and down
  struct Bone {
    std::size_t group;
    std::vector<Place> middle; // frame by frame
  };

  // Its length is the mean over the frames; what is left to where a track is seen is the leaf's.
  void add(honami::Skeleton &fan, const honami::Filmed &filmed, const Place &root, const Bone &bone) const {
    const std::size_t n_frames = bone.middle.size();
    double length = 0;
    for (const Place &at : bone.middle) length += std::hypot(at[0] - root[0], at[1] - root[1]) / double(n_frames);
    if (!(length >= 1e-6)) throw honami::Error("a group is where the root is");
    const std::size_t joint = fan.joint(0, length);
    fan.bear(joint, bone.group);
    std::vector<Place> ends(n_frames, {root[0], root[1] - length}); // it points up unless it is said
    for (std::size_t t = 0; t < n_frames; t++) {
      const double right = bone.middle[t][0] - root[0], up = root[1] - bone.middle[t][1], far = std::hypot(right, up);
      if (!(far > 0)) continue;
      fan.point(joint, t, right, 0, up);
      ends[t] = {root[0] + length * right / far, root[1] - length * up / far};
    }
    for (std::size_t track = 0; has_leaves && track < filmed.tracks.size(); track++) {
      if (filmed.groups.of(track) != int32_t(bone.group)) continue;
      const std::size_t leaf = fan.leaf(joint, track);
      for (std::size_t t = 0; t < n_frames; t++) {
        const Place at = seen(filmed, track, t).value_or(bone.middle[t]);
        fan.place(leaf, t, at[0] - ends[t][0], 0, ends[t][1] - at[1]);
      }
    }
  }

  // Where a track is seen in a frame.
  static std::optional<Place> seen(const honami::Filmed &filmed, std::size_t k, std::size_t t) {
    const honami::Track track = filmed.tracks[k];
    const int64_t at = filmed.tracks.frame(t) - track.first;
    if (at < 0 || at >= int64_t(track.n) || !track.is_seen(std::size_t(at))) return std::nullopt;
    return Place{track.x[at], track.y[at]};
  }

  // The mean of a group's tracks, frame by frame; as in the frame before where none is seen, and at first as when one is.
  static std::vector<Place> middle(const honami::Filmed &filmed, std::size_t group) {
    std::vector<Place> places;
    std::size_t n_before = 0;
    for (std::size_t t = 0; t < filmed.tracks.n_frames(); t++) {
      double right = 0, down = 0, n = 0;
      for (std::size_t k = 0; k < filmed.tracks.size(); k++) {
        if (filmed.groups.of(k) != int32_t(group)) continue;
        if (const std::optional<Place> at = seen(filmed, k, t)) right += (*at)[0], down += (*at)[1], n++;
      }
      if (n > 0) places.push_back({right / n, down / n});
      else if (places.empty()) n_before++;
      else places.push_back(places.back());
    }
    if (places.empty()) throw honami::Error("a group is never seen");
    const Place first = places.front();
    places.insert(places.begin(), n_before, first);
    return places;
  }

  // Under the middle of all, as low as the lowest.
  static Place below(const std::vector<Bone> &bones) {
    double sum = 0, n = 0, lowest = 0;
    for (const Bone &bone : bones)
      for (const Place &at : bone.middle) sum += at[0], n++, lowest = std::max(lowest, at[1]);
    return {sum / std::max(n, 1.0), lowest};
  }

  bool has_leaves;
};

HONAMI_LIBRARY("org.honami.fan", "1.0.0", "MIT OR Apache-2.0", Fan);
