// Table II of the paper: the band of the spectrum.
#include <fmt/format.h>

#include "tools/studies/piezo_fft_gru/piezo_networks.h"

namespace slipbench::reproduce {
namespace {

using learn::LabelRule;

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
  std::vector<std::array<std::size_t, 2>> numbers;  // by the position label, by the true one
  for (const Band& band : bands(options.full)) {
    NetworkRow row = gru_32();
    row.name = fmt::format("{:.0f}-{:.0f}", band.low, band.high);
    row.text = fmt::format("{:.0f} to {:.0f} Hz", band.low, band.high);
    row.input = rows.size();
    const PiezoFrames& frames = recordings.front().inputs[row.input];
    row.shape.inputs = frames.features.size() / frames.truth.size();
    row.f1 = band.f1;
    row.accuracy = band.accuracy;
    numbers.push_back(
        {validations.queue_folds(recordings, row, LabelRule::paper), validations.queue_folds(recordings, row, LabelRule::micro)});
    rows.push_back(row);
  }
  validations.run();

  Result result;
  result.title = "The FFT-GRU by the band of its spectrum";
  result.source = fmt::format("Table II of {}", table_source);
  ResultTable table;
  table.title = "Table II: GRU 32";
  table.head = {"band", "bins", "paper", "position label: all", "with contact", "true label: all", "with contact"};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::vector<GroupCounts>&position = validations.folds(numbers[i][0]), &truth = validations.folds(numbers[i][1]);
    table.rows.push_back({rows[i].text, fmt::format("{}", rows[i].shape.inputs), paper_cell(rows[i]), cell(on_all(position)),
                          cell(on_slip(position)), cell(on_all(truth)), cell(on_slip(truth))});
    result.figures["position"][rows[i].name] = json_of(position);
    result.figures["true"][rows[i].name] = json_of(truth);
  }
  result.tables.push_back(table);
  result.setup = setup_lines(options, size, recordings.size());
  if (!options.full) result.setup.push_back("`--full` has all seven bands.");
  return result;
}

}  // namespace slipbench::reproduce
