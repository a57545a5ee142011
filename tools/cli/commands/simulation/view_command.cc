#include "tools/cli/commands/simulation/simulation_commands.h"

#include <cstdio>
#include <filesystem>

#include <fmt/format.h>

#include "tools/cli/arguments.h"
#include "tools/cli/terminal.h"
#include "tools/dataset/checked_dataset.h"
#include "tools/dataset/reader.h"
#include "tools/dataset/record/json.h"
#include "tools/files/output_file.h"
#include "tools/files/project/project_file.h"
#include "tools/files/reject.h"
#include "tools/report/report.h"
#include "tools/view/rerun.h"

namespace slipbench {
namespace {

constexpr const char* verb = "run";  // command that makes the recording

std::string with_ending(const std::string& path, const char* ending) {
  return std::filesystem::path(path).replace_extension(ending).string();
}

// Replaces a recording only if a single run of the same scene can make it again, because a
// recording may have taken long.
void check_replaceable(const std::string& dataset, const std::string& scene) {
  std::error_code error;
  if (!std::filesystem::exists(dataset, error)) return;
  // Never replaces a dataset of several trials: it took long, and this command makes a single
  // trial.
  const DatasetReader reader = dataset_header_at(dataset);
  const std::string command = reader.header().command;
  const std::string own = fmt::format("slipbench {} {}", verb, shell_word(scene));
  if (reader.trials().size() <= 1 && (command == own || command.starts_with(own + ' '))) return;
  reject("view: {} exists, but contains {}; choose another name with -o, or run slipbench view {}", dataset, command, dataset);
}

}  // namespace

void ViewCommand::declare(Arguments& arguments) {
  arguments.about("view", "Open the report of a dataset or scene in the browser", R"(
For a dataset, writes its report as slipbench report does, and opens it. A scene is run first, as by
slipbench run, and the recording and the page are kept in the current folder. On a machine without a
display, the path of the page is printed. Recordings without truth (slipbench import) are shown with
their signals and recorded labels.

--rerun shows the trial in the viewer Rerun, which needs rerun-sdk in your Python (python3). If a run
is still writing the dataset, the newest trial is shown until the run ends. With -o FILE.rrd no
viewer opens.

Examples:
  slipbench view hexapod.h5
  slipbench view hexapod.h5 --trial 17
  slipbench view scenes/papillarray/stage.yaml --set motion.speed="8 mm/s"
  slipbench view hexapod.h5 --trial 17 --rerun)");
  arguments.input("FILE", subject, "Dataset (HDF5), scene (YAML) or name of a shipped scene").required();
  arguments.overrides(sweep.overrides, sweep.seed);
  arguments.flag("-q,--quiet", quiet, "Print no progress");
  arguments.number("--trials N", sweep.limit, "Scene: simulate N trials", 1);
  arguments.jobs(sweep.jobs);
  arguments.file("-o,--output FILE.html", output,
                 "Page to write (default: named after FILE); with --rerun: recording FILE.rrd to write");
  arguments.flag("--rerun", rerun, "Show the trial in the viewer Rerun, even while a run is still writing FILE.h5");
  arguments.number("--trial K", trial, "Trial to show in detail (default: the first); scene: simulate only this trial", 0);
  arguments.then([this] {
    subject = scene_path(subject);
    const char* const ending = rerun ? ".rrd" : ".html";
    if (!output.empty() && std::filesystem::path(output).extension() != ending) {
      reject("view: -o is {}; the name must end in {}", quote(output), ending);
    }
    if (of_scene()) return;
    const bool simulates = !sweep.overrides.empty() || sweep.seed || sweep.limit > 0 || sweep.jobs > 0;
    if (simulates) reject("view: {} is a dataset; --set, --seed, --trials and --jobs apply only to a scene", subject);
  });
}

bool ViewCommand::of_scene() const {
  const std::string ending = std::filesystem::path(subject).extension().string();
  return ending == ".yaml" || ending == ".yml";
}

int ViewCommand::simulate(const std::string& dataset) const {
  if (!rerun) check_report_target(with_ending(dataset, ".html"), dataset);
  check_replaceable(dataset, subject);
  RunCommand command;
  command.sweep = sweep;
  command.sweep.verb = verb;
  command.sweep.scene_path = subject;
  command.sweep.output = dataset;
  command.sweep.only = trial;
  if (sweep.limit == 0 && !trial) command.sweep.limit = 1;
  command.brief = true;
  command.quiet = silent();
  return command.run();
}

int ViewCommand::show(const std::string& dataset) const {
  const RerunResult result = show_in_rerun(dataset, {.trial = trial, .save = output});
  if (result.status != 0) return result.status;
  if (json) {
    print_json({{"dataset", dataset}, {"trials", result.trials}, {"saved", output}});
  } else if (!output.empty()) {
    print_written({output});
  }
  return exit_good;
}

int ViewCommand::run() {
  const bool scene = of_scene();
  const std::string page = !output.empty() ? output
                           : scene         ? with_ending(std::filesystem::path(subject).filename().string(), ".html")
                                           : with_ending(subject, ".html");
  const std::string dataset = scene ? with_ending(page, ".h5") : subject;
  if (rerun && !output.empty()) check_text_target(output, {dataset}, {"recording of Rerun", &begins_as_rrd});
  if (scene) {
    // Checked before the simulation, which may take minutes.
    if (const int status = rerun ? status_of_rerun() : exit_good; status != exit_good) return status;
    // Failed trials are not on the page, but the other trials are worth showing.
    if (const int status = simulate(dataset); status != exit_good && status != exit_check_failed) return status;
  }
  if (rerun) return show(dataset);
  write_report(dataset, page, {.trial = trial});
  const std::optional<std::string> browser = open_in_browser(page);
  if (json) {
    Json found{{"dataset", dataset}, {"report", page}};
    found["opened_by"] = browser ? Json(*browser) : Json();
    return print_json(found);
  }
  if (scene) print_written({dataset});
  print_written({page});
  if (browser) {
    print_text("opened by {}\n", *browser);
  } else {
    print_text("{} open it in a browser: {}\n", style_for(stdout).dim("next:"), std::filesystem::absolute(page).string());
  }
  return exit_good;
}

}  // namespace slipbench
