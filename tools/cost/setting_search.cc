#include "tools/cost/setting_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <set>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/core/parameters.h"
#include "sim/core/quantity.h"
#include "sim/effects/install.h"
#include "tools/registry/sensor_catalogue.h"
#include "tools/statistics/descriptive.h"

namespace slipbench {
namespace {

constexpr std::size_t most_divisors = 1000;  // of the sampling time, tried for the longest step
constexpr std::size_t most_common = 100;     // of the shortest sampling time, tried for a common divisor of all
constexpr double most_steps = 1e8;           // per trial, the limit of a scene
constexpr std::size_t most_checked = 64;     // trials in which a step must be stable

constexpr double tight_tolerance = 1e-6;  // of an effect's solver, at the longest step
constexpr std::size_t tight_cost = 2;     // as `cost` measures for scenes/soft_skin/sphere.yaml

// Largest errors that may be required, by the measure's name.
const std::vector<ParameterSpec>& requirement_specs() {
  const auto share = [](const char* name) {
    return number_spec(name, Quantity::none, "1 %", positive_up_to(1.0), "Largest error.", "set for each scene");
  };
  static const std::vector<ParameterSpec> specs{
      share("onset"),
      share("micro_onset"),
      share("slip_distance"),
      share("force"),
      share("label"),
      share("label_micro"),
      number_spec("creep", Quantity::speed, "1 um/s", positive, "Largest drift.", "set for each scene")};
  return specs;
}

// Keys of a scene that the search sets or keeps, so that a sweep may not vary them.
constexpr std::array<std::string_view, 3> searched_keys{"field_solver", "integrator", "time_step"};

// Rounds a time to four digits.
std::string rounded_time(const std::string& text) {
  const std::string rounded = fmt::format("{:.3e}", parse_quantity(text, Quantity::time));
  return format_quantity(parse_quantity(rounded, Quantity::time), Quantity::time);
}

// Time step and solver: implicit or explicit pad springs, number of steps per sampling time, and
// whether a soft skin is solved to a tight tolerance.
struct StepSetting {
  bool implicit = false;
  std::size_t steps = 1;
  bool tight = false;

  [[nodiscard]] std::size_t cost() const { return (implicit ? implicit_cost : tight ? tight_cost : 1) * steps; }
};

class Search {
 public:
  Search(const ReadSweep& read, const std::vector<Requirement>& required)
      : plan_(read.planned.plan),
        requested_(read.planned.requested),
        trials_(evenly_spaced(requested_, most_probed)),
        required_(required) {
    const auto [scene, drawn] = plan_.trial(0);
    for (const auto& [path, value] : drawn) {
      if (std::ranges::find(searched_keys, path) != searched_keys.end())
        throw InputError(plan_.where(0, path) + ": the sweep varies " + path + ", which --accuracy finds; remove it: --set " +
                         path + "=null");
    }
    const auto is_body = [](const Named& effect) { return effect_kind(effect.name).body != nullptr; };
    has_choice_ = scene.dynamic() && !scene.grasp && scene.fidelity == "field" && std::ranges::none_of(scene.effects, is_body) &&
                  read.file.root().find("field_solver") == nullptr;
    const auto solves = [](const Named& effect) { return effect_kind(effect.name).tolerance != nullptr; };
    const auto solver = std::ranges::find_if(scene.effects, solves);
    if (solver == scene.effects.end()) return;
    solver_ = static_cast<std::size_t>(solver - scene.effects.begin());
    // If a sweep sets the tolerance, or the effects as a whole, the tolerance is not changed here.
    const std::string ours = tolerance_path(scene) + ".";
    if (std::ranges::any_of(drawn, [&](const auto& swept) { return ours.starts_with(swept.first + "."); })) solver_.reset();
  }

  [[nodiscard]] FoundSetting find() {
    try {
      return search();
    } catch (const SceneValueError& error) {
      throw InputError(plan_.where(0, error.path()) + ": " + error.what());
    }
  }

 private:
  FoundSetting search() {
    FoundSetting found;
    found.trials = trials_;
    const std::size_t longest = longest_step();
    if (read_closed_forms()) {
      found.reference = "closed form";
      if (try_settings(candidates(finest_reference * longest), Recording::outcome, exact_, found)) return found;
      refuse_unmet(found);
    }
    find_reference(longest, found);
    // Includes the reference's neighbouring step, whose errors are known to be small enough.
    if (!try_settings(candidates(reference_steps_), Recording::full, reference_, found)) refuse_unmet(found);
    return found;
  }

  [[nodiscard]] double step_of(const StepSetting& setting) const { return sampling_time_ / static_cast<double>(setting.steps); }

