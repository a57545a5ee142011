#include "tools/cost/settings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string_view>

#include <fmt/format.h>

#include "sim/core/quantity.h"
#include "sim/effects/install.h"

namespace slipbench::cost {
namespace {

constexpr std::array coarse_factors{10.0, 4.0, 2.0};
constexpr std::array divisors{1.0, 2.0, 5.0, 10.0, 20.0};

// Contact settings of a careful MuJoCo user: the defaults, its manual's advice against creep
// (elliptic cones, a high impratio, noslip, stiff contacts), and recipes found by scanning hundreds
// of settings on similar pillars (sim/mujoco/articulated/mujoco_contact.md). %h is the step in s,
// %2h twice the step, and %m a tip's mass: 10 g, and 1 g if tips weigh on bodies that move by
// forces.
struct ContactChoice {
  const char* label;
  const char* contact;  // the scene's key
};
constexpr std::array contact_choices{
    ContactChoice{"defaults", "{}"},
    ContactChoice{"elliptic, stiff", "{cone: elliptic, tip_mass: %m, solimp: [0.99, 0.999, 0.001], solref: [%2h, 1]}"},
    ContactChoice{"stiff, impratio 10",
                  "{cone: elliptic, tip_mass: %m, solimp: [0.99, 0.999, 0.001], solref: [%2h, 1], impratio: 10}"},
    ContactChoice{"stiff, noslip 3", "{cone: elliptic, tip_mass: %m, solimp: [0.99, 0.999, 0.001], solref: [%2h, 1], noslip: 3}"},
    ContactChoice{"stiffer, noslip 3",
                  "{cone: elliptic, tip_mass: %m, solimp: [0.999, 0.9999, 0.001], solref: [%h, 1], noslip: 3, refsafe: false}"},
    ContactChoice{
        "discrete, impratio 20, lightly damped tips",
        "{integrator: discrete, cone: elliptic, tip_mass: %m, solimp: [0.99, 0.999, 0.001], solref: [%2h, 1], impratio: 20, tip_damping: 0.03}"},
    ContactChoice{
        "discrete, impratio 10",
        "{integrator: discrete, cone: elliptic, tip_mass: %m, solimp: [0.99, 0.999, 0.001], solref: [%2h, 1], impratio: 10}"},
    ContactChoice{
        "discrete, noslip 3, slow friction",
        "{integrator: discrete, cone: elliptic, impratio: 0.1, noslip: 3, solref: [-1e7, -6325], solreffriction: [0.002, 1], refsafe: false}"},
};

std::string filled(std::string text, const std::string& mark, const std::string& value) {
  if (const std::size_t at = text.find(mark); at != std::string::npos) text.replace(at, mark.size(), value);
  return text;
}
constexpr std::array contact_steps{4e-3, 2e-3, 1e-3, 5e-4, 2e-4};
// The springs of a grasp's fingers are stable up to 0.8 ms with the grip's defaults; stiffer
// fingers refuse more of these steps.
constexpr std::array grasp_contact_steps{5e-4, 2e-4, 1e-4, 5e-5};

bool has(const SensorScene& sensor, const char* parameter) { return sensor.parameters.values().contains(parameter); }

double rate_of(const SensorScene& sensor) { return has(sensor, "rate") ? sensor.parameters.number("rate") : 0.0; }

Override step(double time_step) { return {"time_step", step_text(time_step)}; }

// True if x is a whole number to within the rounding of decimal text.
bool whole(double x) { return x > 0.5 && std::abs(x - std::round(x)) < 1e-9 * x; }

// Slows every sensor that samples faster than `rate` [Hz] down to it.
void limit_rates(const Scene& scene, double rate, std::vector<Override>& changes) {
  for (const SensorScene& sensor : scene.sensors) {
    if (rate_of(sensor) > rate) changes.push_back({"sensors." + sensor.name + ".rate", format_number(rate) + " Hz"});
  }
}

// Adds a setting with `time_step` to a series; slows down faster sensors.
void add_step(const Scene& scene, const std::string& series, double time_step, std::vector<Override> changes,
              const std::string& label, std::vector<Setting>& settings) {
  if (!whole(scene.duration / time_step)) return;
  changes.push_back(step(time_step));
  const std::size_t before = changes.size();
  limit_rates(scene, 1.0 / time_step, changes);
  const std::string slowed = changes.size() > before ? fmt::format(", output at {} Hz", format_number(1.0 / time_step)) : "";
  settings.push_back({series, label + short_text(time_step) + slowed, std::move(changes)});
}

// A sampling time [s] of the scene. If nothing is integrated it is the scene's step, also for a
// sensor that reads several times per sample.
double sampling_time_of(const Scene& scene, double own) {
  const double rate = fastest_rate(scene);
  return scene.dynamic() && rate > 0.0 ? 1.0 / rate : own;
}

// The step closest to `wanted` [s] that divides the sampling time or is a multiple of it: the steps
// for MuJoCo's contact assume 1 kHz, and a scene may have any rate.
double fitting(double wanted, double sampling_time) {
  const double times = wanted / sampling_time;
  return times >= 1.0 ? std::round(times) * sampling_time : sampling_time / std::ceil(1.0 / times - 1e-9);
}

// Steps from ten times the scene's own down to a twentieth. If forces move bodies, the scene's step
// is near the stability limit: from four times the step down to an eighth, in whole fractions of a
// sampling time.
std::vector<double> ladder(const Scene& scene, double own) {
  std::vector<double> steps;
  if (!scene.dynamic()) {
    for (const double factor : coarse_factors) steps.push_back(factor * own);
    for (const double divisor : divisors) steps.push_back(own / divisor);
    return steps;
  }
  const double sampling_time = sampling_time_of(scene, own);
  const double parts = std::max(1.0, std::round(sampling_time / own));
  for (const double factor : {0.25, 0.5, 1.0, 2.0, 4.0, 8.0})
    steps.push_back(sampling_time / std::max(1.0, std::ceil(factor * parts)));
  steps.erase(std::unique(steps.begin(), steps.end()), steps.end());
  return steps;
}

// Resets the scene's own way of simulating, which may not suit another.
std::vector<Override> plain(const Scene& scene, const char* name) {
  std::vector<Override> changes;
  if (scene.fidelity == "mujoco_contact") changes.push_back({"contact", "none"});
  if (!scene.integrator.empty()) changes.push_back({"integrator", "auto"});
  if (scene.field_solver != FieldSolver::automatic) changes.push_back({"field_solver", "auto"});
  changes.push_back({"fidelity", name});
  return changes;
}

void add_steps(const Scene& scene, double own, std::vector<Setting>& settings) {
  const bool own_is_plain = scene.fidelity == "field" && scene.field_solver == FieldSolver::automatic && scene.integrator.empty();
  const std::vector<double> steps = ladder(scene, own);
  for (const double h : steps) {
    if (own_is_plain && std::abs(h / own - 1.0) < 1e-9) continue;
    add_step(scene, "field", h, plain(scene, "field"), "", settings);
  }
  if (scene.dynamic() && !scene.grasp) {
    for (const double h : steps) {
      std::vector<Override> changes = plain(scene, "field");
      changes.push_back({"field_solver", "implicit"});
      add_step(scene, "implicit", h, std::move(changes), "", settings);
    }
    for (const char* const integrator : {"Euler", "implicitfast", "implicit", "discrete", "RK4"}) {
      std::vector<Override> changes = plain(scene, "field");
      changes.push_back({"integrator", integrator});
      settings.push_back({"integrator", integrator, std::move(changes)});
    }
  }
  if (!scene.grasp && scene.effects.empty()) {
    for (const double h : {2e-3, 1e-3, 5e-4, 2e-4})
      add_step(scene, "articulated", fitting(h, sampling_time_of(scene, own)), plain(scene, "articulated"), "", settings);
  }
}

void add_contact(const Scene& scene, double own, std::vector<Setting>& settings) {
  if (!scene.effects.empty()) return;
  const FrictionScene& friction = scene.friction;
  const std::span<const double> steps = scene.grasp ? std::span<const double>(grasp_contact_steps) : contact_steps;
  for (const double wanted : steps) {
    const double h = fitting(wanted, sampling_time_of(scene, own));
    for (const ContactChoice& choice : contact_choices) {
      std::string contact = filled(choice.contact, "%2h", format_number(2.0 * h));
      contact = filled(filled(contact, "%h", format_number(h)), "%m", scene.dynamic() ? "1 g" : "10 g");
      std::vector<Override> changes = plain(scene, "mujoco_contact");
      if (scene.fidelity == "mujoco_contact") changes.erase(changes.begin());
      changes.push_back({"contact", contact});
      if (one_friction(scene)) {
        const std::string both = format_number(friction.static_coefficient / friction.scale);
        changes.push_back(
            {"friction", fmt::format("{{static: {0}, kinetic: {0}, scale: {1}}}", both, format_number(friction.scale))});
      }
      add_step(scene, "contact", h, std::move(changes), fmt::format("{}, ", choice.label), settings);
    }
  }
}

// Parameters for the number of elements of a pad: a sensor has one of them or none.
constexpr std::array count_parameters{"bristles", "elements"};

// Counts to try for a parameter with the value `now`: for bristles from a point contact to a dense
// end face, for other pads two thirds to four times as many.
std::array<int, 4> counts_for(std::string_view parameter, int now) {
  if (parameter == "bristles") return {1, 2, 6, 48};
  return {(2 * now) / 3, now, 2 * now, 4 * now};
}

void add_elements(const Scene& scene, std::vector<Setting>& settings) {
  for (const char* const parameter : count_parameters) {
    std::vector<const SensorScene*> with;
    for (const SensorScene& sensor : scene.sensors) {
      if (has(sensor, parameter)) with.push_back(&sensor);
    }
    if (with.empty()) continue;
    for (const int count : counts_for(parameter, static_cast<int>(with.front()->parameters.integer(parameter)))) {
      std::vector<Override> changes;
      for (const SensorScene* const sensor : with)
        changes.push_back({fmt::format("sensors.{}.{}", sensor->name, parameter), std::to_string(count)});
      settings.push_back({"elements", fmt::format("{}: {}", parameter, count), std::move(changes)});
    }
    return;
  }
}

// Tolerance of the first effect with an iterative solver.
void add_tolerance(const Scene& scene, std::vector<Setting>& settings) {
  for (std::size_t i = 0; i < scene.effects.size(); ++i) {
    const std::string& name = scene.effects[i].name;
    const char* const parameter = effect_kind(name).tolerance;
    if (parameter == nullptr) continue;
    for (const char* const tolerance : {"0.01", "0.001", "0.0001", "1e-05", "1e-06", "1e-08"})
      settings.push_back({"tolerance", tolerance, {{fmt::format("effects.{}.{}.{}", i, name, parameter), tolerance}}});
    return;
  }
}

// Cells of a flat grid of constant extent, on a pad that is one elastic body.
void add_grid(const Scene& scene, std::vector<Setting>& settings) {
  const auto is_body = [](const Named& effect) { return effect_kind(effect.name).body != nullptr; };
  if (std::ranges::none_of(scene.effects, is_body)) return;
  const SensorScene& sensor = scene.sensors.front();
  if (scene.sensors.size() > 1 || !has(sensor, "rows") || !has(sensor, "columns") || !has(sensor, "pitch")) return;
  const auto rows = sensor.parameters.integer("rows"), columns = sensor.parameters.integer("columns");
  constexpr std::int64_t most = 64;
  constexpr int halves = 2;
  for (const int factor : {1, 2, 3, 4, 6}) {  // half to three times as many along each side
    if (rows * factor % halves != 0 || columns * factor % halves != 0 || std::max(rows, columns) * factor > most * halves)
      continue;
    const auto key = [&](const char* name) { return fmt::format("sensors.{}.{}", sensor.name, name); };
    const std::int64_t up = rows * factor / halves, across = columns * factor / halves;
    settings.push_back(
        {"grid",
         fmt::format("{} x {}", up, across),
         {{key("rows"), std::to_string(up)},
          {key("columns"), std::to_string(across)},
          {key("pitch"), format_quantity(sensor.parameters.number("pitch") * halves / factor, Quantity::length)}}});
  }
}

void add_rates(const Scene& scene, double own, std::vector<Setting>& settings) {
  const double fastest = fastest_rate(scene);
  if (!(fastest > 0.0)) return;
  for (const double factor : coarse_factors) {
    const double rate = fastest / factor;
    if (!whole(scene.duration * rate)) continue;
    std::vector<Override> changes{step(own)};
    limit_rates(scene, rate, changes);
    settings.push_back({"rate", format_number(rate) + " Hz", std::move(changes)});
  }
}

}  // namespace

double fastest_rate(const Scene& scene) {
  double fastest = 0.0;
  for (const SensorScene& sensor : scene.sensors) fastest = std::max(fastest, rate_of(sensor));
  return fastest;
}

bool one_friction(const Scene& scene) { return scene.friction.static_coefficient != scene.friction.kinetic_coefficient; }

const std::vector<Series>& all_series() {
  static const std::vector<Series> series{
      {"own", "the scene as it is"},
      {"field", "element field"},
      {"implicit", "element field, implicit"},
      {"integrator", "integrators, at the scene's time step"},
      {"articulated", "articulated pillars"},
      {"contact", "MuJoCo's own contact"},
      {"rate", "output rate, at the scene's time step"},
      {"elements", "elements per pad, compared with the largest number that ran", true},
      {"tolerance", "tolerance of the soft skin's solver, compared with the smallest that ran", true},
      {"grid", "cells of the soft skin, compared with the finest that ran", true},
  };
  return series;
}

const Series& series_of(const Setting& setting) { return *std::ranges::find(all_series(), setting.series, &Series::name); }

std::vector<Setting> settings_to_try(const Scene& scene, double own) {
  std::vector<Setting> settings;
  add_steps(scene, own, settings);
  add_contact(scene, own, settings);
  add_rates(scene, own, settings);
  add_elements(scene, settings);
  add_tolerance(scene, settings);
  add_grid(scene, settings);
  return settings;
}

std::string short_text(double time_step) {
  return time_step < 0.1e-3 ? fmt::format("{:.4g} us", 1e6 * time_step) : fmt::format("{:.4g} ms", 1e3 * time_step);
}

Setting finer(double time_step) { return {"own", short_text(time_step), {step(time_step)}}; }

std::string step_text(double time_step) { return format_quantity(time_step, Quantity::time); }

}  // namespace slipbench::cost
