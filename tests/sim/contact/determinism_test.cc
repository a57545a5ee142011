// Bit-identical results in every build: optimised or not, with AVX2 or without, sanitised or not.
// The test runs in all of them (release, ci and asan-ubsan in the suite; debug by hand) and
// compares with one pinned hash.
#include <bit>
#include <cstdint>

#include <gtest/gtest.h>

#include "sim/contact/contact_labels.h"
#include "sim/core/random.h"
#include "tests/oracle/pads.h"

namespace slipbench {
namespace {

class Hash {
 public:
  void add(double value) {
    state_ = (state_ ^ std::bit_cast<std::uint64_t>(value)) * 0x100000001b3U;  // FNV-1a, a word at a time
    state_ ^= state_ >> 29U;
  }
  [[nodiscard]] std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0xcbf29ce484222325U;
};

// A turn about Z by 2 atan(h), by divisions alone, because libraries' sine and cosine may differ in
// the last bit between processors.
Pose turned(double h, double x, double y, double z) {
  const double c = (1.0 - h * h) / (1.0 + h * h), s = 2.0 * h / (1.0 + h * h);
  Pose pose;
  pose.rotation << c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0;
  pose.position = {x, y, z};
  return pose;
}

std::uint64_t hash_of_run(const Surface& surface, double height, double dashpot) {
  PadLayout pad = oracle::nine_pillars(6);
  for (Element& element : pad.elements) element.c_normal = element.c_tangential = dashpot;
  Field field(pad, surface, {0.6, 0.45});
  ContactLabels labels(field.layout());
  RandomStream draw(5, 0, "walk");
  Hash hash;
  double h = 0.0, x = 0.0, y = 0.0, z = 0.5e-3;
  for (int step = 0; step < 4000; ++step) {
    h += draw.uniform(-1e-3, 1.2e-3);
    x += draw.uniform(-20e-6, 22e-6);
    y += draw.uniform(-20e-6, 21e-6);
    z += draw.uniform(-10e-6, z < -1e-3 ? 12e-6 : 9e-6);
    field.step(turned(h, x, y, height + z), 1e-3);
    const ContactFrame& frame = labels.update({&field, 1}, 1e-3 * step, 1e-3);
    for (Eigen::Index unit = 0; unit < 9; ++unit) {
      for (Eigen::Index k = 0; k < 3; ++k) hash.add(frame.force(k, unit));
      hash.add(frame.slip_distance[unit]);
    }
    for (const ContactEvent& event : frame.events) hash.add(event.time);
  }
  return hash.value();
}

TEST(Determinism, HashOfARunIsThatOfEveryBuild) {
  // Pinned, not derived: a change of the law changes them, and they must be pinned again.
  EXPECT_EQ(hash_of_run(Plane{}, 0.0, 0.0), 0x53c010649cb4e26fU);
  EXPECT_EQ(hash_of_run(Sphere{0.1}, 0.1, 0.0), 0x7440c16d7ca12beeU);
  EXPECT_EQ(hash_of_run(Plane{}, 0.0, 2.0), 0x2ebba0f63e504b79U);
}

}  // namespace
}  // namespace slipbench
