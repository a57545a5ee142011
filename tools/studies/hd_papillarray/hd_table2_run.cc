#include "tools/studies/hd_papillarray/hd_table2_run.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>

#include "sim/core/pad_state.h"
#include "sim/motion/lift.h"
#include "tools/base/project/project_file.h"

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
    const double shear = std::hypot(double{row.force[k]}, double{row.force[k + 1]});
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

// Smaller of two, a NaN left out.
double least(double a, double b) { return std::isnan(a) || b < a ? b : a; }

// Mean of samples [first, first + n) of the way from the arm's origin to the box's.
std::array<double, 3> mean_way(std::span<const float> arm, std::span<const float> box, std::size_t first, std::size_t n) {
  std::array<double, 3> mean{};
  for (std::size_t i = first; i < first + n; ++i) {
    for (std::size_t k = 0; k < 3; ++k) mean[k] += (double{box[7 * i + k]} - double{arm[7 * i + k]}) / static_cast<double>(n);
  }
  return mean;
}

double polar_angle(const std::array<double, 3>& v) { return std::atan2(std::hypot(v[0], v[1]), v[2]); }

}  // namespace

EstimatedForces estimated_forces(std::span<const float> force, std::span<const std::uint8_t> classes, std::size_t stride) {
  const std::vector<Row> rows = rows_of(force, classes, stride);
  EstimatedForces estimate{nan, nan};
  for (const Row& row : rows) {
    const double sum = normal_force(row);
    if (sum <= most_force) estimate.most = std::isnan(estimate.most) ? sum : std::max(estimate.most, sum);
  }
  for (const Row& row : incipient_rows(rows)) estimate.ideal = least(estimate.ideal, ideal_force(row));
  return estimate;
}

MarkerSlip marker_slip(std::span<const float> arm, std::span<const float> box, std::size_t lift) {
  constexpr std::size_t before = 51, after = 101;
  const std::size_t count = std::min(before, lift + 1);
  const std::array<double, 3> start = mean_way(arm, box, lift + 1 - count, count);
  const std::array<double, 3> end = mean_way(arm, box, arm.size() / 7 - after, after);
  const std::array<double, 3> line{marker_line[0], marker_line[1], marker_line[2]};
  std::array<double, 3> turned = line;
  for (std::size_t k = 0; k < 3; ++k) turned[k] += end[k] - start[k];
  return {std::abs(end[2] - start[2]), std::abs(polar_angle(turned) - polar_angle(line))};
}

Spread spread(std::vector<double> values) {
  std::erase_if(values, [](double value) { return std::isnan(value); });
  return {values.size(), median(values), median_interval(values), mean_sd(values)};
}

namespace {

constexpr const char* published_memories = "tests/detectors/hd/data/published";

const std::vector<GraspChoice>& protocols() {
  static const std::vector<GraspChoice> all{{"as_recorded", "as_recorded (4 N, 43 mm/s)", {{"grip.protocol", "as_recorded"}}},
                                            {"as_printed", "as_printed (1 N, 5 mm/s)", {{"grip.protocol", "as_printed"}}}};
  return all;
}

const std::vector<GraspChoice>& boxes() {
  static const std::vector<GraspChoice> all{{"light", "light box (0.2 kg)", {{"box.mass", "0.2 kg"}}},
                                            {"heavy", "heavy box (0.5 kg)", {{"box.mass", "0.5 kg"}}}};
  return all;
}

// `memories`: folder of the published ones.
std::vector<GraspChoice> loops(const std::string& memories) {
  const auto detected = [](std::string name, std::string text, const std::string& detector) {
    return GraspChoice{std::move(name), std::move(text), {{"detector", detector}, {"controller", "{type: step_on_slip}"}}};
  };
  const auto controlled = [](std::string name, std::string text, const std::string& controller,
                             const std::string& detector = "{type: gst_hd}") {
    return GraspChoice{std::move(name), std::move(text), {{"detector", detector}, {"controller", controller}}};
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
  figures.dropped = outcome.dropped;
  if (outcome.dropped) return figures;
  const SensorRecord& sensor = record.sensors.front();
  const auto force = std::ranges::find(sensor.channels, "force", &SensorColumn::name);
  const auto pose = [&](const char* name) -> const std::vector<float>& {
    return std::ranges::find(record.bodies, name, &BodyRecord::name)->pose;
  };
  const double start = lift_times(lift.motion.parameters).start;
  const auto begun = static_cast<std::size_t>(std::ranges::upper_bound(sensor.time, start) - sensor.time.begin()) - 1;
  const MarkerSlip markers = marker_slip(pose("arm"), pose("box"), begun);
  const std::vector<std::uint8_t>& position = record.control->grip.measured_position;
  figures.slip = outcome.slip_translation;
  figures.rotation = outcome.slip_rotation;
  figures.marker_slip = markers.along;
  figures.marker_spin = markers.spin;
  figures.true_ratio = outcome.max_grip_force / outcome.ideal_grip_force;
  figures.estimated_ratio = estimated_forces(force->values, record.control->detector_class, row_stride).ratio();
  figures.frame_ratio = estimated_forces(force->values, record.control->detector_class, 1).ratio();
  figures.counts = position.back() - position[begun];
  return figures;
}

}  // namespace

const std::vector<GraspChoice>& grasp_surfaces() {
  static const std::vector<GraspChoice> all{
      {"ptfe", "ptfe", {{"surface.material", "ptfe"}}},
      {"rubber", "rubber", {{"surface.material", "rubber"}}},
      {"felt",
       "felt",
       {{"surface.material", "felt"},
        {"effects", "[{anisotropic_friction: {ratio: 0.6}}, {patchy_friction: {sd: 0.2, shortest: 8 mm, longest: 20 mm}}]"}}},
      {"ptfe_0.2", "ptfe, mu 0.2", {{"surface.material", "ptfe"}, {"friction.static", "0.2"}, {"friction.kinetic", "0.19"}}}};
  return all;
}

GridCell GraspCell::grid(std::size_t draws) const {
  GridCell cell{.name = fmt::format("{}, {}, {}, {}", protocol.name, box.name, surface.name, loop.name),
                .scene = lift_scene,
                .draws = draws};
  for (const GraspChoice* choice : {&protocol, &box, &surface, &loop}) {
    std::ranges::copy(choice->overrides, std::back_inserter(cell.overrides));
  }
  return cell;
}

std::vector<GraspCell> grasp_cells(const ReproduceOptions& options) {
  const std::optional<std::string> found = find_project_file(std::string(published_memories) + "/AM.hex");
  const std::string memories = !options.memories.empty() ? options.memories : found ? found->substr(0, found->rfind('/')) : "";
  const std::vector<GraspChoice> all_loops = loops(memories);
  std::vector<std::string> names;
  for (const std::vector<GraspChoice>& axis : {protocols(), boxes(), grasp_surfaces(), all_loops}) {
    std::ranges::copy(names_of(axis), std::back_inserter(names));
  }
  check_only(options.only, names);
  std::vector<GraspCell> cells;
  for (const GraspChoice& protocol : chosen(protocols(), options.only)) {
    for (const GraspChoice& box : chosen(boxes(), options.only)) {
      for (const GraspChoice& surface : chosen(grasp_surfaces(), options.only)) {
        for (const GraspChoice& loop : chosen(all_loops, options.only)) {
          cells.push_back({protocol, box, surface, loop, loop.name != "gst_hd_published" || !memories.empty()});
        }
      }
    }
  }
  return cells;
}

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

}  // namespace slipbench::reproduce
