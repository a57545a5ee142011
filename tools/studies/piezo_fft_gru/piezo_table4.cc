// Tables I, III and IV of the paper with its frame-wise network, against the level of the motors' vibration and by both labels.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <thread>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "tools/base/workers/interrupt.h"
#include "tools/base/workers/ordered_workers.h"
#include "tools/program/learn/validation.h"
#include "tools/studies/piezo_fft_gru/piezo_recordings.h"
#include "tools/studies/study_catalogue.h"

namespace slipbench::reproduce {
namespace {

using learn::Architecture;
using learn::Counts;
using learn::LabelRule;

constexpr std::size_t fold_count = 5;
constexpr std::size_t default_recordings = 200;         // of each level
constexpr std::size_t with_slip = 0, motors_alone = 1;  // groups
constexpr double bench_level = 2.0;

const std::vector<double>& all_levels() {
  static const std::vector<double> levels{0.0, 0.5, 1.0, 2.0, 4.0, 8.0};
  return levels;
}

// A row of Table I.
struct NetworkRow {
  std::string name, text;
  learn::NetworkShape shape;
  std::size_t steps;
  double f1, accuracy;  // published, %
};
const std::vector<NetworkRow>& network_rows() {
  static const std::vector<NetworkRow> rows{
      {"mlp_32", "MLP 32", {}, 500, 0.7913, 88.76},
      {"mlp_128", "MLP 128", {.dim = 128}, 500, 0.7941, 89.39},
      {"tcn_128_8", "TCN 128, kernel 8", {.architecture = Architecture::tcn, .dim = 128, .kernel = 8}, 300, 0.9579, 97.64},
      {"gru_32", "GRU 32", {.architecture = Architecture::gru}, 500, 0.9781, 98.70},
  };
  return rows;
}

// One network to be judged on each of its folds.
struct Task {
  const std::vector<learn::Example>* examples = nullptr;
  std::vector<std::size_t> fold_of;
  std::size_t fold = 0;
  learn::Validation validation;
};

// Counts of each group for the folds of a validation, summed.
using GroupCounts = std::array<Counts, 2>;

struct Figures {
  double accuracy = 0.0, f1 = 0.0;
};
Figures figures_of(const Counts& counts) { return {100.0 * counts.balanced_accuracy(), counts.f1()}; }
// On recordings with a slip, and on all.
Figures on_slip(const GroupCounts& counts) { return figures_of(counts[with_slip]); }
Figures on_all(const GroupCounts& counts) {
  Counts all = counts[with_slip];
  all.add(counts[motors_alone]);
  return figures_of(all);
}
std::string cell(const Figures& figures) {
  return std::isnan(figures.accuracy) ? "-" : fmt::format("{:.1f}, {:.3f}", figures.accuracy, figures.f1);
}
Json json_of(const Figures& figures) { return {{"balanced_accuracy", figures.accuracy / 100.0}, {"f1", figures.f1}}; }

// The examples of one level by one label, and how they are dealt out.
struct MotorLevel {
  double level = 0.0;
  std::map<LabelRule, std::vector<learn::Example>> examples;
  std::vector<std::size_t> groups;
  std::vector<std::string> tips;  // of each example
  double labels_differ = 0.0;     // share of the frames of recordings with a slip
};

std::vector<MotorLevel> levels_of(const std::vector<PiezoRecording>& recordings) {
  std::map<double, MotorLevel> by_level;
  std::map<double, std::pair<double, double>> differing;
  for (const PiezoRecording& recording : recordings) {
    const double key = std::isnan(recording.level) ? -1.0 : recording.level;  // a dataset that sweeps no level has one
    MotorLevel& level = by_level[key];
    level.level = recording.level;
    const std::size_t group = recording.motors_only ? motors_alone : with_slip;
    for (const LabelRule rule : {LabelRule::truth, LabelRule::paper})
      level.examples[rule].push_back({recording.frames(rule), group});
    level.groups.push_back(group);
    level.tips.push_back(recording.tip);
    if (recording.motors_only) continue;
    auto& [different, all] = differing[key];
    for (std::size_t i = 0; i < recording.truth.size(); ++i) different += recording.truth[i] != recording.paper[i] ? 1.0 : 0.0;
    all += static_cast<double>(recording.truth.size());
  }
  std::vector<MotorLevel> levels;
  for (auto& [key, level] : by_level) {
    const auto slips = static_cast<std::size_t>(std::ranges::count(level.groups, with_slip));
    if (slips < fold_count) {
      throw InputError(fmt::format("{} recordings with contact make no {} folds; allowed: {} or more at every level", slips,
                                   fold_count, fold_count));
    }
    for (const auto& [rule, examples] : level.examples) {
      const auto moving = std::ranges::count_if(examples, [](const learn::Example& example) {
        return std::ranges::find(example.frames.slip, 1) != example.frames.slip.end();
      });
      if (static_cast<std::size_t>(moving) < fold_count) {
        throw InputError(fmt::format("{} recordings slip by the {} label; allowed: {} or more at every level", moving,
                                     rule == LabelRule::truth ? "true" : "position", fold_count));
      }
    }
    level.labels_differ = differing[key].first / differing[key].second;
    levels.push_back(std::move(level));
  }
  return levels;
}

// All validations that the tables need, queued first and then run together.
class Validations {
 public:
  explicit Validations(const ReproduceOptions& options) : options_(options) {}

