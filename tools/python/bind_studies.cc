// What the studies (tools/studies) take of the program: its pages, and detectors that read a recorded trial again.
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <nanobind/ndarray.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "tools/base/page/page.h"
#include "tools/base/record/json.h"
#include "tools/python/module.h"

namespace nb = nanobind;

namespace slipbench::python {
namespace {

constexpr page::PageKind result_kind{
    "a result", "slipbench reproduce", "result page", "result of a reproduction", {"reproduction"}};

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
}

}  // namespace slipbench::python