  [[nodiscard]] std::string tolerance_path(const Scene& scene) const {
    const std::string& name = scene.effects[*solver_].name;
    return fmt::format("effects.{}.{}.{}", *solver_, name, effect_kind(name).tolerance);
  }

  // Residuals of the steps of a slipping skin accumulate over the steps. Never larger than the
  // scene's own tolerance.
  [[nodiscard]] double tolerance_of(const StepSetting& setting) const {
    const Named effect = plan_.trial(0).scene.effects[*solver_];
    const EffectKind& kind = effect_kind(effect.name);
    const double least = std::ranges::find(kind.about.parameters, kind.tolerance, &ParameterSpec::name)->range.min;
    const double own = effect.parameters.number(kind.tolerance);
    return std::min(own,
                    std::max(least, tight_tolerance * static_cast<double>(explicit_steps_) / static_cast<double>(setting.steps)));
  }

  // The step reads back as the same double.
  [[nodiscard]] std::vector<Override> overrides_of(const StepSetting& setting) const {
    std::vector<Override> overrides{{"time_step", format_quantity(step_of(setting), Quantity::time)}};
    if (setting.implicit) overrides.push_back({"field_solver", "implicit"});
    if (setting.tight) {
      overrides.push_back({tolerance_path(plan_.trial(0).scene), format_number(tolerance_of(setting))});
    }
    return overrides;
  }

  // The scene of a trial with these overrides.
  [[nodiscard]] Scene scene_of(const StepSetting& setting, std::size_t trial) const {
    Scene scene = plan_.trial(trial).scene;
    scene.time_step = step_of(setting);
    if (has_choice_) scene.field_solver = setting.implicit ? FieldSolver::implicit_springs : FieldSolver::explicit_springs;
    if (setting.tight) {
      Named& effect = scene.effects[*solver_];
      effect.parameters.set(effect_kind(effect.name).tolerance, tolerance_of(setting));
    }
    return scene;
  }

  [[noreturn]] static void refuse(const std::string& why) { throw InputError("cost: --accuracy: " + why); }
  // `requirement`: the one that cannot be met.
  [[noreturn]] static void refuse(const Requirement& requirement, const std::string& why) {
    throw InputError(fmt::format("cost: --accuracy {}: {}", info_of(requirement.measure).name, why));
  }

  // Finds the longest time that divides the sampling times of all sensors with their own pads.
  void find_sampling_time() {
    std::set<double> rates;
    for (const std::size_t trial : evenly_spaced(requested_, most_checked)) {
      const Scene scene = plan_.trial(trial).scene;
      for (const SensorScene& sensor : scene.sensors) {
        if (!sensor.follows.empty()) continue;
        const std::unique_ptr<Sensor> made = make_sensor(sensor, scene.seed, trial);
        rates.insert(made->rate() * static_cast<double>(made->scans()));
      }
    }
    constexpr double rounding = 1e-9;
    const double fastest = *rates.rbegin();
    for (std::size_t divisor = 1; divisor <= most_common; ++divisor) {
      const double common = static_cast<double>(divisor) * fastest;
      const bool divides_all = std::ranges::all_of(rates, [&](double rate) {
        const double ratio = common / rate;
        return std::abs(ratio - std::round(ratio)) <= rounding * ratio;
      });
      if (!divides_all) continue;
      sampling_time_ = 1.0 / common;
      return;
    }
    refuse("the sampling times of the sensors have no common time step; change the rates");
  }

  // Reason why a trial cannot start with the setting; empty if it can.
  [[nodiscard]] std::optional<SceneValueError> refusal_of(const StepSetting& setting, std::size_t trial) const {
    try {
      check_trial(scene_of(setting, trial), trial);
      return std::nullopt;
    } catch (const SceneValueError& error) {
      return error;
    }
  }

  // The fewest steps per sampling time that are stable in all examined trials; 0: no number is, and
  // `last_refusal_` has the reason.
  std::size_t fewest_steps(bool implicit) {
    std::size_t steps = 1;
    // A shorter step is stable wherever a longer one is, so earlier trials need not be repeated.
    for (const std::size_t trial : evenly_spaced(requested_, most_checked)) {
      while (std::optional<SceneValueError> refusal = refusal_of({implicit, steps}, trial)) {
        last_refusal_ = std::move(refusal);
        const bool of_step = last_refusal_->path() == "time_step" || last_refusal_->path() == "duration";
        if (!of_step || ++steps > most_divisors) return 0;
      }
    }
    return steps;
  }

