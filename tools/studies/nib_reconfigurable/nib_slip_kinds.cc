// Fig. 12 of the nib pad's paper: no slip, linear and rotational slip by FL, FR and curl.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "detectors/nib/slip_kind.h"
#include "tools/base/statistics/auc.h"
#include "tools/base/statistics/descriptive.h"
#include "tools/studies/grid.h"
#include "tools/studies/nib_reconfigurable/nib_trace.h"

namespace slipbench::reproduce {
namespace {

constexpr double slip_way = 2e-3;  // m, pull displacement from which on a run is one of slip
constexpr double slip_time = 0.5;  // s, after it, whose windows count

// What one run shows.
struct KindRun {
  std::string material;
  bool slips = false, rotational = false;
  double fl = 0.0, fr = 0.0, curl = 0.0;  // counts, counts, |mean|
  nib::SlipKind said = nib::SlipKind::none;
};

KindRun kind_run(const Scene& scene, const TrialRecord& record, bool rotational) {
  const NibTrace trace(record);
  const std::vector<ControlScene::Point>& pull = scene.controls.front().points;
  const std::size_t begun = trace.at(pull.front().time), held = trace.at(pull.back().time + slip_time);
  const std::optional<std::size_t> moved = trace.moved(begun, slip_way);
  const std::size_t first = moved ? *moved : trace.at(pull.front().time + slip_time);
  const std::size_t last = moved ? trace.at(trace.time(*moved) + slip_time) : held;
  KindRun run{scene.material, moved.has_value(), rotational};
  nib::Features mean;
  double windows = 0.0;
  for (const NibTrace::Window& window : trace.windows(scene.detector->parameters)) {
    if (window.sample < first || window.sample > last) continue;
    windows += 1.0;
    mean.fl += window.features.fl;
    mean.fr += window.features.fr;
    mean.curl += window.features.curl;
  }
  if (windows == 0.0) throw InputError("no window ends within the slip; allowed: a longer duration");
  mean.fl /= windows;
  mean.fr /= windows;
  mean.curl /= windows;
  run.fl = mean.fl;
  run.fr = mean.fr;
  run.curl = std::abs(mean.curl);
  const Parameters& p = scene.detector->parameters;
  run.said = nib::slip_kind(mean, {p.number("fl"), p.number("fr"), p.number("curl")});
  return run;
}

// The runs of linear slip, then those of rotational slip.
std::vector<KindRun> kind_runs(std::size_t trials, const ReproduceOptions& options) {
  constexpr const char *linear = "scenes/nib_pad/linear.yaml", *rotational = "scenes/nib_pad/rotational.yaml";
  const std::vector<GridCell> cells{{linear, linear, {}, {}, trials}, {rotational, rotational, {}, {}, trials}};
  std::vector<KindRun> runs;
  for (const std::vector<KindRun>& found : run_grid<KindRun>(
           cells, options, [](const GridTrial& trial) { return kind_run(trial.scene, trial.record(), trial.cell == 1); })) {
    runs.insert(runs.end(), found.begin(), found.end());
  }
  return runs;
}

using Score = double (*)(const KindRun&);
using Chosen = bool (*)(const KindRun&);

std::vector<double> scores(const std::vector<KindRun>& runs, Score score, Chosen chosen) {
  std::vector<double> values;
  for (const KindRun& run : runs) {
    if (chosen(run)) values.push_back(score(run));
  }
  return values;
}

bool is_linear(const KindRun& run) { return run.slips && !run.rotational; }
bool is_rotational(const KindRun& run) { return run.slips && run.rotational; }
bool is_slip(const KindRun& run) { return run.slips; }
bool is_none(const KindRun& run) { return !run.slips; }

double score_fl(const KindRun& run) { return run.fl; }
double score_fr(const KindRun& run) { return run.fr; }
double score_curl(const KindRun& run) { return run.curl; }

struct Question {
  const char* text;
  const char* bar;
  Score score;
  Chosen positive, negative;
};
const std::vector<Question>& questions() {
  static const std::vector<Question> all{
      {"rotational against linear by FR/FL", "0.97", [](const KindRun& run) { return run.fr / run.fl; }, is_rotational,
       is_linear},
      {"linear against rotational by FL/FR", "0.97", [](const KindRun& run) { return run.fl / run.fr; }, is_linear,
       is_rotational},
      {"rotational against linear by curl", "0.97", score_curl, is_rotational, is_linear},
      {"rotational against linear by curl FR/FL", "0.97", [](const KindRun& run) { return run.curl * run.fr / run.fl; },
       is_rotational, is_linear},
      {"slip against none by FL + FR", "0.93", [](const KindRun& run) { return run.fl + run.fr; }, is_slip, is_none},
      {"slip against none by the larger of FL and FR", "0.93", [](const KindRun& run) { return std::max(run.fl, run.fr); },
       is_slip, is_none},
      {"linear slip against none by FL", "0.93", score_fl, is_linear, is_none},
      {"rotational slip against none by FR", "0.93", score_fr, is_rotational, is_none},
  };
  return all;
}

ResultTable auc_table(const std::vector<KindRun>& runs, Json& figures) {
  ResultTable table{"Told apart", {"question", "bar", "AUC", "95 %", "n"}, {}, "Exact, by ranks; intervals after DeLong."};
  figures["auc"] = Json::array();
  for (const Question& question : questions()) {
    const std::vector<double> positive = scores(runs, question.score, question.positive);
    const std::vector<double> negative = scores(runs, question.score, question.negative);
    if (positive.empty() || negative.empty()) {
      table.rows.push_back({question.text, question.bar, "-", "-", fmt::format("{} and {}", positive.size(), negative.size())});
      continue;
    }
    const Auc found = auc(positive, negative);
    table.rows.push_back({question.text, question.bar, fmt::format("{:.3f}", found.value),
                          fmt::format("{:.3f} to {:.3f}", found.interval.low, found.interval.high),
                          fmt::format("{} and {}", found.positives, found.negatives)});
    figures["auc"].push_back({{"question", question.text},
                              {"bar", std::stod(question.bar)},
                              {"auc", found.value},
                              {"interval_95", {found.interval.low, found.interval.high}},
                              {"positives", found.positives},
                              {"negatives", found.negatives}});
  }
  return table;
}

// Median and quartiles.
std::string quartiles_text(const std::vector<double>& values, int digits) {
  if (values.empty()) return "-";
  return fmt::format("{:.{}f} ({:.{}f} to {:.{}f})", quantile(values, 0.5), digits, quantile(values, 0.25), digits,
                     quantile(values, 0.75), digits);
}

ResultTable feature_table(const std::vector<KindRun>& runs) {
  ResultTable table{"Features, median and quartiles",
                    {"plate", "runs", "n", "FL, counts", "FR, counts", "|curl|", "said: none", "linear", "rotational"},
                    {},
                    "Said by nib_slip_kind with its assumed bounds, of the means that the row is made of."};
  const std::pair<const char*, Chosen> groups[] = {
      {"linear slip", is_linear}, {"rotational slip", is_rotational}, {"no slip", is_none}};
  for (const char* material : {"paper", "masonite", "wavy_acrylic"}) {
    std::vector<KindRun> own;
    std::ranges::copy_if(runs, std::back_inserter(own), [&](const KindRun& run) { return run.material == material; });
    for (const auto& [name, chosen] : groups) {
      std::array<std::size_t, 3> said{};
      std::size_t n = 0;
      for (const KindRun& run : own) {
        if (!chosen(run)) continue;
        ++said[static_cast<std::size_t>(run.said)];
        ++n;
      }
      std::vector<std::string>& row = table.rows.emplace_back(std::vector<std::string>{material, name, std::to_string(n)});
      row.push_back(quartiles_text(scores(own, score_fl, chosen), 0));
      row.push_back(quartiles_text(scores(own, score_fr, chosen), 0));
      row.push_back(quartiles_text(scores(own, score_curl, chosen), 2));
      for (const std::size_t kind : said) row.push_back(std::to_string(kind));
    }
  }
  return table;
}

}  // namespace

Result nib_slip_kinds(const ReproduceOptions& options) {
  const std::size_t trials = options.trials == 0 ? 1 : options.trials;
  const std::vector<KindRun> runs = kind_runs(trials, options);
  Result result;
  result.title = "No slip, linear and rotational slip of the nib pad";
  result.source = "Fig. 12 and section IV-B of \"Dynamically Reconfigurable Tactile Sensor for Robotic Manipulation\"";
  result.setup = {
      fmt::format(
          "scenes/nib_pad/linear.yaml and rotational.yaml, seed {}, {} runs a cell: electronics typical (drift and noise), pads set up with scatter of place, yaw and tilt.",
          options.seed.value_or(1), trials),
      "Slip: the lever has moved by 2 mm since the pull began (paper). FL, FR: magnitude over 0 to 6 Hz; curl: of the normalised shear; means over the windows that end within 0.5 s after these 2 mm, and of runs without slip over those that end between 0.5 s after the pull's beginning and 0.5 s after its end.",
  };
  result.tables.push_back(auc_table(runs, result.figures));
  result.tables.push_back(feature_table(runs));
  return result;
}

}  // namespace slipbench::reproduce
