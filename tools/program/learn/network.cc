#include "tools/program/learn/network.h"

#include <filesystem>

#include "sim/core/own_library.h"
#include "tools/program/learn/torch_library.h"

namespace slipbench::learn {
namespace {

constexpr const char* remedy =
    "allowed: a slipbench built with the package libtorch-dev, which tools/setup/setup.sh test installs";

}  // namespace

std::size_t parameter_count(const NetworkShape& shape) {
  const std::size_t d = shape.dim;
  const auto layer = [&](std::size_t inputs) {
    switch (shape.architecture) {
      case Architecture::mlp: return d * (inputs + 1);
      case Architecture::tcn: return d * (shape.kernel * inputs + 1);
      case Architecture::gru: return 3 * d * (inputs + d + 2);
    }
    return std::size_t{0};
  };
  return layer(shape.inputs) + (shape.layers - 1) * layer(d) + 2 * d + 2;
}

std::unique_ptr<Network> make_network(const NetworkShape& shape, std::uint64_t seed) {
  static MakeNetwork* const make = reinterpret_cast<MakeNetwork*>(own_symbol(SLIPBENCH_TORCH, make_symbol, remedy));
  return std::unique_ptr<Network>(make(shape, seed));
}

bool networks_available() { return std::filesystem::exists(own_path(SLIPBENCH_TORCH)); }

}  // namespace slipbench::learn
