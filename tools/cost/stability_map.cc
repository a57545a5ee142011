#include "tools/cost/stability_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <ranges>
#include <utility>

#include <fmt/format.h>

#include "sim/mujoco/pads/register_plugin.h"
#include "sim/mujoco/pads/step_probe.h"
#include "tools/cost/reading.h"
#include "tools/registry/program_catalogues.h"
#include "tools/registry/sensor_catalogue.h"

namespace slipbench::cost {
namespace {

constexpr double real_k_normal = 7100.0, real_k_tangential = 3900.0;  // N/m, of a PapillArray pillar
constexpr int pillars = 9;
constexpr double g = 9.81;  // m/s2

// A model and its initial velocity disturbance.
struct Probed {
  std::string model;
  std::vector<double> kick;
};

// One combination to measure; stiffness per element.
struct Parameters {
  double mass, k_normal, k_tangential, damping;
  std::string integrator;
};

// Nine flat elements with a spacing of `pitch` [m].
std::string pad(const std::string& name, const std::string& site, double pitch, const Parameters& p, double damping) {
  std::string rows;
  for (int i = 0; i < pillars; ++i) {
    const int row = i / 3 - 1, column = i % 3 - 1;
    rows +=
        fmt::format("{}[{}, {}, 0, {}, {}]", rows.empty() ? "" : ", ", pitch * row, pitch * column, p.k_normal, p.k_tangential);
  }
  return fmt::format(
      "<instance name='{}'><config key='pad' value='{}'/><config key='touch' value='box'/><config key='elements' value='[{}]'/><config key='friction' value='{{static: 1}}'/><config key='damping' value='{} s'/></instance>",
      name, site, rows, damping);
}

std::string model_of(const std::string& integrator, double gravity, const std::string& pads, const std::string& world) {
  return fmt::format(
      "<mujoco><compiler angle='radian'/><option integrator='{}' gravity='0 0 {}'/><extension><plugin plugin='{}'>{}</plugin></extension><default><geom contype='0' conaffinity='0'/></default><worldbody>{}</worldbody></mujoco>",
      integrator, -gravity, bench_plugin_name, pads, world);
}

// A free box of half widths `half` [m] with its centre of mass at `position`. Its geom is slightly
// offset and turned by 4 mrad about `axis`, the pads' normal: the box is asymmetric, but still in
// equilibrium.
std::string box(double mass, const std::array<double, 3>& half, const std::string& position, const std::string& beside,
                const std::string& axis) {
  const auto inertia = [&](double a, double b) { return mass * (a * a + b * b) / 3.0; };
  return fmt::format(
      "<body name='box' pos='{}'><freejoint/><inertial pos='0 0 0' mass='{}' diaginertia='{} {} {}'/><geom name='box' type='box' pos='{}' axisangle='{} 0.004' size='{} {} {}'/></body>",
      position, mass, inertia(half[1], half[2]), inertia(half[0], half[2]), inertia(half[0], half[1]), beside, axis, half[0],
      half[1], half[2]);
}

// Velocity that excites every mode of a free body. `reach`: m, about its radius of gyration.
std::vector<double> kick_of(double speed, double reach) {
  return {0.6 * speed, -0.5 * speed, 0.8 * speed, 0.7 * speed / reach, 0.4 * speed / reach, -0.6 * speed / reach};
}

// A thousand times this speed moves the body by 1 % of `depth` [m], the compression of the
// elements, and gives dashpots 1 % of the normal load.
double kick_speed(double depth, double stiffness, double mass, double damping) {
  const double omega = std::sqrt(stiffness / mass);
  return 1e-5 * depth * omega / (1.0 + damping * omega);
}

// Held between two fixed pads, compressed by 10 um. `right`: damping of the second pad [s].
Probed held(const Parameters& p, double right) {
  const double depth = 1e-5, pitch = 0.007;
  const std::array<double, 3> half{0.015, 0.02, 0.06};
  const std::string world =
      box(p.mass, half, "0 0 0", "0 0.13e-3 0.17e-3", "1 0 0") +
      fmt::format("<site name='left' pos='{} 0 0' zaxis='-1 0 0'/><site name='right' pos='{} 0 0' zaxis='1 0 0'/>",
                  -half[0] + depth, half[0] - depth);
  const double speed = kick_speed(depth, 2 * pillars * p.k_normal, p.mass, p.damping);
  return {model_of(p.integrator, 0.0, pad("left", "left", pitch, p, p.damping) + pad("right", "right", pitch, p, right), world),
          kick_of(speed, 0.03)};
}

constexpr double wide_pitch = 0.02;                      // m; so wide that 5 kg do not tip over on the softest pad
constexpr std::array<double, 3> wide{0.04, 0.04, 0.02};  // m
constexpr double low = 1e-3;                             // m, height of the centre of mass above the face

std::string lower_site() { return "<site name='lower' zaxis='0 0 -1'/>"; }

// Rests on a fixed pad by its weight.
Probed carried(const Parameters& p) {
  const double stiffness = pillars * p.k_normal, sag = p.mass * g / stiffness;
  const std::string world =
      box(p.mass, wide, fmt::format("0 0 {}", low - sag), fmt::format("0.13e-3 -0.21e-3 {}", wide[2] - low), "0 0 1") +
      lower_site();
  return {model_of(p.integrator, g, pad("lower", "lower", wide_pitch, p, p.damping), world),
          kick_of(kick_speed(sag, stiffness, p.mass, p.damping), 0.03)};
}

// Between a fixed pad and the pad of a 0.5 kg finger that slides down a guide with a damper of 50 N
// s/m.
Probed pressed(const Parameters& p) {
  const double finger = 0.5, guide = 50.0;
  const double stiffness = pillars * p.k_normal, upper_sag = finger * g / stiffness,
               lower_sag = (finger + p.mass) * g / stiffness;
  const std::string world =
      box(p.mass, wide, fmt::format("0 0 {}", low - lower_sag), fmt::format("0.13e-3 -0.21e-3 {}", wide[2] - low), "0 0 1") +
      lower_site() +
      fmt::format(
          "<body name='finger' pos='0 0 {}'><joint type='slide' axis='0 0 -1' damping='{}'/><inertial pos='0 0 0' mass='{}' diaginertia='1e-3 1e-3 1e-3'/><site name='upper'/></body>",
          2.0 * wide[2] - lower_sag - upper_sag, guide, finger);
  const double speed = kick_speed(upper_sag, 2.0 * stiffness, std::min(p.mass, finger), p.damping);
  Probed probed{
      model_of(p.integrator, g, pad("lower", "lower", wide_pitch, p, p.damping) + pad("upper", "upper", wide_pitch, p, p.damping),
               world),
      kick_of(speed, 0.03)};
  probed.kick.push_back(0.9 * speed);
  return probed;
}

struct SetUp {
  std::string name;
  std::function<Probed(const Parameters&)> build;
  std::vector<std::string> integrators;
  std::vector<double> dampings;  // s
};

const std::vector<SetUp> set_ups{
    {"two pads hold a box", [](const Parameters& p) { return held(p, p.damping); }, {"Euler", "RK4"}, {0.0, 1e-4, 1e-3}},
    {"two pads hold a box, one of them undamped",
     [](const Parameters& p) { return held(p, 0.0); },
     {"implicitfast", "RK4"},
     {1e-4, 1e-3}},
    {"one pad under a box", carried, {"implicitfast", "RK4"}, {0.0, 1e-4, 1e-3}},
    {"a finger on a damped guide, a box, a pad", pressed, {"Euler", "implicit", "discrete", "RK4"}, {0.0, 1e-3}}};

StabilityCombination measure(const SetUp& set_up, const Parameters& parameters, double scale) {
  const Probed probed = set_up.build(parameters);
  StepProbe probe(probed.model, probed.kick);
  const Vibration vibration = probe.vibration();
  return {set_up.name,
          parameters.integrator,
          parameters.mass,
          scale,
          parameters.k_normal,
          parameters.damping,
          vibration.omega,
          probe.predicted_step(),
          longest_explicit_step(vibration),
          probe.measured_step()};
}

// Description of the method, for readers of the figures alone.
std::vector<std::string> sentences() {
  const StepProbeOptions probe;
  return {
      "The largest stable time step of explicit pads whose elements all stick, measured and predicted, for several masses, stiffnesses, dampings, set-ups and integrators. It does not apply to pads that slip, detach or hit.",
      fmt::format(
          "Measured: MuJoCo steps the model with the plugin, without checks of the time step. The model starts in equilibrium with all elements stuck (a slipping element is less stiff), gets a kick that excites all modes, and runs {} steps, which are {} periods at the limit if the velocity is stepped first. It diverges if the root of its kinetic energy grows to {:g} times that of the kick. The limit is found by bisection to {:g} of the step; steps of 1/4, 1/2, 3/4 and 9/10 of the result were run too and stayed bounded.",
          probe.steps, probe.steps / 2, probe.growth, probe.resolution),
      "Predicted: from mass matrix and tangents in the same pose. If MuJoCo steps the velocity first, the smallest h at which h^2 K + 2 h C has the eigenvalue 4 in the metric M + h D/2 (K, C: springs and dashpots of the pads, D: joint dampers, which MuJoCo treats implicitly). With RK4, the h at which h times an eigenvalue of the linear system leaves the region of stability. 1 % is subtracted for effects that the tangents do not contain.",
      "Allowed: the limit for scenes, 0.75/omega and 1/(tau omega^2). Steps between the allowed and the predicted limit are stable, but slides and impacts become less accurate with longer steps. Models of users may use up to 4/3 of the allowed step. With steps beyond the predicted limit the pads throw off the object that they hold.",
      "Implicit pads (field_solver: implicit) have no such limit and are not in the map."};
}

double allowed_share(const StabilityCombination& c) { return c.allowed / c.predicted; }

std::vector<std::string> remarks(const StabilityMap& map) {
  std::vector<std::string> lines;
  if (map.combinations.empty()) return lines;
  const auto [least_of, most_of] = std::ranges::minmax_element(map.combinations, {}, allowed_share);
  const double least = allowed_share(*least_of), most = allowed_share(*most_of);
  lines.push_back(fmt::format("The limit for scenes is {:.2f} to {:.2f} of the predicted limit.", least, most));
  const auto off = [](const StabilityCombination& c) { return std::abs(c.ratio() - 1.0); };
  const StabilityCombination& worst = *std::ranges::max_element(map.combinations, {}, off);
  lines.push_back(fmt::format("Ratio farthest from 1: {}, {}, {:g} kg, stiffness x{:g}, damping {:g} s: {:.4f}.", worst.set_up,
                              worst.integrator, worst.mass, worst.stiffness_scale, worst.damping, worst.ratio()));
  return lines;
}

}  // namespace

double StabilityMap::worst_ratio() const {
  double worst = 1.0;
  for (const StabilityCombination& c : combinations) worst = std::min(worst, c.ratio());
  return worst;
}

std::size_t StabilityMap::above() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(combinations, [](const StabilityCombination& c) { return c.ratio() > 1.0; }));
}

