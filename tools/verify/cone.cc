#include "tools/verify/cone.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "sim/api/contact_frame.h"
#include "sim/contact/kernel.h"
#include "sim/core/math.h"
#include "sim/effects/install.h"
#include "tools/dataset/record/encoder.h"
#include "tools/registry/sensor_catalogue.h"

namespace slipbench::verify {
namespace {

using Property = bool ConeLaw::*;

// Properties of the law that a change by an effect removes.
struct Exemption {
  Change change;
  std::vector<Property> lost;
  const char* why;  // {}: the effect
};

const std::vector<Exemption>& exemptions() {
  static const std::vector<Exemption> all{
      {Change::static_friction,
       {&ConeLaw::limit},
       "f_t of stick and partial, and the value of margin: {} changes the static friction, but mu_static is that of the scene"},
      {Change::kinetic_friction,
       {&ConeLaw::slip_most, &ConeLaw::slip_least},
       "f_t of slip: {} changes the kinetic friction, but mu_kinetic is that of the scene"},
      {Change::less_kinetic_friction, {&ConeLaw::slip_least}, "lower bound of slip: {} lowers mu_kinetic"},
      {Change::more_kinetic_friction,
       {&ConeLaw::slip_limit, &ConeLaw::slip_most},
       "upper bounds of slip and partial: {} adds to mu_kinetic, so slipping units may carry more than mu_static f_n"},
      {Change::tip_force,
       {&ConeLaw::moving_force},
       "f_t of slip, partial and detached: with {} the force of a moving tip includes that of its mass"},
      {Change::stick_force, {&ConeLaw::stuck_force}, "f_t of stick: with {} the force includes that of ringing elements"},
      {Change::normal_force, {}, nullptr}};
  return all;
}

bool has_sums(const PadLayout& layout) {
  return std::ranges::any_of(layout.units, [](const UnitRange& unit) { return unit.count > 1; });
}

// Largest error of a value by its rounding to float32.
double rounding(double value) { return std::max(0x1p-24 * std::abs(value), 0x1p-150); }

// Relative error of a force that is rotated into the contact plane, in double precision.
constexpr double of_rotation = 1e-14;

// A tip that friction strengthens with its speed creeps at any force beyond mu_s f_n; up to this share
// of it beyond, it counts as sticking (sim/contact/return_mapping.h).
constexpr double of_creep = 1e-6;

// Checks one sensor's labels.
class ConeCheck {
 public:
  ConeCheck(const ConeLaw& law, const SensorRecord& sensor, std::size_t trial, Verification& verification)
      : law_(law), sensor_(sensor), labels_(sensor.labels), trial_(trial), verification_(verification) {}

  void run() {
    for (std::size_t i = 0; i < labels_.unit_state.size(); ++i) check(i);
  }

 private:
  // A touching unit in one sample.
  struct Touch {
    std::size_t i;  // of the unit in the sample
    UnitState state;
    double tangential, normal;  // f_t, f_n [N]
    double slack;               // N, error of f_t
    bool is_friction;           // f_t is the unit's friction
  };

  void check(std::size_t i) {
    const auto state = static_cast<UnitState>(labels_.unit_state[i]);
    const float* const force = labels_.force.data() + 3 * i;
    const double tangential = math::hypot(static_cast<double>(force[0]), static_cast<double>(force[1]));
    const double normal = force[2];
    if (state == UnitState::detached) {
      if (std::abs(normal) > (law_.moving_force ? 0.0 : of_rotation * tangential))
        fail(i, "force", fmt::format("is detached, but f_n is {} N", normal));
      if (law_.moving_force && tangential != 0.0) fail(i, "force", fmt::format("is detached, but f_t is {} N", tangential));
      return;
    }
    verification_.count(Check::cone, 1);
    if (!law_.exact) return;
    const double slack = 2.0 * rounding(tangential) + of_rotation * (tangential + std::abs(normal)) +
                         labels_.k_tangential[i % labels_.units()] * kernel::shortest_slip;
    const bool is_friction = law_.one_plane && (state == UnitState::stick ? law_.stuck_force : law_.moving_force);
    const Touch touch{i, state, tangential, normal, slack, is_friction};
    if (law_.one_plane && normal < -slack) fail(i, "force", fmt::format("touches, but is pulled with {} N", -normal));
    if (is_friction && state == UnitState::slip) check_slip(touch);
    if (is_friction && state != UnitState::slip && is_limited(state)) check_stick(touch);
    check_margin(touch);
  }

  // True if mu_static f_n limits the friction of a unit in that state.
  [[nodiscard]] bool is_limited(UnitState state) const { return law_.limit && (state == UnitState::stick || law_.slip_limit); }

