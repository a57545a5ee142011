#include "detectors/network/engine.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "sim/core/math.h"
#include "sim/core/process/check_readable.h"
#include "sim/core/process/own_library.h"

namespace slipbench::network {
namespace {

constexpr const char* remedy =
    "install the requirement openvino of the Python package slipbench, which pip check examines, or build slipbench with OpenVINO and "
    "libonnx-dev, which tools/setup/setup.sh build python installs";

}  // namespace

std::unique_ptr<Engine> load_engine(const std::string& path) {
  if (engine_available()) check_readable_once(FileKind::network, path);
  return load_engine_unchecked(path);
}

std::unique_ptr<Engine> load_engine_unchecked(const std::string& path) {
  static LoadEngine* const load = reinterpret_cast<LoadEngine*>(own_symbol(SLIPBENCH_NETWORK, load_symbol, remedy));
  return std::unique_ptr<Engine>(load(path));
}

bool engine_available() { return std::filesystem::exists(own_path(SLIPBENCH_NETWORK)); }

double slip_probability(const Description& description, std::span<const float> output) {
  const bool logits = description.output == Output::logits;
  const double top = double{*std::ranges::max_element(output)};
  double slip = 0.0;
  double all = 0.0;
  for (std::size_t i = 0; i < output.size(); ++i) {
    const double weight = logits ? math::exp(double{output[i]} - top) : double{output[i]};
    all += weight;
    if (slips(description.classes[i].state)) slip += weight;
  }
  return logits ? slip / all : std::clamp(slip, 0.0, 1.0);
}

PadState state_of(const Description& description, std::span<const float> output, bool slip) {
  std::size_t best = output.size();
  for (std::size_t i = 0; i < output.size(); ++i) {
    if (slips(description.classes[i].state) == slip && (best == output.size() || output[i] > output[best])) best = i;
  }
  return description.classes[best].state;
}

}  // namespace slipbench::network
