// What the studies (tools/studies) take of the program: its pages, and detectors that read a recorded trial again.
#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <nanobind/ndarray.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "sim/core/detector.h"
#include "sim/core/error.h"
#include "tools/base/page/page.h"
#include "tools/base/record/json.h"
#include "tools/base/record/trial_record.h"
#include "tools/program/catalogue/program_catalogues.h"
#include "tools/program/eval/replay.h"
#include "tools/program/samples/samples.h"
#include "tools/python/module.h"

namespace nb = nanobind;

namespace slipbench::python {
namespace {

constexpr page::PageKind result_kind{
    "a result", "slipbench reproduce", "result page", "result of a reproduction", {"reproduction"}};

// An array of these extents that owns `values`.
template <class T>
nb::ndarray<nb::numpy, T> array_of(std::vector<T> values, std::vector<std::size_t> extents) {
  auto* const held = new std::vector<T>(std::move(values));
  const nb::capsule owner(held, [](void* all) noexcept { delete static_cast<std::vector<T>*>(all); });
  return nb::ndarray<nb::numpy, T>(held->data(), extents.size(), extents.data(), owner);
}

// What a detector says of each sample of a recorded sensor: states, the values that it hands on, and their names.
using Estimates =
    nb::typed<nb::tuple, nb::ndarray<nb::numpy, std::uint8_t>, nb::ndarray<nb::numpy, double>, std::vector<std::string>>;
Estimates estimates(const TrialRecord& record, const std::string& name, const std::string& type, const Pairs& parameters) {
  std::vector<std::uint8_t> states;
  std::vector<double> values;
  std::vector<std::string> names;
  {
    const nb::gil_scoped_release release;
    const auto sensor = std::ranges::find(record.sensors, name, &SensorRecord::name);
    if (sensor == record.sensors.end()) throw InputError("trial " + std::to_string(record.trial) + ": no sensor '" + name + "'");
    RecordedSamples samples(*sensor);
    const std::unique_ptr<Detector> detector =
        make_detector(eval::chosen_detector(type, overrides_of(parameters)), {sensor->name,
                                                                              sensor->type,
                                                                              sensor->rate,
                                                                              samples.channels(),
                                                                              record.trial,
                                                                              sensor->time.back(),
                                                                              record.seed,
                                                                              {samples.source()}});
    if (detector->listener() != nullptr) throw InputError("detector '" + type + "' reads other sensors, too");
    while (!samples.ended()) {
      const SlipEstimate& now = detector->update(samples.take());
      states.push_back(static_cast<std::uint8_t>(now.state));
      values.insert(values.end(), now.features.begin(), now.features.end());
    }
    detector->finish();
    for (const Feature& feature : detector->features()) names.push_back(feature.name);
  }
  const std::size_t rows = states.size(), columns = rows == 0 ? 0 : values.size() / rows;
  return nb::make_tuple(array_of(std::move(states), {rows}), array_of(std::move(values), {rows, columns}), names);
}

}  // namespace

void bind_studies(nb::module_& module) {
  module.def(
      "compose_page",
      [](const std::string& generator, const std::string& title, const std::string& body) {
        return page::compose_page({generator, title}, body);
      },
      nb::arg("generator"), nb::arg("title"), nb::arg("body"));
  module.def(
      "write_result",
      [](const std::string& path, const std::string& page, const std::string& object) {
        return page::write_page_files(path, result_kind, page, Json::parse(object));
      },
      nb::arg("path"), nb::arg("page"), nb::arg("object"));
  module.def("estimates", &estimates, nb::arg("record"), nb::arg("sensor"), nb::arg("detector"), nb::arg("parameters"));
}

}  // namespace slipbench::python