  // Error of f_t and of mu f_n [N].
  [[nodiscard]] double slack_of(const Touch& touch, double mu) const {
    return touch.slack + mu * (2.0 * rounding(touch.normal) + (law_.slip_limit ? 0.0 : of_creep * touch.normal));
  }

  void check_slip(const Touch& touch) {
    const double mu = labels_.mu_kinetic[touch.i % labels_.units()], friction = mu * touch.normal, slack = slack_of(touch, mu);
    if (law_.slip_most && touch.tangential > friction + slack)
      fail(touch.i, "force", fmt::format("slips at f_t = {} N, more than mu_kinetic f_n = {} N", touch.tangential, friction));
    if (law_.slip_least && touch.tangential < friction - slack)
      fail(touch.i, "force", fmt::format("slips at f_t = {} N, less than mu_kinetic f_n = {} N", touch.tangential, friction));
  }

  void check_stick(const Touch& touch) {
    const double mu = labels_.mu_static[touch.i % labels_.units()], most = mu * touch.normal;
    if (touch.tangential > most + slack_of(touch, mu))
      fail(touch.i, "force", fmt::format("sticks at f_t = {} N, more than mu_static f_n = {} N", touch.tangential, most));
  }

  void check_margin(const Touch& touch) {
    const double margin = labels_.margin[touch.i], mu = labels_.mu_static[touch.i % labels_.units()];
    const double most = mu * touch.normal, slack = slack_of(touch, mu);
    if (margin > 1.0) fail(touch.i, "margin", fmt::format("is {}, above 1", margin));
    // The friction exceeds its limit by -margin times the limit, which may be as little as the
    // slack. The limit, or less than it: mu_static f_n; if several faces carry f_n, mu_static of
    // what the whole force proves; if an effect changes the limit, f_t/(1 - margin).
    double limit = 0.0;
    if (law_.limit) limit = law_.one_plane ? most : mu / (1.0 + mu) * math::hypot(touch.tangential, touch.normal);
    if (!law_.limit && touch.is_friction) limit = touch.tangential / (1.0 - margin);
    if ((touch.state == UnitState::stick || law_.slip_limit) && -margin * limit > slack)
      fail(touch.i, "margin", fmt::format("is {}, below 0", margin));
    if (!law_.limit || !touch.is_friction || !(most > 0.0)) return;
    // Multiplied by mu_static f_n, whose rounding may exceed the force itself.
    if (std::abs((1.0 - margin) * most - touch.tangential) > slack + 2.0 * rounding(margin) * most)
      fail(touch.i, "margin", fmt::format("is {}, but 1 - f_t/(mu_static f_n) is {}", margin, 1.0 - touch.tangential / most));
  }

  void fail(std::size_t i, const char* array, const std::string& what) {
    verification_.fail(Check::cone, {trial_, fmt::format("{}/{}", label_group(sensor_.name), array), i / labels_.units()},
                       fmt::format("unit {}: {}", i % labels_.units(), what));
  }

  const ConeLaw& law_;
  const SensorRecord& sensor_;
  const LabelRecord& labels_;
  std::size_t trial_;
  Verification& verification_;
};

}  // namespace

ConeLaw cone_law(const Scene& scene, std::size_t index) {
  ConeLaw law;
  const auto leave_out = [&law](const std::vector<Property>& lost, const std::string& why) {
    for (const Property property : lost) law.*property = false;
    law.left_out.push_back(why);
  };
  if (scene.fidelity != "field") {
    leave_out({&ConeLaw::exact},
              fmt::format("all: fidelity {} satisfies the cone only to the solver's tolerance", scene.fidelity));
    return law;
  }
  for (const Named& effect : scene.effects) {
    for (const Change change : effect_kind(effect.name).changes) {
      const Exemption& exempt = *std::ranges::find(exemptions(), change, &Exemption::change);
      if (!exempt.lost.empty()) leave_out(exempt.lost, fmt::format(fmt::runtime(exempt.why), effect.name));
    }
  }
  const std::unique_ptr<Sensor> sensor = make_sensor(scene.sensors.at(index), scene.seed, 0);
  if (!has_sums(sensor->layout())) return law;
  if (!law.moving_force) {
    leave_out({&ConeLaw::stuck_force}, "f_t of stick: elements of the unit that are detached ring beside those that stick");
  }
  if (scene.dynamic() || scene.surface.name != "plane") {
    leave_out({&ConeLaw::one_plane}, "all except margin >= 0: elements of one unit touch faces with different directions");
  } else {
    leave_out({&ConeLaw::slip_least}, "lower bound of slip: a unit is the sum of elements with different directions");
  }
  return law;
}

void check_cone(const ConeLaw& law, const SensorRecord& sensor, std::size_t trial, Verification& verification) {
  for (const std::string& why : law.left_out) verification.leave_out(Check::cone, why);
  ConeCheck(law, sensor, trial, verification).run();
}

}  // namespace slipbench::verify
