#include "tools/studies/nib_reconfigurable/nib_table3_run.h"

#include <algorithm>
#include <cmath>

#include "tools/base/statistics/descriptive.h"
#include "tools/program/catalogue/program_catalogues.h"

namespace slipbench::reproduce {
namespace {

Parameters reorient_defaults() {
  const Catalogues catalogues = program_catalogues();
  return defaults_of(std::ranges::find(catalogues.controllers, "reorient", &Entry::name)->parameters);
}

// With 118 g in the box's middle and 200 g at y the common centre is 200/318 y from there; a sixth of 155 mm takes 41.08 mm.
std::vector<ReorientCell> all_cells() {
  const auto surface = [](const char* material, const char* friction) {
    return std::vector<Override>{{"surface.material", material}, {"friction.static", friction}, {"friction.kinetic", friction}};
  };
  std::vector<ReorientCell> cells{
      {"200g", "200 g in the middle, paper", 10, {}},
      {"100g", "100 g in the middle, paper", 9, {{"box.weight", "100 g"}}},
      {"300g", "300 g in the middle, paper", 7, {{"box.weight", "300 g"}}},
      {"com_low", "200 g, centre of mass at L/3 from the end it stands on", 11, {{"box.weight_place", "[0 mm, 41.08 mm, 0 mm]"}}},
      {"com_high", "200 g, centre of mass at 2L/3", 3, {{"box.weight_place", "[0 mm, -41.08 mm, 0 mm]"}}},
      {"masonite", "200 g in the middle, masonite", 10, surface("masonite", "0.5")},
      {"wavy", "200 g in the middle, friction of wavy acrylic, without its waves", 10, surface("wavy_acrylic", "0.55")}};
  const Parameters defaults = reorient_defaults();
  struct Threshold {
    const char *name, *unit;
  };
  for (const auto& [name, unit] : {Threshold{"fl_slip", ""}, Threshold{"fr_slip", ""}, Threshold{"fr_quiet", " s"},
                                   Threshold{"fr_upright", ""}, Threshold{"released_normal", " N"}}) {
    for (const double factor : {0.5, 2.0}) {
      cells.push_back({fmt::format("{}_x{}", name, factor),
                       fmt::format("200g with {} x {}", name, factor),
                       std::nullopt,
                       {{fmt::format("controller.{}", name), fmt::format("{}{}", factor * defaults.number(name), unit)}}});
    }
  }
  cells.push_back(
      {"stick_slip", "200g with kinetic friction of 0.9 times the static one", std::nullopt, {{"friction.kinetic", "0.585"}}});
  return cells;
}

double median_of(const ReorientRuns& runs, double (*figure)(const ReorientRun&)) {
  std::vector<double> values;
  for (const ReorientRun& run : runs) {
    if (const double value = figure(run); !std::isnan(value)) values.push_back(value);
  }
  return quantile(std::move(values), 0.5);
}

}  // namespace

std::vector<ReorientCell> reorient_cells(const std::vector<std::string>& only) {
  const std::vector<ReorientCell> cells = all_cells();
  check_only(only, names_of(cells));
  return chosen(cells, only);
}

std::vector<ReorientRuns> run_reorientations(const std::vector<ReorientCell>& cells, std::size_t trials,
                                             const ReproduceOptions& options) {
  std::vector<GridCell> grid;
  for (const ReorientCell& cell : cells) grid.push_back(cell.grid(trials));
  return run_grid<ReorientRun>(grid, options, [target = reorient_defaults().number("target")](const GridTrial& trial) {
    const TrialRecord record = trial.record();
    const GraspOutcome& grasp = record.outcome.grasp.value();
    return ReorientRun{grasp.turn->standing,   grasp.dropped,        grasp.turn->tilt,
                       grasp.turn->least_tilt, grasp.max_grip_force, turn_of(record, target)};
  });
}

ReorientSummary summary_of(const ReorientRuns& runs) {
  ReorientSummary summary{.runs = runs.size()};
  for (const ReorientRun& run : runs) {
    summary.standing += run.standing ? 1 : 0;
    summary.turned_up += run.least_tilt < turned_up ? 1 : 0;
    summary.dropped += run.dropped ? 1 : 0;
    ++summary.ends.at(static_cast<std::size_t>(run.turn.end));
  }
  summary.tilt = median_of(runs, [](const ReorientRun& run) { return run.tilt; });
  summary.least_tilt = median_of(runs, [](const ReorientRun& run) { return run.least_tilt; });
  summary.most_force = median_of(runs, [](const ReorientRun& run) { return run.most_force; });
  summary.released_tilt = median_of(runs, [](const ReorientRun& run) { return run.turn.tilt; });
  summary.held_by = median_of(runs, [](const ReorientRun& run) { return run.turn.force; });
  return summary;
}

}  // namespace slipbench::reproduce
