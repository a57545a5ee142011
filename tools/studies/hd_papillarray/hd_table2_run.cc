#include "tools/studies/hd_papillarray/hd_table2_run.h"

#include <algorithm>
#include <iterator>

#include "sim/motion/lift.h"
#include "tools/base/project/project_file.h"
#include "tools/studies/hd_papillarray/hd_table2_figures.h"

namespace slipbench::reproduce {
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
