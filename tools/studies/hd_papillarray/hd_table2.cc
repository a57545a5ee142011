// Table II of the paper: grasp and lift in the closed loop, with every detector and controller, the oracle and the negative control.
#include "tools/studies/hd_papillarray/hd_tables.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <optional>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <Eigen/Core>

#include "sim/core/math.h"
#include "sim/core/pad_state.h"
#include "sim/motion/motion.h"
#include "tools/base/project/project_file.h"
#include "tools/program/catalogue/program_catalogues.h"
#include "tools/studies/grid.h"

namespace slipbench::reproduce {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// The script's constants.
constexpr double most_force = 10.0;  // N
constexpr std::size_t window = 4;    // rows
constexpr std::size_t slips = 3;     // rows of a window

struct Row {
  std::span<const float> force;  // [N,3]
  PadState state;
};

std::vector<Row> rows_of(std::span<const float> force, std::span<const std::uint8_t> classes, std::size_t stride) {
  const std::size_t values = classes.empty() ? 0 : force.size() / classes.size();
  std::vector<Row> rows;
  for (std::size_t i = stride - 1; i < classes.size(); i += stride) {
    const std::span<const float> row = force.subspan(i * values, values);
    if (std::ranges::all_of(row, [](float value) { return std::isfinite(value); })) {
      rows.push_back({row, static_cast<PadState>(classes[i])});
    }
  }
  return rows;
}

double normal_force(const Row& row) {
  double sum = 0.0;
  for (std::size_t k = 2; k < row.force.size(); k += 3) sum += double{row.force[k]};
  return sum;
}

// sum f_t / mean(f_t/f_n); NaN where no ratio is below 1.
double ideal_force(const Row& row) {
  double tangential = 0.0, ratios = 0.0, n = 0.0;
  for (std::size_t k = 0; k < row.force.size(); k += 3) {
    const double shear = math::hypot(double{row.force[k]}, double{row.force[k + 1]});
    const double normal = double{row.force[k + 2]};
    tangential += shear;
    if (shear == 0.0 || normal == 0.0 || shear / normal >= 1.0) continue;
    ratios += shear / normal;
    n += 1.0;
  }
  return tangential * n / ratios;
}

std::vector<Row> incipient_rows(const std::vector<Row>& rows) {
  const auto incipient = [](const Row& row) { return row.state == PadState::incipient; };
  const auto slipping = [](const Row& row) { return row.state == PadState::incipient || row.state == PadState::gross; };
  std::vector<Row> found;
  std::size_t i = 0;
  while (i + window < rows.size()) {
    const std::span<const Row> part = std::span(rows).subspan(i, window);
    const bool counts = static_cast<std::size_t>(std::ranges::count_if(part, slipping)) >= slips;
    if (counts && std::ranges::any_of(part, incipient)) {
      std::ranges::copy_if(part, std::back_inserter(found), incipient);
      i += window;
    } else {
      ++i;
    }
  }
  return found;
}

// Mean of samples [first, first + n) of the way from the arm's origin to the box's.
Eigen::Vector3d mean_way(std::span<const float> arm, std::span<const float> box, std::size_t first, std::size_t n) {
  const auto place = [](std::span<const float> poses, std::size_t i) {
    return Eigen::Vector3f::Map(&poses[7 * i]).cast<double>();
  };
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (std::size_t i = first; i < first + n; ++i) mean += (place(box, i) - place(arm, i)) / static_cast<double>(n);
  return mean;
}

double polar_angle(const Eigen::Vector3d& v) { return math::atan2(math::hypot(v.x(), v.y()), v.z()); }

// What Table II simulates: grasps under two protocols, with boxes, surfaces and loops of detector and controller.
constexpr const char* lift_scene = "scenes/grasp/lift.yaml";
// Rows of the published log: four of them are 0.6 s in the paper, 15 frames of its 100 Hz each.
constexpr std::size_t row_stride = 15;

// One of the values that an axis of the table takes.
struct GraspChoice {
  std::string name;
  std::string text;  // as the table shows it
  std::vector<Override> overrides;
};
struct GraspCell {
  GraspChoice protocol, box, surface, loop;
  bool usable = true;  // what the loop needs is there