  // Finds the coarsest settings to try; returns the number of steps of the longest one of the kind
  // used for references.
  std::size_t longest_step() {
    find_sampling_time();
    explicit_steps_ = fewest_steps(false);
    if (explicit_steps_ == 0 && !has_choice_) throw SceneValueError(*last_refusal_);
    if (has_choice_) implicit_steps_ = fewest_steps(true);
    if (explicit_steps_ == 0 && implicit_steps_ == 0) throw SceneValueError(*last_refusal_);
    return explicit_steps_ > 0 ? explicit_steps_ : implicit_steps_;
  }

  // Settings in the order of trying, with fewer steps than `below`.
  [[nodiscard]] std::vector<StepSetting> candidates(std::size_t below) const {
    std::vector<StepSetting> settings;
    for (const auto& [implicit, fewest] : {std::pair{false, explicit_steps_}, std::pair{true, implicit_steps_}}) {
      for (std::size_t steps = fewest; steps > 0 && steps < below; steps *= 2) {
        settings.push_back({implicit, steps});
        if (solver_) settings.push_back({implicit, steps, true});
      }
    }
    std::ranges::stable_sort(settings, {}, &StepSetting::cost);
    return settings;
  }

  // True if all required measures have a closed form in all trials.
  bool read_closed_forms() {
    const bool onsets = std::ranges::all_of(required_, [](const Requirement& requirement) {
      return requirement.measure == Measure::onset || requirement.measure == Measure::micro_onset;
    });
    for (std::size_t k = 0; onsets && k < trials_.size(); ++k) {
      const std::optional<ClosedForm> exact = closed_form(plan_.trial(trials_[k]).scene, trials_[k]);
      if (!exact) break;
      exact_.push_back(*exact);
    }
    return exact_.size() == trials_.size();
  }

  // True if the errors are within `share` of the requirement.
  [[nodiscard]] bool meets(const Errors& errors, double share) const {
    return std::ranges::all_of(required_, [&](const Requirement& requirement) {
      const std::optional<MeasureError>& error = at(errors, requirement.measure);
      return !error || (!error->different && error->worst <= share * requirement.limit);
    });
  }

  void refuse_what_never_happens(const Errors& errors) const {
    for (const Requirement& requirement : required_) {
      if (at(errors, requirement.measure)) continue;
      refuse(requirement,
             fmt::format("the quantity does not occur in the examined trials ({}); leave it out", fmt::join(trials_, ", ")));
    }
  }

  // `references`: reference of each trial.
  template <class Reference>
  bool try_settings(const std::vector<StepSetting>& settings, Recording recording, const std::vector<Reference>& references,
                    FoundSetting& found) {
    for (const StepSetting& setting : settings) {
      TriedSetting attempt{overrides_of(setting), {}, {}, true};
      for (std::size_t k = 0; k < trials_.size() && attempt.met; ++k) {
        try {
          const Scene scene = scene_of(setting, trials_[k]);
          keep_worst(attempt.errors, compare(scene, run_trial(scene, trials_[k], recording), references[k]));
          attempt.met = meets(attempt.errors, margin);
        } catch (const InputError& error) {
          attempt.failure = fmt::format("trial {}: {}", trials_[k], error.what());
          attempt.met = false;
        }
      }
      if (attempt.met) refuse_what_never_happens(attempt.errors);
      found.tried.push_back(std::move(attempt));
      if (!found.tried.back().met) continue;
      found.overrides = found.tried.back().overrides;
      return true;
    }
    return false;
  }

  // True if the scene would have too many steps.
  [[nodiscard]] bool too_many(std::size_t steps) const {
    return plan_.trial(0).scene.duration / sampling_time_ * static_cast<double>(steps) > most_steps;
  }

  [[nodiscard]] std::vector<TrialResult> run_all(const StepSetting& setting) const {
    std::vector<TrialResult> results;
    for (const std::size_t trial : trials_) {
      try {
        results.push_back(run_trial(scene_of(setting, trial), trial, Recording::full));
      } catch (const InputError& error) {
        refuse(fmt::format("trial {} with {}: {}", trial, setting_text(overrides_of(setting)), error.what()));
      }
    }
    return results;
  }

  // Halves the step until two successive runs are close enough.
  void find_reference(std::size_t longest, FoundSetting& found) {
    const bool implicit = explicit_steps_ == 0;
    StepSetting setting{implicit, 4 * longest, solver_.has_value()};
    reference_ = run_all(setting);
    while (true) {
      setting.steps *= 2;
      std::vector<TrialResult> results = run_all(setting);
      Errors errors;
      for (std::size_t k = 0; k < trials_.size(); ++k) {
        keep_worst(errors, compare(scene_of(setting, trials_[k]), reference_[k], results[k]));
      }
      refuse_what_never_happens(errors);
      reference_ = std::move(results);
      found.reference_overrides = overrides_of(setting);
      found.reference = setting_text(found.reference_overrides);
      found.reference_errors = errors;
      reference_steps_ = setting.steps;
      if (meets(errors, reference_share)) return;
      if (setting.steps >= finest_reference * longest || too_many(2 * setting.steps)) refuse_unsettled(errors, found.reference);
    }
  }

