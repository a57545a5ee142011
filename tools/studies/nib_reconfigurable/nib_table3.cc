// Table III of the nib pad's paper: a box turned up by rotational slip and released, over weights, centres of mass and surfaces.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <thread>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/scene/parser.h"
#include "tools/base/project/project_file.h"
#include "tools/base/statistics/binomial.h"
#include "tools/base/statistics/descriptive.h"
#include "tools/base/workers/interrupt.h"
#include "tools/base/workers/ordered_workers.h"
#include "tools/program/catalogue/program_catalogues.h"
#include "tools/program/run/run_trial.h"
#include "tools/studies/nib_reconfigurable/turn_loss.h"
#include "tools/studies/study_catalogue.h"

namespace slipbench::reproduce {
namespace {

constexpr const char* reorient_scene = "scenes/nib_pad/reorient.yaml";
constexpr std::size_t published_runs = 11;
constexpr double degrees = 180.0 / std::numbers::pi;

struct ReorientCell {
  std::string name, text;
  std::optional<std::size_t> published;  // successes of published_runs; empty: a change of ours
  std::vector<Override> overrides;

  [[nodiscard]] std::string command(std::uint64_t seed) const {
    std::string line = fmt::format("slipbench run {}", reorient_scene);
    for (const Override& change : overrides) line += fmt::format(" --set '{}={}'", change.path, change.value);
    return fmt::format("{} --seed {}", line, seed);
  }
};

Parameters reorient_defaults() {
  const Catalogues catalogues = program_catalogues();
  return defaults_of(std::ranges::find(catalogues.controllers, "reorient", &Entry::name)->parameters);
}

// With 118 g in the box's middle and 200 g at y the common centre is 200/318 y from there; a sixth of 155 mm takes 41.08 mm.
std::vector<ReorientCell> reorient_cells() {
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

struct ReorientFigures {
  bool standing = false, dropped = false;
  double tilt = 0.0, least_tilt = 0.0;  // rad
  double most_force = 0.0;              // N
  Turn turn;
};

std::vector<ReorientCell> chosen_cells(const std::vector<std::string>& only) {
  std::vector<ReorientCell> cells = reorient_cells();
  std::vector<std::string> names;
  for (const ReorientCell& cell : cells) names.push_back(cell.name);
  for (const std::string& name : only) {
    if (std::ranges::find(names, name) == names.end()) {
      throw InputError(fmt::format("reproduce: --only: unknown name {}{}", quote(name), allowed_names(name, names)));
    }
  }
  if (!only.empty())
    std::erase_if(cells, [&](const ReorientCell& cell) { return std::ranges::find(only, cell.name) == only.end(); });
  return cells;
}

using Runs = std::vector<ReorientFigures>;

// Trials of the same number have the same draws in every cell.
std::vector<Runs> run_reorientations(const std::vector<ReorientCell>& cells, std::size_t trials, std::uint64_t seed,
                                     const ReproduceOptions& options) {
  const InterruptGuard guard("ending after the trials at hand");
  const Catalogues catalogues = program_catalogues();
  const double target = reorient_defaults().number("target");
  std::vector<std::optional<TrialPlan>> plans;
  for (const ReorientCell& cell : cells) {
    SceneFile file = SceneFile::load(project_file(reorient_scene));
    for (const Override& change : cell.overrides) file.apply(change);
    plans.emplace_back(std::in_place, file, catalogues, trials, seed);
  }
  const auto one = [&](std::size_t index) {
    const std::size_t cell = index / trials, trial = index % trials;
    try {
      Scene scene = plans[cell]->trial(trial).scene;
      scene.seed = seed;
      const TrialRecord record = run_trial(scene, trial, Recording::full).record;
      const GraspOutcome& grasp = record.outcome.grasp.value();
      return ReorientFigures{grasp.turn->standing,   grasp.dropped,        grasp.turn->tilt,
                             grasp.turn->least_tilt, grasp.max_grip_force, turn_of(record, target)};
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}, trial {}: {}; the same: {} --trials {} --trial {}", cells[cell].name, trial, error.what(),
                                   cells[cell].command(seed), trial + 1, trial));
    }
  };
  const std::size_t total = cells.size() * trials;
  const std::size_t threads = options.jobs != 0 ? options.jobs : std::max(1U, std::thread::hardware_concurrency());
  OrderedWorkers<ReorientFigures> workers(
      total, std::min(threads, std::max<std::size_t>(1, total)), [&] { return one; }, &InterruptGuard::flag());
  std::vector<Runs> results(cells.size());
  for (std::size_t i = 0; i < total; ++i) {
    if (options.say && i % trials == 0) options.say(fmt::format("{} ({} of {} trials done)", cells[i / trials].name, i, total));
    std::optional<ReorientFigures> figures = workers.next();
    if (!figures) throw Interrupted();
    results[i / trials].push_back(*figures);
  }
  return results;
}

