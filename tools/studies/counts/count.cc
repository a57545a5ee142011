#include "tools/studies/counts/count.h"

#include <fcntl.h>
#include <fftw3.h>
#include <spawn.h>
#include <sys/utsname.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <gnu/libc-version.h>

#include "sim/core/error.h"
#include "sim/core/process/own_library.h"
#include "sim/scene/parser.h"
#include "tools/base/files/output_file.h"
#include "tools/base/project/project_file.h"
#include "tools/base/statistics/descriptive.h"
#include "tools/base/workers/ordered_workers.h"
#include "tools/program/doctor/build_info.h"
#include "tools/program/doctor/doctor.h"
#include "tools/program/doctor/machine.h"
#include "tools/program/run/run_trial.h"
#include "tools/studies/counts/callgrind.h"

namespace slipbench::counts {
namespace {

constexpr std::array<std::string_view, 6> scenes{
    "scenes/papillarray/stage.yaml",  // rigid pillars, prescribed motion
    "scenes/piezo_skin/slide.yaml",   // masses that ring, 10 kHz, spectra
    "scenes/biotac_sp/slip.yaml",     // a skin of many elements
    "scenes/nib_pad/linear.yaml",     // MuJoCo's bodies on a lever bench
    "scenes/myrmex/slip.yaml",        // three sensors on one free body, images
    "scenes/grasp/lift.yaml",         // closed loop: detector and controller
};

// What the counted program sees of this one's environment. A user's settings of valgrind and of the C library would change
// counts.
std::vector<std::string> child_environment() {
  std::vector<std::string> environment{"LD_BIND_NOW=1"};  // else the loader's look-ups count too
  for (const char* const name : {"PATH", "LD_LIBRARY_PATH", "TMPDIR"}) {
    if (const char* const value = std::getenv(name)) environment.push_back(fmt::format("{}={}", name, value));
  }
  return environment;
}

// The end of what a program said, in one line.
std::string last_words(const std::filesystem::path& file) {
  std::istringstream lines(file_text(file));
  std::string last;
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty()) last = line;
  }
  return last.empty() ? "and said nothing" : last;
}

// The program beside the studies.
std::string slipbench_program() { return own_path("slipbench"); }

SceneCount count_scene(const std::string& valgrind, std::string_view scene, const Catalogues& catalogues) {
  const std::string path = std::filesystem::absolute(project_file(std::string(scene))).string();
  const ScratchFolder folder;
  const int status = run_child(
      {valgrind, "-q", "--vgdb=no", "--tool=callgrind", "--callgrind-out-file=profile", "--toggle-collect=slipbench::run_trial(*",
       slipbench_program(), "run", path, "--trial", "0", "--jobs", "1", "--quiet"},
      folder.path(), child_environment());
  if (status != 0) {
    throw InputError(
        fmt::format("bench: {} under {} ended with {}: {}", scene, valgrind, status, last_words(folder.file("err"))));
  }
  const InstructionProfile profile = parse_callgrind(file_text(folder.file("profile")), "profile of " + std::string(scene));
  if (profile.instructions == 0 || profile.steps == 0) {
    throw InputError(fmt::format(
        "bench: {} under {}: {} instructions in {} steps were counted inside run_trial; allowed: a program with its symbols, not stripped",
        scene, valgrind, profile.instructions, profile.steps));
  }
  SceneCount count{.scene = std::string(scene),
                   .simulated = parse_scene(SceneFile::load(path), catalogues).duration,
                   .steps = profile.steps,
                   .instructions = profile.instructions,
                   .cpu_time = 0.0,
                   .functions = {}};
  for (const auto& [name, instructions] : profile.self) {
    if (instructions > 0) count.functions.push_back({name, instructions});
  }
  std::ranges::stable_sort(count.functions, std::ranges::greater{}, &FunctionCount::instructions);
  return count;
}

// CPU time of one trial, in s.
double trial_time(const Scene& scene) {
  const std::clock_t start = std::clock();
  static_cast<void>(run_trial(scene, 0, Recording::outcome));
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

// Puts the medians in. A first run of each warms up, and the scenes take turns, so that a machine that slows down slows all
// alike.
void time_scenes(std::vector<SceneCount>& counts, std::size_t timings, const std::atomic<bool>* interrupt,
                 const Catalogues& catalogues) {
  std::vector<Scene> parsed;
  for (const SceneCount& count : counts) {
    parsed.push_back(parse_scene(SceneFile::load(project_file(count.scene)), catalogues));
  }
  std::vector<std::vector<double>> times(counts.size());
  for (std::size_t run = 0; run <= timings; ++run) {
    for (std::size_t i = 0; i < counts.size(); ++i) {
      if (interrupt != nullptr && interrupt->load()) return;
      const double time = trial_time(parsed[i]);
      if (run > 0) times[i].push_back(time);
    }
  }
  for (std::size_t i = 0; i < counts.size(); ++i) counts[i].cpu_time = median(std::move(times[i]));
}

// Flags but for those of warnings, which decide nothing.
std::string deciding_flags(std::string_view flags) {
  std::istringstream words{std::string(flags)};
  std::string kept;
  for (std::string word; words >> word;) {
    if (!word.starts_with("-W")) kept += (kept.empty() ? "" : " ") + word;
  }
  return kept;
}

// The instruction set that valgrind offers the program: the machine's, up to AVX2. The dispatched kernels and the C library go
// by it.
std::string instruction_set() {
  utsname system{};
  uname(&system);
  return fmt::format("{}{}", system.machine, has_avx2() ? " with AVX2" : "");
}

std::string valgrind_version(const std::string& valgrind) {
  const ScratchFolder folder;
  const int status = run_child({valgrind, "--version"}, folder.path(), child_environment());
  std::string text = file_text(folder.file("out"));
  while (text.ends_with('\n')) text.pop_back();
  constexpr std::string_view prefix = "valgrind-";
  if (status != 0 || !text.starts_with(prefix)) {
    throw InputError(fmt::format("bench: {} --version ended with {} and said '{}'", valgrind, status, text));
  }
  return text.substr(prefix.size());
}

}  // namespace