  // Returns a number to ask result() with.
  std::size_t queue(const std::vector<learn::Example>& examples, const std::vector<std::size_t>& fold_of, const NetworkRow& row,
                    bool slip_alone) {
    learn::Validation validation{row.shape, {.steps = row.steps, .seed = options_.seed.value_or(1)}};
    if (slip_alone) validation.learns = [](std::size_t group) { return group == with_slip; };
    const std::size_t folds = *std::ranges::max_element(fold_of) + 1;
    for (std::size_t fold = 0; fold < folds; ++fold) {
      tasks_.push_back({&examples, fold_of, fold, validation});
      validation_of_.push_back(count_);
    }
    return count_++;
  }

  void run() {
    const InterruptGuard guard("ending after the networks at hand");
    results_.assign(count_, {});
    by_fold_.assign(count_, {});
    const auto one = [this](std::size_t index) {
      const Task& task = tasks_[index];
      return learn::judge_fold(*task.examples, task.fold_of, task.fold, task.validation);
    };
    const std::size_t threads = options_.jobs != 0 ? options_.jobs : std::max(1U, std::thread::hardware_concurrency());
    OrderedWorkers<std::vector<Counts>> workers(
        tasks_.size(), std::min(threads, tasks_.size()), [&] { return one; }, &InterruptGuard::flag());
    for (std::size_t i = 0; i < tasks_.size(); ++i) {
      if (options_.say && i % 10 == 0) options_.say(fmt::format("networks ({} of {} done)", i, tasks_.size()));
      const std::optional<std::vector<Counts>> counts = workers.next();
      if (!counts) throw Interrupted();
      GroupCounts fold{};
      for (std::size_t group = 0; group < counts->size(); ++group) fold.at(group) = (*counts)[group];
      for (std::size_t group = 0; group < fold.size(); ++group) results_[validation_of_[i]][group].add(fold[group]);
      by_fold_[validation_of_[i]].push_back(fold);
    }
  }

  [[nodiscard]] const GroupCounts& result(std::size_t validation) const { return results_[validation]; }
  [[nodiscard]] const std::vector<GroupCounts>& folds(std::size_t validation) const { return by_fold_[validation]; }

