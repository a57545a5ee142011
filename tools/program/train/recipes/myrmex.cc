#include <fmt/format.h>

#include "tools/program/train/recipes/families.h"

namespace slipbench::train {
namespace {

constexpr std::size_t taxel_rows = 16, kept = 12, edge = (taxel_rows - kept) / 2, bins = 32;

Recipe myrmex_recipe(const char* name, const char* summary, const char* row, Layers layers) {
  Recipe one;
  one.name = name;
  one.summary = summary;
  one.source = fmt::format(
      "Myrmex, slip classification by spectra and a CNN (papers/myrmex-tactile-cnn), section 4, Table 2: "
      "{}",
      row);
  one.assumed =
      "32 and 32 channels, images padded by 1, Adam at 1e-3, 600 steps; stable, translation and rotation are the truth: of the rigid motion that "
      "fits the slip best, the part with more energy; at most 60 frames of a class and trial";
  one.input.sensor = "myrmex";
  one.input.rate = 1000.0;
  network::ChannelPick taxels{"taxels", {}};
  for (std::size_t r = 0; r < kept; ++r) {
    for (std::size_t c = 0; c < kept; ++c) taxels.values.push_back((r + edge) * taxel_rows + c + edge);
  }
  one.input.channels = {taxels};
  one.input.window = 64;
  one.input.stride = 8;
  one.input.transform = network::Transform::amplitude;
  one.input.low = 0.0;
  one.input.high = 31.0 * one.input.rate / 64.0;
  one.network = {kept * kept * bins, {Reshape{{kept, kept, bins}}, Permute{{2, 0, 1}}}};
  one.network.layers.insert(one.network.layers.end(), layers.begin(), layers.end());
  one.classes = ClassRule::kind;
  one.at_most = 60;
  one.training = {
      .steps = 600, .batch = 64, .clip = 1, .optimiser = Optimiser::adam, .learning_rate = 1e-3, .balance = Balance::drawing};
  one.training.validate_every = 50;
  return one;
}

Layers network(std::size_t convolutions, std::size_t hidden) {
  Layers layers;
  for (std::size_t i = 0; i < convolutions; ++i) {
    for (const Layer& layer : Layers{Conv2d{32, 3, 1}, Tanh{}, MaxPool{}}) layers.push_back(layer);
  }
  for (const Layer& layer : Layers{Flatten{}, Linear{hidden}, Tanh{}, Linear{3}}) layers.push_back(layer);
  return layers;
}

}  // namespace

std::vector<Recipe> myrmex_recipes() {
  return {
      myrmex_recipe("myrmex_net1", "Spectra of 12 x 12 taxels through one convolution and 512 units", "net 1", network(1, 512)),
      myrmex_recipe("myrmex_net2", "The same through two convolutions", "net 2", network(2, 512)),
      myrmex_recipe("myrmex_net3", "The same through two convolutions and 1024 units", "net 3", network(2, 1024))};
}

}  // namespace slipbench::train