StabilityMap measure_stability(const StabilityOptions& options) {
  [[maybe_unused]] static const bool registered = (register_bench_plugin({pad_catalogues(), &make_sensor}), true);
  StabilityMap map;
  std::size_t number = 0;
  for (const SetUp& set_up : set_ups) {
    for (const std::string& integrator : set_up.integrators) {
      for (const double mass : {0.005, 0.05, 0.5, 5.0}) {
        for (const double scale : {0.1, 1.0, 10.0, 100.0}) {
          for (const double damping : set_up.dampings) {
            if (number++ % options.every != 0) continue;
            map.combinations.push_back(
                measure(set_up, {mass, scale * real_k_normal, scale * real_k_tangential, damping, integrator}, scale));
          }
        }
      }
    }
  }
  return map;
}

Json stability_json(const StabilityMap& map) {
  Json combinations = Json::array();
  for (const StabilityCombination& c : map.combinations) {
    combinations.push_back({{"case", c.set_up},
                            {"integrator", c.integrator},
                            {"mass_kg", c.mass},
                            {"stiffness_scale", c.stiffness_scale},
                            {"k_normal", c.k_normal},
                            {"damping_s", c.damping},
                            {"omega", c.omega},
                            {"predicted_s", c.predicted},
                            {"allowed_s", c.allowed},
                            {"measured_s", c.measured},
                            {"ratio", c.ratio()}});
  }
  return {{"slipbench_stability", 1},         {"text", sentences()},  {"combinations", std::move(combinations)},
          {"worst_ratio", map.worst_ratio()}, {"above", map.above()}, {"remarks", remarks(map)}};
}