  // Text of the allowed requirement if an error must be at most `share` of it.
  static std::string allowed(const Requirement& requirement, const MeasureError& error, double share) {
    if (error.different && error.worst <= share * requirement.limit) return "leave it out";
    return fmt::format("{} or more, or leave it out", error_text(requirement.measure, error.worst / share));
  }

  // Reports that even the finest runs disagree.
  [[noreturn]] void refuse_unsettled(const Errors& errors, const std::string& reference) const {
    for (const Requirement& requirement : required_) {
      const MeasureError& error = at(errors, requirement.measure).value();
      if (!error.different && error.worst <= reference_share * requirement.limit) continue;
      refuse(
          requirement,
          fmt::format(
              "{} cannot be demonstrated: the run with {} still differs by {} from the run with twice the step{}, but a tenth of the accuracy is needed; allowed: {}",
              error_text(requirement.measure, requirement.limit), reference, error_text(requirement.measure, error.worst),
              error.different ? ", and an event occurs in only one of them" : "", allowed(requirement, error, reference_share)));
    }
    throw std::logic_error("a reference that is good enough was refused");
  }

  // Reports that no setting is accurate enough, with the error of the finest one for the first
  // requirement that it misses.
  [[noreturn]] void refuse_unmet(const FoundSetting& found) const {
    const TriedSetting& last = found.tried.back();
    if (!last.failure.empty())
      refuse(fmt::format("no setting meets it; with {}: {}", setting_text(last.overrides), last.failure));
    for (const Requirement& requirement : required_) {
      const std::optional<MeasureError>& error = at(last.errors, requirement.measure);
      if (!error || (!error->different && error->worst <= margin * requirement.limit)) continue;
      refuse(requirement,
             fmt::format("{} cannot be met: with {} the error is {}{}, but half of the accuracy is needed; allowed: {}",
                         error_text(requirement.measure, requirement.limit), setting_text(last.overrides),
                         error_text(requirement.measure, error->worst),
                         error->different ? ", and a slip occurs in only one of the runs" : "",
                         allowed(requirement, *error, margin)));
    }
    throw std::logic_error("a setting that meets the accuracy was rejected");
  }

  const TrialPlan& plan_;  // the scene unchanged
  std::size_t requested_;  // number of trials to run
  std::vector<std::size_t> trials_;
  std::vector<Requirement> required_;
  bool has_choice_ = false;            // of the solver
  std::optional<std::size_t> solver_;  // index of the scene's first effect with an iterative solver
  double sampling_time_ = 0.0;
  std::size_t explicit_steps_ = 0, implicit_steps_ = 0;  // fewest per sampling time; 0: no such setting
  std::optional<SceneValueError> last_refusal_;
  std::vector<ClosedForm> exact_;       // by examined trial
  std::vector<TrialResult> reference_;  // by examined trial
  std::size_t reference_steps_ = 0;
};

}  // namespace

Requirement parse_requirement(const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::string name = text.substr(0, equals), value = equals == std::string::npos ? "" : text.substr(equals + 1);
  const auto spec = std::ranges::find(requirement_specs(), name, &ParameterSpec::name);
  if (spec == requirement_specs().end()) {
    std::vector<std::string> names;
    for (const ParameterSpec& known : requirement_specs()) names.push_back(known.name);
    throw InputError("cost: --accuracy " + text + ": unknown measure " + quote(name) + allowed_names(name, names) +
                     ", each with its largest error, such as onset=1%");
  }
  try {
    const auto measure = std::ranges::find(measure_table(), name, &MeasureInfo::name);
    return {measure->measure, std::get<double>(parse_scalar(*spec, value))};
  } catch (const std::invalid_argument& error) {
    throw InputError("cost: --accuracy " + text + ": " + error.what());
  }
}

FoundSetting find_setting(const ReadSweep& read, const std::vector<Requirement>& required) {
  return Search(read, required).find();
}

std::string setting_text(const std::vector<Override>& overrides) {
  std::string text;
  for (const Override& change : overrides) {
    const std::string value = change.path == "time_step" ? rounded_time(change.value) : change.value;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", change.path, value);
  }
  return text;
}

std::string error_text(Measure measure, double value) {
  const MeasureInfo& info = info_of(measure);
  return fmt::format("{:.3g} {}", info.factor * value, info.unit);
}

}  // namespace slipbench