  // With `draws` trials.
  [[nodiscard]] GridCell grid(std::size_t draws = 1) const;
};

// What a trial came to. `dropped`: or not lifted. NaN where the box was not held, or the figure does not exist.
struct GraspFigures {
  bool dropped = false;
  double slip = nan, rotation = nan;            // m, rad
  double marker_slip = nan, marker_spin = nan;  // m, rad
  double true_ratio = nan;
  double estimated_ratio = nan;  // by the paper's script
  double counts = nan;           // by which the gripper closed after the lift had begun
};
using Grasps = std::vector<GraspFigures>;

constexpr const char* published_memories = "tests/detectors/hd/data/published";

const std::vector<GraspChoice> protocols{{"as_recorded", "as_recorded (4 N, 43 mm/s)", {{"grip.protocol", "as_recorded"}}},
                                         {"as_printed", "as_printed (1 N, 5 mm/s)", {{"grip.protocol", "as_printed"}}}};

const std::vector<GraspChoice> boxes{{"light", "light box (0.2 kg)", {{"box.mass", "0.2 kg"}}},
                                     {"heavy", "heavy box (0.5 kg)", {{"box.mass", "0.5 kg"}}}};

// `memories`: folder of the published ones.
std::vector<GraspChoice> loops(const std::string& memories) {
  const auto controlled = [](std::string name, std::string text, const std::string& controller,
                             const std::string& detector = "{type: gst_hd}") {
    return GraspChoice{std::move(name), std::move(text), {{"detector", detector}, {"controller", controller}}};
  };
  const auto detected = [&](std::string name, std::string text, const std::string& detector) {
    return controlled(std::move(name), std::move(text), "{type: step_on_slip}", detector);
  };
  return {
      detected("oracle", "oracle (sees the truth)", "{type: truth}"),
      detected("gst_hd", "gst_hd, shipped memory", "{type: gst_hd}"),
      detected("gst_hd_published", "gst_hd, published memory",
               fmt::format("{{type: gst_hd, memories: {}, compat: published_core}}", Json(memories).dump())),
      detected("gst_hd_rtl", "gst_hd_rtl", "{type: gst_hd_rtl}"),
      detected("force_ratio", "detector force_ratio", "{type: force_ratio}"),
      detected("stuck_fraction", "detector stuck_fraction", "{type: stuck_fraction}"),
      detected("shear_rate", "detector shear_rate", "{type: shear_rate}"),
      controlled("constant_force", "constant_force", "{type: constant_force}"),
      controlled("force_ratio_control", "controller force_ratio", "{type: force_ratio}"),
      controlled("stuck_fraction_control", "controller stuck_fraction", "{type: stuck_fraction}", "{type: stuck_fraction}"),
      controlled("force_pid", "controller force_pid", "{type: force_pid}"),
      controlled("hold_preset", "hold_preset (negative control)", "{type: hold_preset}"),
  };
}

GraspFigures grasp_figures(const Scene& lift, const TrialRecord& record) {
  const GraspOutcome& outcome = *record.outcome.grasp;
  GraspFigures figures;
  figures.dropped = !outcome.held();
  if (figures.dropped) return figures;
  const SensorRecord& sensor = record.sensors.front();
  const auto force = std::ranges::find(sensor.channels, "force", &SensorColumn::name);
  const double start = lift_times(lift.motion.parameters).start;
  const auto begun = static_cast<std::size_t>(std::ranges::upper_bound(sensor.time, start) - sensor.time.begin()) - 1;
  const MarkerSlip markers = marker_slip(record.body("arm").pose, record.body("box").pose, begun);
  const std::vector<std::uint8_t>& position = record.control->grip.measured_position;
  figures.slip = outcome.slip_translation;
  figures.rotation = outcome.slip_rotation;
  figures.marker_slip = markers.along;
  figures.marker_spin = markers.spin;
  figures.true_ratio = outcome.max_grip_force / outcome.ideal_grip_force;
  figures.estimated_ratio = estimated_forces(force->values, record.control->detector_class, row_stride).ratio();
  figures.counts = position.back() - position[begun];
  return figures;
}

constexpr const char* felt_effects =
    "{anisotropic_friction: {ratio: 0.6}}, {patchy_friction: {sd: 0.2, shortest: 8 mm, longest: 20 mm}}";

// Friction fitted to the published slips of the light boxes alone (README.md); of felt that along its grain.
GraspChoice fitted(const std::string& surface, double mu, const std::string& effects = "") {
  return {surface + "_fitted",
          surface + ", fitted to light boxes",
          {{"surface.material", surface},
           {"friction.static", fmt::format("{}", mu)},
           {"friction.kinetic", fmt::format("{:.4g}", 0.95 * mu)},
           {"effects",
            fmt::format("[{}{}{{viscous_friction: {{gain: 0.3, speed: 1 mm/s}}}}]", effects, effects.empty() ? "" : ", ")}}};
}

const std::vector<GraspChoice> grasp_surfaces{
    {"ptfe", "ptfe", {{"surface.material", "ptfe"}}},
    {"rubber", "rubber", {{"surface.material", "rubber"}}},
    {"felt", "felt", {{"surface.material", "felt"}, {"effects", fmt::format("[{}]", felt_effects)}}},
    {"ptfe_0.2", "ptfe, mu 0.2", {{"surface.material", "ptfe"}, {"friction.static", "0.2"}, {"friction.kinetic", "0.19"}}},
    fitted("ptfe", 0.14),
    fitted("rubber", 0.5),
    fitted("felt", 0.75, felt_effects)};

GridCell GraspCell::grid(std::size_t draws) const {
  GridCell cell{.name = fmt::format("{}, {}, {}, {}", protocol.name, box.name, surface.name, loop.name),
                .scene = lift_scene,
                .draws = draws};
  for (const GraspChoice* choice : {&protocol, &box, &surface, &loop}) {
    std::ranges::copy(choice->overrides, std::back_inserter(cell.overrides));
  }
  return cell;
}

// The cells that options.only asks for, in the order of the table: protocol, box, surface, loop. Throws InputError for a name that no choice has.
std::vector<GraspCell> grasp_cells(const ReproduceOptions& options) {
  const std::optional<std::string> found = find_project_file(std::string(published_memories) + "/AM.hex");
  const std::string memories = !options.memories.empty() ? options.memories : found ? found->substr(0, found->rfind('/')) : "";
  const std::vector<GraspChoice> all_loops = loops(memories);
  std::vector<std::string> names;
  for (const std::vector<GraspChoice>& axis : {protocols, boxes, grasp_surfaces, all_loops}) {
    std::ranges::copy(names_of(axis), std::back_inserter(names));
  }
  check_only(options.only, names);
  std::vector<GraspCell> cells;
  for (const GraspChoice& protocol : chosen(protocols, options.only)) {
    for (const GraspChoice& box : chosen(boxes, options.only)) {
      for (const GraspChoice& surface : chosen(grasp_surfaces, options.only)) {
        for (const GraspChoice& loop : chosen(all_loops, options.only)) {
          cells.push_back({protocol, box, surface, loop, loop.name != "gst_hd_published" || !memories.empty()});
        }
      }
    }
  }
  return cells;
}

// The trials of each cell; of one that is not usable none.
std::vector<Grasps> run_grasps(const std::vector<GraspCell>& cells, std::size_t trials, const ReproduceOptions& options) {
  std::vector<GridCell> grid;
  for (const GraspCell& cell : cells) {
    if (cell.usable) grid.push_back(cell.grid(trials));
  }
  std::vector<Grasps> found =
      run_grid<GraspFigures>(grid, options, [](const GridTrial& trial) { return grasp_figures(trial.scene, trial.record()); });
  std::vector<Grasps> results;
  for (auto next = found.begin(); const GraspCell& cell : cells) results.push_back(cell.usable ? std::move(*next++) : Grasps{});
  return results;
}

constexpr std::size_t default_trials = 10;
constexpr double degrees = 180.0 / std::numbers::pi;

// The paper's row, and what its recordings have beside it.
struct PublishedGrasp {
  const char* surface;
  const char* box;
  double slip_median;  // mm
  MeanSd slip;
  double spin_median;  // deg
  MeanSd spin;
  std::optional<MeanSd> ratio;
};
const std::vector<PublishedGrasp> published_grasps{
    {"ptfe", "light", 2.54, {3.56, 2.65}, 0.68, {1.36, 2.18}, MeanSd{1.48, 0.29}},
    {"rubber", "light", 0.25, {1.34, 3.35}, 0.44, {0.51, 0.22}, MeanSd{1.36, 0.36}},
    {"felt", "light", 0.27, {0.44, 0.41}, 0.28, {0.64, 0.68}, MeanSd{1.25, 0.27}},
    {"ptfe", "heavy", 9.09, {8.71, 1.96}, 1.30, {2.33, 2.29}, std::nullopt},
    {"rubber", "heavy", 1.00, {2.21, 2.48}, 0.39, {0.66, 0.56}, std::nullopt},
    {"felt", "heavy", 1.36, {1.37, 0.65}, 0.33, {0.35, 0.09}, std::nullopt},
};

constexpr std::string_view fitted_end = "_fitted";
bool is_fitted(const GraspChoice& surface) { return surface.name.ends_with(fitted_end); }

// What is published of a surface and a box; null: nothing.
const PublishedGrasp* published_of(const GraspCell& cell) {
  std::string_view surface = cell.surface.name;
  if (is_fitted(cell.surface)) surface.remove_suffix(fitted_end.size());
  const auto row = std::ranges::find_if(
      published_grasps, [&](const PublishedGrasp& one) { return one.surface == surface && one.box == cell.box.name; });
  return row == published_grasps.end() ? nullptr : &*row;
}

std::size_t drops(const Grasps& trials) {
  return static_cast<std::size_t>(std::ranges::count_if(trials, &GraspFigures::dropped));
}

// `scale`: to the table's unit.
Spread spread_of(const Grasps& trials, double GraspFigures::*figure, double scale = 1.0) {
  std::vector<double> values;
  for (const GraspFigures& trial : trials) values.push_back(trial.*figure * scale);
  return spread(values);
}

std::string number(double value) { return std::isnan(value) ? "-" : fmt::format("{:.2f}", value); }
std::string text_of(const MeanSd& value) {
  return std::isnan(value.sd) ? number(value.mean) : fmt::format("{} +- {}", number(value.mean), number(value.sd));
}
std::string text_of(const Interval& value) {
  return std::isnan(value.low) ? "-" : fmt::format("{:.2f} to {:.2f}", value.low, value.high);
}

// Median, its interval and mean.
void add(std::vector<std::string>& row, const Spread& value) {
  row.insert(row.end(), {number(value.median), text_of(value.interval), text_of(value.mean_sd)});
}

std::string drop_interval(const Grasps& trials) {
  const Interval share = clopper_pearson(drops(trials), trials.size());
  return fmt::format("{:.0f} to {:.0f} %", 100.0 * share.low, 100.0 * share.high);
}

// A row per loop below each surface, the published one first.
template <class PublishedRow, class LoopRow>
void add_rows(ResultTable& table, std::span<const GraspCell> cells, std::span<const Grasps> results, PublishedRow&& published_row,
              LoopRow&& loop_row) {
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const GraspCell& cell = cells[i];
    if (i == 0 || cells[i - 1].surface.name != cell.surface.name) {
      if (const PublishedGrasp* row = published_of(cell)) published_row(*row);
    }
    std::vector<std::string> row{fmt::format("{}: {}", cell.surface.text, cell.loop.text)};
    if (results[i].empty()) {
      row.emplace_back("no memories: --memories DIR");
    } else {
      loop_row(row, results[i]);
    }
    row.resize(table.head.size(), "-");
    table.rows.push_back(std::move(row));
  }
}

