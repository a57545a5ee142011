#include "tools/program/cost/explore.h"

#include <algorithm>

#include <fmt/format.h>

namespace slipbench::cost {
namespace {

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
      fmt::format("a run of the same scene with steps of {}, whose own error is estimated by one of twice the step",
                  short_text(reference.time_step));
  return reference.closed_onsets ? fmt::format("Onsets are compared with their closed form, all else with {}.", fine)
                                 : fmt::format("All is compared with {}.", fine);
}

}  // namespace

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

}  // namespace slipbench::cost
