// Table III of the nib pad's paper: a box turned up by rotational slip and released, over weights, centres of mass and surfaces.
#include "tools/studies/nib_reconfigurable/nib_tables.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "sim/core/math.h"
#include "tools/program/catalogue/program_catalogues.h"
#include "tools/studies/grid.h"

namespace slipbench::reproduce {
namespace {

constexpr std::size_t pose_size = 7;
constexpr double upright = 0.0872664625997164788;  // rad, 5 degrees, as TurnOutcome has it

const float* pose_of(const TrialRecord& record, std::string_view body, std::size_t row) {
  return record.body(body).pose.data() + pose_size * row;
}

// Between the body's axis Y and the vertical: of a rotation by (w, x, y, z) the entry of Y upwards is 2 (y z + w x).
double tilt_of(const float* pose) {
  const double w = pose[3], x = pose[4], y = pose[5], z = pose[6];
  return math::acos(std::min(1.0, std::abs(2.0 * (y * z + w * x))));
}

double median_of(const ReorientRuns& runs, double (*figure)(const ReorientRun&)) {
  std::vector<double> values;
  for (const ReorientRun& run : runs) {
    if (const double value = figure(run); !std::isnan(value)) values.push_back(value);
  }
  return quantile(std::move(values), 0.5);
}

// What Table III of the nib pad's paper simulates, a box that is turned up and released, and what the trials of a cell come to.
constexpr const char* reorient_scene = "scenes/nib_pad/reorient.yaml";
constexpr std::size_t published_runs = 11;

struct ReorientCell {
  std::string name, text;
  std::optional<std::size_t> published;  // successes of published_runs; empty: a change of ours
  std::vector<Override> overrides;