ResultTable displacement_table(const std::string& title, std::span<const GraspCell> cells, std::span<const Grasps> results) {
  ResultTable table{title + ": drops, slip and rotation",
                    {"", "dropped", "95 %", "slip, median mm", "95 %", "mean +- SD", "by markers, median", "mean +- SD",
                     "turned, median deg", "mean +- SD", "by markers, median", "mean +- SD"}};
  add_rows(
      table, cells, results,
      [&](const PublishedGrasp& row) {
        table.rows.push_back({std::string(row.surface) + ": published", "0 of 10", "0 to 31 %", "-", "-", "-",
                              number(row.slip_median), text_of(row.slip), "-", "-", number(row.spin_median), text_of(row.spin)});
      },
      [](std::vector<std::string>& row, const Grasps& trials) {
        row.insert(row.end(), {fmt::format("{} of {}", drops(trials), trials.size()), drop_interval(trials)});
        add(row, spread_of(trials, &GraspFigures::slip, 1e3));
        for (const auto& [figure, scale] : {std::pair{&GraspFigures::marker_slip, 1e3},
                                            {&GraspFigures::rotation, degrees},
                                            {&GraspFigures::marker_spin, degrees}}) {
          const Spread value = spread_of(trials, figure, scale);
          row.insert(row.end(), {number(value.median), text_of(value.mean_sd)});
        }
      });
  table.note =
      "Of the boxes that were not dropped. Slip: way of the box's middle in the arm's frame from the lift's beginning on, turned: its rotation there. By markers: as the paper's script has it. 95 %: of the drop rate after Clopper and Pearson, of the median by order statistics.";
  return table;
}

