#include "tools/studies/study_catalogue.h"

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string_view>

#include "sim/core/process/own_library.h"
#include "tools/base/files/reject.h"
#include "tools/base/page/svg.h"
#include "tools/base/project/project_file.h"
#include "tools/base/python/python_package.h"
#include "tools/base/record/encoder.h"
#include "tools/base/record/json.h"
#include "tools/program/cli/arguments.h"
#include "tools/program/cli/terminal.h"
#include "tools/studies/grid.h"

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

std::string result_text(const Result& result, const Style& style, std::size_t width) {
  std::string text = style.bold(result.title) + '\n' + wrap_text(result.source, width, 2);
  for (const ResultTable& part : result.tables) {
    text += fmt::format("\n{}\n", style.heading(part.title));
    text += Table(page::TextTable{part.head, part.rows}).text(style);
    if (!part.note.empty()) text += wrap_text(part.note, width, 2);
  }
  for (const auto& [title, lines] :
       {std::pair{"What differs, and why", &result.remarks}, {"How it was measured", &result.setup}}) {
    if (lines->empty()) continue;
    text += fmt::format("\n{}\n", style.heading(title));
    for (const std::string& line : *lines) text += wrap_text(line, width, 2);
  }
  return text;
}

int list_reproductions(bool json) {
  const std::vector<Reproduction>& all = reproductions();
  if (json) {
    Json entries = Json::array();
    for (const Reproduction& one : all) entries.push_back({{"name", one.name}, {"summary", one.summary}});
    return print_json({{"reproductions", entries}});
  }
  for (const Reproduction& one : all) fmt::print("{:<34}  {}\n", one.name, one.summary);
  return exit_good;
}

// An option that this reproduction has no use for would be a misunderstanding.
void check_options(const ReproduceOptions& options, bool resume, const Reproduction& reproduction) {
  const std::array<std::pair<const char*, bool>, 10> given{{{"--data", !options.data.empty()},
                                                            {"--real", !options.real.empty()},
                                                            {"--full", options.full},
                                                            {"--seed", options.seed.has_value()},
                                                            {"--jobs", options.jobs != 0},
                                                            {"--resume", resume},
                                                            {"--synthesise", options.synthesise},
                                                            {"--trials", options.trials != 0},
                                                            {"--only", !options.only.empty()},
                                                            {"--memories", !options.memories.empty()}}};
  for (const auto& [name, there] : given) {
    const std::vector<std::string>& takes = reproduction.options;
    if (!there || std::find(takes.begin(), takes.end(), name) != takes.end()) continue;
    reject("reproduce: {} does not take {}; allowed: {}", reproduction.name, name,
           takes.empty() ? "--output, --json, --quiet" : fmt::format("{}", fmt::join(takes, ", ")));
  }
}

constexpr const char* any_scene = "scenes/papillarray/stage.yaml";

// Of every file below the folder: name and content; nothing where there is none.
Json contents_of(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  if (!std::filesystem::is_directory(folder)) return {};  // a program without libraries: what needs one says so
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::ranges::sort(files);
  Json contents;
  for (const std::filesystem::path& file : files) contents[file.lexically_relative(folder).string()] = file_sha256(file.string());
  return contents;
}

// All that decides what the study's networks say: the command, the data, the scenes that it simulates, and the program with the libraries that it loads.
std::string identity_of(const ReproduceOptions& options, const Reproduction& reproduction) {
  const auto content = [](const std::string& path) { return path.empty() ? "" : file_sha256(path); };
  return Json{{"name", reproduction.name},
              {"data", content(options.data)},
              {"real", content(options.real)},
              {"seed", options.seed.value_or(1)},
              {"full", options.full},
              {"trials", options.trials},
              {"only", options.only},
              {"program", file_sha256("/proc/self/exe")},
              {"libraries", contents_of(own_path("../lib/slipbench"))},
              {"scenes", contents_of(std::filesystem::path(project_file(any_scene)).parent_path().parent_path())}}
      .dump();
}

