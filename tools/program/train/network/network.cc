#include "tools/program/train/network/network.h"

#include <filesystem>

#include "sim/core/process/own_library.h"

namespace slipbench::train {
namespace {

constexpr const char* remedy =
    "allowed: a slipbench built with the packages libtorch-dev and libonnx-dev, which tools/setup/setup.sh test installs";

const TorchLibrary& library() {
  using Library = const TorchLibrary*();
  static const TorchLibrary* const loaded = reinterpret_cast<Library*>(own_symbol(SLIPBENCH_TORCH, torch_symbol, remedy))();
  return *loaded;
}

// Arrays that a step hands to the next.
std::size_t carried_states(const NetworkShape& shape) {
  if (!carries_state(shape)) return 0;
  std::size_t states = 0;
  for (const Layer& layer : shape.layers) {
    if (std::holds_alternative<Gru>(layer)) states += 1;
    if (std::holds_alternative<Lstm>(layer) || std::holds_alternative<ConvLstm>(layer)) states += 2;
  }
  return states;
}

}  // namespace

std::unique_ptr<Network> make_network(const NetworkShape& shape, std::uint64_t seed) {
  return std::unique_ptr<Network>(library().make(shape, seed));
}

std::string onnx_model(const NetworkShape& shape, std::span<const std::vector<std::vector<float>>> members,
                       network::Description description) {
  description.states.clear();
  for (std::size_t i = 0; i < members.size() * carried_states(shape); ++i) {
    const std::string name = "state_" + std::to_string(i);
    description.states.push_back({name, name + "_next"});
  }
  description.output = members.size() == 1 ? network::Output::logits : network::Output::probabilities;
  return library().onnx(shape, members, network::description_text(description));
}

bool networks_available() { return std::filesystem::exists(own_path(SLIPBENCH_TORCH)); }

std::string network_libraries() { return library().versions; }

}  // namespace slipbench::train