ResultTable force_table(const std::string& title, std::span<const GraspCell> cells, std::span<const Grasps> results) {
  ResultTable table{title + ": force",
                    {"", "max/least, median", "95 %", "mean +- SD", "n", "max/ideal by the paper, median", "95 %", "mean +- SD",
                     "n", "counts"}};
  add_rows(
      table, cells, results,
      [&](const PublishedGrasp& row) {
        if (!row.ratio) return;
        table.rows.push_back(
            {std::string(row.surface) + ": published", "-", "-", "-", "-", "-", "-", text_of(*row.ratio), "-", "-"});
      },
      [](std::vector<std::string>& row, const Grasps& trials) {
        for (const auto figure : {&GraspFigures::true_ratio, &GraspFigures::estimated_ratio}) {
          const Spread value = spread_of(trials, figure);
          add(row, value);
          row.push_back(std::to_string(value.n));
        }
        row.push_back(number(spread_of(trials, &GraspFigures::counts).median));
      });
  table.note =
      "Of the boxes that were not dropped. Least: m g/(2 mu_s), mu_s that of the trial, upwards, without patches. By the paper: largest force up to 10 N over the least sum f_t/mean(f_t/f_n) of the rows called incipient; n: trials that have such rows. Counts: by which the gripper closed after the lift had begun, median.";
  return table;
}

