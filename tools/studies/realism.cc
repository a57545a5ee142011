// How near the bench is to real devices: figures that others measured on one, ours beside them.
#include <array>
#include <cmath>
#include <span>

#include "tools/base/dataset/checked_dataset.h"
#include "tools/base/dataset/reader.h"
#include "tools/base/project/project_file.h"
#include "tools/studies/grid.h"

namespace slipbench::reproduce {
namespace realism {
namespace {

constexpr std::size_t pillars = 9, centre = 4;
constexpr std::size_t frame_stride = 10;    // samples at 1 kHz of a detector's frame
constexpr double moves_from = 1e-6;         // m/s, rad/s of the pad
constexpr std::uint64_t scene_seed = 2851;  // of hexapod.yaml, whose gains are those of this device
constexpr std::size_t grasps_a_box = 40;    // of which the median's scatter is some 10 %

// What trials of hexapod.yaml add up to.
struct Sums {
  std::size_t rows = 0;
  std::array<std::array<double, pillars>, pillars> products{};  // N^2, of the tangential forces of two pillars, x and y
  std::array<std::size_t, 3> frames{}, right{};                 // with contact: all, before the halt, while the pad moves

  void operator+=(const Sums& other) {
    rows += other.rows;
    for (std::size_t p = 0; p < pillars; ++p) {
      for (std::size_t q = 0; q < pillars; ++q) products[p][q] += other.products[p][q];
    }
    for (std::size_t part = 0; part < 3; ++part) {
      frames.at(part) += other.frames.at(part);
      right.at(part) += other.right.at(part);
    }
  }
  [[nodiscard]] double rms(std::size_t p) const { return std::sqrt(products[p][p] / (2.0 * static_cast<double>(rows))); }
};

void add_forces(const SensorRecord& pad, Sums& sums) {
  const auto force = std::ranges::find(pad.channels, "force", &SensorColumn::name);
  if (force == pad.channels.end() || force->row_size() != 3 * pillars)
    throw InputError("reproduce: realism: the pad of hexapod.yaml has no forces of nine pillars");
  const std::span<const float> values = force->values;
  for (std::size_t first = 0; first < values.size(); first += 3 * pillars, ++sums.rows) {
    for (std::size_t p = 0; p < pillars; ++p) {
      for (std::size_t q = 0; q < pillars; ++q) {
        const std::size_t a = first + 3 * p, b = first + 3 * q;
        sums.products[p][q] += double{values[a]} * double{values[b]} + double{values[a + 1]} * double{values[b + 1]};
      }
    }
  }
}

// The published memory's calls, by the paper's label.
void add_frames(const TrialRecord& record, const SensorRecord& pad, Sums& sums) {
  const ControlRecord& control = *record.control;
  const std::vector<float>& velocity = record.bodies.front().velocity;
  const auto latest = [](const std::vector<double>& times, double t) {
    const auto after = std::ranges::upper_bound(times, t + 1e-9);
    return static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, after - times.begin() - 1));
  };
  struct Frame {
    bool counts, right, moves;
  };
  std::vector<Frame> frames;
  std::size_t halt = 0;  // frames until the pad moves no more
  for (std::size_t k = 0; k < pad.time.size(); k += frame_stride) {
    const std::uint8_t truth = pad.labels.state_paper[k], seen = control.detector_class[latest(control.time, pad.time[k])];
    const std::size_t row = 6 * latest(record.body_time, pad.time[k]);
    const bool moves = std::max({std::abs(velocity[row]), std::abs(velocity[row + 1]), std::abs(velocity[row + 5])}) > moves_from;
    frames.push_back({truth > 0 && seen > 0, truth == seen, moves});
    if (moves) halt = frames.size();
  }
  for (std::size_t k = 0; k < frames.size(); ++k) {
    for (std::size_t part = 0; part < 3; ++part) {
      if (!frames[k].counts || (part == 1 && k >= halt) || (part == 2 && !frames[k].moves)) continue;
      ++sums.frames.at(part);
      sums.right.at(part) += frames[k].right ? 1 : 0;
    }
  }
}

Sums hexapod_sums(const ReproduceOptions& options) {
  const std::optional<std::string> memory = find_project_file("tests/detectors/hd/data/published/AM.hex");
  if (!memory)
    throw InputError("reproduce: realism: the published memory is in the source tree alone; --only names what needs none");
  const GridCell cell{.name = "hexapod.yaml",
                      .scene = "scenes/papillarray/hexapod.yaml",
                      .overrides = {{"detector", fmt::format("{{type: gst_hd, memories: {}, compat: published_core}}",
                                                             Json(memory->substr(0, memory->rfind('/'))).dump())}}};
  ReproduceOptions with_its_device = options;
  if (!options.seed) with_its_device.seed = scene_seed;
  const auto found = run_grid<Sums>({cell}, with_its_device, [](const GridTrial& trial) {
    const TrialRecord record = trial.record();
    Sums sums;
    add_forces(record.sensors.front(), sums);
    add_frames(record, record.sensors.front(), sums);
    return sums;
  });
  Sums all;
  for (const Sums& one : found.front()) all += one;
  return all;
}

// What is published of the PapillArray's recordings: the paper, and statistics of their forces (scenes/papillarray/README.md).
Result hexapod(const ReproduceOptions& options) {
  // N, of pillars 1 to 8: odd ones are edges, 4 is the centre. Nothing is published of pillar 0.
  constexpr std::array<double, pillars> published_rms{0.0, .31, .12, .42, .39, .22, .24, .34, .16};
  const Sums sums = hexapod_sums(options);
  const char* const fitted = "fitted with this in view";
  Result result;
  for (const auto& [part, text] : {std::pair{0, "all"}, {1, "without what follows a halt"}, {2, "while the pad moves"}}) {
    const auto k = static_cast<std::size_t>(part);
    const double right = 100.0 * static_cast<double>(sums.right.at(k)) / static_cast<double>(sums.frames.at(k));
    result.real.push_back({fmt::format("published memory, frames with contact that are right, {}, %", text),
                           part == 0 ? 91.8 : std::numeric_limits<double>::quiet_NaN(), right, fitted});
  }
  double edges = 0.0, corners = 0.0, correlation = 0.0;
  for (std::size_t p = 1; p < pillars; ++p) {
    result.real.push_back({fmt::format("force of an axis of pillar {}, rms, N", p), published_rms.at(p), sums.rms(p), fitted});
    if (p != centre) (p % 2 == 1 ? edges : corners) += sums.rms(p) / (p % 2 == 1 ? 4.0 : 3.0);
  }
  result.real.push_back({"that of the edges over the centre's", 0.82, edges / sums.rms(centre), fitted});
  result.real.push_back({"that of the corners over the centre's", 0.45, corners / sums.rms(centre), fitted});
  for (std::size_t p = 0; p < pillars; ++p) {
    for (std::size_t q = 0; q < p; ++q)
      correlation += sums.products[p][q] / std::sqrt(sums.products[p][p] * sums.products[q][q]) / 36.0;
  }
  result.real.push_back({"correlation of two pillars' forces, mean of the 36 pairs", 0.85, correlation,
                         "fitted with this in view; of the vectors x, y"});
  return result;
}

const std::vector<std::string> fitted_boxes{"as_recorded", "oracle", "ptfe_fitted", "rubber_fitted", "felt_fitted"};
const std::vector<std::string> without_place{"sd_trend_no_site", "sorted_sd_no_site"};

// Studies that hold a published figure of a real device against ours.
struct Source {
  std::string name;
  Result (*run)(const ReproduceOptions& options);
  bool quick;                          // within some minutes of CPU
  std::vector<std::string> only = {};  // its --only
  std::size_t trials = 0;              // of each of its rows, where --trials names none
  const char* recordings = nullptr;    // the format of --real that it needs; null: none
};
const std::vector<Source>& sources() {
  static const std::vector<Source> all{{"hexapod", &hexapod, true},
                                       {"hd-papillarray/table1", &hd_table1, true},
                                       {"hd-papillarray/table2", &hd_table2, true, fitted_boxes, grasps_a_box},
                                       {"nib-reconfigurable/table1", &nib_table1, true},
                                       {"nib-reconfigurable/table2", &nib_table2, true},
                                       {"nib-reconfigurable/table3", &nib_table3, true},
                                       {"piezo-fft-gru/table1", &piezo_table1, false},
                                       {"myrmex-tactile-cnn/table2", &myrmex_table2, false},
                                       {"biotac-stability-slip/table2", &biotac_table2, false, {}, 0, "bts3v2"},
                                       {"biotac-stability-slip/table3", &biotac_table3, false, without_place, 0, "biotacsp-dos"}};
  return all;
}

std::string figure(double value) { return std::isnan(value) ? "-" : fmt::format("{:.3g}", value); }

// The studies that `options` asks for. `left_out` gets the names of the others.
std::vector<Source> asked_for(const ReproduceOptions& options, std::vector<std::string>& left_out) {
  std::vector<Source> asked = rows_asked_for(sources(), options);
  const std::string truth = options.real.empty() ? "" : dataset_header_at(options.real).header().truth;
  std::erase_if(asked, [&](const Source& source) {
    const bool left = source.recordings != nullptr ? !truth.ends_with(source.recordings)
                                                   : options.only.empty() && !options.full && !source.quick;
    if (left) left_out.push_back(source.name);
    return left;
  });
  if (asked.empty() || (!options.real.empty() && std::ranges::all_of(asked, [](const Source& one) { return !one.recordings; })))
    throw InputError(
        "reproduce: realism: no study that is asked for judges by these recordings; allowed: --real of bts3v2, biotacsp-dos");
  return asked;
}

}  // namespace
}  // namespace realism

