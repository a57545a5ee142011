#include "controllers/grip.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "sim/core/error.h"
#include "sim/core/math.h"
#include "sim/core/readable_quantity.h"

namespace slipbench::controllers {
namespace {

std::string described(const std::vector<Channel>& channels) {
  std::string text;
  for (const Channel& channel : channels) {
    text += (text.empty() ? "" : ", ") + channel.name + " [";
    for (std::size_t i = 0; i < channel.shape.size(); ++i) text += (i == 0 ? "" : ", ") + std::to_string(channel.shape[i]);
    text += "]";
  }
  return text.empty() ? "nothing" : text;
}

}  // namespace

VectorChannel::VectorChannel(const std::vector<Channel>& channels, const std::string& name, const std::string& unit,
                             const std::string& controller) {
  for (const Channel& channel : channels) {
    if (channel.name == name && channel.shape.size() == 2 && channel.shape[1] == 3) {
      if (channel.unit != unit) {
        throw SceneValueError("controller.type", quote(controller) + " reads the channel '" + name + "' in " + unit +
                                                     ", but the sensor has it in " + quote(channel.unit));
      }
      first_ = frame_size_;
      units_ = channel.shape[0];
    }
    frame_size_ += channel.size();
  }
  if (units_ == 0) {
    throw SceneValueError("controller.type", quote(controller) + " needs a channel '" + name +
                                                 "' [N, 3], but the sensor has: " + described(channels));
  }
}

UnitVector VectorChannel::unit(const SensorFrame& frame, std::size_t i) const {
  if (frame.values.size() != frame_size_) throw std::logic_error("a controller received a frame of another size");
  return UnitVector(frame.values.subspan(first_ + 3 * i, 3));
}

double GripForce::normal(const SensorFrame& frame, std::size_t unit) const { return force_.unit(frame, unit)[2]; }

double GripForce::tangential(const SensorFrame& frame, std::size_t unit) const {
  const UnitVector force = force_.unit(frame, unit);
  return math::hypot(double{force[0]}, double{force[1]});
}

double GripForce::total(const SensorFrame& frame) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < units(); ++i) sum += normal(frame, i);
  if (!std::isfinite(sum)) {
    throw SceneValueError("controller", quote(controller_) + ": the sum of the sensor's normal forces is " + format_number(sum) +
                                            " N at t = " + readable_quantity(frame.time, Quantity::time) + "; it must be finite");
  }
  return sum;
}

int moved(int position, double counts) { return static_cast<int>(std::clamp(position + counts, 0.0, double{max_register})); }

ForceFollower::ForceFollower(const Parameters& parameters)
    : force_per_count_(parameters.number("force_per_count")),
      ceiling_(parameters.number("ceiling")),
      loosen_(parameters.flag("loosen")) {}

int ForceFollower::toward(double grip, double target, int measured) {
  if (position_ < 0) position_ = measured;
  if (grip < target) {
    const double wanted = std::ceil((target - grip) / force_per_count_);
    const double counts = std::max(0.0, std::min(wanted, std::floor((ceiling_ - grip) / force_per_count_)));
    const int position = moved(measured, counts);
    position_ = loosen_ ? position : std::max(position_, position);
  } else if (loosen_ && grip >= target + force_per_count_) {
    position_ = moved(measured, -std::floor((grip - target) / force_per_count_));
  }
  return position_;
}

GripController::GripController(const Parameters& parameters, const GripSource& source, const std::string& name,
                               bool waits_for_detector)
    : force_(source.channels, name), preset_(source.preset), command_(registers_of(parameters)) {
  if (waits_for_detector && !source.detected)
    throw SceneValueError("controller.type", name + " needs a detector, but the scene has none");
}

ParameterSpec force_per_count_spec() {
  return number_spec("force_per_count", Quantity::force, "1.6 N", positive,
                     "Assumed change of the grip force for one count of position, at least the gripper's real change.",
                     "assumed: the published ratios of maximum to ideal force fit at most about 1.6 N a count");
}

ParameterSpec ceiling_spec() {
  return number_spec("ceiling", Quantity::force, "inf", positive_or_infinite,
                     "Grip force above which no count is added; a stronger grip is not loosened.",
                     "the published controller has none");
}

ParameterSpec loosen_spec() {
  return flag_spec(
      "loosen", "false",
      "True: the fingers open again when the target force falls by a count or more; false: the position never falls.", "assumed");
}

ParameterSpec touch_spec() {
  return number_spec("touch", Quantity::force, "0.05 N", positive,
                     "Normal force above which a pillar counts as touching; the ratio of two forces of a few mN is meaningless.",
                     "assumed");
}

std::vector<ParameterSpec> with_registers(std::vector<ParameterSpec> specs) {
  constexpr Range byte{0.0, double{max_register}};
  const std::string source = "HD-computing slip paper, published HDL (control_gripper.sv): 0";
  return joined(std::move(specs), {integer_spec("speed_register", "0", byte, "rSP of every command; 0: the slowest.", source),
                                   integer_spec("force_register", "0", byte, "rFR of every command; 0: the weakest.", source)});
}

GripCommand registers_of(const Parameters& parameters) {
  return {.position = 0,
          .speed = static_cast<int>(parameters.integer("speed_register")),
          .force = static_cast<int>(parameters.integer("force_register"))};
}

}  // namespace slipbench::controllers
