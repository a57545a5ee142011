// Tables I, III and IV of the paper with its frame-wise network, against the level of the motors' vibration and by both labels.
#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "tools/studies/grid.h"
#include "tools/studies/piezo_fft_gru/piezo_networks.h"

namespace slipbench::reproduce {
namespace {

using learn::LabelRule;

constexpr std::size_t default_recordings = 200;  // of each level
constexpr double bench_level = 2.0;

const std::vector<double>& all_levels() {
  static const std::vector<double> levels{0.0, 0.5, 1.0, 2.0, 4.0, 8.0};
  return levels;
}

std::string cell(const NetworkFigures& figures) {
  return std::isnan(figures.accuracy) ? "-" : fmt::format("{:.1f}, {:.3f}", figures.accuracy, figures.f1);
}
Json json_of(const NetworkFigures& figures) { return {{"balanced_accuracy", figures.accuracy / 100.0}, {"f1", figures.f1}}; }

const char* label_name(LabelRule rule) { return rule == LabelRule::truth ? "true" : "position"; }

std::string level_name(double level) { return std::isnan(level) ? "as recorded" : fmt::format("{}", level); }

// The networks of all tables, queued in the order of the tables.
class Networks {
 public:
  Networks(const std::vector<MotorLevel>& levels, const std::vector<NetworkRow>& rows, const ReproduceOptions& options)
      : levels_(levels), rows_(rows), validations_(options) {
    const std::uint64_t seed = options.seed.value_or(1);
    for (const MotorLevel& level : levels) {
      const std::vector<std::size_t> fold_of = learn::folds(level.groups, fold_count, seed);
      auto& point = points_.emplace_back();
      for (const auto& [rule, examples] : level.examples) {
        point[rule] = {validations_.queue(examples, fold_of, curve_network(), false),
                       validations_.queue(examples, fold_of, curve_network(), true)};
      }
    }
    const std::vector<learn::Example>& examples = bench().examples.at(LabelRule::paper);
    for (const NetworkRow& row : rows)
      architectures_.push_back(validations_.queue(examples, learn::folds(bench().groups, fold_count, seed), row, false));
    const std::set<std::string> tips(bench().tips.begin(), bench().tips.end());
    tips_ = tips.size();
    if (tips.size() < 2) return;
    std::vector<std::size_t> tip_of;
    for (const std::string& tip : bench().tips) {
      tip_of.push_back(static_cast<std::size_t>(std::distance(tips.begin(), tips.find(tip))));
    }
    for (const NetworkRow& row : rows) left_out_.push_back(validations_.queue(examples, tip_of, row, false));
  }

  void run() { validations_.run(); }

  static const NetworkRow& curve_network() { return network_rows().front(); }
  // The bench's own level, or what there is.
  [[nodiscard]] const MotorLevel& bench() const {
    const auto at = std::ranges::find(levels_, bench_level, &MotorLevel::level);
    return at != levels_.end() ? *at : levels_.front();
  }

  [[nodiscard]] ResultTable curve_table(LabelRule rule, Json& figures) const;
  [[nodiscard]] ResultTable architecture_table(Json& figures) const;
  [[nodiscard]] bool has_tips() const { return !left_out_.empty(); }  // more than one
  [[nodiscard]] ResultTable tip_table(Json& figures) const;

 private:
  struct CurvePoint {
    std::size_t both, slip_alone;
  };