std::span<const std::string_view> reference_scenes() { return scenes; }

std::string find_valgrind() {
  std::string path = find_program("valgrind");
  if (path.empty()) {
    throw InputError(
        "bench: valgrind is not on PATH; it counts instructions, and is there after: apt-get install --yes --no-install-recommends valgrind");
  }
  return std::filesystem::absolute(path).string();
}

Facts build_facts() {
  const BuildInfo& info = build_info();
  Facts facts{{"compiler", std::string(info.compiler)},
              {"flags", deciding_flags(info.flags)},
              {"sources", SLIPBENCH_UNITY_BUILD ? "several to a compilation" : "one to a compilation"},
              {"instruction set", instruction_set()},
              {"valgrind", valgrind_version(find_valgrind())},
              {"C library", gnu_get_libc_version()},
              {"FFTW", fftw_version}};
  for (const Check& check : run_checks()) {
    const bool decides = check.name == "Eigen" || check.name == "yaml-cpp" || check.name == "MuJoCo";
    if (check.group == "libraries" && decides) facts.emplace_back(check.name, check.found.empty() ? "none" : check.found);
  }
  return facts;
}

Facts context_facts() {
  Facts facts;
  for (const Check& check : run_checks()) {
    const bool told = check.group == "program" || check.group == "machine" || check.group == "libraries";
    if (told && !check.found.empty()) facts.emplace_back(check.name, check.found);
  }
  return facts;
}

std::optional<Results> count_reference_scenes(const CountOptions& options, const Catalogues& catalogues) {
  const std::string valgrind = find_valgrind();
  Results results{.build = build_facts(), .context = context_facts(), .scenes = {}};
  const auto interrupted = [&options] { return options.interrupt != nullptr && options.interrupt->load(); };
  try {
    OrderedWorkers<SceneCount> workers(
        scenes.size(), std::min(options.jobs, scenes.size()),
        [&] { return [&](std::size_t index) { return count_scene(valgrind, scenes[index], catalogues); }; }, options.interrupt);
    while (std::optional<SceneCount> count = workers.next()) {
      if (options.on_counted) options.on_counted(*count);
      results.scenes.push_back(std::move(*count));
    }
  } catch (const InputError&) {
    if (!interrupted()) throw;  // the signal may have ended valgrind, too
  }
  if (results.scenes.size() < scenes.size()) return std::nullopt;
  if (options.timings > 0) time_scenes(results.scenes, options.timings, options.interrupt, catalogues);
  if (interrupted()) return std::nullopt;
  return results;
}

namespace {

std::vector<char*> pointers_to(std::vector<std::string>& words) {
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  return pointers;
}

class FileActions {
 public:
  explicit FileActions(const std::filesystem::path& folder) {
    posix_spawn_file_actions_init(&actions_);
    posix_spawn_file_actions_addchdir_np(&actions_, folder.c_str());
    posix_spawn_file_actions_addopen(&actions_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions_, STDOUT_FILENO, "out", O_WRONLY | O_CREAT | O_TRUNC, 0600);
    posix_spawn_file_actions_addopen(&actions_, STDERR_FILENO, "err", O_WRONLY | O_CREAT | O_TRUNC, 0600);
  }
  ~FileActions() { posix_spawn_file_actions_destroy(&actions_); }
  FileActions(const FileActions&) = delete;
  FileActions& operator=(const FileActions&) = delete;

  [[nodiscard]] const posix_spawn_file_actions_t* get() const { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_{};
};

}  // namespace

std::string file_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file) throw InputError(fmt::format("{}: it cannot be read", path.string()));
  return text.str();
}

int run_child(std::vector<std::string> words, const std::filesystem::path& folder, std::vector<std::string> environment) {
  const std::string program = words.at(0);
  const FileActions actions(folder);
  pid_t child = 0;
  const int error =
      posix_spawn(&child, program.c_str(), actions.get(), nullptr, pointers_to(words).data(), pointers_to(environment).data());
  if (error != 0) throw InputError(fmt::format("cannot start {}: {}", program, std::strerror(error)));
  int status = 0;
  while (waitpid(child, &status, 0) != child) {
    if (errno != EINTR) throw std::system_error(errno, std::generic_category(), "waitpid");
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace slipbench::counts
