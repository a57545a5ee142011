#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "tools/studies/piezo_fft_gru/piezo_networks.h"

namespace slipbench::reproduce {
namespace {

using train::LabelRule;

struct Band {
  double low, high;     // Hz
  double f1, accuracy;  // published
};

const std::vector<Band>& bands(bool full) {
  static const std::vector<Band> all{{0.0, 5000.0, 0.9589, 97.40}, {0.0, 600.0, 0.9777, 98.67},  {50.0, 400.0, 0.9769, 98.40},
                                     {50.0, 450.0, 0.9784, 98.80}, {50.0, 500.0, 0.9783, 98.79}, {50.0, 600.0, 0.9782, 98.74},
                                     {50.0, 1000.0, 0.9774, 98.63}};
  static const std::vector<Band> few{all[0], all[1], all[2], all[5]};
  return full ? all : few;
}

}  // namespace

Result piezo_table2(const ReproduceOptions& options) {
  const StudySize size = size_of(options, usual_recordings);
  std::vector<network::Input> inputs;
  for (const Band& band : bands(options.full)) inputs.push_back(spectra_of(band.low, band.high));
  const std::vector<PiezoRecording> recordings = recordings_for(options, size, {bench_level}, inputs);
  Validations validations(options, size);
  std::vector<NetworkRow> rows;
  const std::vector<LabelRule> rules =
      options.full ? std::vector{LabelRule::paper, LabelRule::micro} : std::vector{LabelRule::paper};
  std::vector<std::vector<std::size_t>> numbers;  // of each band and rule
  for (const Band& band : bands(options.full)) {
    NetworkRow row = gru_32();
    row.name = fmt::format("{:.0f}-{:.0f}", band.low, band.high);
    row.text = fmt::format("{:.0f} to {:.0f} Hz", band.low, band.high);
    row.input = rows.size();
    const PiezoFrames& frames = recordings.front().inputs[row.input];
    row.shape.inputs = frames.features.size() / frames.truth.size();
    row.f1 = band.f1;
    row.accuracy = band.accuracy;
    numbers.emplace_back();
    for (const LabelRule rule : rules) numbers.back().push_back(validations.queue_folds(recordings, row, rule));
    rows.push_back(row);
  }
  validations.run();

  Result result;
  result.title = "The FFT-GRU by the band of its spectrum";
  result.source = fmt::format("Table II of {}", table_source);
  ResultTable table{"Table II: GRU 32", {"band", "bins", "paper"}};
  for (const LabelRule rule : rules) {
    table.head.push_back(fmt::format("{} label: all", label_name(rule)));
    table.head.emplace_back("with contact");
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::vector<std::string>& cells =
        table.rows.emplace_back(std::vector{rows[i].text, fmt::format("{}", rows[i].shape.inputs), paper_cell(rows[i])});
    for (std::size_t k = 0; k < rules.size(); ++k) {
      const std::vector<GroupCounts>& folds = validations.folds(numbers[i][k]);
      cells.insert(cells.end(), {cell(on_all(folds)), cell(on_slip(folds))});
      result.figures[label_name(rules[k])][rows[i].name] = json_of(folds);
    }
  }
  result.tables.push_back(table);
  result.setup = setup_lines(options, size, recordings.size());
  if (!options.full) result.setup.push_back("`--full` has all seven bands, and the true label.");
  return result;
}

// Table III of the paper: tips that were never learnt.
Result piezo_table3(const ReproduceOptions& options) {
  const StudySize size = size_of(options, usual_recordings);
  const std::vector<PiezoRecording> recordings = recordings_for(options, size, {bench_level}, {published_spectra()});
  std::set<std::string> tips;
  for (const PiezoRecording& recording : recordings) tips.insert(recording.tip);
  if (tips.size() < 2) {
    throw InputError(fmt::format("{}: all recordings are of one tip; allowed: two or more, as one is left out",
                                 options.data.empty() ? piezo_bench_scene : options.data));
  }
  std::vector<std::size_t> tip_of;
  for (const PiezoRecording& recording : recordings)
    tip_of.push_back(static_cast<std::size_t>(std::distance(tips.begin(), tips.find(recording.tip))));

  struct Row {
    NetworkRow network;
    LabelRule rule;
    std::size_t all, left_out;  // validations
  };
  Validations validations(options, size);
  std::vector<Row> rows;
  for (const NetworkRow& network : {gru_32(), mlp_32()}) {
    for (const LabelRule rule : {LabelRule::paper, LabelRule::micro})
      rows.push_back({network, rule, validations.queue_folds(recordings, network, rule),
                      validations.queue(recordings, tip_of, network, rule)});
  }
  validations.run();

  Result result;
  result.title = "A tip that was never learnt";
  result.source = fmt::format("Table III of {}", table_source);
  ResultTable table{"Table III: all recordings of the tip, with contact and motors alone", {"network", "label", "none left out"}};
  for (std::size_t tip = 0; tip < tips.size(); ++tip) table.head.push_back(fmt::format("tip {}", tip + 1));
  table.note =
      "Tips are numbered in the order of what the sweep says of them; the paper's are not described, so that the numbers do not match.";
  table.rows.push_back({"paper, GRU 32", "position", "98.6, 0.976", "96.5, 0.950", "95.3, 0.937", "94.4, 0.934"});
  table.rows.back().resize(table.head.size(), "-");
  for (const Row& row : rows) {
    std::vector<std::string> cells{row.network.text, label_name(row.rule), cell(on_all(validations.folds(row.all)))};
    Json& figures = result.figures[label_name(row.rule)][row.network.name];
    figures["none"] = json_of(validations.folds(row.all));
    for (const GroupCounts& fold : validations.folds(row.left_out)) {
      cells.push_back(cell(on_all({fold})));
      figures["tips"].push_back(json_of(std::vector<GroupCounts>{fold}));
    }
    table.rows.push_back(std::move(cells));
  }
  result.tables.push_back(table);
  result.setup = setup_lines(options, size, recordings.size());
  std::size_t number = 0;
  for (const std::string& tip : tips) {
    result.setup.push_back(fmt::format("Tip {}: {} recordings, {}", number + 1, std::ranges::count(tip_of, number), tip));
    ++number;
  }
  result.remarks = {
      "The scene's tips differ in friction, stiffness, roundness, resonance and roughness; what they have in common is the sensor and its motors."};
  return result;
}

}  // namespace slipbench::reproduce
