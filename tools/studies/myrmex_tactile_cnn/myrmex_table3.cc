// Table 3 of the Myrmex paper: confusion of nets 1 to 3 from 62.5 Hz on, ten folds by window, and by trial.
#include <array>

#include <fmt/format.h>

#include "tools/studies/grid.h"
#include "tools/studies/myrmex_tactile_cnn/myrmex_networks.h"

namespace slipbench::reproduce {
namespace {

constexpr std::size_t window_folds_count = 10;  // the paper's
constexpr std::array names{"stable", "translation", "rotation"};
using Shares = std::array<std::array<double, kinds>, kinds>;  // [true][called], %
constexpr std::array<Shares, 3> published{{Shares{{{90.79, 5.83, 3.38}, {2.13, 92.58, 5.29}, {2.15, 3.17, 94.68}}},
                                           Shares{{{95.73, 2.54, 1.73}, {1.26, 96.37, 2.37}, {0.97, 1.56, 97.47}}},
                                           Shares{{{97.57, 1.41, 1.02}, {0.68, 97.73, 1.58}, {0.51, 0.93, 98.56}}}}};

}  // namespace

Result myrmex_table3(const ReproduceOptions& options) {
  const MyrmexSize size = myrmex_size(options);
  std::vector<MyrmexRow> all;
  for (std::size_t net = 1; net <= 3; ++net) all.push_back(network_row(net, MyrmexInput::high_pass, SlipWord::truth));
  check_only(options.only, names_of(all));
  const std::vector<MyrmexRow> rows = chosen(all, options.only);
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
    ResultTable table{fmt::format("{}: share of the true class in %", rows[k].text), {"true"}, {}, ""};
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