// What tools/studies/__main__.py takes.
[[noreturn]] void start_python_study(const ReproduceCommand& command) {
  const ReproduceOptions& options = command.options;
  const PythonModule module("slipbench_studies", "reproduce " + command.name, "studies");
  take_stdout_back();
  module.start(Json{{"name", command.name},
                    {"json", command.json},
                    {"quiet", command.quiet},
                    {"install", module.install()},
                    {"data", options.data},
                    {"real", options.real},
                    {"seed", or_null(options.seed)},
                    {"jobs", options.jobs},
                    {"full", options.full},
                    {"synthesise", options.synthesise},
                    {"trials", options.trials},
                    {"only", options.only},
                    {"memories", options.memories},
                    {"output", command.output},
                    {"resume", command.resume}}
                   .dump());
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
      {"hd-papillarray/latency", "time from a frame to its class, in software and in the register-level core", {}, nullptr},
      {"hd-papillarray/resources",
       "what the core takes of the published FPGA, for each degree of unrolling",
       {"--synthesise"},
       nullptr},
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
       nullptr},
      {"myrmex-tactile-cnn/table2",
       "nets 1 to 3 of the Myrmex array by the paper's split, by trial and by object, beside what the static image or a clock give away",
       {"--trials", "--only", "--full", "--seed", "--jobs", "--resume"},
       nullptr},
      {"myrmex-tactile-cnn/table3",
       "what stable, translation and rotation are taken for, by window and by trial",
       {"--trials", "--only", "--full", "--seed", "--jobs", "--resume"},
       nullptr},
      {"nib-reconfigurable/table1",
       "calibration of the nib pad: force and moment out of 36 capacitances, uniform and partial loads, and what decides it",
       {"--seed", "--jobs"},
       nullptr},
      {"nib-reconfigurable/table2",
       "Algorithm 1 while the grasp is slowly let go, four surfaces; what decides its figures, and where 0 to 8 Hz comes from",
       runs, nullptr},
      {"nib-reconfigurable/slip_kinds", "no slip, linear and rotational slip told apart by FL, FR and curl", runs, nullptr},
      {"nib-reconfigurable/table3",
       "a box turned up by rotational slip and released: weights, centres of mass, surfaces, thresholds", rows, nullptr},
      {"piezo-fft-gru/table1",
       "networks on the piezoelectric skin, beside what a clock, the contact or the motors alone give away", teaches_rows,
       nullptr},
      {"piezo-fft-gru/table2", "the FFT-GRU by the band of its spectrum", teaches, nullptr},
      {"piezo-fft-gru/table3", "networks that have not learnt one of the tips", teaches, nullptr},
      {"piezo-fft-gru/table4", "networks that learn with and without motor recordings, against the motors' vibration",
       teaches_rows, nullptr},
      {"piezo-fft-gru/delay",
       "delay of the FFT-GRU from the position label and from the true first slip, and how early the label itself is", teaches,
       nullptr},
      {"piezo-fft-gru/slip_against_hold",
       "slip and hold told apart by the power of one frame, against the motors' vibration, and which frames are mistaken", runs,
       nullptr},
      {"realism",
       "published figures of real devices beside ours, from the studies that hold them",
       {"--real", "--trials", "--only", "--full", "--seed", "--jobs"},
       nullptr},
  };
  return all;
}

const Reproduction& find_reproduction(const std::string& name) {
  const std::vector<Reproduction>& all = reproductions();
  const auto found = std::ranges::find(all, name, &Reproduction::name);
  if (found != all.end()) return *found;
  reject("unknown reproduction {}{}", quote(name), allowed_names(name, names_of(all)));
}

