#include "tools/studies/nib_reconfigurable/nib_table1_run.h"

#include "tools/base/project/project_file.h"
#include "tools/program/catalogue/program_catalogues.h"

namespace slipbench::reproduce {
namespace {

// Trials of each cell of a scene's own sweep.
std::size_t own_draws(const char* scene) {
  const Catalogues catalogues = program_catalogues();
  return TrialPlan(SceneFile::load(project_file(scene)), catalogues, 0, 1).draws();
}

// The rows of several loads as those of one recording.
CalibrationSplit split_of(const CalibrationCase& one, const LoadRecordings& recordings, SplitKind kind, RandomStream& stream) {
  CalibrationSplit all;
  Eigen::Index first = 0;
  const std::size_t parts = one.loads.size();
  for (const CalibrationLoad load : one.loads) {
    const std::size_t rows = recordings[load].size();
    const CalibrationSplit part = split_rows(rows, fit_rows / parts, choose_rows / parts, test_rows / parts, kind, stream);
    for (const auto member : {&CalibrationSplit::fit, &CalibrationSplit::choose, &CalibrationSplit::test}) {
      for (const Eigen::Index row : part.*member) (all.*member).push_back(first + row);
    }
    first += static_cast<Eigen::Index>(rows);
  }
  return all;
}

CalibrationRecording recording_of(const CalibrationCase& one, const LoadRecordings& recordings) {
  std::vector<CalibrationRecording> parts;
  for (const CalibrationLoad load : one.loads) parts.push_back(recordings[load]);
  return joined(parts);
}

PadWrench error_of(const CalibrationCase& one, const LoadRecordings& recordings, SplitKind kind, std::uint64_t seed) {
  RandomStream stream(seed, 0, "nib_table1.split");
  const CalibrationRecording data = recording_of(one, recordings);
  const CalibrationSplit split = split_of(one, recordings, kind, stream);
  const QuadraticFit fit(data.si, data.averaged, split.fit, split.choose);
  return rms_error(fit.predict(rows_of(data.si, split.test)), rows_of(data.averaged, split.test));
}

}  // namespace

const std::vector<CalibrationVariant>& calibration_variants() {
  static const std::vector<CalibrationVariant> all{
      {"as it is"},
      {"linear capacitor", {{"sensors.pad.capacitor", "linear"}}},
      {"no noise", {{"sensors.pad.electronics", "ideal"}}},
      {"nibs of one height", {{"sensors.pad.height_sd", "0 mm"}}},
      {"all read at one instant", {{"sensors.pad.scan", "simultaneous"}}},
      {"k_tangential 0.4 N/mm", {{"sensors.pad.k_tangential", "0.4 N/mm"}}},
      {"reference not averaged", {}, false},
      {"nibs that lean (P-delta)", {{"effects", "[lean]"}}},
      {"as it is, images 0.3 s apart", {}, true, 10},
      {"linear capacitor, images 0.3 s apart", {{"sensors.pad.capacitor", "linear"}}, true, 10},
      {"nibs that lean (P-delta), images 0.3 s apart", {{"effects", "[lean]"}}, true, 10}};
  return all;
}

std::vector<LoadRecordings> record_loads(const ReproduceOptions& options) {
  std::vector<GridCell> cells;
  for (const CalibrationVariant& variant : calibration_variants()) {
    for (const char* scene : calibration_scenes) {
      cells.push_back({variant.name, scene, variant.overrides, {}, variant.apart * own_draws(scene)});
    }
  }
  const auto found = run_grid<CalibrationRecording>(cells, options, [](const GridTrial& trial) {
    return record_calibration(trial.scene, trial.number,
                              static_cast<Eigen::Index>(calibration_variants()[trial.cell / load_count].apart));
  });
  std::vector<LoadRecordings> all(calibration_variants().size());
  for (std::size_t k = 0; k < cells.size(); ++k) {
    CalibrationRecording& recording = all[k / load_count][k % load_count];
    recording = joined(found[k]);
    if (!calibration_variants()[k / load_count].averaged_reference) recording.averaged = recording.wrench;
  }
  return all;
}

const std::array<CalibrationCase, 4>& calibration_cases() {
  static const std::array<CalibrationCase, 4> cases{{{"uniform", {plate}},
                                                     {"uniform + end face", {plate, end_face}},
                                                     {"uniform + lying", {plate, lying}},
                                                     {"uniform + both", {plate, end_face, lying}}}};
  return cases;
}

std::vector<PadWrench> fit_errors(const std::vector<CalibrationFit>& fits, const std::vector<LoadRecordings>& recordings,
                                  const ReproduceOptions& options) {
  return run_in_order<PadWrench>(
      fits.size(), options, [](std::size_t) { return "fits"; },
      [&](std::size_t k) {
        return error_of(*fits[k].loads, recordings[fits[k].variant], fits[k].kind, options.seed.value_or(1));
      });
}

LoadTransfer transfer_of(const LoadRecordings& recordings, std::uint64_t seed) {
  RandomStream stream(seed, 0, "nib_table1.split");
  const CalibrationSplit split = split_of(calibration_cases()[0], recordings, SplitKind::random, stream);
  const QuadraticFit fit(recordings[plate].si, recordings[plate].averaged, split.fit, split.choose);
  LoadTransfer transfer;
  for (std::size_t load = 0; load < load_count; ++load) {
    const CalibrationRecording& asked = recordings[load];
    const std::vector<Eigen::Index> all = split_rows(asked.size(), 0, 0, asked.size(), SplitKind::random, stream).test;
    const std::vector<Eigen::Index>& rows = load == plate ? split.test : all;
    const Eigen::MatrixXd error = fit.predict(rows_of(asked.si, rows)) - rows_of(asked.averaged, rows);
    transfer.rms[load] = rms_error(error, Eigen::MatrixXd::Zero(error.rows(), error.cols()));
    transfer.bias[load] = error.colwise().mean();
  }
  return transfer;
}

}  // namespace slipbench::reproduce
