#include <algorithm>
#include <string>
#include <variant>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/core/error.h"
#include "tools/program/train/recipes/families.h"

namespace slipbench::train {
namespace {

std::string text(const Linear& layer) { return fmt::format("linear {}", layer.outputs); }
std::string text(const Relu&) { return "relu"; }
std::string text(const Tanh&) { return "tanh"; }
std::string text(const BatchNorm&) { return "batch norm"; }
std::string text(const Gru& layer) { return fmt::format("GRU {}", layer.units); }
std::string text(const Lstm& layer) { return fmt::format("LSTM {}", layer.units); }
std::string text(const ConvLstm& layer) { return fmt::format("ConvLSTM {} {} x {}", layer.channels, layer.kernel, layer.kernel); }
std::string text(const Conv1d& layer) { return fmt::format("convolution over {} frames {}", layer.kernel, layer.channels); }
std::string text(const Conv2d& layer) {
  return fmt::format("convolution {} x {} {}", layer.kernel, layer.kernel, layer.channels);
}
std::string text(const MaxPool&) { return "max pool 2 x 2"; }
std::string text(const GlobalAverage&) { return "global average"; }
std::string text(const PoolUnits& layer) {
  return fmt::format("mean and greatest of units{}", layer.beside ? " beside each" : "");
}
std::string text(const GraphConvolution& layer) { return fmt::format("graph convolution {}", layer.units); }
std::string text(const Flatten&) { return "flatten"; }
std::string text(const Reshape& layer) { return fmt::format("as {}", fmt::join(layer.shape, " x ")); }
std::string text(const Permute& layer) { return fmt::format("axes {}", fmt::join(layer.order, " ")); }
std::string text(const Last& layer) { return fmt::format("last of {} frames", layer.frames); }

}  // namespace

Recipe begun_recipe(const std::string& name, const std::string& summary, const std::string& source, const std::string& sensor,
                    double rate, const std::vector<network::ChannelPick>& channels) {
  Recipe one;
  one.name = name;
  one.summary = summary;
  one.source = source;
  one.input.sensor = sensor;
  one.input.rate = rate;
  one.input.channels = channels;
  return one;
}

void append(Layers& layers, const Layers& more) { layers.insert(layers.end(), more.begin(), more.end()); }

const std::vector<Recipe>& recipes() {
  static const std::vector<Recipe> all = [] {
    std::vector<Recipe> together;
    for (const auto& family : {piezo_recipes(), papillarray_recipes(), myrmex_recipes(), biotac_recipes()})
      together.insert(together.end(), family.begin(), family.end());
    return together;
  }();
  return all;
}

const Recipe& find_recipe(std::string_view name) {
  const auto found = std::ranges::find(recipes(), name, &Recipe::name);
  if (found != recipes().end()) return *found;
  std::vector<std::string> names{"gst_hd"};
  for (const Recipe& recipe : recipes()) names.push_back(recipe.name);
  throw InputError(fmt::format("no recipe {}{}", quote(name), allowed_names(name, names)));
}

std::string layers_text(const Layers& layers) {
  std::vector<std::string> words;
  for (const Layer& layer : layers) words.push_back(std::visit([](const auto& kind) { return text(kind); }, layer));
  return fmt::format("{}", fmt::join(words, ", "));
}

}  // namespace slipbench::train
