#include "tools/studies/nib_reconfigurable/nib_table2_run.h"

#include <algorithm>
#include <cmath>

#include "detectors/nib/linear_slip.h"
#include "tools/base/statistics/descriptive.h"
#include "tools/studies/nib_reconfigurable/nib_trace.h"

namespace slipbench::reproduce {
namespace {

struct ReleaseTrial {
  std::vector<ReleaseRun> runs;  // in the order of detector_readings()
  std::optional<Signature> signature;
};

Parameters detector_parameters(const DetectorScene& scene, const DetectorReading& reading) {
  Parameters parameters = scene.parameters;
  for (const auto& [name, value] : reading.changes) parameters.set(name, value);
  return parameters;
}

ReleaseTrial trial_of(const Scene& scene, const TrialRecord& record) {
  const NibTrace trace(record);
  const std::size_t begun = trace.at(scene.detector->parameters.number("start"));
  ReleaseTrial trial{{}, signature_of(scene, trace)};
  for (const DetectorReading& reading : detector_readings()) {
    ReleaseRun run;
    run.material = scene.material;
    run.required = scene.controls.front().points.back().value / scene.friction.static_coefficient;
    const auto detector = make_nib_linear_slip(detector_parameters(*scene.detector, reading), trace.source());
    if (const auto found = trace.detection(*detector)) {
      run.force = trace.normal(*found);
      run.way = trace.lever(*found) - trace.lever(begun);
    }
    trial.runs.push_back(std::move(run));
  }
  return trial;
}

}  // namespace

const std::vector<DetectorReading>& detector_readings() {
  static const std::vector<DetectorReading> all{
      {"as_is", "threshold 25, patience 0.5 s, F_S/F_N of counts as equations 1, 2 and 4 have it", {}},
      {"threshold_15", "threshold 15", {{"threshold", 15.0}}},
      {"threshold_20", "threshold 20", {{"threshold", 20.0}}},
      {"threshold_40", "threshold 40", {{"threshold", 40.0}}},
      {"threshold_80", "threshold 80", {{"threshold", 80.0}}},
      {"patience_0.25", "patience 0.25 s", {{"patience", 0.25}}},
      {"patience_1", "patience 1 s", {{"patience", 1.0}}},
      {"alpha_0", "alpha 0", {{"weight", 0.0}}},
      {"alpha_5_m_5", "M 5, alpha 5", {{"counter_max", 5.0}, {"weight", 5.0}}},
      {"forces", "F_S/F_N of newtons", {{"ratio", std::string("forces")}}},
  };
  return all;
}

std::vector<LawRuns> run_releases(std::size_t draws, const ReproduceOptions& options) {
  std::vector<GridCell> cells;
  for (const FrictionLaw& law : friction_laws()) {
    cells.push_back({law.text, release_scene, {}, law.change, cells.empty() ? draws : std::min(draws, few_draws)});
  }
  std::vector<LawRuns> laws;
  for (const std::vector<ReleaseTrial>& trials :
       run_grid<ReleaseTrial>(cells, options, [](const GridTrial& trial) { return trial_of(trial.scene, trial.record()); })) {
    LawRuns& law = laws.emplace_back();
    law.by_reading.resize(detector_readings().size());
    for (const ReleaseTrial& trial : trials) {
      for (std::size_t k = 0; k < trial.runs.size(); ++k) law.by_reading[k].push_back(trial.runs[k]);
      law.signatures.push_back(trial.signature);
    }
  }
  return laws;
}

ReleaseSummary summary_of(const std::vector<ReleaseRun>& runs, const std::string& material) {
  ReleaseSummary summary;
  std::vector<double> errors, gross, ways;
  for (const ReleaseRun& run : runs) {
    if (!material.empty() && run.material != material) continue;
    ++summary.runs;
    if (!run.safe()) continue;
    ++summary.safe;
    errors.push_back(std::abs(run.force - run.required));
    ways.push_back(1e3 * run.way);
    if (run.gross()) {
      gross.push_back(errors.back());
    } else {
      ++summary.early;
    }
  }
  summary.error = mean_sd(errors);
  summary.gross_error = mean_sd(gross);
  summary.slip = mean_sd(ways);
  return summary;
}

}  // namespace slipbench::reproduce
