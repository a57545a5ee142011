#include "tools/trial/cluster/cluster.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "sim/core/counted.h"
#include "sim/scene/parser.h"
#include "tools/files/output_file.h"
#include "tools/files/reject.h"
#include "tools/trial/sweep/sweep_shard.h"

namespace slipbench {
namespace {

// Returns `form` with each @NAME@ replaced. The values, which users choose, are not searched for
// names.
std::string filled(std::string_view form, const std::vector<std::pair<std::string_view, std::string>>& values) {
  std::string text;
  while (!form.empty()) {
    const auto value = std::ranges::find_if(values, [&](const auto& named) {
      const std::string_view name = named.first;
      return form.size() > name.size() + 1 && form.front() == '@' && form.substr(1, name.size()) == name &&
             form[name.size() + 1] == '@';
    });
    text += value == values.end() ? std::string(1, form.front()) : value->second;
    form.remove_prefix(value == values.end() ? 1 : value->first.size() + 2);
  }
  return text;
}

constexpr const char* shard_script = R"(#!/usr/bin/env bash
# Runs shard K of the sweep: shard.sh K ATTEMPT
# Writes shards/K, a folder with shard.h5. A shard that exists and whose digests are correct is left unchanged. Each attempt writes into its own
# folder, which is renamed to shards/K in one step, so killed and simultaneous attempts do no harm. A repeated attempt with the same name continues
# its work.
set -euo pipefail
folder=@FOLDER@
from=@FROM@   # folder of the sweep's relative paths
sweep=(@SWEEP@)
n=@N@
slipbench=(@PROGRAM@)
if [[ -n ${SLIPBENCH:-} ]]; then read -ra slipbench <<< "$SLIPBENCH"; fi   # SLIPBENCH="apptainer run slipbench.sif": from a container

k=$1
whole=$folder/shards/$k
own=$folder/attempts/$k.$2

holds() { [[ -f $1/shard.h5 ]] && "${slipbench[@]}" verify "$1/shard.h5" --json > /dev/null; }

cd "$from"
if holds "$whole"; then
  echo "shard $k/$n exists, and its digests are correct"
  exit 0
fi
mkdir -p "$folder/shards" "$own"
# If an earlier attempt with this name is still running, this one starts from the beginning.
exec {lock}< "$own"
if ! flock --nonblock "$lock"; then
  own=$own.$$
  mkdir "$own"
fi

status=0
"${slipbench[@]}" "${sweep[@]}" --shard "$k/$n" --jobs @JOBS@ --resume --quiet -o "$own/shard.h5" || status=$?
((status <= 1)) || exit "$status"   # 1: some trials failed; the shard lists them
holds "$own" || { echo "shard $k/$n: $own fails its verification" >&2; exit 1; }

if ! holds "$whole" && [[ -e $whole/shard.h5 ]]; then
  mv -T "$whole" "$folder/attempts/$k.damaged.$$"
fi
# Renames in one step, and never replaces a folder that is not empty.
if ! mv -T "$own" "$whole" 2> /dev/null; then
  holds "$whole" || { echo "shard $k/$n: $whole exists and fails its verification" >&2; exit 1; }
  rm -r "$own"
fi
echo "shard $k/$n is finished"
)";

constexpr const char* array_script = R"(#!/usr/bin/env bash
# All shards as one Slurm array: sbatch array.sbatch
# A task that is killed with its machine is queued again and continues its work.
#SBATCH --job-name=slipbench
#SBATCH --array=1-@TASKS@%@THROTTLE@
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=@JOBS@
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output="@RAW_FOLDER@/logs/%a.log"
set -euo pipefail
for ((k = SLURM_ARRAY_TASK_ID; k <= @N@; k += @TASKS@)); do
  bash @FOLDER@/shard.sh "$k" "slurm-$SLURM_JOB_ID"
done
)";

constexpr const char* merge_script = R"(#!/usr/bin/env bash
# Verifies all shards and merges them
set -euo pipefail
folder=@FOLDER@
slipbench=(@PROGRAM@)
if [[ -n ${SLIPBENCH:-} ]]; then read -ra slipbench <<< "$SLIPBENCH"; fi
shards=()
for ((k = 1; k <= @N@; ++k)); do shards+=("$folder/shards/$k/shard.h5"); done
"${slipbench[@]}" verify "${shards[@]}"
"${slipbench[@]}" merge "${shards[@]}" -o "$folder"/@NAME@
)";

constexpr const char* snake_file = R"(# The same with Snakemake, for all executors that it supports: snakemake --cores 8
# On a cluster: snakemake --jobs 100 --cluster 'bsub -n {threads}', --profile, --kubernetes, ...
folder = @PYTHON_FOLDER@
workdir: folder

rule merge:
    input: expand("shards/{k}", k=range(1, @N@ + 1))
    output: @PYTHON_NAME@
    shell: "bash merge.sh"

rule shard:
    output: directory("shards/{k}")
    threads: @JOBS@
    retries: 3
    shell: "bash shard.sh {wildcards.k} snakemake"
)";

constexpr const char* readme = R"(# A sweep in @N@ shards
@WHAT@

| with | from this folder |
|---|---|
| Slurm | `sbatch array.sbatch`, then `sbatch --dependency=afterok:JOB merge.sh`, or `bash merge.sh` |
| Snakemake | `snakemake --cores 8`; other executors: see its manual |
| neither | `bash shard.sh 1 by-hand`, and so on to @N@, on any machines; then `bash merge.sh` |

`@RAW_NAME@` then has the content and the digests of the undivided sweep.

