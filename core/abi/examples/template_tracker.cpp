// template_tracker.cpp - a tracker in C++ that looks for every point's first picture of it, near where it was last.
//
//   c++ -std=c++17 -O2 -shared -fPIC -fvisibility=hidden -fvisibility-inlines-hidden template_tracker.cpp -o t.so
#include "honami.hpp"
#include <map>
#include <optional>

class Template : public honami::Tracker {
public:
  static constexpr honami::Info info{"org.honami.template", "Templates of the first frame",
                                     "Looks for the first picture of every point, near where it was last."};
  static constexpr honami::Param params[] = {
      honami::integer("radius", 7, 2, 30, "px", "Half the side of the template."),
      honami::integer("search", 6, 1, 30, "px", "How far a point may move from frame to frame.")};

  Template(const honami::Values &values, const honami::Stream &)
      : radius(values.integer("radius")), search(values.integer("search")) {}

  void seed(const honami::Points &points, const honami::Call &) override {
    for (auto [id, x, y] : points)
      live[id] = {x, y, last ? last->frame().window(x, y, radius) : std::vector<uint8_t>()};
  }

  void retire(uint32_t id) override { live.erase(id); }

  void push(const honami::Frame &frame, honami::Rows &out, const honami::Call &call) override {
    std::size_t n = 0;
    for (auto &[id, point] : live) {
      call.progress(double(n++) / double(live.size()), "looking for templates");
      if (!last) point.first = frame.window(point.x, point.y, radius);
      const honami::Status status = look(frame, point);
      out.add(id, point.x, point.y, status);
    }
    last.emplace(frame);
  }

private:
  struct Point {
    float x, y;
    std::vector<uint8_t> first; // around it, where it was seeded; none near the border
  };

  // Whether what misses by so much is something else: by more than half of the template's own contrast.
  static bool is_other(const std::vector<uint8_t> &first, long miss) {
    long n = long(first.size()), sum = 0, squares = 0;
    for (long pixel : first) sum += pixel, squares += pixel * pixel;
    return 2 * miss * n > n * squares - sum * sum;
  }

  // Moves a point to where the sum of squared differences from its template is smallest; it stays where all look alike.
  // Where the search leaves the picture and finds something else, the point has left it, too.
  honami::Status look(const honami::Frame &frame, Point &point) const {
    long best = -1;
    int dx = 0, dy = 0;
    for (int j = -search; j <= search; j++)
      for (int i = -search; i <= search; i++) {
        const std::vector<uint8_t> here = frame.window(point.x + float(i), point.y + float(j), radius);
        if (here.empty() || point.first.empty()) continue;
        long miss = i || j;
        for (std::size_t k = 0; k < here.size(); k++) miss += (here[k] - point.first[k]) * (here[k] - point.first[k]);
        if (best < 0 || miss < best) best = miss, dx = i, dy = j;
      }
    if (best < 0) return honami::LOST;
    if (frame.window(point.x, point.y, radius + search).empty() && is_other(point.first, best)) return honami::LOST;
    point.x += float(dx), point.y += float(dy);
    return honami::TRACKED;
  }

  int radius, search;
  std::map<uint32_t, Point> live;
  std::optional<honami::Picture> last;
};

HONAMI_LIBRARY("org.honami.template", "1.0.0", "MIT OR Apache-2.0", Template);
