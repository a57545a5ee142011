// A round object between two pads of one element each, against closed forms. The element sticks to
// a point of the object, and its force follows the object's surface there. Where the object is off
// the line of the pads by y, the surface is inclined by y/r:
//   lateral force of both pads: 2 (N y/r - k_t y)
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/sim/mujoco/bodies/dynamic_rig.h"

namespace slipbench::round_object_test {
namespace {

constexpr double k_t = 5e3;      // N/m
constexpr double radius = 0.01;  // m
constexpr double mu = 0.5, g = 9.81;

// Fingers that begin 0.1 mm inside an object of that radius.
std::string fingers(const std::string& options) {
  const auto finger = [](const char* name, int side) {
    return fmt::format(
        "<body name='{0}_finger' pos='{1} 0 0.1'><joint name='{0}' type='slide' axis='{2} 0 0' damping='5'/>"
        "<geom type='box' pos='{3} 0 0' size='0.005 0.012 0.012' mass='0.05'/><site name='{0}_pad' zaxis='{4} 0 0'/></body>",
        name, side * (radius - 1e-4), -side, 0.01 * side, side);
  };
  return "<mujoco><option " + options + "/><worldbody>" + finger("left", -1) + finger("right", 1) +
         "</worldbody><actuator><motor name='left' joint='left'/><motor name='right' joint='right'/></actuator></mujoco>";
}

// `grip`: rows of time and force of each finger.
std::string held(const std::string& object, double friction, const std::string& grip, double duration) {
  std::string text = fmt::format(
      "duration: {} s\ntime_step: auto\nfriction: {{static: {}, kinetic: {}}}\nmodel: fingers.xml\nbodies: {{object: {{{}}}}}\n"
      "controls: {{left: {}, right: {}}}\nsensors:\n",
      duration, friction, friction, object, grip, grip);
  for (const char* side : {"left", "right"}) {
    text += fmt::format(
        "  {0}: {{type: taxels, rate: 1 kHz, site: {0}_pad, touches: [object], rows: 1, columns: 1, k_normal: 50 N/mm, "
        "k_tangential: {1} N/m, max_force: 100 N}}\n",
        side, k_t);
  }
  return text;
}

// A rod without weight, 0.02 mm off the line of the pads. The lateral force drives it out where N >
// k_t r = 50 N. At 45 N the offset is at rest at 0.02 mm/(1 - 45/50) = 0.2 mm and swings to at most
// twice that, undamped; at 55 N it grows as exp(t sqrt(2 (N/r - k_t)/m)) = exp(100 t/s).
TEST(RoundObject, BucklesWhereTheGripExceedsStiffnessTimesRadius) {
  const auto largest_offset = [](double grip) {
    const ModelFolder folder;
    folder.write("fingers.xml", fingers("gravity='0 0 0' integrator='implicitfast'"));
    DynamicRig rig(held("shape: cylinder, radius: 10 mm, length: 60 mm, mass: 100 g, position: [0 mm, 0.02 mm, 100 mm]", 1.5,
                        fmt::format("[[0 s, 5 N], [0.5 s, {} N]]", grip), 0.8),
                   folder.file("scene.yaml"));
    double largest = 0.0;
    for (int k = 0; k < 80; ++k) {
      rig.run_to(0.01 * k);
      largest = std::max(largest, std::abs(rig.body("object").pose.position.y()));
    }
    return largest;
  };
  EXPECT_LT(largest_offset(0.9 * k_t * radius), 1e-3);
  EXPECT_GT(largest_offset(1.1 * k_t * radius), 0.5 * radius);
}

// A sphere sags until T = k_t sag, which inclines the surface by T/(k_t r). Balance along the
// weight: T - N T/(k_t r) = m g/2, and slip begins at T = mu N:
//   N (1 - N/(k_t r)) = m g/(2 mu), so that N = k_t r/2 (1 - sqrt(1 - 4 m g/(2 mu k_t r)))
// The pad presses with N along the inclined normal and T across it, so its force along the line of
// the pads is F = N + T T/(k_t r). For 200 g, N is 2.0457 N and F 2.067 N, 5.3 % more than m g/(2
// mu) = 1.962 N, which holds a box. Samples come every ms while the grip falls by 1.6 N/s: 0.1 %.
TEST(RoundObject, NeedsMoreGripThanABox) {
  constexpr double mass = 0.2, flat = mass * g / (2.0 * mu), reach = k_t * radius;
  const double round = 0.5 * reach * (1.0 - std::sqrt(1.0 - 4.0 * flat / reach));
  const double grip = round * (1.0 + mu * mu * round / reach);
  EXPECT_NEAR(grip / flat, 1.053, 1e-3);
  const auto slips_at = [&](const std::string& shape) {
    const ModelFolder folder;
    folder.write("fingers.xml", fingers("integrator='implicitfast'"));
    DynamicRig rig(held(shape + ", mass: 200 g, position: [0 mm, 0 mm, 100 mm]", mu, "[[0.3 s, 4 N], [1.8 s, 1.6 N]]", 1.8),
                   folder.file("scene.yaml"));
    for (int k = 300; k < 1800; ++k) {
      rig.run_to(1e-3 * k);
      if (rig->contact(0).state == PadState::gross) return rig->contact(0).force(2, 0);
    }
    return 0.0;
  };
  EXPECT_NEAR(slips_at("shape: sphere, radius: 10 mm"), grip, 3e-3 * grip);
  EXPECT_NEAR(slips_at("shape: box, size: [20 mm, 40 mm, 60 mm]"), flat, 3e-3 * flat);
}

}  // namespace
}  // namespace slipbench::round_object_test