| name | content |
|---|---|
| `shard.sh` | runs one shard: skips a finished shard, continues a killed one, publishes in one step |
| `array.sbatch` | all shards as a Slurm array: @TASKS@ tasks, at most @THROTTLE@ at a time |
| `Snakefile` | the same for Snakemake |
| `merge.sh` | verifies all shards and merges them |
| `shards/` | finished shards |
| `attempts/` | unfinished shards; can be removed after the merge |
| `logs/` | one log per Slurm task |

All machines must see this folder and the scene under the paths in `shard.sh`, and the same version of the program. `SLIPBENCH` in the
environment sets another way to start it, such as a container. If a task reaches its time limit, submit the array again; it continues.
)";

std::string python_text(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' || c == '\\' ? std::string("\\") + c : std::string(1, c);
  return quoted + "\"";
}

// Written in this order: a folder without the last file was left by a killed run.
const std::array<std::pair<const char*, std::string_view>, 5> files{{{"README.md", readme},
                                                                     {"shard.sh", shard_script},
                                                                     {"array.sbatch", array_script},
                                                                     {"merge.sh", merge_script},
                                                                     {"Snakefile", snake_file}}};

bool is_left_by_a_killed_run(const std::filesystem::path& folder) {
  std::error_code error;
  return std::ranges::all_of(std::filesystem::directory_iterator(folder, error), [](const auto& entry) {
    const std::string name = entry.path().filename().string();
    const auto written = [&](const auto& file) { return name == file.first || name == std::string(file.first) + ".partial"; };
    return name == "logs" || (name != files.back().first && std::ranges::any_of(files, written));
  });
}

void check_folder(const std::filesystem::path& folder) {
  std::error_code error;
  const auto refuse = [&](const char* what) {
    reject("cannot write {}: it {}; give a new or an empty folder", folder.string(), what);
  };
  if (!std::filesystem::exists(folder, error)) return;
  if (!std::filesystem::is_directory(folder, error)) refuse("is not a folder");
  if (!is_left_by_a_killed_run(folder)) refuse("is not empty");
}

// Splits a command at spaces, as the scripts split SLIPBENCH, and quotes each word for the shell.
std::string shell_words(const std::string& command) {
  std::istringstream words(command);
  std::string result;
  for (std::string word; words >> word;) result += (result.empty() ? "" : " ") + shell_word(word);
  return result;
}

}  // namespace

std::vector<std::string> write_cluster_folder(const ClusterOptions& options, const Catalogues& catalogues) {
  SceneFile file = SceneFile::load(options.sweep.scene_path);
  for (const Override& change : options.sweep.overrides) file.apply(change);
  const std::uint64_t seed = options.sweep.seed ? *options.sweep.seed : parse_scene(file, catalogues).seed;
  const PlannedTrials planned = plan_trials(file, catalogues, options.sweep, seed);
  try {
    static_cast<void>(check_trial(planned.plan.trial(0).scene, 0));
  } catch (const SceneValueError& error) {
    throw InputError(planned.plan.where(0, error.path()) + ": " + error.what());
  } catch (const FailedRun& error) {
    throw InputError(planned.plan.where(0, "time_step") + ": " + error.what());
  }
  static_cast<void>(trials_of_shard(planned.plan, planned.requested, seed, 1, options.shards));
  std::error_code error;
  const std::filesystem::path here = std::filesystem::current_path(error);
  if (error)
    reject("cluster: the current folder, from which the scripts start, cannot be found: {}; change to another folder",
           error.message());
  std::filesystem::path folder = (here / options.folder).lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();
  check_folder(folder);

  const std::string command = canonical_command(options.sweep);
  // Command that started the program if it was not started directly: from Python, from a container.
  const char* const started = std::getenv("SLIPBENCH");
  const std::string program = started != nullptr && *started != '\0'
                                  ? shell_words(started)
                                  : shell_word(std::filesystem::read_symlink("/proc/self/exe").string());
  // Slurm interprets % and other characters in log paths, Snakemake interprets braces.
  const std::string name = std::filesystem::path(options.sweep.scene_path).stem().string() + ".h5";
  if ((folder.string() + name).find_first_of("%{}\"\\\n\r\t") != std::string::npos) {
    reject("cannot write {} for {}; allowed: names without % {{ }} \" \\ and control characters", printable(folder.string()),
           printable(name));
  }
  // Slurm's MaxArraySize is 1001 unless a cluster changes it, and an index must stay below it. With
  // more shards each task runs several.
  const std::size_t tasks = std::min<std::size_t>(options.shards, 1000);
  const std::vector<std::pair<std::string_view, std::string>> values{
      {"FOLDER", shell_word(folder.string())},
      {"RAW_FOLDER", folder.string()},
      {"PYTHON_FOLDER", python_text(folder.string())},
      {"FROM", shell_word(here.string())},
      {"SWEEP", command.substr(std::string_view("slipbench ").size())},
      {"N", std::to_string(options.shards)},
      {"TASKS", std::to_string(tasks)},
      {"THROTTLE", std::to_string(options.throttle == 0 ? tasks : std::min(options.throttle, tasks))},
      {"JOBS", std::to_string(std::max<std::size_t>(1, options.sweep.jobs))},
      {"NAME", shell_word(name)},
      {"PYTHON_NAME", python_text(name)},
      {"RAW_NAME", name},
      {"PROGRAM", program},
      {"WHAT", fmt::format("`{}`: {}. Written by `slipbench cluster`.", command, counted(planned.requested, "trial"))}};
  std::filesystem::create_directories(folder / "logs", error);
  if (error) reject("cannot create the folder {}: {}", (folder / "logs").string(), error.message());
  std::vector<std::string> written;
  for (const auto& [name, text] : files) {
    written.push_back((folder / name).string());
    write_text_file(written.back(), filled(text, values));
  }
  return written;
}

}  // namespace slipbench
