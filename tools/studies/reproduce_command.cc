#include "tools/studies/reproduce_command.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/core/process/own_library.h"
#include "tools/base/project/project_file.h"
#include "tools/base/record/encoder.h"
#include "tools/base/record/json.h"
#include "tools/base/workers/child_process.h"
#include "tools/program/cli/arguments.h"
#include "tools/program/cli/terminal.h"
#include "tools/studies/grid.h"

namespace slipbench::reproduce {
namespace {

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
    throw InputError(fmt::format("reproduce: {} does not take {}; allowed: {}", reproduction.name, name,
                                 takes.empty() ? "--output, --json, --quiet" : fmt::format("{}", fmt::join(takes, ", "))));
  }
}

constexpr const char* any_scene = "scenes/papillarray/stage.yaml";

bool takes_resume(const Reproduction& reproduction) {
  return std::ranges::find(reproduction.options, "--resume") != reproduction.options.end();
}

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

std::string kept_beside(const std::string& html_path) {
  return html_path.substr(0, html_path.size() - std::string_view(".html").size()) + ".networks";
}

}  // namespace

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
  options.say = [this](const std::string& what) { tell(what); };
  std::optional<KeptNetworks> kept;
  if (!output.empty() && takes_resume(reproduction)) {
    kept.emplace(kept_beside(output), identity_of(options, reproduction), resume);
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