  // With `draws` trials.
  [[nodiscard]] GridCell grid(std::size_t draws) const { return {name, reorient_scene, overrides, {}, draws}; }
};

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
  for (const auto& [name, unit] :
       {std::pair{"fl_slip", ""}, {"fr_slip", ""}, {"fr_quiet", " s"}, {"fr_upright", ""}, {"released_normal", " N"}}) {
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

std::string share_text(std::size_t k, std::size_t n) {
  const Interval share = clopper_pearson(k, n);
  return fmt::format("{} of {} ({:.0f} to {:.0f} %)", k, n, 100.0 * share.low, 100.0 * share.high);
}

std::string tilt_text(double tilt) { return std::isnan(tilt) ? "-" : fmt::format("{:.1f} deg", 180.0 / std::numbers::pi * tilt); }
std::string force_text(double force) { return std::isnan(force) ? "-" : fmt::format("{:.2f} N", force); }

std::vector<std::string> success_row(const ReorientCell& cell, const ReorientSummary& summary) {
  return {cell.text,
          cell.published ? fmt::format("{} of {}", *cell.published, published_runs) : "",
          share_text(summary.standing, summary.runs),
          fmt::format("{} of {}", summary.turned_up, summary.runs),
          fmt::format("{} of {}", summary.dropped, summary.runs),
          tilt_text(summary.tilt),
          tilt_text(summary.least_tilt),
          force_text(summary.most_force)};
}

std::vector<std::string> ends_row(const ReorientCell& cell, const ReorientSummary& summary) {
  std::vector<std::string> row{cell.text};
  for (const std::size_t n : summary.ends) row.push_back(std::to_string(n));
  row.push_back(tilt_text(summary.released_tilt));
  row.push_back(force_text(summary.held_by));
  return row;
}

Json cell_json(const ReorientCell& cell, const ReorientSummary& summary, std::uint64_t seed) {
  const Interval share = clopper_pearson(summary.standing, summary.runs);
  Json ends = Json::object();
  for (std::size_t end = 0; end < turn_ends; ++end) ends[turn_end_names.at(end)] = summary.ends.at(end);
  return {{"name", cell.name},
          {"command", cell.grid(summary.runs).command(seed)},
          {"published", or_null(cell.published)},
          {"trials", summary.runs},
          {"standing", summary.standing},
          {"standing_share_95", {share.low, share.high}},
          {"turned_up", summary.turned_up},
          {"dropped", summary.dropped},
          {"ends", ends},
          {"median_tilt_rad", summary.tilt},
          {"median_least_tilt_rad", summary.least_tilt},
          {"median_max_grip_force_N", summary.most_force}};
}

}  // namespace

Turn turn_of(const TrialRecord& record, double target) {
  const double never = std::numeric_limits<double>::quiet_NaN();
  const std::size_t rows = record.num_samples();
  if (!record.outcome.grasp || !record.outcome.grasp->turn || !record.control || rows == 0 ||
      record.control->grip.arm.size() != 2 * rows || record.control->grip.grip_force.size() != rows) {
    throw std::logic_error("turn_of: no full record of a guided grasp");
  }
  const TurnOutcome& outcome = *record.outcome.grasp->turn;
  const GripRecord& grip = record.control->grip;

  std::size_t released = 0;
  bool rising = false, lost = false;
  for (; released < rows && grip.arm[2 * released] == 0.0F; ++released) {
    rising = rising || grip.arm[2 * released + 1] > 0.0F;
    lost = lost || (rising && grip.grip_force[released] == 0.0F);
  }
  Turn turn{TurnEnd::standing, never, never};
  if (released < rows) {
    turn.tilt = tilt_of(pose_of(record, "box", released));
    turn.force = grip.grip_force[released];
  }
  if (outcome.standing) return turn;
  if (lost) {
    turn.end = TurnEnd::lost;
  } else if (released == rows) {
    turn.end = TurnEnd::not_released;
  } else if (outcome.tilt < upright) {
    turn.end = TurnEnd::not_let_go;
  } else if (outcome.least_tilt < turned_up) {
    turn.end = TurnEnd::fell;
  } else {
    const double rise = pose_of(record, "arm", released)[2] - pose_of(record, "arm", 0)[2];
    constexpr double lag = 1e-3;  // m, of the arm behind what it has been told, at 10 mm/s
    turn.end = rise < target - lag ? TurnEnd::told_early : TurnEnd::not_turned;
  }
  return turn;
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

Result nib_table3(const ReproduceOptions& options) {
  const std::uint64_t seed = options.seed.value_or(1);
  const std::size_t trials = options.trials == 0 ? published_runs : options.trials;
  const std::vector<ReorientCell> cells = rows_asked_for(all_cells(), options);
  const std::vector<ReorientRuns> results = run_reorientations(cells, trials, options);
  Result result;
  result.title = "Reorientation of a box by rotational slip, and its release";
  result.source =
      "Table III and section VI of \"Dynamically Reconfigurable Tactile Sensor for Robotic Manipulation\", IEEE RA-L 2020";
  result.setup = {
      fmt::format("{}, seed {}, {} trials a cell, which differ by what `scatter` draws, the patches and the noise.",
                  reorient_scene, seed, trials),
      "Success: at the trial's end the box is upright to 5 degrees, the table carries it and no pad touches it.",
      "Turned up: at some time nearer than 20 degrees to upright, whatever came after.",
      "The paper's row of weights, of centres of mass and of surfaces share one cell, 200 g in the middle with paper: 10 of 11.",
      "Intervals: 95 %, exact (Clopper and Pearson).",
  };
  result.figures["cells"] = Json::array();
  ResultTable table{.title = "Success, by cell",
                    .head = {"cell", "published", "here (95 %)", "turned up", "dropped", "tilt at the end, median",
                             "least tilt, median", "peak grip force, median"},
                    .rows = {},
                    .note = "Rows without a published figure change one number in the cell 200g."};
  ResultTable ends{.title = "What became of the boxes, by cell",
                   .head = {"cell", "standing", "lost", "told early", "not turned", "fell", "not let go", "not released",
                            "tilt when released, median", "grip force then, median"},
                   .rows = {},
                   .note = {}};
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const ReorientSummary summary = summary_of(results[i]);
    table.rows.push_back(success_row(cells[i], summary));
    ends.rows.push_back(ends_row(cells[i], summary));
    result.figures["cells"].push_back(cell_json(cells[i], summary, seed));
    if (!cells[i].published) continue;
    const auto share = [](std::size_t standing, std::size_t runs) {
      return 100.0 * static_cast<double>(standing) / static_cast<double>(runs);
    };
    result.real.push_back({fmt::format("boxes turned up and released, {}, %", cells[i].name),
                           share(*cells[i].published, published_runs), share(summary.standing, summary.runs),
                           "thresholds assumed, with these runs in view"});
  }
  result.tables.push_back(std::move(table));
  result.tables.push_back(std::move(ends));
  result.remarks = {
      "The height of the grip over the edge is l sin(theta): it no longer grows once theta is 90 degrees, when a box of 54 mm, held in its middle 137.5 mm from the end, still leans by 11 degrees. What stands it up from there is its weight, which is beyond the edge from 19 degrees on with the centre of mass in the middle, 28 at L/3, 15 at 2L/3.",
      "Lost: no pad touched the box any more before the release began. Told early: the release began below TargetPoint, and the box was never nearer than 20 degrees to upright. Not turned: the same at TargetPoint. Fell: nearer than that at some time, and not upright at the end. Not let go: upright, but a pad touched it. Not released: the arm rose to the end of the trial.",
      "The paper prints no threshold; slipbench describe reorient says where each of the controller's comes from, and the last rows what halving or doubling it does.",
      "Both fingers of the paper are read until both touch; here only one finger's pad has electronics.",
  };
  return result;
}

}  // namespace slipbench::reproduce