  const std::vector<MotorLevel>& levels_;
  const std::vector<NetworkRow>& rows_;
  Validations validations_;
  std::vector<std::map<LabelRule, CurvePoint>> points_;  // of each level
  std::vector<std::size_t> architectures_, left_out_;    // of each row
  std::size_t tips_ = 0;
};

ResultTable Networks::curve_table(LabelRule rule, Json& figures) const {
  ResultTable table;
  table.title = fmt::format("MLP 32 by the {} label", rule == LabelRule::truth ? "true" : "100 Hz position");
  table.head = {"motor level", "learnt slip + noise: on slip + noise",
                "on slip",     "learnt slip: on slip + noise",
                "on slip",     "slip to slip + noise"};
  table.rows.push_back({"paper, MLP 32 (Table I)", "88.8, 0.791", "-", "-", "-", "-"});
  table.rows.push_back({"paper, GRU 32 (Table IV)", "98.5, 0.974", "98.2, 0.977", "86.5, 0.678", "98.6, 0.983", "-12.1"});
  for (std::size_t i = 0; i < levels_.size(); ++i) {
    const std::string level = level_name(levels_[i].level);
    const GroupCounts both = validations_.result(points_[i].at(rule).both);
    const GroupCounts alone = validations_.result(points_[i].at(rule).slip_alone);
    table.rows.push_back({level, cell(on_all(both)), cell(on_slip(both)), cell(on_all(alone)), cell(on_slip(alone)),
                          fmt::format("{:+.1f}", on_all(alone).accuracy - on_slip(alone).accuracy)});
    figures[label_name(rule)][level] = {
        {"slip_and_noise", {{"on_slip_and_noise", json_of(on_all(both))}, {"on_slip", json_of(on_slip(both))}}},
        {"slip", {{"on_slip_and_noise", json_of(on_all(alone))}, {"on_slip", json_of(on_slip(alone))}}},
        {"labels_differ", levels_[i].labels_differ}};
  }
  return table;
}

ResultTable Networks::architecture_table(Json& figures) const {
  ResultTable table;
  table.title = fmt::format("Table I: architectures at motor level {}, position label", level_name(bench().level));
  table.head = {"network", "parameters", "paper", "ours", "on slip"};
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const GroupCounts counts = validations_.result(architectures_[i]);
    table.rows.push_back({rows_[i].text, fmt::format("{}", learn::parameter_count(rows_[i].shape)),
                          fmt::format("{:.1f}, {:.3f}", rows_[i].accuracy, rows_[i].f1), cell(on_all(counts)),
                          cell(on_slip(counts))});
    figures[rows_[i].name] = {{"on_slip_and_noise", json_of(on_all(counts))}, {"on_slip", json_of(on_slip(counts))}};
  }
  return table;
}

ResultTable Networks::tip_table(Json& figures) const {
  ResultTable table;
  table.title =
      fmt::format("Table III: a tip that was never learnt, at motor level {}, position label", level_name(bench().level));
  table.head = {"network", "none left out"};
  for (std::size_t tip = 0; tip < tips_; ++tip) table.head.push_back(fmt::format("tip {}", tip + 1));
  table.note =
      "Tips are numbered in the order of what the sweep says of them; the paper's are not described, so that the numbers do not match.";
  table.rows.push_back({"paper, GRU 32", "98.6, 0.976", "96.5, 0.950", "95.3, 0.937", "94.4, 0.934"});
  table.rows.back().resize(table.head.size(), "-");
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    std::vector<std::string> cells{rows_[i].text, cell(on_all(validations_.result(architectures_[i])))};
    for (const GroupCounts& fold : validations_.folds(left_out_[i])) {
      cells.push_back(cell(on_all(fold)));
      figures[rows_[i].name].push_back(json_of(on_all(fold)));
    }
    table.rows.push_back(std::move(cells));
  }
  return table;
}

std::vector<NetworkRow> chosen_networks(const std::vector<std::string>& only) {
  check_only(only, names_of(network_rows()));
  return chosen(network_rows(), only.empty() ? std::vector<std::string>{"mlp_32", "mlp_128"} : only);
}

}  // namespace

Result piezo_table4(const ReproduceOptions& options) {
  if (!learn::networks_available()) static_cast<void>(learn::make_network({}, 1));  // says what is missing before anything is run
  if (!options.data.empty() && options.trials != 0)
    throw InputError("reproduce: --trials is for recordings that are made; allowed: --data alone");
  const std::vector<NetworkRow> rows = chosen_networks(options.only);
  const std::size_t recordings = options.trials != 0 ? options.trials : default_recordings;
  check_recordings(recordings, 2 * fold_count, fmt::format("{} folds need one each", fold_count));
  const std::vector<MotorLevel> levels =
      levels_of(options.data.empty() ? run_recordings(all_levels(), recordings, options) : read_recordings(options.data));

  Networks networks(levels, rows, options);
  networks.run();

  Result result;
  result.title = "A network that sees one frame of the piezoelectric skin, against the motors' vibration";
  result.source =
      "Tables I, III and IV of \"Spectro-Temporal Recurrent Neural Network for Robotic Slip Detection with Piezoelectric Tactile Sensor\". Cells are balanced accuracy in % and F1 of slip.";
  for (const LabelRule rule : {LabelRule::paper, LabelRule::truth}) {
    result.tables.push_back(networks.curve_table(rule, result.figures["curve"]));
  }
  result.tables.push_back(networks.architecture_table(result.figures["table1"]));
  if (networks.has_tips()) result.tables.push_back(networks.tip_table(result.figures["table3"]));
  double differ = 0.0;
  for (const MotorLevel& level : levels) differ = std::max(differ, level.labels_differ);
  result.setup = {
      options.data.empty()
          ? fmt::format("{} recordings a level from scenes/piezo_skin/dataset.yaml (paper: 3,200), half with a slip, seed {}.",
                        recordings, options.seed.value_or(1))
          : fmt::format("{} recordings of {}.", networks.bench().groups.size(), options.data),
      "Frames of 20 ms every 10 ms, 12 bins of 50 to 600 Hz, log power, standardised on the recordings that are learnt.",
      fmt::format(
          "{} folds by recording, stratified; counts of all folds are summed. {} steps of 32 clips of 128 frames by RMSProp.",
          fold_count, Networks::curve_network().steps),
      fmt::format("The two labels differ in up to {:.1f} % of the frames of recordings with a slip.", 100.0 * differ)};
  result.remarks = {
      "Table IV is the paper's GRU, which remembers; the columns of the curve are a network of single frames, whose counterpart in the paper is the row MLP 32 of Table I. The paper trains no MLP without motor recordings. `--only gru_32` adds its own network at one level.",
      "The true label is that a part of the patch slips; by the rule strict all of its elements, which stick and slip by turns, would have to at once. Between them lie the stick phase at the beginning of the motion and instants at which all stick.",
      "The paper keeps the state of the best validation result, from the recordings that also judge; here the last state is kept.",
      "Neither the paper's motors nor the size of its signal are printed: the level 1 is an assumption, and the curve shows what it decides."};
  return result;
}

}  // namespace slipbench::reproduce