Result realism_table(const ReproduceOptions& options) {
  using namespace realism;
  std::vector<std::string> left_out;
  const std::vector<Source> asked = asked_for(options, left_out);
  Result result;
  result.title = "The bench beside real devices";
  result.source = "Published figures of real devices for which a study of slipbench has one of its own.";
  ResultTable table{"Real and simulated", {"row", "study", "figure", "real", "ours", "ours/real", "note"}};
  result.figures = Json::array();
  for (const Source& source : asked) {
    if (options.say) options.say(source.name);
    ResultChart chart{.title = source.name + ", ours over the real figure",
                      .across = "row",
                      .up = "ratio",
                      .places = {},
                      .curves = {{"ours/real", {}}},
                      .bar = 1.0,
                      .bar_name = "as real"};
    ReproduceOptions its = options;
    its.only = source.only;
    if (its.trials == 0) its.trials = source.trials;
    its.full = false;
    if (source.recordings == nullptr) its.real.clear();
    for (const RealFigure& one : source.run(its).real) {
      const double ratio = one.ours / one.real;
      const std::string row = fmt::format("{}", table.rows.size() + 1);
      table.rows.push_back({row, source.name, one.what, figure(one.real), figure(one.ours), figure(ratio), one.note});
      result.figures.push_back({{"study", source.name},
                                {"what", one.what},
                                {"real", or_null(one.real)},
                                {"ours", or_null(one.ours)},
                                {"ratio", or_null(ratio)},
                                {"note", one.note}});
      if (std::isnan(ratio)) continue;
      chart.places.push_back(row);
      chart.curves.front().points.push_back({ratio, ratio, ratio});
    }
    if (chart.places.size() > 1) result.charts.push_back(std::move(chart));
  }
  result.tables.push_back(std::move(table));
  result.setup = {
      options.seed ? fmt::format("Seed {}.", *options.seed) : "Seed 1, of hexapod.yaml its own.",
      fmt::format(
          "Table II of hd-papillarray with {} grasps a box, unless --trials says how many; `slipbench reproduce STUDY` says how each is made.",
          grasps_a_box)};
  if (!left_out.empty())
    result.remarks.push_back(fmt::format(
        "Left out: {}. --full runs those that teach for a quarter of an hour, --real FILE the one that takes its recordings.",
        fmt::join(left_out, ", ")));
  return result;
}

}  // namespace slipbench::reproduce