 private:
  const ReproduceOptions& options_;
  std::size_t count_ = 0;
  std::vector<Task> tasks_;
  std::vector<std::size_t> validation_of_;  // of each task
  std::vector<GroupCounts> results_;
  std::vector<std::vector<GroupCounts>> by_fold_;
};

std::vector<NetworkRow> chosen_rows(const std::vector<std::string>& only) {
  std::vector<std::string> names;
  for (const NetworkRow& row : network_rows()) names.push_back(row.name);
  for (const std::string& name : only) {
    if (std::ranges::find(names, name) == names.end()) {
      throw InputError(fmt::format("reproduce: --only: unknown name {}{}", quote(name), allowed_names(name, names)));
    }
  }
  const std::vector<std::string> usual{"mlp_32", "mlp_128"};
  std::vector<NetworkRow> rows;
  for (const NetworkRow& row : network_rows()) {
    if (std::ranges::find(only.empty() ? usual : only, row.name) != (only.empty() ? usual : only).end()) rows.push_back(row);
  }
  return rows;
}

const char* label_name(LabelRule rule) { return rule == LabelRule::truth ? "true" : "position"; }

std::string level_name(double level) { return std::isnan(level) ? "as recorded" : fmt::format("{}", level); }

}  // namespace

Result piezo_table4(const ReproduceOptions& options) {
  if (!learn::networks_available()) static_cast<void>(learn::make_network({}, 1));  // says what is missing before anything is run
  if (!options.data.empty() && options.trials != 0)
    throw InputError("reproduce: --trials is for recordings that are made; allowed: --data alone");
  const std::vector<NetworkRow> rows = chosen_rows(options.only);
  const std::size_t recordings = options.trials != 0 ? options.trials : default_recordings;
  check_recordings(recordings, 2 * fold_count, fmt::format("{} folds need one each", fold_count));
  const std::vector<MotorLevel> levels =
      levels_of(options.data.empty() ? run_recordings(all_levels(), recordings, options) : read_recordings(options.data));

  Validations validations(options);
  const NetworkRow& curve = network_rows().front();
  struct CurvePoint {
    std::size_t both, slip_alone;
  };
  std::vector<std::map<LabelRule, CurvePoint>> points;
  const std::uint64_t seed = options.seed.value_or(1);
  for (const MotorLevel& level : levels) {
    const std::vector<std::size_t> fold_of = learn::folds(level.groups, fold_count, seed);
    auto& point = points.emplace_back();
    for (const auto& [rule, examples] : level.examples) {
      point[rule] = {validations.queue(examples, fold_of, curve, false), validations.queue(examples, fold_of, curve, true)};
    }
  }
  // The bench's own level, or what there is.
  const auto at = std::ranges::find(levels, bench_level, &MotorLevel::level);
  const MotorLevel& bench_at = at != levels.end() ? *at : levels.front();
  const std::vector<learn::Example>& examples = bench_at.examples.at(LabelRule::paper);
  std::vector<std::size_t> architectures, left_out;
  for (const NetworkRow& row : rows)
    architectures.push_back(validations.queue(examples, learn::folds(bench_at.groups, fold_count, seed), row, false));
  const std::set<std::string> tips(bench_at.tips.begin(), bench_at.tips.end());
  std::vector<std::size_t> tip_of;
  for (const std::string& tip : bench_at.tips) {
    tip_of.push_back(static_cast<std::size_t>(std::distance(tips.begin(), tips.find(tip))));
  }
  if (tips.size() > 1) {
    for (const NetworkRow& row : rows) left_out.push_back(validations.queue(examples, tip_of, row, false));
  }
  validations.run();

  Result result;
  result.title = "A network that sees one frame of the piezoelectric skin, against the motors' vibration";
  result.source =
      "Tables I, III and IV of \"Spectro-Temporal Recurrent Neural Network for Robotic Slip Detection with Piezoelectric Tactile Sensor\". Cells are balanced accuracy in % and F1 of slip.";
  for (const LabelRule rule : {LabelRule::paper, LabelRule::truth}) {
    ResultTable table;
    table.title = fmt::format("MLP 32 by the {} label", rule == LabelRule::truth ? "true" : "100 Hz position");
    table.head = {"motor level", "learnt slip + noise: on slip + noise",
                  "on slip",     "learnt slip: on slip + noise",
                  "on slip",     "slip to slip + noise"};
    table.rows.push_back({"paper, MLP 32 (Table I)", "88.8, 0.791", "-", "-", "-", "-"});
    table.rows.push_back({"paper, GRU 32 (Table IV)", "98.5, 0.974", "98.2, 0.977", "86.5, 0.678", "98.6, 0.983", "-12.1"});
    for (std::size_t i = 0; i < levels.size(); ++i) {
      const CurvePoint point = points[i].at(rule);
      const GroupCounts& both = validations.result(point.both);
      const GroupCounts& alone = validations.result(point.slip_alone);
      table.rows.push_back({level_name(levels[i].level), cell(on_all(both)), cell(on_slip(both)), cell(on_all(alone)),
                            cell(on_slip(alone)), fmt::format("{:+.1f}", on_all(alone).accuracy - on_slip(alone).accuracy)});
      result.figures["curve"][label_name(rule)][level_name(levels[i].level)] = {
          {"slip_and_noise", {{"on_slip_and_noise", json_of(on_all(both))}, {"on_slip", json_of(on_slip(both))}}},
          {"slip", {{"on_slip_and_noise", json_of(on_all(alone))}, {"on_slip", json_of(on_slip(alone))}}},
          {"labels_differ", levels[i].labels_differ}};
    }
    result.tables.push_back(std::move(table));
  }

  ResultTable networks;
  networks.title = fmt::format("Table I: architectures at motor level {}, position label", level_name(bench_at.level));
  networks.head = {"network", "parameters", "paper", "ours", "on slip"};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const GroupCounts& counts = validations.result(architectures[i]);
    networks.rows.push_back({rows[i].text, fmt::format("{}", learn::parameter_count(rows[i].shape)),
                             fmt::format("{:.1f}, {:.3f}", rows[i].accuracy, rows[i].f1), cell(on_all(counts)),
                             cell(on_slip(counts))});
    result.figures["table1"][rows[i].name] = {{"on_slip_and_noise", json_of(on_all(counts))},
                                              {"on_slip", json_of(on_slip(counts))}};
  }
  result.tables.push_back(std::move(networks));

