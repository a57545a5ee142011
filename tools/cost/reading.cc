#include "tools/cost/reading.h"

// Evaluates an exploration: fronts, the cheapest settings, plain sentences.

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "sim/core/counted.h"
#include "sim/core/math/decade.h"
#include "tools/cost/explore.h"

namespace slipbench::cost {
namespace {

// Measures with a sentence each. Forces and labels follow onsets so closely that more would repeat
// them.
constexpr std::array stated_measures{Measure::onset, Measure::force, Measure::label, Measure::creep};
// In the measure's own units: shares, and m/s of creep.
constexpr std::array stated_shares{1e-2, 1e-3};
constexpr std::array stated_creeps{1e-6, 1e-8};

constexpr std::string_view contact_series = "contact";

bool comparable(const Row& row, Measure measure) {
  const std::optional<MeasureError>& error = at(row.errors, measure);
  return row.ok() && row.cpu && error && !error->different;
}

bool apart(const Row& row) { return series_of(row.setting).own_reference; }

// "0.17 %", "1420 %"
std::string limit_text(const MeasureInfo& info, double limit) {
  return fmt::format("{} {}", ratio_text(info.factor * limit), info.unit);
}

// "380 times real time". `cost`: CPU seconds per simulated second.
std::string speed_text(double cost) { return fmt::format("{} times real time", ratio_text(1.0 / cost)); }

// The row of the series with the least worst error; null if none is comparable.
const Row* best_of(const Exploration& exploration, Measure measure, std::string_view series) {
  const Row* best = nullptr;
  for (const Row& row : exploration.rows) {
    if (row.setting.series != series || !comparable(row, measure) || !as_often(exploration, row)) continue;
    if (best == nullptr || at(row.errors, measure)->worst < at(best->errors, measure)->worst) best = &row;
  }
  return best;
}

bool has_series(const Exploration& exploration, std::string_view series) {
  return std::ranges::any_of(exploration.rows, [&](const Row& row) { return row.setting.series == series; });
}

// Numbers of the settings of MuJoCo's own contact by their result.
struct ContactCounts {
  std::size_t all = 0, refused = 0, not_run = 0;
  std::size_t failed = 0;    // ran and failed
  std::size_t slower = 0;    // ran with an output rate below the scene's
  std::size_t compared = 0;  // ran and can be compared
  std::string why = {};      // of a refusal
};
ContactCounts contact_counts(const Exploration& exploration) {
  ContactCounts counts;
  for (const Row& row : exploration.rows) {
    if (row.setting.series != contact_series) continue;
    ++counts.all;
    switch (row.status) {
      case Status::ok: ++(as_often(exploration, row) ? counts.compared : counts.slower); break;
      case Status::refused:
        ++counts.refused;
        counts.why = row.why;
        break;
      case Status::over_budget: ++counts.not_run; break;
      case Status::warning:
      case Status::diverged: ++counts.failed; break;
    }
  }
  return counts;
}

std::string contact_text(const Exploration& exploration, Measure measure, double limit, const Row& cheapest_row) {
  const MeasureInfo& info = info_of(measure);
  const ContactCounts counts = contact_counts(exploration);
  if (const Row* const contact = cheapest(exploration, measure, limit, contact_series)) {
    return fmt::format("MuJoCo's own contact: {} ({}), {} times slower", speed_text(exploration.cost(*contact)),
                       contact->setting.label, ratio_text(exploration.cost(*contact) / exploration.cost(cheapest_row)));
  }
  if (counts.refused == counts.all) return fmt::format("MuJoCo's own contact: not possible ({})", counts.why);
  if (counts.not_run + counts.refused == counts.all) return "MuJoCo's own contact: not tried, because the budget was used up";
  if (counts.compared == 0) return "MuJoCo's own contact: no run can be compared";
  const std::string none = fmt::format("MuJoCo's own contact: not reached by its {}", counted(counts.compared, "setting"));
  const Row* const best = best_of(exploration, measure, contact_series);
  if (best == nullptr) return none + ", in which other events occur";
  return fmt::format("{}, {} at best ({}, {})", none, limit_text(info, at(best->errors, measure)->worst), best->setting.label,
                     speed_text(exploration.cost(*best)));
}

// Counts of settings without a result; empty if there are none.
std::string left_out_text(const ContactCounts& counts) {
  std::vector<std::string> parts;
  const auto add = [&parts](std::size_t count, std::string_view what) {
    if (count > 0) parts.push_back(fmt::format("{} {}", count, what));
  };
  add(counts.failed, "diverged");
  add(counts.slower, "had a lower output rate than the scene");
  add(counts.refused, "refused");
  add(counts.not_run, "not run, because the budget was used up");
  if (parts.empty()) return "";
  const std::size_t left_out = counts.all - counts.compared;
  return fmt::format("{} of {} of MuJoCo's own contact {} not counted: {}.", left_out, counted(counts.all, "setting"),
                     left_out == 1 ? "is" : "are", fmt::join(parts, ", "));
}

void append_statement(const Exploration& exploration, Measure measure, double limit, std::vector<std::string>& lines) {
  const MeasureInfo& info = info_of(measure);
  const std::string subject = fmt::format("{}, error up to {}", info.title, limit_text(info, limit));
  if (const auto& own = at(exploration.reference.own_error, measure); own && (own->different || own->worst > limit)) {
    lines.push_back(fmt::format("{}: the reference itself is less accurate, so no statement is possible.", subject));
    return;
  }
  const Row* const row = cheapest(exploration, measure, limit);
  if (row == nullptr) {
    lines.push_back(fmt::format("{}: not reached by any setting.", subject));
    return;
  }
  std::string line = fmt::format("{}: {} ({})", subject, speed_text(exploration.cost(*row)), setting_text(*row));
  if (row->setting.series != contact_series && has_series(exploration, contact_series)) {
    line += "; " + contact_text(exploration, measure, limit, *row);
  }
  lines.push_back(line + ".");
}

std::string reference_text(const Exploration& exploration) {
  std::vector<std::string> open;
  for (const MeasureInfo& info : measure_table()) {
    const std::optional<MeasureError>& error = at(exploration.reference.own_error, info.measure);
    if (!error || (!error->different && error->worst <= converged_error(info.measure))) continue;
    open.push_back(error->different ? fmt::format("{} (an event occurs in only one of two fine runs)", info.title)
                                    : fmt::format("{} ({})", info.title, limit_text(info, error->worst)));
  }
  return fmt::format("The reference has not converged: {}. Smaller errors than these are meaningless.", fmt::join(open, ", "));
}

Json json_of(const MeasureError& error) { return {{"worst", error.worst}, {"median", error.median}}; }

Json json_of(const std::optional<CpuTime>& cpu) {
  if (!cpu) return nullptr;
  return {{"median", cpu->median}, {"low", or_null(cpu->low)}, {"high", or_null(cpu->high)}, {"repeats", cpu->repeats}};
}

Json errors_json(const Errors& errors) {
  Json json = Json::object();
  for (const MeasureInfo& info : measure_table()) {
    if (const auto& error = at(errors, info.measure)) json[std::string(info.name)] = json_of(*error);
  }
  return json;
}

Json different_json(const Errors& errors) {
  Json json = Json::array();
  for (const MeasureInfo& info : measure_table()) {
    if (const auto& error = at(errors, info.measure); error && error->different) json.push_back(info.name);
  }
  return json;
}

Json measures_json(const Exploration& exploration) {
  Json json = Json::array();
  for (const MeasureInfo& info : measure_table()) {
    if (!at(exploration.own().errors, info.measure)) continue;
    const bool closed =
        exploration.reference.closed_onsets && (info.measure == Measure::onset || info.measure == Measure::micro_onset);
    const auto& floor = at(exploration.reference.own_error, info.measure);
    json.push_back({{"name", info.name},
                    {"title", info.title},
                    {"unit", info.unit},
                    {"factor", info.factor},
                    {"definition", info.definition},
                    {"reference", closed ? "closed form" : "fine run"},
                    {"floor", floor && !closed ? Json(floor->worst) : Json(nullptr)}});
  }
  return json;
}

Json row_json(const Exploration& exploration, const Row& row) {
  Json front = Json::array();
  for (const Measure measure : row.front) front.push_back(info_of(measure).name);
  return {{"series", row.setting.series},
          {"label", row.setting.label},
          {"settings", setting_text(row)},
          {"command", row.command},
          {"own", row.own},
          {"rate_hz", row.rate > 0.0 ? Json(row.rate) : Json(nullptr)},
          {"status", status_name(row.status)},
          {"why", row.why},
          {"cpu_s", json_of(row.cpu)},
          {"cost", row.cpu ? Json(exploration.cost(row)) : Json()},
          {"errors", errors_json(row.errors)},
          {"different", different_json(row.errors)},
          {"pareto", front}};
}

Json price_json(const Price& price) {
  return {{"name", price.name},
          {"kind", price.electronics ? "electronics" : "effect"},
          {"status", price.why.empty() ? "ok" : "does not run"},
          {"why", price.why},
          {"share", price.why.empty() ? Json(price.share) : Json(nullptr)},
          {"low", price.why.empty() ? or_null(price.low) : Json(nullptr)},
          {"high", price.why.empty() ? or_null(price.high) : Json(nullptr)},
          {"changes", errors_json(price.changes)},
          {"different", different_json(price.changes)},
          {"verdict", verdict(price)},
          {"idle", price.idle()}};
}

std::string reference_text(const Reference& reference) {
  const std::string fine =
      fmt::format("a run of the same scene with time steps of {}, whose error is estimated by a run with twice the step",
                  short_text(reference.time_step));
  return reference.closed_onsets ? fmt::format("Onsets are compared with their closed form, everything else with {}.", fine)
                                 : fmt::format("Everything is compared with {}.", fine);
}

}  // namespace

void mark_fronts(Exploration& exploration) {
  std::vector<Row*> rows;
  for (Row& row : exploration.rows) {
    if (row.ok() && row.cpu && !apart(row) && as_often(exploration, row)) rows.push_back(&row);
  }
  std::ranges::stable_sort(rows, {}, [](const Row* row) { return row->cpu->median; });
  for (const MeasureInfo& info : measure_table()) {
    double least = std::numeric_limits<double>::infinity();
    for (Row* const row : rows) {
      if (!comparable(*row, info.measure) || at(row->errors, info.measure)->worst >= least) continue;
      least = at(row->errors, info.measure)->worst;
      row->front.push_back(info.measure);
    }
  }
}

bool as_often(const Exploration& exploration, const Row& row) { return row.rate >= exploration.own().rate; }

const Row* cheapest(const Exploration& exploration, Measure measure, double limit, std::string_view only) {
  const Row* best = nullptr;
  for (const Row& row : exploration.rows) {
    if (only.empty() ? apart(row) : row.setting.series != only) continue;
    if (!comparable(row, measure) || !as_often(exploration, row) || at(row.errors, measure)->worst > limit) continue;
    if (best == nullptr || row.cpu->median < best->cpu->median) best = &row;
  }
  return best;
}

std::string ratio_text(double ratio) {
  if (ratio < 1000.0) return fmt::format("{:.3g}", ratio);
  const double unit = power_of_ten(decade_of(ratio) - 2);
  return fmt::format("{:.0f}", std::round(ratio / unit) * unit);
}

std::string setting_text(const Row& row) { return fmt::format("{}, {}", series_of(row.setting).title, row.setting.label); }

std::string verdict(const Price& price) {
  if (!price.why.empty()) return "does not run: " + price.why;
  const std::string costs =
      price.low > 0.0 ? fmt::format("costs {:.2g} %", 100.0 * price.share) : "costs less than the scatter of the CPU time";
  const MeasureInfo* most = nullptr;
  double change = 0.0;
  // Measures in different units are compared by their multiple of converged_error().
  const auto weight = [](Measure measure, double error) { return error / converged_error(measure); };
  for (const MeasureInfo& info : measure_table()) {
    const std::optional<MeasureError>& error = at(price.changes, info.measure);
    if (!error) continue;
    if (error->different) {
      return fmt::format("{}; {}: an event occurs only with it or only without it", costs, info.title);
    }
    if (error->worst <= 0.0 || (most != nullptr && weight(info.measure, error->worst) <= weight(most->measure, change))) continue;
    most = &info;
    change = error->worst;
  }
  if (most == nullptr) return costs + " and changes nothing";
  return fmt::format("{}; changes {} most, by {}", costs, most->title, limit_text(*most, change));
}

std::vector<std::string> sentences(const Exploration& exploration) {
  std::vector<std::string> lines;
  for (const Measure measure : stated_measures) {
    if (!at(exploration.own().errors, measure)) continue;
    for (const double limit : measure == Measure::creep ? stated_creeps : stated_shares)
      append_statement(exploration, measure, limit, lines);
  }
  if (!exploration.reference.converged) lines.push_back(reference_text(exploration));
  const ContactCounts counts = contact_counts(exploration);
  if (const std::string left_out = left_out_text(counts); counts.refused < counts.all && !left_out.empty())
    lines.push_back(left_out);
  if (exploration.one_friction && has_series(exploration, contact_series)) {
    lines.push_back("MuJoCo's own contact has one coefficient of friction: its rows use the scene's static one.");
  }
  if (exploration.interrupted) lines.push_back("Interrupted: the results are incomplete.");
  for (const Price& price : exploration.prices) {
    if (price.idle())
      lines.push_back(
          fmt::format("{} costs {:.2g} % of the time and changes no measured quantity.", price.name, 100.0 * price.share));
  }
  return lines;
}

Json cost_json(const Exploration& exploration, const Json& environment) {
  Json series = Json::array();
  for (const Series& one : all_series()) {
    const auto in_it = [&](const Row& row) { return row.setting.series == one.name; };
    if (std::ranges::any_of(exploration.rows, in_it)) {
      series.push_back({{"name", one.name}, {"title", one.title}, {"own_reference", one.own_reference}});
    }
  }
  Json rows = Json::array(), effects = Json::array();
  for (const Row& row : exploration.rows) rows.push_back(row_json(exploration, row));
  for (const Price& price : exploration.prices) effects.push_back(price_json(price));
  const Reference& reference = exploration.reference;
  return {{"slipbench_cost", 1},
          {"scene", exploration.scene_path},
          {"description", exploration.description},
          {"command", exploration.command},
          {"seed", exploration.seed},
          {"trial", exploration.trial},
          {"budget_s", exploration.budget},
          {"elapsed_s", exploration.elapsed},
          {"simulated_s", exploration.simulated},
          {"interrupted", exploration.interrupted},
          {"environment", environment},
          {"reference",
           {{"kind", reference.closed_onsets ? "closed form" : "fine run"},
            {"settings", short_text(reference.time_step)},
            {"command", reference.command},
            {"own_error", errors_json(reference.own_error)},
            {"converged", reference.converged},
            {"text", reference_text(reference)}}},
          {"measures", measures_json(exploration)},
          {"series", series},
          {"rows", rows},
          {"sentences", sentences(exploration)},
          {"effects", effects}};
}

std::string cost_page(const Json& result) {
  if (!result.is_object() || result.empty() || std::ranges::find(page_kind.keys, result.begin().key()) == page_kind.keys.end()) {
    throw std::logic_error("the result of a cost exploration begins with its kind");
  }
  const std::string title =
      result.contains("scene") ? result.at("scene").get<std::string>() : "stability";  // in the browser's tab
  return page::compose_drawn_page({page_kind.generator, title + " · slipbench cost"}, assets(), result);
}

}  // namespace slipbench::cost
