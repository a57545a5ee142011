#include "tools/studies/study_catalogue.h"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "tools/base/page/svg.h"

namespace slipbench::reproduce {
namespace {

// Where a chart stands in its drawing [px].
constexpr double left = 56.0, right = 610.0, top = 14.0, foot = 286.0;
constexpr page::Frame frame{760.0, 330.0, left, right, top, foot};

std::string chart_html(const ResultChart& chart) {
  std::vector<double> values{chart.bar};
  for (const ResultCurve& curve : chart.curves) {
    for (const ResultPoint& point : curve.points) values.insert(values.end(), {point.low, point.high});
  }
  const auto [least, most] = std::ranges::minmax(values);
  const page::Axis up = page::linear_axis(values, std::max(0.05, page::round_step(most - least, 8.0)), foot, top);
  const page::Axis across{.high = static_cast<double>(chart.places.size() - 1), .begin = left, .end = right};
  page::Svg svg = page::chart(frame, "", across, chart.across, up, chart.up);
  const auto place = [&](std::size_t i) { return across.at(static_cast<double>(i)); };
  for (std::size_t i = 0; i < chart.places.size(); ++i) svg.text("small middle", place(i), foot + 14.0, chart.places[i]);
  svg.line("limit", left, up.at(chart.bar), right, up.at(chart.bar));
  double row = top + 12.0;  // of the legend
  const auto name = [&](std::string_view kind, std::string_view text) {
    svg.line(kind, right + 14.0, row, right + 36.0, row);
    svg.text("", right + 42.0, row + 4.0, text);
    row += 20.0;
  };
  for (std::size_t k = 0; k < chart.curves.size(); ++k) {
    const std::string series = fmt::format("s{}", k % page::series_count);
    std::vector<std::array<double, 2>> way;
    for (const ResultPoint& point : chart.curves[k].points) {
      const double x = place(way.size());
      svg.line(series, x, up.at(point.low), x, up.at(point.high));
      svg.dot(series, x, up.at(point.value), 3.5);
      way.push_back({x, up.at(point.value)});
    }
    svg.polyline(series, way);
    name(series, chart.curves[k].name);
  }
  name("limit", chart.bar_name);
  return svg.element(chart.title);
}

}  // namespace

const std::vector<Reproduction>& reproductions() {
  const std::vector<std::string> runs{"--trials", "--seed", "--jobs"}, rows{"--trials", "--only", "--seed", "--jobs"},
      grasps{"--real", "--data", "--trials", "--full", "--seed", "--jobs", "--resume"},
      teaches{"--data", "--trials", "--full", "--seed", "--jobs", "--resume"},
      teaches_rows{"--data", "--trials", "--only", "--full", "--seed", "--jobs", "--resume"};
  static const std::vector<Reproduction> all{
      {"biotac-stability-slip/table1", "grasps held or lost by the layout of the tactile image, real and synthetic", grasps,
       &biotac_table1},
      {"biotac-stability-slip/fig12", "the same by the graph of the GCN: drawn by hand, or nearest neighbours", grasps,
       &biotac_fig12},
      {"biotac-stability-slip/table2",
       "grasps held or lost on objects that were not learnt: GCN, CNN and plainer networks; learnt from real, synthetic, both",
       grasps, &biotac_table2},
      {"biotac-stability-slip/table3",
       "direction of slip on objects that were not learnt, with and without the place of the touch; learnt from real, synthetic, both",
       {"--real", "--data", "--trials", "--only", "--full", "--seed", "--jobs", "--resume"},
       &biotac_table3},
      {"hd-papillarray/table1",
       "ablation of the encoders, by sequence and by frame, and what decides it",
       {"--data", "--seed", "--jobs"},
       &hd_table1},
      {"hd-papillarray/table2",
       "grasp and lift in the closed loop: drops, slip and grip force of every detector and controller",
       {"--trials", "--only", "--memories", "--seed", "--jobs"},
       &hd_table2},
      {"hd-papillarray/table3",
       "the published recurrent network on the same protocol: balanced accuracy, delay, early and missed",
       {"--only", "--seed", "--jobs"},
       &hd_table3},
      {"hd-papillarray/latency", "time from a frame to its class, in software and in the register-level core", {}, &hd_latency},
      {"hd-papillarray/resources",
       "what the core takes of the published FPGA, for each degree of unrolling",
       {"--synthesise"},
       &hd_resources},
      {"learned/grasp_loop",
       "detectors that learnt from simulated grasps, in the published loop: drops, slip and force beside an oracle and two controls",
       {"--data", "--trials", "--only", "--seed", "--jobs"},
       &learned_grasp_loop},
      {"learned/scaling",
       "how many trials to learn from, and with --full what has to be varied in them: score, delay and alarms on slip-2",
       {"--trials", "--only", "--full", "--seed", "--jobs", "--resume"},
       &learned_scaling},
      {"myrmex-tactile-cnn/onset_label",
       "the onset that a third sensor on the object labels, beside the true one: 64 trials, several readings of the rule", runs,
       &myrmex_onset_label},
      {"myrmex-tactile-cnn/table2",
       "nets 1 to 3 of the Myrmex array by the paper's split, by trial and by object, beside what the static image or a clock give away",
       {"--trials", "--only", "--full", "--seed", "--jobs", "--resume"},
       &myrmex_table2},
      {"myrmex-tactile-cnn/table3",
       "what stable, translation and rotation are taken for, by window and by trial",
       {"--trials", "--only", "--full", "--seed", "--jobs", "--resume"},
       &myrmex_table3},
      {"nib-reconfigurable/table1",
       "calibration of the nib pad: force and moment out of 36 capacitances, uniform and partial loads, and what decides it",
       {"--seed", "--jobs"},
       &nib_table1},
      {"nib-reconfigurable/table2",
       "Algorithm 1 while the grasp is slowly let go, four surfaces; what decides its figures, and where 0 to 8 Hz comes from",
       runs, &nib_table2},
      {"nib-reconfigurable/slip_kinds", "no slip, linear and rotational slip told apart by FL, FR and curl", runs,
       &nib_slip_kinds},
      {"nib-reconfigurable/table3",
       "a box turned up by rotational slip and released: weights, centres of mass, surfaces, thresholds", rows, &nib_table3},
      {"piezo-fft-gru/table1",
       "networks on the piezoelectric skin, beside what a clock, the contact or the motors alone give away", teaches_rows,
       &piezo_table1},
      {"piezo-fft-gru/table2", "the FFT-GRU by the band of its spectrum", teaches, &piezo_table2},
      {"piezo-fft-gru/table3", "networks that have not learnt one of the tips", teaches, &piezo_table3},
      {"piezo-fft-gru/table4", "networks that learn with and without motor recordings, against the motors' vibration",
       teaches_rows, &piezo_table4},
      {"piezo-fft-gru/delay",
       "delay of the FFT-GRU from the position label and from the true first slip, and how early the label itself is", teaches,
       &piezo_delay},
      {"piezo-fft-gru/slip_against_hold",
       "slip and hold told apart by the power of one frame, against the motors' vibration, and which frames are mistaken", runs,
       &piezo_slip_against_hold},
      {"realism",
       "published figures of real devices beside ours, from the studies that hold them",
       {"--real", "--trials", "--only", "--full", "--seed", "--jobs"},
       &realism_table},
  };
  return all;
}

const Reproduction& find_reproduction(const std::string& name) {
  const std::vector<Reproduction>& all = reproductions();
  const auto found = std::find_if(all.begin(), all.end(), [&](const Reproduction& candidate) { return candidate.name == name; });
  if (found != all.end()) return *found;
  std::vector<std::string> names;
  for (const Reproduction& candidate : all) names.push_back(candidate.name);
  throw InputError(fmt::format("unknown reproduction {}{}", quote(name), allowed_names(name, names)));
}

Json result_json(const std::string& name, const Result& result) {
  return {{"reproduction", name},  {"title", result.title},     {"source", result.source},
          {"setup", result.setup}, {"figures", result.figures}, {"remarks", result.remarks}};
}

std::string result_page(const std::string& name, const Result& result) {
  std::string body =
      page::head_html(fmt::format("{} {}", page_kind.generator, page::escape_html(name)), result.title, {result.source});
  for (const ResultChart& chart : result.charts)
    body += page::section_html(chart.title, "", "<div class=\"scroll\">" + chart_html(chart) + "</div>\n");
  for (const ResultTable& table : result.tables)
    body += page::section_html(table.title, table.note, page::table_html({table.head, table.rows}));
  if (!result.remarks.empty()) body += page::section_html("What differs, and why", "", page::list_html(result.remarks));
  if (!result.setup.empty()) body += page::section_html("How it was measured", "", page::list_html(result.setup));
  return page::compose_page({page_kind.generator, name + " · slipbench reproduce"}, body);
}

}  // namespace slipbench::reproduce
