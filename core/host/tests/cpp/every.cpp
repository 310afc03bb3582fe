// every.cpp - plugins in C++ that have everything that honami.hpp offers.
#include "honami.hpp"
#include <map>
#include <sstream>

// Moves every point to the right, each time by a pixel more.
class Faster : public honami::Tracker {
public:
  static constexpr honami::Info info{"org.test.faster", "Faster"};
  static constexpr honami::Param params[] = {honami::number("from", 0.5, 0, 4, "px", "How far at first.")};
  static constexpr uint32_t state_version = 3;

  Faster(const honami::Values &values, const honami::Stream &) : step(values.number("from")) {}

  void seed(const honami::Points &points, const honami::Call &) override {
    for (auto [id, x, y] : points) live[id] = {x, y};
  }
  void retire(uint32_t id) override { live.erase(id); }
  void push(const honami::Frame &, honami::Rows &out, const honami::Call &) override {
    for (auto &[id, at] : live) {
      if (has_seen) at.first += float(step);
      out.add(id, at.first, at.second, honami::TRACKED, 0.25f);
    }
    if (has_seen) step += 1;
    has_seen = true;
  }

  std::string save() const {
    std::ostringstream out;
    out.precision(17);
    out << step << ' ' << has_seen << ' ' << live.size();
    for (auto &[id, at] : live) out << ' ' << id << ' ' << at.first << ' ' << at.second;
    return out.str();
  }
  void load(const std::string &saved) {
    std::istringstream in(saved);
    std::size_t n = 0;
    in >> step >> has_seen >> n;
    for (uint32_t id = 0; n-- && in >> id;) in >> live[id].first >> live[id].second;
    if (!in) throw honami::Error("no such state");
  }

  // Pixels that are brighter than their neighbours to both sides; the brightest first.
  static std::vector<honami::Feature> detect(const honami::Values &, const honami::Wanted &wanted, const honami::Call &) {
    std::vector<honami::Feature> found;
    const honami::Frame &frame = wanted.frame;
    for (int y = 0; y < frame.height; y++)
      for (int x = 1; x + 1 < frame.width; x++) {
        const uint8_t here = frame.at(x, y);
        bool is_taken = !wanted.may(x, y) || here <= frame.at(x - 1, y) || here <= frame.at(x + 1, y);
        for (auto [id, px, py] : wanted.points) is_taken = is_taken || (int(px) == x && int(py) == y);
        if (!is_taken) found.push_back({float(x), float(y), float(here)});
      }
    std::sort(found.begin(), found.end(), [](auto &a, auto &b) { return a.score > b.score; });
    return found;
  }

  // How much brighter it has become, as a motion; unknown in the last column.
  static honami::Field field(const honami::Values &, const honami::Frame &from, const honami::Frame &to,
                             const honami::Call &call) {
    honami::Field found(0.5f, 1.0f, 2.0f, uint32_t(from.width / 2), uint32_t(from.height / 2));
    for (uint32_t j = 0; j < found.ny; j++)
      for (uint32_t i = 0; i < found.nx; i++) {
        call.progress(double(j) / found.ny);
        found.set(i, j, float(to.at(int(2 * i), int(2 * j)) - from.at(int(2 * i), int(2 * j))), float(j));
        if (i + 1 == found.nx) found.known[j * found.nx + i] = 0, found.set(i, j, 0, 0);
      }
    return found;
  }

private:
  double step;
  bool has_seen = false;
  std::map<uint32_t, std::pair<float, float>> live;
};

// Merges tracks one after the other, by where the first was seen; frames with an odd number are outliers.
class Chain : public honami::Clusterer {
public:
  static constexpr honami::Info info{"org.test.chain", "Chain"};
  explicit Chain(const honami::Values &) {}

  honami::Tree run(const honami::Tracks &tracks, const honami::Call &) override {
    if (tracks.size() == 1) throw honami::Error("one alone is no group");
    honami::Tree tree;
    double far = 0;
    for (std::size_t k = 1; k < tracks.size(); k++) {
      const honami::Track a = tracks[k - 1], b = tracks[k];
      if (a.is_seen(0) && b.is_seen(0)) far += std::abs(double(b.x[0]) - double(a.x[0]));
      tree.merge(k == 1 ? 0 : tracks.size() + k - 2, k, far);
    }
    for (std::size_t k = 0; k < tracks.n_frames(); k++)
      tree.judge(tracks.frame(k), tracks.frame(k) % 2 != 0, tracks.time_s(k));
    return tree;
  }
};

// A bone from the root to where each group without parts is, in a frame where all of it is seen.
class Fan : public honami::Structure {
public:
  static constexpr honami::Entry faults[] = {{"none", "None"}, {"joint", "Joint"}, {"leaf", "Leaf"},
                                             {"frame", "Frame"}, {"nowhere", "Nowhere"}, {"endless", "Endless"}};
  static constexpr honami::Info info{"org.test.fan", "Fan"};
  static constexpr honami::Param params[] = {honami::choice("fault", faults, "What it does wrongly.")};
  explicit Fan(const honami::Values &values) : fault(values.text("fault")) {}

  honami::Skeleton run(const honami::Filmed &filmed, const honami::Call &call) override {
    if (!filmed.root) throw honami::Error("a fan wants a root");
    const double *root = filmed.root;
    honami::Skeleton fan(filmed.tracks.n_frames(), root[0], filmed.may(1, 1) ? 0 : 5, -root[1]);
    for (std::size_t group = 0; group < filmed.groups.size(); group++) {
      if (filmed.groups.has_parts(group)) continue;
      call.progress(double(group) / double(filmed.groups.size()));
      const std::size_t joint = fan.joint(0, 1 + double(filmed.groups.parent(group)));
      fan.bear(joint, group);
      for (std::size_t k = 0; k < filmed.tracks.size(); k++) {
        if (filmed.groups.of(k) != int32_t(group)) continue;
        const honami::Track track = filmed.tracks[k];
        const std::size_t leaf = fan.leaf(joint, k);
        for (std::size_t t = 0; t < track.n; t++) {
          fan.point(joint, t, track.x[t] - root[0], 0, root[1] - track.y[t]);
          fan.place(leaf, t, track.x[t], 0.5, track.y[t]);
        }
      }
    }
    if (fault == "joint") fan.point(1000000, 1, 1, 0, 0);
    if (fault == "leaf") fan.place(1000000, 1, 1, 0, 0);
    if (fault == "frame") fan.point(1, 1000000, 1, 0, 0);
    if (fault == "nowhere") fan.point(1, 1, 0, 0, 0);
    if (fault == "endless") fan.point(2, 0, 1.7e308, 1.7e308, 0);
    return fan;
  }

private:
  std::string fault;
};

HONAMI_LIBRARY("org.test.every", "1.0.0", "MIT", Faster, Chain, Fan);
