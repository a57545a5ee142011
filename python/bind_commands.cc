// Bindings of the commands on dataset files: report, verify, merge, export, import, and of the
// signals, the progress and the output that they share with the program.
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "python/library_call.h"
#include "python/module.h"
#include "sim/core/parameters.h"
#include "tools/cli/commands/dataset_commands.h"
#include "tools/cli/terminal.h"
#include "tools/dataset/shard_set.h"
#include "tools/files/reject.h"
#include "tools/verify/verify.h"

namespace nb = nanobind;

namespace slipbench::python {
namespace {

// Catches SIGINT, SIGTERM and SIGHUP in a `with` block, as InterruptGuard.
class Interrupt {
 public:
  explicit Interrupt(std::string notice) : notice_(std::move(notice)) {}

  void enter() { guard_.emplace(notice_); }
  void exit() { guard_.reset(); }
  // Raises KeyboardInterrupt after a signal.
  static void check() { end_if(&InterruptGuard::flag()); }

 private:
  std::string notice_;
  std::optional<SharedInterrupt> guard_;
};

std::string verify(const std::vector<std::string>& paths) {
  const Verified verified = call_library([&] { return verify_datasets(paths, &InterruptGuard::flag()); });
  if (verified.readable) return printed_json(verified_json(verified));
  std::string errors;
  for (const Json& dataset : verified.datasets) {
    if (dataset.contains("error")) errors += (errors.empty() ? "" : "\n") + dataset["error"].get<std::string>();
  }
  throw InputError(errors);
}

ExportOptions export_options(const std::string& format, const std::string& labels, std::optional<double> label_speed,
                             std::vector<std::string> sensors, std::optional<std::size_t> trial, std::optional<double> rate,
                             std::string split, bool points, std::string licence, bool compress) {
  ExportOptions options;
  options.format = parse_export_format(format);
  if (!labels.empty()) set_label_rule(options, labels);
  options.label_speed = label_speed;
  options.sensors = std::move(sensors);
  options.trial = trial;
  options.rate = rate;
  options.split = std::move(split);
  options.points = points;
  options.licence = std::move(licence);
  options.compress = compress;
  check_export_options(options);
  return options;
}

// Writes the dataset to `folder` if C++ writes the format; returns the request to slipbench._export
// for the rest.
std::string export_files(const std::string& dataset, const std::string& folder, const ExportOptions& options) {
  return call_library([&] {
    std::vector<std::string> files;
    if (!is_python_format(options.format)) {
      check_card_target(folder);
      files = export_dataset(dataset, folder, options);
    }
    return export_request(dataset, folder, options, files).dump();
  });
}

ImportOptions import_options(std::vector<std::string> sources, const std::string& format, std::string map, std::string output,
                             std::uint64_t seed, std::optional<double> rate) {
  ImportOptions options{
      .sources = std::move(sources), .output = std::move(output), .seed = seed, .map = std::move(map), .rate = rate};
  if (!format.empty()) options.format = chosen_import_format(format);
  check_import_options(options);
  return options;
}

// A value above 0 in SI. Throws InputError that begins with `key`.
double positive_quantity(const std::string& key, const std::string& text, Quantity quantity) {
  ParameterSpec spec;
  spec.name = key;
  spec.quantity = quantity;
  spec.range = positive;
  try {
    return std::get<double>(parse_scalar(spec, text));
  } catch (const std::invalid_argument& error) {
    reject("{}: {}", key, error.what());
  }
}

}  // namespace

void bind_commands(nb::module_& module) {
  nb::class_<Interrupt>(module, "Interrupt")
      .def(nb::init<std::string>(), nb::arg("notice"))
      .def(
          "__enter__",
          [](nb::handle self) {
            nb::cast<Interrupt&>(self).enter();
            return nb::borrow(self);
          },
          nb::sig("def __enter__(self) -> Interrupt"))
      .def(
          "__exit__", [](Interrupt& self, const nb::args&) { self.exit(); }, nb::sig("def __exit__(self, *args: object) -> None"))
      .def_static("check", &Interrupt::check);
  nb::class_<ExportBar>(module, "ExportBar")
      .def(nb::init<bool>(), nb::arg("quiet"))
      .def("update", &ExportBar::update, nb::arg("done"), nb::arg("total"), nb::arg("bytes"))
      .def("clear", &ExportBar::clear);
  module.def("size_text", &size_text, nb::arg("bytes"));
  module.def(
      "print_export",
      [](const std::vector<std::string>& files, const std::string& folder, bool json, bool quiet, bool verbose) {
        print_whole([&] { print_export(files, folder, {.json = json, .quiet = quiet, .verbose = verbose}); });
      },
      nb::arg("files"), nb::arg("folder"), nb::arg("json"), nb::arg("quiet"), nb::arg("verbose"));
  module.def("frequency",
             [](const std::string& key, const std::string& text) { return positive_quantity(key, text, Quantity::frequency); });
  module.def("speed",
             [](const std::string& key, const std::string& text) { return positive_quantity(key, text, Quantity::speed); });
  module.def(
      "report",
      [](const std::string& dataset, const std::string& output, std::optional<std::size_t> trial) {
        const std::string page = output.empty() ? report_path(dataset) : output;
        return call_library([&] {
          write_report(dataset, page, {.trial = trial});
          return page;
        });
      },
      nb::arg("dataset"), nb::arg("output"), nb::arg("trial").none());
  module.def("verify", &verify, nb::arg("datasets"));
  module.def(
      "merge",
      [](const std::vector<std::string>& shards, const std::string& output) {
        return printed_json(merged_json(call_library([&] { return merge_shards(shards, output, &InterruptGuard::flag()); })));
      },
      nb::arg("shards"), nb::arg("output"));
  nb::class_<ExportOptions>(module, "ExportOptions");
  module.def("export_options", &export_options, nb::arg("format"), nb::arg("labels"), nb::arg("label_speed").none(),
             nb::arg("sensors"), nb::arg("trial").none(), nb::arg("rate").none(), nb::arg("split"), nb::arg("points"),
             nb::arg("licence"), nb::arg("compress"));
  module.def("export_files", &export_files, nb::arg("dataset"), nb::arg("folder"), nb::arg("options"));
  module.def("failed_trials", [](const std::string& dataset) { return call_library([&] { return failed_text(dataset); }); });
  nb::class_<ImportOptions>(module, "ImportOptions")
      .def_ro("sources", &ImportOptions::sources)
      .def_ro("map", &ImportOptions::map);
  module.def("import_options", &import_options, nb::arg("sources"), nb::arg("format"), nb::arg("map"), nb::arg("output"),
             nb::arg("seed"), nb::arg("rate").none());
  module.def(
      "import_recordings",
      [](const ImportOptions& options) {
        return printed_json(import_json(call_library([&] { return import_recordings(options); })));
      },
      nb::arg("options"));
}

}  // namespace slipbench::python
