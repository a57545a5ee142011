#include "tools/program/benchmark/control.h"

#include <algorithm>
#include <memory>

#include "sim/motion/lift.h"
#include "tools/program/catalogue/detector_catalogue.h"
#include "tools/program/eval/detector_choice.h"

namespace slipbench::benchmark {
namespace {

class Control final : public Detector {
 public:
  explicit Control(const Parameters& parameters) : from_(parameters.number("from")), until_(parameters.number("until")) {}

  const SlipEstimate& update(const SensorFrame& frame) override {
    estimate_.time = frame.time;
    estimate_.state = frame.time >= from_ && frame.time < until_ ? PadState::gross : PadState::non_slip;
    return estimate_;
  }

 private:
  double from_, until_;
  SlipEstimate estimate_;
};

Entry control_entry() {
  constexpr Range time{0.0, never, false, true};
  const std::string source = "free: what a clock knows";
  return {control_type,
          "Says slip between two instants, whatever is felt.",
          "",
          "none: a negative control",
          {number_spec("from", Quantity::time, "0 s", time, "When slip is said first.", source),
           number_spec("until", Quantity::time, "inf", time, "When it is said no longer.", source)}};
}

// How long a stage moves sideways or turns [s].
double way_time(const Parameters& motion) {
  const double travel = motion.number("travel") * static_cast<double>(motion.integer("strokes"));
  return std::min(motion.number("stop"), motion.number("speed") > 0.0 ? travel / motion.number("speed") : never);
}

}  // namespace

void register_control() {
  register_detector(control_entry(), [](const Parameters& parameters, const FrameSource& source) {
    static_cast<void>(source);
    return std::make_unique<Control>(parameters);
  });
}

DetectorScene control_of(double from, double until) {
  DetectorScene detector = eval::chosen_detector(control_type, {});
  detector.parameters.set("from", from);
  detector.parameters.set("until", until);
  return detector;
}

DetectorScene motion_known(const Scene& scene, const std::string& mover) {
  const Parameters& motion = scene.motion.parameters;
  if (scene.grasp) return control_of(lift_times(motion).start, never);
  if (!mover.empty()) {
    const std::vector<ControlScene::Point>& points = std::ranges::find(scene.controls, mover, &ControlScene::actuator)->points;
    const auto moves = std::ranges::adjacent_find(points, std::ranges::not_equal_to{}, &ControlScene::Point::value);
    return control_of(moves == points.end() ? never : moves->time, never);
  }
  if (motion.number("speed") == 0.0 && motion.number("rotation") == 0.0) return control_of(never, never);
  return control_of(motion.number("start"), motion.number("start") + way_time(motion));
}

DetectorScene motion_known_and(double time, const Scene& scene, const std::string& mover) {
  const DetectorScene known = motion_known(scene, mover);
  const double from = known.parameters.number("from"), until = known.parameters.number("until");
  return scene.grasp ? control_of(from, from + time) : control_of(from + time, until);
}

}  // namespace slipbench::benchmark