std::string share_text(std::size_t k, std::size_t n) {
  const Interval share = clopper_pearson(k, n);
  return fmt::format("{} of {} ({:.0f} to {:.0f} %)", k, n, 100.0 * share.low, 100.0 * share.high);
}

template <class Figure>
double median_over(const Runs& runs, Figure&& figure) {
  std::vector<double> values;
  for (const ReorientFigures& run : runs) {
    if (const double value = figure(run); !std::isnan(value)) values.push_back(value);
  }
  return median(std::move(values));
}

}  // namespace

Result nib_table3(const ReproduceOptions& options) {
  const std::uint64_t seed = options.seed.value_or(1);
  const std::size_t trials = options.trials == 0 ? published_runs : options.trials;
  const std::vector<ReorientCell> cells = chosen_cells(options.only);
  const std::vector<Runs> results = run_reorientations(cells, trials, seed, options);
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
    const Runs& runs = results[i];
    const auto count = [&](auto&& of) { return static_cast<std::size_t>(std::ranges::count_if(runs, of)); };
    const std::size_t standing = count([](const ReorientFigures& run) { return run.standing; });
    const std::size_t up = count([](const ReorientFigures& run) { return run.least_tilt < turned_up; });
    const std::size_t dropped = count([](const ReorientFigures& run) { return run.dropped; });
    const double tilt = median_over(runs, [](const ReorientFigures& run) { return run.tilt; });
    const double least = median_over(runs, [](const ReorientFigures& run) { return run.least_tilt; });
    const double force = median_over(runs, [](const ReorientFigures& run) { return run.most_force; });
    table.rows.push_back({cells[i].text, cells[i].published ? fmt::format("{} of {}", *cells[i].published, published_runs) : "",
                          share_text(standing, runs.size()), fmt::format("{} of {}", up, runs.size()),
                          fmt::format("{} of {}", dropped, runs.size()), fmt::format("{:.1f} deg", degrees * tilt),
                          fmt::format("{:.1f} deg", degrees * least), fmt::format("{:.2f} N", force)});
    std::vector<std::string> row{cells[i].text};
    Json counted = Json::object();
    for (std::size_t end = 0; end < turn_ends; ++end) {
      const std::size_t n = count([&](const ReorientFigures& run) { return run.turn.end == static_cast<TurnEnd>(end); });
      row.push_back(fmt::format("{}", n));
      counted[turn_end_names[end]] = n;
    }
    const double released_at = degrees * median_over(runs, [](const ReorientFigures& run) { return run.turn.tilt; });
    const double held_by = median_over(runs, [](const ReorientFigures& run) { return run.turn.force; });
    row.push_back(std::isnan(released_at) ? "-" : fmt::format("{:.1f} deg", released_at));
    row.push_back(std::isnan(held_by) ? "-" : fmt::format("{:.2f} N", held_by));
    ends.rows.push_back(std::move(row));
    const Interval share = clopper_pearson(standing, runs.size());
    result.figures["cells"].push_back({{"name", cells[i].name},
                                       {"command", cells[i].command(seed)},
                                       {"published", cells[i].published ? Json(*cells[i].published) : Json(nullptr)},
                                       {"trials", runs.size()},
                                       {"standing", standing},
                                       {"standing_share_95", {share.low, share.high}},
                                       {"turned_up", up},
                                       {"dropped", dropped},
                                       {"ends", counted},
                                       {"median_tilt_rad", tilt},
                                       {"median_least_tilt_rad", least},
                                       {"median_max_grip_force_N", force}});
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
