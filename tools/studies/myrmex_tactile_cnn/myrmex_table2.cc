#include <cmath>

#include <fmt/format.h>

#include "tools/base/statistics/descriptive.h"
#include "tools/studies/grid.h"
#include "tools/studies/myrmex_tactile_cnn/myrmex_networks.h"

namespace slipbench::reproduce {
namespace {

constexpr std::array<double, 3> published_forward{0.29, 0.44, 0.43};  // ms
constexpr std::size_t window_splits = 5;                              // 20 % of the windows judge; the first of five folds

std::vector<MyrmexRow> all_rows() {
  std::vector<MyrmexRow> rows;
  for (const MyrmexInput input : {MyrmexInput::spectra, MyrmexInput::high_pass}) {
    for (std::size_t net = 1; net <= 3; ++net) rows.push_back(network_row(net, input, SlipWord::truth));
  }
  for (std::size_t net = 1; net <= 3; ++net) rows.push_back(network_row(net, MyrmexInput::spectra, SlipWord::bench));
  rows.push_back(network_row(3, MyrmexInput::spectra, SlipWord::motion));
  const auto other = [&](const char* name, const char* text, auto&& change) {
    MyrmexRow row = network_row(3, MyrmexInput::spectra, SlipWord::truth);
    row.name = name;
    row.text = text;
    row.published = std::numeric_limits<double>::quiet_NaN();
    change(row);
    rows.push_back(row);
  };
  other("net_3_longer", "net 3, four times the steps", [](MyrmexRow& row) { row.longer = 4; });
  other("net_3_late", "net 3, stable from the last half second alone", [](MyrmexRow& row) { row.late = true; });
  other("static", "the static image alone, net 3", [](MyrmexRow& row) { row.input = MyrmexInput::static_image; });
  const auto shortcut = [&](const char* name, const char* text, MyrmexInput input) {
    MyrmexRow row;
    row.name = name;
    row.text = text;
    row.input = input;
    rows.push_back(row);
  };
  shortcut("load", "the mean count alone", MyrmexInput::load);
  shortcut("clock", "a clock", MyrmexInput::clock);
  shortcut("placement", "object and placement", MyrmexInput::placement);
  shortcut("clock_placement", "a clock, object and placement", MyrmexInput::clock_placement);
  return rows;
}

struct Asked {
  MyrmexRow row;
  std::size_t window, trial, object;  // validations
};

Json figures_json(const MyrmexFigures& figures) {
  Json folds = Json::array();
  for (const KindCounts& fold : figures.folds) folds.push_back(fold.accuracy());
  return {{"accuracy", figures.all().accuracy()}, {"folds", folds}, {"windows", figures.all().windows}};
}

ResultTable accuracy_table() {
  return {
      "Accuracy in %",
      {"what it is told", "label", "paper, by window", "by window", "by trial", "SD of folds", "object left out",
       "object, least fold", "forward, ms: paper", "ours"},
      {},
      "By window: a fifth of the windows of each class in turn judges, as in the paper, and its neighbours are learnt from. By trial: "
      "five folds. Object left out: cylinder, remote, glass."};
}

ResultTable mistakes_table() {
  return {"Stable windows called slip, in %, by trial",
          {"what it is told", "label", "last half second before the true onset", "earlier", "of trials that hold"},
          {},
          "All windows of the last half second; of the others those drawn."};
}

// Time of a forward pass [ms] of the networks that the paper times; NaN of the others.
double forward_ms(const MyrmexRow& row) {
  const bool timed = !row.layers.empty() && row.input != MyrmexInput::static_image && row.longer == 1 && !row.late &&
                     row.word == SlipWord::truth;
  return timed ? 1e3 * forward_seconds(row) : std::numeric_limits<double>::quiet_NaN();
}

// The figures of a row, each validation's, go into the tables and into the result.
void add_row(const Asked& asked, const MyrmexValidations& validations, ResultTable& accuracy, ResultTable& mistakes, Json& json) {
  const MyrmexRow& row = asked.row;
  const MyrmexFigures &by_window = validations.figures(asked.window), &by_trial = validations.figures(asked.trial),
                      &by_object = validations.figures(asked.object);
  std::vector<double> folds;
  for (const KindCounts& fold : by_trial.folds) folds.push_back(fold.accuracy());
  double least = std::numeric_limits<double>::quiet_NaN();
  for (const KindCounts& fold : by_object.folds) least = std::fmin(least, fold.accuracy());
  const double forward = forward_ms(row);
  const bool timed = !std::isnan(forward);
  accuracy.rows.push_back(
      {row.text, slip_word(row.word), percent_text(row.published / 100.0), percent_text(by_window.all().accuracy()),
       percent_text(by_trial.all().accuracy()), percent_text(mean_sd(folds).sd), percent_text(by_object.all().accuracy()),
       percent_text(least),
       timed ? fmt::format("{:.2f}", published_forward.at(static_cast<std::size_t>(row.layers.back() - '1'))) : "-",
       timed ? fmt::format("{:.2f}", forward) : "-"});
  mistakes.rows.push_back({row.text, slip_word(row.word), percent_text(by_trial.late.share()),
                           percent_text(by_trial.earlier.share()), percent_text(by_trial.holds.share())});
  json[row.name] = {{"by_window", figures_json(by_window)},
                    {"by_trial", figures_json(by_trial)},
                    {"object_left_out", figures_json(by_object)},
                    {"stable_called_slip",
                     {{"last_half_second", by_trial.late.share()},
                      {"earlier", by_trial.earlier.share()},
                      {"trials_that_hold", by_trial.holds.share()}}},
                    {"forward_ms", forward}};
}

constexpr std::size_t window_folds_count = 10;  // the paper's
constexpr std::array names{"stable", "translation", "rotation"};
using Shares = std::array<std::array<double, kinds>, kinds>;  // [true][called], %
constexpr std::array<Shares, 3> published{{Shares{{{90.79, 5.83, 3.38}, {2.13, 92.58, 5.29}, {2.15, 3.17, 94.68}}},
                                           Shares{{{95.73, 2.54, 1.73}, {1.26, 96.37, 2.37}, {0.97, 1.56, 97.47}}},
                                           Shares{{{97.57, 1.41, 1.02}, {0.68, 97.73, 1.58}, {0.51, 0.93, 98.56}}}}};

}  // namespace

Result myrmex_table2(const ReproduceOptions& options) {
  const MyrmexSize size = myrmex_size(options);
  const std::vector<MyrmexRow> rows = rows_asked_for(all_rows(), options);
  const std::vector<MyrmexTrial> trials = myrmex_trials(options, size);
  MyrmexValidations validations(options, size, trials);
  std::vector<Asked> asked;
  for (const MyrmexRow& row : rows) {
    asked.push_back({row, validations.queue(row, MyrmexSplit::window, window_splits, 1),
                     validations.queue(row, MyrmexSplit::trial, trial_folds, trial_folds),
                     validations.queue(row, MyrmexSplit::object, 0, row.longer > 1 ? 0 : trials.size())});
  }
  validations.run();

  Result result;
  result.title = "Networks of the Myrmex array: stable, translation or rotation";
  result.source = fmt::format("Table 2 of {}", myrmex_source);
  ResultTable accuracy = accuracy_table(), mistakes = mistakes_table();
  for (const Asked& one : asked) {
    add_row(one, validations, accuracy, mistakes, result.figures);
    if (std::isnan(one.row.published)) continue;
    result.real.push_back({one.row.text + ", windows that are right, %", one.row.published,
                           100.0 * validations.figures(one.window).all().accuracy(), "ours has learnt from simulation"});
  }
  result.tables = {accuracy, mistakes};
  result.setup = myrmex_setup(options, size, trials);
  result.remarks = {
      "The grip opens until the object slips, so a low static image means slip; the shortcuts say how much of a score that is.",
      "Windows drawn at random are seldom those shortly before the onset, where stable and slip differ least: the second table has them.",
      "Forward: one window through libtorch on one core, without its spectra; the paper's is a GPU's."};
  return result;
}

// Table 3 of the Myrmex paper: confusion of nets 1 to 3 from 62.5 Hz on, ten folds by window, and by trial.
Result myrmex_table3(const ReproduceOptions& options) {
  const MyrmexSize size = myrmex_size(options);
  std::vector<MyrmexRow> all;
  for (std::size_t net = 1; net <= 3; ++net) all.push_back(network_row(net, MyrmexInput::high_pass, SlipWord::truth));
  const std::vector<MyrmexRow> rows = rows_asked_for(all, options);
  const std::vector<MyrmexTrial> trials = myrmex_trials(options, size);
  MyrmexValidations validations(options, size, trials);
  struct Asked {
    std::size_t window, trial;
  };
  std::vector<Asked> asked;
  for (const MyrmexRow& row : rows)
    asked.push_back({validations.queue(row, MyrmexSplit::window, window_folds_count, window_folds_count),
                     validations.queue(row, MyrmexSplit::trial, trial_folds, trial_folds)});
  validations.run();

  Result result;
  result.title = "Networks of the Myrmex array: what is taken for what";
  result.source = fmt::format("Table 3 of {}", myrmex_source);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    ResultTable table{fmt::format("{}: share of the true class in %", rows[k].text), {"true"}};
    for (const char* where : {"paper", "by window", "by trial"}) {
      for (const char* name : names) table.head.push_back(fmt::format("{}: called {}", where, name));
    }
    const Shares& paper = published.at(static_cast<std::size_t>(rows[k].layers.back() - '1'));
    const KindCounts by_window = validations.figures(asked[k].window).all(), by_trial = validations.figures(asked[k].trial).all();
    for (std::size_t label = 0; label < kinds; ++label) {
      std::vector<std::string>& row = table.rows.emplace_back(1, names[label]);
      for (const double share : paper[label]) row.push_back(fmt::format("{:.1f}", share));
      for (const KindCounts* counts : {&by_window, &by_trial}) {
        for (std::size_t called = 0; called < kinds; ++called) row.push_back(percent_text(counts->share(label, called)));
      }
    }
    result.tables.push_back(std::move(table));
    result.figures[rows[k].name] = {{"by_window", by_window.windows}, {"by_trial", by_trial.windows}};
  }
  result.setup = myrmex_setup(options, size, trials);
  result.remarks = {
      "By window: ten folds, of each class every tenth window in turn. The paper's ten chunks are \"stored in an alternating fashion\", and how its "
      "windows lie in them is not said."};
  return result;
}

}  // namespace slipbench::reproduce
