#include "tools/studies/nib_reconfigurable/nib_tables.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "detectors/nib/slip_detectors.h"
#include "sim/effects/effect_catalogue.h"
#include "tools/program/samples/samples.h"
#include "tools/studies/grid.h"

namespace slipbench::reproduce {
namespace {

void drop(Scene& scene, const char* effect) {
  std::erase_if(scene.effects, [&](const Named& named) { return named.name == effect; });
}
void set_patches(Scene& scene, double sd) {
  for (Named& effect : scene.effects) {
    if (effect.name == "patchy_friction") effect.parameters.set("sd", sd);
  }
}
void add_lean(Scene& scene) {
  const auto& all = effect_catalogue();
  const auto lean = std::ranges::find(all, "lean", [](const EffectKind& kind) { return kind.about.name; });
  scene.effects.push_back({lean->about.name, defaults_of(lean->about.parameters)});
}
// Coulomb's law, mu_k 0.9 mu_s.
void drop_to_kinetic(Scene& scene) { scene.friction.kinetic_coefficient = 0.9 * scene.friction.static_coefficient; }

constexpr double slow = 8.0;                                   // Hz, the paper's effective response
constexpr double slip_begins = 0.3e-3, slip_ends = 10e-3;      // m, of the lever
constexpr std::size_t window_samples = 150, hop_samples = 30;  // samples at 300 Hz, as in the paper

// Median of `figure` over those of the slips that have waves or not; empty of none.
std::optional<double> median_of(const std::vector<std::optional<Signature>>& found, bool wavy, double Signature::*figure) {
  std::vector<double> values;
  for (const std::optional<Signature>& signature : found) {
    if (signature && signature->wavy == wavy) values.push_back(*signature.*figure);
  }
  if (values.empty()) return std::nullopt;
  return median(std::move(values));
}

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
const std::vector<Question> questions{
    {"rotational against linear by FR/FL", "0.97", [](const KindRun& run) { return run.fr / run.fl; }, is_rotational, is_linear},
    {"linear against rotational by FL/FR", "0.97", [](const KindRun& run) { return run.fl / run.fr; }, is_linear, is_rotational},
    {"rotational against linear by curl", "0.97", score_curl, is_rotational, is_linear},
    {"rotational against linear by curl FR/FL", "0.97", [](const KindRun& run) { return run.curl * run.fr / run.fl; },
     is_rotational, is_linear},
    {"slip against none by FL + FR", "0.93", [](const KindRun& run) { return run.fl + run.fr; }, is_slip, is_none},
    {"slip against none by the larger of FL and FR", "0.93", [](const KindRun& run) { return std::max(run.fl, run.fr); }, is_slip,
     is_none},
    {"linear slip against none by FL", "0.93", score_fl, is_linear, is_none},
    {"rotational slip against none by FR", "0.93", score_fr, is_rotational, is_none},
};

ResultTable auc_table(const std::vector<KindRun>& runs, Json& figures) {
  ResultTable table{"Told apart", {"question", "bar", "AUC", "95 %", "n"}, {}, "Exact, by ranks; intervals after DeLong."};
  figures["auc"] = Json::array();
  for (const Question& question : questions) {
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

const std::vector<FrictionLaw>& friction_laws() {
  static const std::vector<FrictionLaw> all{
      {"scene", "as in the scene: rate law, patches 0.3", [](Scene&) {}},
      {"lean", "as in the scene, nibs that lean", add_lean},
      {"patches_0.2", "patches 0.2", [](Scene& scene) { set_patches(scene, 0.2); }},
      {"patches_0.1", "patches 0.1", [](Scene& scene) { set_patches(scene, 0.1); }},
      {"no_patches", "no patches", [](Scene& scene) { drop(scene, "patchy_friction"); }},
      {"no_rate", "no rate law", [](Scene& scene) { drop(scene, "viscous_friction"); }},
      {"coulomb", "Coulomb, mu_k 0.9 mu_s, no patches",
       [](Scene& scene) {
         drop(scene, "patchy_friction");
         drop(scene, "viscous_friction");
         drop_to_kinetic(scene);
       }},
      {"coulomb_patches", "Coulomb, mu_k 0.9 mu_s, patches 0.3",
       [](Scene& scene) {
         drop(scene, "viscous_friction");
         drop_to_kinetic(scene);
       }},
  };
  return all;
}

NibTrace::NibTrace(const TrialRecord& record) {
  const auto lever = std::ranges::find(record.bodies, "lever", &BodyRecord::name);
  if (record.sensors.size() != 1 || record.sensors.front().time.empty() || lever == record.bodies.end())
    throw std::logic_error("no trial of the lever bench");
  const SensorRecord& sensor = record.sensors.front();
  RecordedSamples samples(sensor);
  source_ = {sensor.name, sensor.type, sensor.rate, samples.channels()};
  time_ = sensor.time;
  while (!samples.ended()) {
    const SensorFrame frame = samples.take();
    frames_.insert(frames_.end(), frame.values.begin(), frame.values.end());
  }
  frame_size_ = frames_.size() / size();
  const std::size_t units = sensor.labels.units();
  normal_.resize(size());
  lever_.resize(size());
  for (std::size_t k = 0; k < size(); ++k) {
    for (std::size_t unit = 0; unit < units; ++unit) normal_[k] += double{sensor.labels.force[3 * (k * units + unit) + 2]};
    lever_[k] = double{lever->pose[7 * k + 1]};
  }
}

std::size_t NibTrace::at(double time) const {
  return static_cast<std::size_t>(std::ranges::lower_bound(time_, time) - time_.begin());
}

std::optional<std::size_t> NibTrace::moved(std::size_t from, double way) const {
  for (std::size_t k = from; k < size(); ++k) {
    if (lever_[k] - lever_[from] >= way) return k;
  }
  return std::nullopt;
}

std::optional<std::size_t> NibTrace::detection(Detector& detector) const {
  for (std::size_t k = 0; k < size(); ++k) {
    if (detector.update(frame(k)).state == PadState::gross) return k;
  }
  return std::nullopt;
}

std::vector<NibTrace::Window> NibTrace::windows(const Parameters& parameters) const {
  nib::FeatureReader reader(parameters, source_, "a reproduction");
  std::vector<Window> found;
  for (std::size_t k = 0; k < size(); ++k) {
    if (reader.update(frame(k))) found.push_back({k, reader.features()});
  }
  return found;
}

std::optional<Signature> signature_of(const Scene& scene, const NibTrace& trace) {
  const std::size_t begun = trace.at(scene.detector->parameters.number("start"));
  const std::optional<std::size_t> first = trace.moved(begun, slip_begins);
  if (!first) return std::nullopt;
  const std::size_t last = trace.moved(begun, slip_ends).value_or(trace.size());
  if (last - *first < window_samples) return std::nullopt;
  const std::size_t fl = trace.source().channels.front().size();  // behind the image
  nib::SlidingSpectrum spectrum(window_samples, hop_samples, trace.source().rate);
  const double bin = trace.source().rate / static_cast<double>(window_samples);
  double below = 0.0, above = 0.0, windows = 0.0;
  for (std::size_t k = *first; k < last; ++k) {
    const std::span<const float> values = trace.frame(k).values;
    if (!spectrum.push(double{values[fl]} - double{values[fl + 1]})) continue;
    windows += 1.0;
    for (std::size_t n = 1; n < spectrum.magnitudes().size(); ++n) {
      const double energy = spectrum.magnitudes()[n] * spectrum.magnitudes()[n];
      (static_cast<double>(n) * bin <= slow ? below : above) += energy;
    }
  }
  // White noise of variance v has v sum w^2 in every bin, sum w^2 = (0.54^2 + 0.46^2/2) N; of N/2 bins.
  const auto n = static_cast<double>(window_samples);
  const auto rms = [&](double energy) { return std::sqrt(2.0 * energy / (0.3974 * n * n * windows)); };
  const bool wavy = std::ranges::any_of(scene.effects, [](const Named& effect) { return effect.name == "texture"; });
  return Signature{wavy, below / (below + above), static_cast<double>(last - *first) / trace.source().rate, rms(below),
                   rms(above)};
}

ResultTable signature_table() {
  return {
      "Energy of the linear mode below 8 Hz while the pad slips",
      {"law", "plates", "slips that last", "share below 8 Hz", "below, counts rms", "above", "time of the slip, s"},
      {},
      "Medians over slips. Of C_N - C_S in windows of 0.5 s, less their line, Hamming, that lie wholly between 0.3 and 10 mm of the lever; shorter slips are left out. The converter's noise alone has a share of 0.05 and 1.7 counts above 8 Hz."};
}

void add_signatures(const char* law, const std::vector<std::optional<Signature>>& found, ResultTable& table, Json& figures) {
  for (const bool wavy : {false, true}) {
    const auto slips = std::ranges::count_if(found, [&](const auto& signature) { return signature && signature->wavy == wavy; });
    const auto text = [&](double Signature::*figure, int digits) {
      const std::optional<double> value = median_of(found, wavy, figure);
      return value ? fmt::format("{:.{}f}", *value, digits) : std::string("-");
    };
    table.rows.push_back({law, wavy ? "wavy" : "flat", std::to_string(slips), text(&Signature::share, 3),
                          text(&Signature::below, 1), text(&Signature::above, 1), text(&Signature::time, 2)});
    Json row{{"law", law}, {"wavy", wavy}, {"slips", slips}};
    if (slips > 0) {
      row.update({{"share", *median_of(found, wavy, &Signature::share)},
                  {"below_counts", *median_of(found, wavy, &Signature::below)},
                  {"above_counts", *median_of(found, wavy, &Signature::above)},
                  {"time_s", *median_of(found, wavy, &Signature::time)}});
    }
    figures.push_back(std::move(row));
  }
}

// Fig. 12 of the nib pad's paper: no slip, linear and rotational slip by FL, FR and curl.
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
