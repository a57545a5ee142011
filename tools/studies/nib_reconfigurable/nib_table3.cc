// Table III of the nib pad's paper: a box turned up by rotational slip and released, over weights, centres of mass and surfaces.
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "tools/base/statistics/binomial.h"
#include "tools/studies/nib_reconfigurable/nib_table3_run.h"

namespace slipbench::reproduce {
namespace {

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
          {"published", cell.published ? Json(*cell.published) : Json(nullptr)},
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

Result nib_table3(const ReproduceOptions& options) {
  const std::uint64_t seed = options.seed.value_or(1);
  const std::size_t trials = options.trials == 0 ? published_runs : options.trials;
  const std::vector<ReorientCell> cells = reorient_cells(options.only);
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
