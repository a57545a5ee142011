// Arbitrary text is a scene whose trials can be made, or gives an InputError; anything else is a
// crash.
#include <cstddef>
#include <cstdint>
#include <sstream>
#include <string>

#include "sim/core/error.h"
#include "sim/scene/parser.h"
#include "tests/sim/scene/test_catalogues.h"

namespace {

using namespace slipbench;

// Lines "#set path=value" stand for the command line's --set.
void apply_overrides(SceneFile& file) {
  const std::string marker = "#set ";
  std::istringstream lines(file.text());
  for (std::string line; std::getline(lines, line);) {
    const std::size_t equals = line.find('=');
    if (!line.starts_with(marker) || equals == std::string::npos) continue;
    file.apply({line.substr(marker.size(), equals - marker.size()), line.substr(equals + 1)});
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Catalogues catalogues = test_catalogues();
  try {
    SceneFile file = SceneFile::from_text(std::string(reinterpret_cast<const char*>(data), size), "fuzz.yaml");
    apply_overrides(file);
    static_cast<void>(parse_scene(file, catalogues));
    const TrialPlan plan(file, catalogues, 0, 1);
    static_cast<void>(plan.trial(plan.size() - 1));
  } catch (const InputError&) {
    // The expected answer to bad input.
  }
  return 0;
}