std::string stability_text(const StabilityMap& map) {
  std::string text = fmt::format("{:<42} {:<12} {:>4}  {:>17}  {:>21}  {:>13}\n", "case", "integrator", "n", "measured step",
                                 "predicted / measured", "allowed/pred.");
  for (auto first = map.combinations.begin(); first != map.combinations.end();) {
    const auto last = std::find_if(first, map.combinations.end(), [&](const StabilityCombination& c) {
      return c.set_up != first->set_up || c.integrator != first->integrator;
    });
    const auto span_of = [&](const std::function<double(const StabilityCombination&)>& value) {
      const auto [least_of, most_of] =
          std::minmax_element(first, last, [&](const auto& a, const auto& b) { return value(a) < value(b); });
      return std::pair{value(*least_of), value(*most_of)};
    };
    const auto measured = span_of([](const auto&c) { return c.measured; }),
               ratio = span_of([](const auto&c) { return c.ratio(); }), allowed = span_of(allowed_share);
    text += fmt::format("{:<42} {:<12} {:>4}  {:>7.1e}-{:.1e} s  {:>10.4f} to {:.4f}  {:>5.2f} to {:.2f}\n", first->set_up,
                        first->integrator, last - first, measured.first, measured.second, ratio.first, ratio.second,
                        allowed.first, allowed.second);
    first = last;
  }
  return text +
         fmt::format(
             "{} combinations: the predicted longest stable step is at least {:.4f} of the measured one, and longer than it in {} cases.\n",
             map.combinations.size(), map.worst_ratio(), map.above());
}

}  // namespace slipbench::cost
