#include "tools/benchmark/control.h"

#include <algorithm>

#include "sim/motion/motion_catalogue.h"

namespace slipbench::benchmark {
namespace {

class ControlDetector final : public Detector {
 public:
  explicit ControlDetector(const Control& control) : control_(control) {}

  const SlipEstimate& update(const SensorFrame& frame) override {
    estimate_.time = frame.time;
    const bool reports = frame.time >= control_.from && frame.time < control_.until;
    estimate_.state = reports ? PadState::gross : PadState::non_slip;
    return estimate_;
  }

 private:
  Control control_;
  SlipEstimate estimate_;
};

// Returns how long a stage moves sideways or turns [s].
double way_time(const Parameters& motion) {
  const double travel = motion.number("travel") * static_cast<double>(motion.integer("strokes"));
  return std::min(motion.number("stop"), motion.number("speed") > 0.0 ? travel / motion.number("speed") : never);
}

}  // namespace

std::unique_ptr<Detector> make_detector(const Control& control) { return std::make_unique<ControlDetector>(control); }

Control motion_known(const TestSet& test_set, const Scene& scene) {
  const Parameters& motion = scene.motion.parameters;
  if (scene.grasp) {
    const double lift = lift_times(motion).start;
    return {.from = lift, .until = lift + test_set.time};
  }
  if (!test_set.mover.empty()) {
    const std::vector<ControlScene::Point>& points =
        std::ranges::find(scene.controls, test_set.mover, &ControlScene::actuator)->points;
    const auto moves = std::ranges::adjacent_find(points, std::ranges::not_equal_to{}, &ControlScene::Point::value);
    return {.from = moves == points.end() ? never : moves->time};
  }
  if (motion.number("speed") == 0.0 && motion.number("rotation") == 0.0) return {};
  return {.from = motion.number("start"), .until = motion.number("start") + way_time(motion)};
}

double judged_from(const TestSet& test_set, const Scene& scene) {
  if (!test_set.disturbance.empty()) return -never;
  return motion_known(test_set, scene).from;
}

}  // namespace slipbench::benchmark
