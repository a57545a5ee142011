#include "controllers/grip.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "sim/core/error.h"

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

VectorChannel::VectorChannel(const std::vector<Channel>& channels, const std::string& name, const std::string& controller) {
  for (const Channel& channel : channels) {
    if (channel.name == name && channel.shape.size() == 2 && channel.shape[1] == 3) {
      first_ = frame_size_;
      units_ = channel.shape[0];
    }
    frame_size_ += channel.size();
  }
  if (units_ == 0) {
    throw SceneValueError("controller.type", quote(controller) + " reads a channel '" + name +
                                                 "' [N, 3] and the sensor has: " + described(channels));
  }
}

UnitVector VectorChannel::unit(const SensorFrame& frame, std::size_t i) const {
  if (frame.values.size() != frame_size_) throw std::logic_error("a controller was handed a frame of another size");
  return UnitVector(frame.values.subspan(first_ + 3 * i, 3));
}

double GripForce::normal(const SensorFrame& frame, std::size_t unit) const { return force_.unit(frame, unit)[2]; }

double GripForce::tangential(const SensorFrame& frame, std::size_t unit) const {
  const UnitVector force = force_.unit(frame, unit);
  return std::hypot(double{force[0]}, double{force[1]});
}

double GripForce::total(const SensorFrame& frame) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < units(); ++i) sum += normal(frame, i);
  if (!std::isfinite(sum)) {
    throw InputError("controller " + controller_ + ": the sensor's normal forces sum up to " + format_number(sum) +
                     " N at t = " + format_quantity(frame.time, Quantity::time) + "; allowed: finite forces");
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

ParameterSpec declared(std::string name, ParameterType type, Quantity quantity, std::string default_text, Range range,
                       std::string doc, std::string source) {
  return {.name = std::move(name),
          .type = type,
          .quantity = quantity,
          .default_text = std::move(default_text),
          .range = range,
          .choices = {},
          .size = 1,
          .doc = std::move(doc),
          .source = std::move(source)};
}

ParameterSpec declared_choice(std::string name, std::string default_text, std::vector<std::string> choices, std::string doc,
                              std::string source) {
  ParameterSpec spec = declared(std::move(name), ParameterType::choice, Quantity::none, std::move(default_text), any_value,
                                std::move(doc), std::move(source));
  spec.choices = std::move(choices);
  return spec;
}

void refuse_without_detector(const std::string& controller) {
  throw SceneValueError("controller.type",
                        controller + " needs what a detector says, and the scene has none; allowed: a detector");
}

ParameterSpec force_per_count_spec() {
  return declared("force_per_count", ParameterType::number, Quantity::force, "1.6 N", positive,
                  "Grip force that one count of position is taken to be worth; no less than what the gripper really has.",
                  "assumed: the published ratios of maximum to ideal force fit no more than about 1.6 N a count");
}

ParameterSpec ceiling_spec() {
  return declared("ceiling", ParameterType::number, Quantity::force, "inf", positive_or_infinite,
                  "No count is added that would take the measured grip force beyond this; what is gripped harder is not let go.",
                  "published: none");
}

ParameterSpec loosen_spec() {
  return declared("loosen", ParameterType::flag, Quantity::none, "false", any_value,
                  "Open again when the target force falls by a count or more; without it the position never falls.", "assumed");
}

ParameterSpec touch_spec() {
  return declared("touch", ParameterType::number, Quantity::force, "0.05 N", positive,
                  "Normal force from which a pillar counts as touching: the ratio of a few mN to a few mN says nothing.",
                  "assumed");
}

std::vector<ParameterSpec> with_registers(std::vector<ParameterSpec> specs) {
  constexpr Range byte{.min = 0.0, .max = double{max_register}, .open_min = false};
  const std::string source = "HD-computing slip paper, published HDL (control_gripper.sv): 0";
  specs.push_back(declared("speed_register", ParameterType::integer, Quantity::none, "0", byte,
                           "rSP of every command, 0 the slowest.", source));
  specs.push_back(declared("force_register", ParameterType::integer, Quantity::none, "0", byte,
                           "rFR of every command, 0 the weakest.", source));
  return specs;
}

GripCommand registers_of(const Parameters& parameters) {
  return {.position = 0,
          .speed = static_cast<int>(parameters.integer("speed_register")),
          .force = static_cast<int>(parameters.integer("force_register"))};
}

}  // namespace slipbench::controllers
