// dies.cpp - a tracker that dies of the dense motion of frame 2, and measures none in any other.
#include "honami.hpp"
#include <cstdlib>

class Dies : public honami::Tracker {
public:
  static constexpr honami::Info info{"org.test.dies", "Dies"};
  Dies(const honami::Values &, const honami::Stream &) {}

  void seed(const honami::Points &, const honami::Call &) override {}
  void retire(uint32_t) override {}
  void push(const honami::Frame &, honami::Rows &, const honami::Call &) override {}

  static honami::Field field(const honami::Values &, const honami::Frame &from, const honami::Frame &, const honami::Call &) {
    if (from.index == 2) std::abort();
    return honami::Field(0.0f, 0.0f, 8.0f, uint32_t(from.width / 8), uint32_t(from.height / 8));
  }
};

HONAMI_LIBRARY("org.test.dies", "1.0.0", "MIT", Dies);