  if (!left_out.empty()) {
    ResultTable table;
    table.title =
        fmt::format("Table III: a tip that was never learnt, at motor level {}, position label", level_name(bench_at.level));
    table.head = {"network", "none left out"};
    for (std::size_t tip = 0; tip < tips.size(); ++tip) table.head.push_back(fmt::format("tip {}", tip + 1));
    table.note =
        "Tips are numbered in the order of what the sweep says of them; the paper's are not described, so that the numbers do not match.";
    table.rows.push_back({"paper, GRU 32", "98.6, 0.976", "96.5, 0.950", "95.3, 0.937", "94.4, 0.934"});
    table.rows.back().resize(table.head.size(), "-");
    for (std::size_t i = 0; i < rows.size(); ++i) {
      std::vector<std::string> cells{rows[i].text, cell(on_all(validations.result(architectures[i])))};
      for (const GroupCounts& fold : validations.folds(left_out[i])) {
        cells.push_back(cell(on_all(fold)));
        result.figures["table3"][rows[i].name].push_back(json_of(on_all(fold)));
      }
      table.rows.push_back(std::move(cells));
    }
    result.tables.push_back(std::move(table));
  }

  double differ = 0.0;
  for (const MotorLevel& level : levels) differ = std::max(differ, level.labels_differ);
  result.setup = {
      options.data.empty()
          ? fmt::format("{} recordings a level from scenes/piezo_skin/dataset.yaml (paper: 3,200), half with a slip, seed {}.",
                        recordings, seed)
          : fmt::format("{} recordings of {}.", bench_at.groups.size(), options.data),
      "Frames of 20 ms every 10 ms, 12 bins of 50 to 600 Hz, log power, standardised on the recordings that are learnt.",
      fmt::format(
          "{} folds by recording, stratified; counts of all folds are summed. {} steps of 32 clips of 128 frames by RMSProp.",
          fold_count, curve.steps),
      fmt::format("The two labels differ in up to {:.1f} % of the frames of recordings with a slip.", 100.0 * differ)};
  result.remarks = {
      "Table IV is the paper's GRU, which remembers; the columns of the curve are a network of single frames, whose counterpart in the paper is the row MLP 32 of Table I. The paper trains no MLP without motor recordings. `--only gru_32` adds its own network at one level.",
      "The true label is that a part of the patch slips; by the rule strict all of its elements, which stick and slip by turns, would have to at once. Between them lie the stick phase at the beginning of the motion and instants at which all stick.",
      "The paper keeps the state of the best validation result, from the recordings that also judge; here the last state is kept.",
      "Neither the paper's motors nor the size of its signal are printed: the level 1 is an assumption, and the curve shows what it decides."};
  return result;
}

}  // namespace slipbench::reproduce