Json spread_json(const Spread& value) {
  return {{"n", value.n},
          {"median", or_null(value.median)},
          {"median_95", {or_null(value.interval.low), or_null(value.interval.high)}},
          {"mean", or_null(value.mean_sd.mean)},
          {"sd", or_null(value.mean_sd.sd)}};
}

Json cell_json(const GraspCell& cell, const Grasps& trials, std::uint64_t seed) {
  Json entry{{"protocol", cell.protocol.name}, {"box", cell.box.name}, {"surface", cell.surface.name}, {"loop", cell.loop.name}};
  entry["trials"] = trials.size();
  if (trials.empty()) return entry;
  const Interval share = clopper_pearson(drops(trials), trials.size());
  Json dropped = Json::array();
  for (std::size_t k = 0; k < trials.size(); ++k) {
    if (trials[k].dropped) dropped.push_back(k);
  }
  entry["dropped"] = std::move(dropped);
  entry["drop_rate_95"] = {share.low, share.high};
  entry["slip_mm"] = spread_json(spread_of(trials, &GraspFigures::slip, 1e3));
  entry["marker_slip_mm"] = spread_json(spread_of(trials, &GraspFigures::marker_slip, 1e3));
  entry["rotation_deg"] = spread_json(spread_of(trials, &GraspFigures::rotation, degrees));
  entry["marker_spin_deg"] = spread_json(spread_of(trials, &GraspFigures::marker_spin, degrees));
  entry["max_over_least"] = spread_json(spread_of(trials, &GraspFigures::true_ratio));
  entry["max_over_ideal_by_paper"] = spread_json(spread_of(trials, &GraspFigures::estimated_ratio));
  entry["counts"] = spread_json(spread_of(trials, &GraspFigures::counts));
  entry["command"] = fmt::format("{} --trials {}", cell.grid().command(seed), trials.size());
  return entry;
}

