#include "tools/benchmark/control.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>

#include "sim/api/motion.h"
#include "sim/core/math.h"
#include "sim/core/math/rotation.h"
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
    if (reports && control_.once) control_.until = frame.time;
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

Control motion_known(const Scene& scene, const std::string& mover) {
  const Parameters& motion = scene.motion.parameters;
  if (scene.grasp) return {.from = lift_times(motion).start};
  if (!mover.empty()) {
    const std::vector<ControlScene::Point>& points = std::ranges::find(scene.controls, mover, &ControlScene::actuator)->points;
    const auto moves = std::ranges::adjacent_find(points, std::ranges::not_equal_to{}, &ControlScene::Point::value);
    return {.from = moves == points.end() ? never : moves->time};
  }
  if (motion.number("speed") == 0.0 && motion.number("rotation") == 0.0) return {};
  return {.from = motion.number("start"), .until = motion.number("start") + way_time(motion)};
}

double HandMotion::passes(double distance) const {
  const auto first = std::ranges::find_if(travel, [distance](double way) { return way >= distance; });
  return first == travel.end() ? never : step * static_cast<double>(first - travel.begin());
}

HandMotion hand_motion(const Scene& scene, const std::string& mover) {
  HandMotion hand;
  hand.start = motion_known(scene, mover).from;
  std::function<double(double)> travel;
  if (mover.empty()) {
    const std::shared_ptr<const Motion> motion = stage_motion().create(scene.motion.parameters, {});
    const Pose begin = motion->pad_at(hand.start).pose;
    travel = [motion, begin](double time) {
      constexpr double arm = 0.01;  // m, where a turn is counted
      const Pose now = motion->pad_at(time).pose;
      const Eigen::Vector3d way = now.position - begin.position;
      return math::hypot(way.x(), way.y()) + arm * rotation_vector(now.rotation * begin.rotation.transpose()).norm();
    };
  } else {
    const std::vector<ControlScene::Point>& points = std::ranges::find(scene.controls, mover, &ControlScene::actuator)->points;
    travel = [&points](double time) {
      const auto next = std::ranges::upper_bound(points, time, {}, &ControlScene::Point::time);
      if (next == points.begin()) return 0.0;
      const ControlScene::Point& last = *std::prev(next);
      const double share = next == points.end() ? 0.0 : (time - last.time) / (next->time - last.time);
      return std::abs(last.value + share * ((next == points.end() ? last : *next).value - last.value) - points.front().value);
    };
  }
  for (double time = 0.0; time <= scene.duration; time = HandMotion::step * static_cast<double>(hand.travel.size())) {
    const double way = time < hand.start ? 0.0 : travel(time);
    if (!hand.travel.empty()) hand.top_speed = std::max(hand.top_speed, (way - hand.travel.back()) / HandMotion::step);
    hand.travel.push_back(way);
  }
  return hand;
}

Control informed_control(SideInformation side_information, const TestSet& test_set, const Scene& scene) {
  if (side_information == SideInformation::clock) return {.from = test_set.clock, .once = true};
  if (side_information == SideInformation::motion) return motion_known(scene, test_set.mover);
  if (side_information == SideInformation::motion_and_time) {
    const double from = motion_known(scene, test_set.mover).from;
    return scene.grasp ? Control{.from = from, .until = from + test_set.time}
                       : Control{.from = from + test_set.time, .once = true};
  }
  const HandMotion hand = hand_motion(scene, test_set.mover);
  if (side_information == SideInformation::travel) return {.from = hand.passes(test_set.travel), .once = true};
  return {.from = hand.top_speed >= test_set.speed ? hand.start + test_set.speed_time : never, .once = true};
}

double judged_from(const TestSet& test_set, const Scene& scene) {
  if (!test_set.disturbance.empty()) return -never;
  return motion_known(scene, test_set.mover).from;
}

}  // namespace slipbench::benchmark
