// A pad driven over a free box that lies on another pad: slow and fast, to and fro; and a box
// between fingers of another mass.

#include "tests/stability/hard_case.h"

namespace slipbench::hard {
namespace {

std::string stacked_scene(const std::string& motion, double duration, double damping) {
  return "slipbench: 1\nmodel: box.xml\nduration: " + exact(longest_sample * std::ceil(duration / longest_sample)) +
         " s\ntime_step: auto\nfriction: {static: 0.2, kinetic: 0.2}\nsensors:\n  top: {type: papillarray, touches: [box], damping: " +
         exact(damping) + " s}\n  bottom: {type: papillarray, site: pad, touches: [box], damping: " + exact(damping) +
         " s}\nmotion: {compression: 0.04 mm, gap: 0.05 mm, start: 0.5 s, acceleration: inf, " + motion + "}\n";
}

// The pad above carries N and slides with mu N; the pad below carries N + m g and sticks, so its
// springs yield by mu N/K_t. The same holds at any speed, and after reversal with the opposite
// sign. The box leans under the two, so N is the force on its face.
class Slide : public ::testing::TestWithParam<double> {};

TEST_P(Slide, PullsWithMuTimesTheLoadAtAnySpeedAndBothWays) {
  const double speed = GetParam();
  BoxOnPad box;
  box.mu = 0.2;
  box.position.z() = -sag_of(box);
  box.turn = {1e-4, 0.6e-4, 4e-3};
  const double there = std::max(0.1, 0.3e-3 / speed), back = std::max(0.1, 0.45e-3 / speed);
  CaseRun run(stacked_scene("speed: " + exact(speed) + " m/s, reverse: " + exact(there) + " s", 0.5 + there + back + 0.01, 4e-4),
              "box.xml", stacked_model(box), {&box.pad, &box.pad});
  for (const double at : {0.5 + there, 0.5 + there + back}) {
    run.to(at - 0.001);
    const Eigen::Vector3d above = run.force(0), below = run.force(1);
    const double way = at < 0.6 + there ? 1.0 : -1.0;
    EXPECT_EQ(run->contact(0).state, PadState::gross);
    EXPECT_EQ(run->contact(1).state, PadState::non_slip);
    const Eigen::Vector3d on_face = run.body("box").pose.rotation.transpose() * above;
    EXPECT_NEAR(on_face.head<2>().norm(), 0.2 * -on_face.z(), 1e-6 * -on_face.z());
    EXPECT_GT(way * above.x(), 0.0);
    EXPECT_LT((above + below - Eigen::Vector3d(0.0, 0.0, box.mass * g)).norm(), 1e-3 * box.mass * g);
  }
}

INSTANTIATE_TEST_SUITE_P(Stability, Slide, ::testing::Values(1e-4, 1e-3, 1e-2, 1e-1));

// A finger on a guide presses with 5 N on the box, which lies on the pad.
struct Ratio {
  double finger, box;  // kg
};
class MassRatio : public ::testing::TestWithParam<Ratio> {};

TEST_P(MassRatio, OfOneToAThousandIsCarriedOrRefused) {
  const auto [finger, mass] = GetParam();
  BoxOnPad box;
  box.mass = mass;
  box.position.z() = -sag_of(box);
  box.turn = {1e-4, 0.6e-4, 4e-3};
  const std::string model = fingered_model(box, finger);
  const double fastest = fastest_of_ratio(finger, mass);
  // tau omega is at most 0.4
  const auto scene = [&](const std::string& step) {
    return "slipbench: 1\nmodel: box.xml\nduration: 4 s\ntime_step: " + step +
           "\nfriction: {static: 0.5, kinetic: 0.5}\ncontrols: {press: [[0.1 s, 0 N], [0.3 s, 5 N]]}\nsensors:\n"
           "  top: {type: papillarray, site: finger, touches: [box], damping: " +
           exact(0.4 / fastest) +
           " s}\n  bottom: {type: papillarray, site: pad, touches: [box], damping: " + exact(0.4 / fastest) + " s}\n";
  };
  const std::string said = refusal_of([&] { CaseRun run(scene("1 ms"), "box.xml", model, {&box.pad, &box.pad}); });
  EXPECT_THAT(said, HasSubstr("1 ms is too long for explicit springs of the pads"));
  EXPECT_THAT(said, HasSubstr("allowed: up to "));
  CaseRun run(scene("auto"), "box.xml", model, {&box.pad, &box.pad});
  run.to_end();
  EXPECT_NEAR(-run.force(0).z(), 5.0 + finger * g, 1e-3 * finger * g);
  EXPECT_NEAR(run.force(1).z(), 5.0 + (finger + mass) * g, 1e-3 * mass * g);
}

INSTANTIATE_TEST_SUITE_P(Stability, MassRatio, ::testing::Values(Ratio{1e-3, 1.0}, Ratio{1.0, 1e-3}));

}  // namespace
}  // namespace slipbench::hard