Json result_json(const std::string& name, const Result& result) {
  Json object{{"reproduction", name},  {"title", result.title},     {"source", result.source},
              {"setup", result.setup}, {"figures", result.figures}, {"remarks", result.remarks}};
  if (std::getenv("SLIPBENCH_REAL_FIGURES") != nullptr) {  // for realism.py
    object["real"] = Json::array();
    for (const RealFigure& one : result.real) {
      object["real"].push_back(
          {{"what", one.what}, {"real", or_null(one.real)}, {"ours", or_null(one.ours)}, {"note", one.note}});
    }
  }
  return object;
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

void ReproduceCommand::declare(Arguments& arguments) {
  arguments.about("reproduce", "Reproduce a table of a paper", R"(
Without a name: what can be reproduced. With -o the table goes to FILE.html and all figures to FILE.json beside it. Studies that teach networks
keep those that are done in FILE.networks until the page is written: where such a run was killed or interrupted, the same command with
--resume goes on with them.

Examples:
  slipbench reproduce
  slipbench reproduce hd-papillarray/table1 --data hexapod.h5 -o table1.html
  slipbench reproduce hd-papillarray/table2 --trials 2 --only as_recorded,light,rubber,gst_hd,hold_preset)");
  arguments.text("PAPER/TABLE", name, "What to reproduce (default: list what there is)");
  arguments.file("-o,--output FILE.html", output, "Write the page, and FILE.json beside it");
  arguments.number("--trials N", options.trials, "Trials of each row, or recordings (default: of a size that takes minutes)", 1);
  arguments.texts(
      "--only NAME,...", options.only,
      "table2: protocols, boxes, surfaces and loops to keep; grasp_loop: loops; scaling: sensors; realism: studies; table1, table3, "
      "table4: networks");
  arguments.text("--memories DIR", options.memories, "table2: folder of the published classifier");
  arguments.flag("--full", options.full, "The paper's size: hours");
  arguments.text("--data FILE.h5", options.data, "Use this dataset instead of a fresh one");
  arguments.text("--real FILE.h5", options.real,
                 "biotac-stability-slip: recordings that `slipbench import` has read; table3: of biotacsp-dos, else of bts3v2");
  arguments.number("--seed N", options.seed, "Seed of dataset, item memories and draws (default: 1)", 0);
  arguments.jobs(options.jobs);
  arguments.flag("--resume", resume, "Go on with the networks that a killed or interrupted run of the same command has left");
  arguments.flag("--synthesise", options.synthesise, "Run the synthesis instead of reading its stored figures");
  arguments.flag("--quiet", quiet, "No progress");
}

int ReproduceCommand::run() {
  if (name.empty() || name == "list") return list_reproductions(json);
  const Reproduction& reproduction = find_reproduction(name);
  check_options(options, resume, reproduction);
  if (!output.empty()) page::check_page_files(output, page_kind);
  if (resume && output.empty()) throw InputError("reproduce: --resume goes on with what lies beside a page; allowed: with -o");
  if (reproduction.run == nullptr) start_python_study(*this);
  options.say = [this](const std::string& what) { tell(what); };
  std::optional<KeptNetworks> kept;
  if (!output.empty() && std::ranges::find(reproduction.options, "--resume") != reproduction.options.end()) {
    const std::string beside = std::filesystem::path(output).replace_extension(".networks").string();
    kept.emplace(beside, identity_of(options, reproduction), resume);
    options.kept = &*kept;
    if (kept->size() > 0) tell(fmt::format("{} networks of an earlier run are there", kept->size()));
    if (resume && kept->size() == 0) tell(fmt::format("no network of an earlier run is in {}: beginning anew", kept->path()));
  }
  Result result;
  try {
    result = reproduction.run(options);
  } catch (const Interrupted&) {
    say(stderr, kept && kept->size() > 0
                    ? fmt::format("slipbench: interrupted; {} networks are kept in {}; the same command with --resume goes on\n",
                                  kept->size(), kept->path())
                    : "slipbench: interrupted; nothing is kept\n");
    return exit_interrupted;
  }
  const Json object = result_json(reproduction.name, result);
  std::vector<std::string> files;
  if (!output.empty()) files = page::write_page_files(output, page_kind, result_page(reproduction.name, result), object);
  if (kept) kept->remove();
  if (json) return print_json(object);
  fmt::print("{}", result_text(result, style_for(stdout), terminal_width(stdout)));
  print_written(files);
  return exit_good;
}

}  // namespace slipbench::reproduce