// "grip: clearance 1 mm, ...": what the catalogues call assumed, at the defaults that the scene leaves them at.
std::string assumed_text(const Entry& entry) {
  std::vector<std::string> values;
  for (const ParameterSpec& spec : entry.parameters) {
    if (spec.source.starts_with("assumed")) values.push_back(spec.name + " " + spec.default_text);
  }
  return fmt::format("Assumed, {}: {}.", entry.name, fmt::join(values, ", "));
}

std::vector<std::string> setup_lines(std::size_t trials, std::uint64_t seed) {
  const Catalogues catalogues = program_catalogues();
  std::vector<std::string> lines{
      fmt::format(
          "{}, seed {}, {} trials a row; nothing else differs between rows than what they name. Trial k has the same box, place and loop phase in every row.",
          lift_scene, seed, trials),
      "Rows of detectors have the controller step_on_slip. constant_force, controller force_ratio, force_pid and hold_preset ask no detector: gst_hd with the shipped memory looks on for the paper's estimate. Controller stuck_fraction has the detector stuck_fraction.",
      fmt::format(
          "Rows of the paper's script: one in {} frames of 100 Hz; assumed, since its window of four rows is 0.6 s in the paper. The script asks for three slips of four, the paper's words for half.",
          row_stride),
      "Published: Table II (light boxes; the script gives the same means and SDs from the recordings), and the medians, the heavy boxes and the drops of the recordings, github.com/JT2106/Hyperdimensional-computing-tactile-sensing, data/grip force control.",
      "Rows `_fitted`: friction alone, fitted to the median slips published of the light boxes; heavy boxes were not seen. The gain of viscous_friction is assumed, for boxes that slip slowly.",
      "Assumed, felt: anisotropic_friction 0.6 with its grain level, so that the box hangs by the lesser friction; patches 0.2, 8 mm to 20 mm. Assumed, hard case: mu_s 0.2, mu_k 0.19. Assumed, lift: settle 1.5 s.",
  };
  for (const Material& material : catalogues.materials) {
    if (std::ranges::find(grasp_surfaces, material.name, &GraspChoice::name) == grasp_surfaces.end()) continue;
    lines.push_back(
        fmt::format("{}: mu_s {}, mu_k {}, {}.", material.name, material.mu_static, material.mu_kinetic, material.source));
  }
  for (const Entry& entry : catalogues.grasp) lines.push_back(assumed_text(entry));
  return lines;
}

// What the rows at hand say by themselves.
std::vector<std::string> remarks_on(const std::vector<GraspCell>& cells, const std::vector<Grasps>& results, std::uint64_t seed) {
  std::vector<std::string> remarks, idle, lost;
  std::size_t light = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const GraspCell& cell = cells[i];
    if (cell.loop.name == "hold_preset" && drops(results[i]) == 0) {
      idle.push_back(fmt::format("{} {} {}", cell.protocol.name, cell.box.name, cell.surface.name));
    }
    if (cell.loop.name != "oracle" || cell.box.name != "light") continue;
    light += results[i].size();
    for (std::size_t k = 0; k < results[i].size(); ++k) {
      if (results[i][k].dropped) lost.push_back(fmt::format("{} --trials {} --trial {}", cell.grid().command(seed), k + 1, k));
    }
  }
  if (light > 0) {
    remarks.push_back(lost.empty()
                          ? fmt::format("The oracle drops none of {} light boxes.", light)
                          : fmt::format("The oracle drops {} of {} light boxes: {}.", lost.size(), light, fmt::join(lost, "; ")));
  }
  if (!idle.empty()) {
    remarks.push_back(fmt::format(
        "The negative control, which never tightens, drops no box either, so that these rows are no test of a detector's drops: {}.",
        fmt::join(idle, "; ")));
  }
  remarks.insert(
      remarks.end(),
      {"Published means stand on outliers: rubber is nine trials of 0.15 to 0.41 mm and one of 10.86 mm; of PTFE the largest, 8.49 mm, is a jump of the gripper's marker (median without it 2.24 mm), and another moves long after the lift. Compare medians.",
       "Published rotations are the angle of a line of 135 mm between two markers: 1 to 2 mm of play sideways make 0.4 to 0.9 deg.",
       "max/ideal by the paper is nearly the last force over the least force at a row called incipient: sum f_t/mean(f_t/f_n) is sum f_n when all ratios are alike. It says little about m g/(2 mu).",
       "The paper prints 1 N, 5 mm/s and 50 mm/s2; the published HDL holds 4 N and the recordings rise at 43 mm/s."});
  return remarks;
}

}  // namespace

