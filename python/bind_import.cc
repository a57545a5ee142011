// Bindings for `import --map`: sources, YAML with line numbers, and the writer of recordings.
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "detectors/channel.h"
#include "python/library_call.h"
#include "python/module.h"
#include "sim/core/counted.h"
#include "sim/scene/parser.h"
#include "sim/scene/yaml_tree.h"
#include "tools/cli/commands/dataset_commands.h"
#include "tools/cli/terminal.h"
#include "tools/files/reject.h"
#include "tools/formats/import/channel_unit.h"
#include "tools/formats/import/source_table.h"

namespace nb = nanobind;

namespace slipbench::python {
namespace {

template <class T>
using Values = nb::ndarray<const T, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
// Name, unit, shape of a row, names of its values, values [T, shape...].
using ChannelParts = std::tuple<std::string, std::string, std::vector<std::size_t>, std::vector<std::string>, Values<float>>;
using Node = nb::typed<nb::tuple, nb::any, nb::ellipsis>;

template <class T>
std::vector<T> copied(const Values<T>& values) {
  return {values.data(), values.data() + values.size()};
}

// Key, line of the key, kind, line of the value, text, children.
Node tuple_of(const YamlNode& node) {
  nb::list children;
  for (const YamlNode& child : node.children) children.append(tuple_of(child));
  constexpr std::array kinds{"null", "scalar", "sequence", "map"};
  return nb::borrow<Node>(nb::make_tuple(node.key, node.key_origin.line, kinds[static_cast<std::size_t>(node.kind)],
                                         node.origin.line, node.text, children));
}

std::vector<std::pair<std::string, std::string>> sources_of(const std::vector<std::string>& sources,
                                                            const std::vector<std::string>& endings) {
  std::vector<std::pair<std::string, std::string>> files;
  for (const SourceFile& file : list_sources(sources, endings, true)) files.emplace_back(file.path, file.name);
  return files;
}

// Builds one recording from Python at a time, and writes it.
class MappedImport {
 public:
  MappedImport(ImportOptions options, const std::string& split_by) : options_(std::move(options)) {
    const Hdf5Use alone;
    writer_.emplace(options_, split_by);
  }
  MappedImport(const MappedImport&) = delete;
  MappedImport& operator=(const MappedImport&) = delete;
  ~MappedImport() {
    const Hdf5Use alone;
    writer_.reset();
  }

  // `rate` [Hz]: of samples without stamps; empty: from the stamps, with `resolution` [s], read in
  // `unit` [s]; 0: dates.
  void add_sensor(const std::string& name, const std::string& type, const std::string& frame, const Values<double>& time,
                  double resolution, double unit, std::optional<double> rate, const std::string& rule,
                  const std::optional<Values<std::uint8_t>>& states, const std::vector<ChannelParts>& channels) {
    SensorRecord sensor;
    sensor.name = name;
    sensor.type = type;
    sensor.frame = frame;
    sensor.labels.truth = false;
    sensor.labels.rule = rule;
    sensor.time = copied(time);
    if (states) sensor.labels.state_paper = copied(*states);
    for (const auto& [channel, unit, shape, names, values] : channels) {
      const bool scalar = shape == std::vector<std::size_t>{1} && is_scalar_channel(type, channel);
      sensor.channels.push_back({channel, unit, scalar ? std::vector<std::size_t>{} : shape, copied(values)});
      sensor.channel_names.insert(sensor.channel_names.end(), names.begin(), names.end());
      if (sensor.channels.back().values.size() != sensor.time.size() * sensor.channels.back().row_size())
        reject("{}/{}: has {} for {} of {}", name, channel, counted(values.size(), "value"),
               counted(sensor.time.size(), "sample"), sensor.channels.back().row_size());
    }
    sensor.rate = rate ? *rate : rate_of(sensor.time, resolution);
    if (!rate) sensor.timing = timing_of(sensor.time, resolution);
    sensors_.push_back(std::move(sensor));
    time_units_.push_back(unit);
  }
  // Adds the recording of the sensors added since the last one. `params`: JSON.
  void add(const std::string& path, const std::string& params, const std::string& object) {
    TrialRecord record = make_recording(Json::parse(params), object);
    record.sensors = std::exchange(sensors_, {});
    record.body_time = record.sensors.front().time;
    const Hdf5Use alone;
    writer_->add(std::move(record), path, 0, std::exchange(time_units_, {}));
  }
  void warn(const std::string& path, const std::string& text) { writer_->warn(path, text); }
  void finish(std::size_t sources) {
    const Hdf5Use alone;
    summary_ = writer_->finish(sources);
  }
  // The summary of the finished import as JSON.
  [[nodiscard]] std::string summary() const { return printed_json(import_json(summary_)); }
  // Prints the summary of the finished import as the program does. Raises OSError if stdout cannot
  // be written.
  void print(bool json) const {
    print_whole([&] { print_import(summary_, options_, json); });
  }

 private:
  ImportOptions options_;
  std::optional<RecordingWriter> writer_;  // empty only while the import is created or destroyed
  ImportSummary summary_;
  std::vector<SensorRecord> sensors_;
  std::vector<double> time_units_;  // of each sensor
};

}  // namespace

void bind_import(nb::module_& module) {
  module.def("list_sources", &sources_of, nb::arg("sources"), nb::arg("endings"));
  module.def("read_yaml", [](const std::string& path) { return tuple_of(SceneFile::load(path).root()); });
  module.def("is_plain_name", &is_plain_name);
  module.def("si_unit_of", [](const std::string& unit) {
    const SiUnit si = si_unit_of(unit);
    return std::pair(si.symbol, si.factor);
  });
  module.def("other_unit_remedy",
             [](const std::string& found, const std::string& needed) { return other_unit_remedy(found, needed); });
  nb::class_<MappedImport>(module, "MappedImport")
      .def(nb::init<ImportOptions, const std::string&>(), nb::arg("options"), nb::arg("split_by"))
      .def("add_sensor", &MappedImport::add_sensor, nb::arg("name"), nb::arg("type"), nb::arg("frame"), nb::arg("time"),
           nb::arg("resolution"), nb::arg("unit"), nb::arg("rate").none(), nb::arg("rule"), nb::arg("states").none(),
           nb::arg("channels"))
      .def("add", &MappedImport::add, nb::arg("path"), nb::arg("params"), nb::arg("object"))
      .def("warn", &MappedImport::warn, nb::arg("path"), nb::arg("text"))
      .def("finish", &MappedImport::finish, nb::arg("sources"))
      .def("summary", &MappedImport::summary)
      .def("print", &MappedImport::print, nb::arg("json"));
}

}  // namespace slipbench::python
