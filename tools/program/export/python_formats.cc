#include "tools/program/export/export.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/core/error.h"
#include "sim/core/process/own_library.h"
#include "tools/base/dataset/guarded.h"
#include "tools/base/record/json.h"

namespace slipbench {
namespace {

constexpr std::array python_formats{ExportFormat::lerobot, ExportFormat::parquet, ExportFormat::mcap};
constexpr const char* module_file = "slipbench/_export/__main__.py";

// Who runs the package, and how more is installed there.
struct Python {
  std::string program, folder, install;  // folder: above the package
};

Python python() {
  if (const char* const own = std::getenv("SLIPBENCH_PYTHON"); own != nullptr) {
    return {own, own_path("../.."), "pip install 'slipbench[export]'"};
  }
  return {own_path("../../venv/bin/python3"), own_path("../python"), "tools/setup/setup.sh build python test-python"};
}

bool has_package(const std::string& folder) {
  std::error_code error;
  const std::filesystem::path package = std::filesystem::path(folder) / "slipbench";
  if (!std::filesystem::exists(std::filesystem::path(folder) / module_file, error)) return false;
  std::filesystem::directory_iterator libraries(package / "bin", error);
  return !error && std::any_of(begin(libraries), end(libraries), [](const auto& entry) {
    return entry.path().filename().string().starts_with("_core.") && entry.path().extension() == ".so";
  });
}

// What Python is told (tools/python/slipbench/_export/request.py).
Json request_of(const std::string& dataset_path, const std::string& out_dir, const ExportOptions& options) {
  const DatasetReader reader(dataset_path);
  const std::vector<std::size_t> trials = trials_to_export(reader, options);
  const std::vector<std::string> sensors = chosen_sensors(reader, trials.front(), options.sensors);
  for (const std::size_t trial : trials) {
    if (const auto found = chosen_sensors(reader, trial, options.sensors); found != sensors) {
      throw InputError(fmt::format(
          "trial {} has the sensors {}, trial {} has {}; allowed: --sensors with those that all trials have, or --trial", trial,
          fmt::join(found, ", "), trials.front(), fmt::join(sensors, ", ")));
    }
  }
  return {{"format", export_format_name(options.format)},
          {"dataset", dataset_path},
          {"out", out_dir},
          {"trials", trials},
          {"sensors", sensors},
          {"rate", or_null(options.rate)},
          {"labels", options.slip_rule ? Json(slip_rule_name(*options.slip_rule)) : Json()}};
}

}  // namespace

bool is_python_format(ExportFormat format) { return std::ranges::find(python_formats, format) != python_formats.end(); }

void start_python_export(const std::string& dataset_path, const std::string& out_dir, const ExportOptions& options, bool json) {
  check_export_options(options);
  const Python python = slipbench::python();
  const std::string format = export_format_name(options.format);
  if (!has_package(python.folder)) {
    throw InputError(fmt::format(
        "--format {} is written by Python's package slipbench, which is not in {}; build it: {}, then cmake --build --preset "
        "release --target slipbench_python; or in an environment of your own: pip install '.[export]'",
        format, python.folder, python.install));
  }
  Json request = Json::parse(guarded(dataset_path, [&] { return request_of(dataset_path, out_dir, options).dump(); }));
  request["json"] = json;
  request["install"] = python.install;
  const char* const others = std::getenv("PYTHONPATH");
  ::setenv("PYTHONPATH", others == nullptr ? python.folder.c_str() : (python.folder + ":" + others).c_str(), 1);
  std::fflush(nullptr);
  // Signals are held back until Python, which takes a while to start, can note them (tools/python/slipbench/_export/interrupt.py).
  sigset_t signals, before;
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&signals, signal);
  pthread_sigmask(SIG_BLOCK, &signals, &before);
  // -P: no package of the folder where the user stands. -B: nothing is written beside the package.
  std::array<std::string, 6> words{python.program, "-P", "-B", "-m", "slipbench._export", request.dump()};
  std::array<char*, 7> pointers{};
  std::ranges::transform(words, pointers.begin(), [](std::string& word) { return word.data(); });
  ::execv(python.program.c_str(), pointers.data());
  const int reason = errno;
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  throw InputError(fmt::format("--format {}: cannot start {}: {}; install it: {}", format, python.program, std::strerror(reason),
                               python.install));
}

}  // namespace slipbench