EstimatedForces estimated_forces(std::span<const float> force, std::span<const std::uint8_t> classes, std::size_t stride) {
  const std::vector<Row> rows = rows_of(force, classes, stride);
  EstimatedForces estimate{nan, nan};
  for (const Row& row : rows) {
    const double sum = normal_force(row);
    if (sum <= most_force) estimate.most = std::fmax(estimate.most, sum);  // NaN is none
  }
  for (const Row& row : incipient_rows(rows)) estimate.ideal = std::fmin(estimate.ideal, ideal_force(row));
  return estimate;
}

MarkerSlip marker_slip(std::span<const float> arm, std::span<const float> box, std::size_t lift) {
  constexpr std::size_t before = 51, after = 101;
  const std::size_t count = std::min(before, lift + 1);
  const Eigen::Vector3d start = mean_way(arm, box, lift + 1 - count, count);
  const Eigen::Vector3d end = mean_way(arm, box, arm.size() / 7 - after, after);
  const Eigen::Vector3d line = Eigen::Vector3d::Map(marker_line), turned = line + (end - start);
  return {std::abs(end.z() - start.z()), std::abs(polar_angle(turned) - polar_angle(line))};
}

Spread spread(std::vector<double> values) {
  std::erase_if(values, [](double value) { return std::isnan(value); });
  return {values.size(), median(values), median_interval(values), mean_sd(values)};
}

Result hd_table2(const ReproduceOptions& options) {
  const std::uint64_t seed = options.seed.value_or(1);
  const std::size_t trials = options.trials == 0 ? default_trials : options.trials;
  const std::vector<GraspCell> cells = grasp_cells(options);
  const std::vector<Grasps> results = run_grasps(cells, trials, options);
  Result result;
  result.title = "Grasp and lift with slip detection in the loop";
  result.source =
      "Table II and section IV-D of \"Ultra-Fast Lightweight Incipient Slip Detection Using Hyperdimensional Computing With the PapillArray Tactile Sensor\"";
  result.setup = setup_lines(trials, seed);
  result.figures["cells"] = Json::array();
  for (std::size_t first = 0; first < cells.size();) {
    std::size_t last = first;
    while (last < cells.size() && cells[last].protocol.name == cells[first].protocol.name &&
           cells[last].box.name == cells[first].box.name) {
      const GraspCell& cell = cells[last];
      result.figures["cells"].push_back(cell_json(cell, results[last], seed));
      const PublishedGrasp* row = published_of(cell);
      if (row != nullptr && cell.protocol.name == "as_recorded" && cell.loop.name == "oracle") {
        const char* seen = !is_fitted(cell.surface)   ? "friction assumed"
                           : cell.box.name == "light" ? "fitted to it"
                                                      : "not seen by the fit";
        result.real.push_back({fmt::format("slip of the {} box, {}, median, mm", row->box, row->surface), row->slip_median,
                               spread_of(results[last], &GraspFigures::slip, 1e3).median,
                               fmt::format("{}; the oracle in place of the detector", seen)});
      }
      ++last;
    }
    const std::string title = cells[first].protocol.text + ", " + cells[first].box.text;
    const auto part = std::span(cells).subspan(first, last - first);
    const auto trials_of_part = std::span(results).subspan(first, last - first);
    result.tables.push_back(displacement_table(title, part, trials_of_part));
    result.tables.push_back(force_table(title, part, trials_of_part));
    first = last;
  }
  result.remarks = remarks_on(cells, results, seed);
  return result;
}

}  // namespace slipbench::reproduce
