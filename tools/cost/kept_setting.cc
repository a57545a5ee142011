#include "tools/cost/kept_setting.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <set>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include <unistd.h>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/core/quantity.h"
#include "tools/dataset/record/encoder.h"
#include "tools/dataset/record/json.h"
#include "tools/files/output_file.h"
#include "tools/registry/sensor_catalogue.h"
#include "tools/statistics/descriptive.h"

namespace slipbench {
namespace {

constexpr int schema = 1;
constexpr std::size_t most_kept = 32;  // settings of one scene, by overrides and seed; the latest are kept

const TextKind kept_kind{"record of settings for a scene's accuracy", [](std::string_view beginning) {
                           return beginning.starts_with("{") &&
                                  beginning.find("\"slipbench_accuracy\"") != std::string_view::npos;
                         }};

Json overrides_as_json(const std::vector<Override>& overrides) {
  Json list = Json::array();
  for (const Override& change : overrides) list.push_back(Json::array({change.path, change.value}));
  return list;
}

std::vector<Override> overrides_of(const Json& json) {
  std::vector<Override> overrides;
  for (const Json& change : json) overrides.push_back({change.at(0).get<std::string>(), change.at(1).get<std::string>()});
  return overrides;
}

Json errors_as_json(const Errors& errors) {
  Json json = Json::object();
  for (const MeasureInfo& info : measure_table()) {
    if (const std::optional<MeasureError>& error = at(errors, info.measure)) {
      json[std::string(info.name)] = {{"worst", error->worst}, {"median", error->median}, {"different", error->different}};
    }
  }
  return json;
}

// Identity of an entry: equal inputs give equal settings.
Json subject_of(const SceneFile& file, const Scene& scene, const std::vector<Override>& overrides, const PlannedTrials& planned) {
  return {{"version", SLIPBENCH_VERSION},
          {"scene_sha256", text_sha256(file.text())},
          {"model_sha256", scene.model.empty() ? Json(nullptr) : Json(file_sha256(scene.model))},
          {"seed", scene.seed},
          {"trials", {{"asked", planned.asked}, {"of_each_cell", planned.plan.draws()}}},
          {"overrides", overrides_as_json(overrides)}};
}

Json entry_of(const Json& subject, const Scene& scene, const FoundSetting& found) {
  Json wish = Json::object();
  for (const AccuracyScene::Wish& part : scene.accuracy->wishes) wish[part.measure] = part.limit;
  Json looks = Json::array();
  for (const SettingLook& look : found.looks) {
    looks.push_back({{"setting", overrides_as_json(look.overrides)},
                     {"met", look.met},
                     {"errors", errors_as_json(look.errors)},
                     {"failure", look.failure.empty() ? Json(nullptr) : Json(look.failure)}});
  }
  Json entry = {{"subject", subject},
                {"wish", std::move(wish)},
                {"setting", overrides_as_json(found.overrides)},
                {"trials", found.trials},
                {"reference",
                 {{"is", found.reference},
                  {"setting", overrides_as_json(found.reference_overrides)},
                  {"errors", errors_as_json(found.reference_errors)}}},
                {"margin", margin},
                {"looks", std::move(looks)}};
  entry["sha256"] = text_sha256(entry.dump());
  return entry;
}

[[noreturn]] void refuse_to_keep(const std::string& why) {
  throw InputError(
      why +
      "; the time step that meets the scene's accuracy is stored there; make the file writable, or run without it: --set accuracy=none");
}

// Throws InputError if write_text_file() would fail. Only creating a file proves that it can be
// created; the test file's name is as long as the final one.
void check_record(const std::string& path, const std::string& scene_path) {
  try {
    check_text_target(path, {scene_path}, kept_kind);
  } catch (const InputError& error) {
    refuse_to_keep(error.what());
  }
  std::string name = path + "..XXXXXX";
  const int descriptor = ::mkstemp(name.data());
  if (descriptor < 0) refuse_to_keep(fmt::format("cannot write {}: {}", path, std::strerror(errno)));
  ::close(descriptor);
  ::unlink(name.c_str());
}

// The entries of the file; empty if there is no file.
Json read_entries(const std::string& path) {
  std::error_code error;
  const std::filesystem::file_type type = std::filesystem::status(path, error).type();
  // If the path cannot even be examined, writing reports the reason.
  if (type == std::filesystem::file_type::not_found || type == std::filesystem::file_type::none) return Json::array();
  if (type != std::filesystem::file_type::regular) refuse_to_keep(path + ": is not a file");
  std::ifstream stream(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  const auto damaged = [&](const std::string& why) {
    return InputError(
        fmt::format("{}: is not a {}: {}; remove it, and the setting is searched again", path, kept_kind.name, why));
  };
  if (!stream.is_open() || stream.bad()) throw InputError(path + ": cannot be read");
  try {
    const Json json = Json::parse(text);
    if (json.at("slipbench_accuracy") != schema) throw damaged(fmt::format("its slipbench_accuracy is not {}", schema));
    for (Json entry : json.at("settings")) {
      const std::string digest = entry.at("sha256").get<std::string>();
      entry.erase("sha256");
      if (digest != text_sha256(entry.dump())) throw damaged("an entry was changed");
    }
    return json.at("settings");
  } catch (const nlohmann::json::exception& error) {
    throw damaged(error.what());
  }
}

// One line: "accuracy: time_step 0.5 ms; onset 0.12 % of 1 % against the closed form, 5 trials
// looked at".
std::string line_of(const Json& entry) {
  std::string errors;
  for (const auto& [name, limit] : entry.at("wish").items()) {
    const auto info = std::ranges::find(measure_table(), name, &MeasureInfo::name);
    const Json& last = entry.at("looks").back().at("errors").at(name);
    errors +=
        fmt::format("{}{} error {}, allowed {}", errors.empty() ? "" : "; ", info->title,
                    error_text(info->measure, last.at("worst").get<double>()), error_text(info->measure, limit.get<double>()));
  }
  const std::size_t trials = entry.at("trials").size();
  return fmt::format("{}: {}, compared with {} in {}", setting_text(overrides_of(entry.at("setting"))), errors,
                     entry.at("reference").at("is").get<std::string>(),
                     trials == 1 ? "one trial" : fmt::format("{} trials", trials));
}

constexpr std::size_t most_divisors = 1000;  // of the sampling time, tried for the longest step
constexpr std::size_t most_common = 100;     // of the shortest sampling time, tried for a common divisor of all
constexpr double most_steps = 1e8;           // per trial, the limit of a scene
constexpr std::size_t most_checked = 64;     // trials in which a step must be stable

constexpr double tight_tolerance = 1e-6;  // of elastic_skin, at the longest step
constexpr std::size_t tight_cost = 2;     // as `cost` measures for scenes/soft_skin/sphere.yaml

const Override no_wish{"accuracy", "none"};

Measure measure_named(const std::string& name) {
  const auto found = std::ranges::find(measure_table(), name, &MeasureInfo::name);
  if (found == measure_table().end()) throw std::logic_error("unknown measure " + name);
  return found->measure;
}

// Rounds a time to four digits.
std::string rounded_time(const std::string& text) {
  const std::string rounded = fmt::format("{:.3e}", parse_quantity(text, Quantity::time));
  return format_quantity(parse_quantity(rounded, Quantity::time), Quantity::time);
}

struct Wish {
  Measure measure;
  double limit;
};

// Time step and solver: implicit or explicit pad springs, number of steps per sampling time, and
// whether a soft skin is solved to a tight tolerance.
struct Cut {
  bool implicit = false;
  std::size_t steps = 1;
  bool tight = false;

  [[nodiscard]] std::size_t cost() const { return (implicit ? implicit_cost : tight ? tight_cost : 1) * steps; }
};

class Search {
 public:
  explicit Search(const PlannedTrials& planned)
      : wished_(planned.plan), asked_(planned.asked), trials_(evenly_spaced(asked_, most_probed)) {
    const auto [scene, drawn] = wished_.trial(0);
    if (!scene.accuracy) return;
    for (const AccuracyScene::Wish& wish : scene.accuracy->wishes) wishes_.push_back({measure_named(wish.measure), wish.limit});
    const auto skin = std::ranges::find(scene.effects, "elastic_skin", &Named::name);
    has_choice_ = scene.dynamic() && !scene.grasp && scene.fidelity == "field" && skin == scene.effects.end();
    if (skin == scene.effects.end()) return;
    skin_ = static_cast<std::size_t>(skin - scene.effects.begin());
    // If a sweep sets the tolerance, or the effects as a whole, the tolerance is not changed here.
    const std::string ours = tolerance_path() + ".";
    if (std::ranges::any_of(drawn, [&](const auto& swept) { return ours.starts_with(swept.first + "."); })) skin_.reset();
  }

  // Empty if the scene has no accuracy requirement.
  [[nodiscard]] std::optional<FoundSetting> find() {
    if (wishes_.empty()) return std::nullopt;
    try {
      return look();
    } catch (const SceneValueError& error) {
      throw InputError(wished_.where(0, error.path()) + ": " + error.what());
    }
  }

 private:
  FoundSetting look() {
    FoundSetting found;
    found.trials = trials_;
    const std::size_t longest = longest_step();
    if (read_closed_forms()) {
      found.reference = "closed form";
      if (try_cuts(candidates(finest_reference * longest), Recording::outcome, exact_, found)) return found;
      refuse_unmet(found);
    }
    find_reference(longest, found);
    // Includes the reference's neighbouring step, whose errors are known to be small enough.
    if (!try_cuts(candidates(reference_steps_), Recording::full, reference_, found)) refuse_unmet(found);
    return found;
  }

  [[nodiscard]] double step_of(const Cut& cut) const { return sampling_time_ / static_cast<double>(cut.steps); }

  [[nodiscard]] std::string tolerance_path() const { return fmt::format("effects.{}.elastic_skin.tolerance", *skin_); }

  // Residuals of the steps of a slipping skin accumulate over the steps. Never larger than the
  // scene's own tolerance.
  [[nodiscard]] double tolerance_of(const Cut& cut) const {
    constexpr double least = 1e-10;  // lower limit of the parameter
    const double own = wished_.trial(0).scene.effects[*skin_].parameters.number("tolerance");
    return std::min(own,
                    std::max(least, tight_tolerance * static_cast<double>(explicit_steps_) / static_cast<double>(cut.steps)));
  }

  // Overrides that replace the accuracy requirement. The step reads back as the same double.
  [[nodiscard]] std::vector<Override> overrides_of(const Cut& cut) const {
    std::vector<Override> overrides{no_wish, {"time_step", format_quantity(step_of(cut), Quantity::time)}};
    if (cut.implicit) overrides.push_back({"field_solver", "implicit"});
    if (cut.tight) {
      overrides.push_back({tolerance_path(), format_number(tolerance_of(cut))});
    }
    return overrides;
  }

  // The scene of a trial with these overrides.
  [[nodiscard]] Scene scene_of(const Cut& cut, std::size_t trial) const {
    Scene scene = wished_.trial(trial).scene;
    scene.accuracy.reset();
    scene.time_step = step_of(cut);
    if (has_choice_) scene.field_solver = cut.implicit ? FieldSolver::implicit_springs : FieldSolver::explicit_springs;
    if (cut.tight) scene.effects[*skin_].parameters.set("tolerance", tolerance_of(cut));
    return scene;
  }

  [[noreturn]] void refuse(const std::string& path, const std::string& why) const {
    throw InputError(wished_.where(0, path) + ": " + path + ": " + why);
  }

  // Finds the longest time that divides the sampling times of all sensors with their own pads.
  void find_sampling_time() {
    std::set<double> rates;
    for (const std::size_t trial : evenly_spaced(asked_, most_checked)) {
      const Scene scene = wished_.trial(trial).scene;
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
    refuse("accuracy", "the sampling times of the sensors have no common time step; change the rates, or leave accuracy out");
  }

  // Reason why a trial cannot start with the setting; empty if it can.
  [[nodiscard]] std::optional<SceneValueError> refusal_of(const Cut& cut, std::size_t trial) const {
    try {
      check_trial(scene_of(cut, trial), trial);
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
    for (const std::size_t trial : evenly_spaced(asked_, most_checked)) {
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
  [[nodiscard]] std::vector<Cut> candidates(std::size_t below) const {
    std::vector<Cut> cuts;
    for (const auto& [implicit, fewest] : {std::pair{false, explicit_steps_}, std::pair{true, implicit_steps_}}) {
      for (std::size_t steps = fewest; steps > 0 && steps < below; steps *= 2) {
        cuts.push_back({implicit, steps});
        if (skin_) cuts.push_back({implicit, steps, true});
      }
    }
    std::ranges::stable_sort(cuts, {}, &Cut::cost);
    return cuts;
  }

  // True if all required measures have a closed form in all trials.
  bool read_closed_forms() {
    const bool onsets = std::ranges::all_of(
        wishes_, [](const Wish& wish) { return wish.measure == Measure::onset || wish.measure == Measure::micro_onset; });
    for (std::size_t k = 0; onsets && k < trials_.size(); ++k) {
      const std::optional<ClosedForm> exact = closed_form(wished_.trial(trials_[k]).scene, trials_[k]);
      if (!exact) break;
      exact_.push_back(*exact);
    }
    return exact_.size() == trials_.size();
  }

  // True if the errors are within `share` of the requirement.
  [[nodiscard]] bool meets(const Errors& errors, double share) const {
    return std::ranges::all_of(wishes_, [&](const Wish& wish) {
      const std::optional<MeasureError>& error = at(errors, wish.measure);
      return !error || (!error->different && error->worst <= share * wish.limit);
    });
  }

  void refuse_what_never_happens(const Errors& errors) const {
    for (const Wish& wish : wishes_) {
      if (at(errors, wish.measure)) continue;
      const MeasureInfo& info = info_of(wish.measure);
      refuse(
          fmt::format("accuracy.{}", info.name),
          fmt::format("the quantity does not occur in the examined trials ({}); leave this key out", fmt::join(trials_, ", ")));
    }
  }

  // `references`: reference of each trial.
  template <class Reference>
  bool try_cuts(const std::vector<Cut>& cuts, Recording recording, const std::vector<Reference>& references,
                FoundSetting& found) {
    for (const Cut& cut : cuts) {
      SettingLook look{overrides_of(cut), {}, {}, true};
      for (std::size_t k = 0; k < trials_.size() && look.met; ++k) {
        try {
          const Scene scene = scene_of(cut, trials_[k]);
          keep_worst(look.errors, compare(scene, run_trial(scene, trials_[k], recording), references[k]));
          look.met = meets(look.errors, margin);
        } catch (const InputError& error) {
          look.failure = fmt::format("trial {}: {}", trials_[k], error.what());
          look.met = false;
        }
      }
      if (look.met) refuse_what_never_happens(look.errors);
      found.looks.push_back(std::move(look));
      if (!found.looks.back().met) continue;
      found.overrides = found.looks.back().overrides;
      return true;
    }
    return false;
  }

  // True if the scene would have too many steps.
  [[nodiscard]] bool too_many(std::size_t steps) const {
    return wished_.trial(0).scene.duration / sampling_time_ * static_cast<double>(steps) > most_steps;
  }

  [[nodiscard]] std::vector<TrialResult> run_all(const Cut& cut) const {
    std::vector<TrialResult> results;
    for (const std::size_t trial : trials_) {
      try {
        results.push_back(run_trial(scene_of(cut, trial), trial, Recording::full));
      } catch (const InputError& error) {
        refuse("accuracy", fmt::format("trial {} with {}: {}", trial, setting_text(overrides_of(cut)), error.what()));
      }
    }
    return results;
  }

  // Halves the step until two successive runs are close enough.
  void find_reference(std::size_t longest, FoundSetting& found) {
    const bool implicit = explicit_steps_ == 0;
    Cut cut{implicit, 4 * longest, skin_.has_value()};
    reference_ = run_all(cut);
    while (true) {
      cut.steps *= 2;
      std::vector<TrialResult> results = run_all(cut);
      Errors errors;
      for (std::size_t k = 0; k < trials_.size(); ++k) {
        keep_worst(errors, compare(scene_of(cut, trials_[k]), reference_[k], results[k]));
      }
      refuse_what_never_happens(errors);
      reference_ = std::move(results);
      found.reference_overrides = overrides_of(cut);
      found.reference = setting_text(found.reference_overrides);
      found.reference_errors = errors;
      reference_steps_ = cut.steps;
      if (meets(errors, reference_share)) return;
      if (cut.steps >= finest_reference * longest || too_many(2 * cut.steps)) refuse_unsettled(errors, found.reference);
    }
  }

  // Text of the allowed requirement if an error must be at most `share` of it.
  static std::string allowed(const Wish& wish, const MeasureError& error, double share) {
    if (error.different && error.worst <= share * wish.limit) return "leave this key out";
    return fmt::format("{} or more, or leave this key out", error_text(wish.measure, error.worst / share));
  }

  // Reports that even the finest runs disagree.
  [[noreturn]] void refuse_unsettled(const Errors& errors, const std::string& reference) const {
    for (const Wish& wish : wishes_) {
      const MeasureError& error = at(errors, wish.measure).value();
      if (!error.different && error.worst <= reference_share * wish.limit) continue;
      refuse(
          fmt::format("accuracy.{}", info_of(wish.measure).name),
          fmt::format(
              "{} cannot be demonstrated: the run with {} still differs by {} from the run with twice the step{}, but a tenth of the accuracy is needed; allowed: {}",
              error_text(wish.measure, wish.limit), reference, error_text(wish.measure, error.worst),
              error.different ? ", and an event occurs in only one of them" : "", allowed(wish, error, reference_share)));
    }
    throw std::logic_error("a reference that is good enough was refused");
  }

  // Reports that no setting is accurate enough, with the error of the finest one for the first
  // requirement that it misses.
  [[noreturn]] void refuse_unmet(const FoundSetting& found) const {
    const SettingLook& last = found.looks.back();
    if (!last.failure.empty())
      refuse("accuracy", fmt::format("no setting meets it; with {}: {}", setting_text(last.overrides), last.failure));
    for (const Wish& wish : wishes_) {
      const std::optional<MeasureError>& error = at(last.errors, wish.measure);
      if (!error || (!error->different && error->worst <= margin * wish.limit)) continue;
      refuse(
          fmt::format("accuracy.{}", info_of(wish.measure).name),
          fmt::format("{} cannot be met: with {} the error is {}{}, but half of the accuracy is needed; allowed: {}",
                      error_text(wish.measure, wish.limit), setting_text(last.overrides), error_text(wish.measure, error->worst),
                      error->different ? ", and a slip occurs in only one of the runs" : "", allowed(wish, *error, margin)));
    }
    throw std::logic_error("a setting that meets the accuracy was rejected");
  }

  const TrialPlan& wished_;  // the scene unchanged
  std::size_t asked_;        // number of trials to run
  std::vector<std::size_t> trials_;
  std::vector<Wish> wishes_;
  bool has_choice_ = false;          // of the solver
  std::optional<std::size_t> skin_;  // index of elastic_skin in the scene's effects
  double sampling_time_ = 0.0;
  std::size_t explicit_steps_ = 0, implicit_steps_ = 0;  // fewest per sampling time; 0: no such setting
  std::optional<SceneValueError> last_refusal_;
  std::vector<ClosedForm> exact_;       // by examined trial
  std::vector<TrialResult> reference_;  // by examined trial
  std::size_t reference_steps_ = 0;
};

}  // namespace

std::optional<KeptSetting> setting_for(const SweepOptions& sweep, const Catalogues& catalogues,
                                       const std::function<void()>& on_search) {
  const SceneFile file = scene_file(sweep);
  if (file.root().find("accuracy") == nullptr) return std::nullopt;
  const std::uint64_t seed = sweep.seed ? *sweep.seed : parse_scene(file, catalogues).seed;
  const PlannedTrials planned = plan_trials(file, catalogues, sweep, seed);
  const Scene scene = planned.plan.trial(0).scene;
  if (!scene.accuracy) return std::nullopt;
  if (sweep.scene_text) {
    throw InputError(file.name() + ": accuracy needs a scene in a file, next to which the chosen time step is stored");
  }

  const std::string path = sweep.scene_path + ".accuracy.json";
  const Json subject = subject_of(file, scene, sweep.overrides, planned);
  Json entries = read_entries(path);
  for (const Json& entry : entries) {
    if (entry.at("subject") == subject) return KeptSetting{overrides_of(entry.at("setting")), path, line_of(entry)};
  }

  check_record(path, sweep.scene_path);  // before the long search
  if (on_search) on_search();
  const FoundSetting found = find_setting(planned).value();
  Json kept = Json::array();
  for (const Json& entry : entries) {
    if (entry.at("subject").at("scene_sha256") == subject.at("scene_sha256")) kept.push_back(entry);
  }
  while (kept.size() >= most_kept) kept.erase(0);
  kept.push_back(entry_of(subject, scene, found));
  write_text_file(path, Json{{"slipbench_accuracy", schema}, {"settings", kept}}.dump(1) + "\n");
  return KeptSetting{found.overrides, path, line_of(kept.back())};
}

std::optional<FoundSetting> find_setting(const PlannedTrials& planned) { return Search(planned).find(); }

std::string setting_text(const std::vector<Override>& overrides) {
  std::string text;
  for (const Override& change : overrides) {
    if (change.path == no_wish.path) continue;
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
