#include <algorithm>
#include <cmath>
#include <string>
#include <variant>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tools/base/files/reject.h"
#include "tools/program/train/recipes/recipe.h"

namespace slipbench::train {
namespace {

Recipe grasp_gru() {
  Recipe grasp =
      begun_recipe("grasp_gru", "Forces and displacements of all nine pillars at 100 Hz through a GRU: slip in a grasp",
                   "none published: for scenes/grasp, where the published detector is nearly blind", "papillarray", 100.0,
                   {{"force", {}}, {"displacement", {}}});
  grasp.assumed = "all of it; the label is the truth, so that a grip which holds again is no slip, and tightening ends";
  grasp.scaling = Scaling::standard;
  grasp.network = {54, {Linear{48}, Relu{}, Gru{48}, Linear{2}}};
  grasp.labels = LabelRule::micro;
  grasp.training = {.steps = 600, .batch = 32, .clip = 100, .optimiser = Optimiser::adam, .learning_rate = 3e-3};
  grasp.training.validate_every = 30;
  return grasp;
}

Recipe slip_gru() {
  Recipe slip = slip_recipe(
      "slip_gru", "Forces of units, their ratio and rates, each unit by the same weights, pooled, through a GRU at 100 Hz",
      "papillarray", 1000.0, {{"force", {}}});
  slip.input.transform = network::Transform::units;
  slip.input.spans = {10, 20, 40, 80, 160};
  slip.input.floor = 1e-3;  // N, the noise of a pillar: what is less tells nothing
  slip.scaling = Scaling::common;
  const std::size_t features = 2 + 3 * slip.input.spans.size();
  slip.network = {9 * features,
                  {Reshape{{9, features}}, BatchNorm{1}, Linear{32}, Relu{}, PoolUnits{true}, Linear{48}, Relu{}, PoolUnits{},
                   Linear{48}, Relu{}, Gru{48}, Linear{2}}};
  slip.training = {.steps = 5000, .batch = 32, .clip = 150, .optimiser = Optimiser::adam, .learning_rate = 3e-3};
  slip.training.validate_every = 250;
  slip.training.onset_frames = 20;
  return slip;
}

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

constexpr std::size_t taxel_rows = 16, kept = 12, edge = (taxel_rows - kept) / 2, bins = 32;

Recipe myrmex_recipe(const char* name, const char* summary, const char* row, const Layers& layers) {
  network::ChannelPick taxels{"taxels", {}};
  for (std::size_t r = 0; r < kept; ++r) {
    for (std::size_t c = 0; c < kept; ++c) taxels.values.push_back((r + edge) * taxel_rows + c + edge);
  }
  Recipe one = begun_recipe(
      name, summary,
      fmt::format("Myrmex, slip classification by spectra and a CNN (papers/myrmex-tactile-cnn), section 4, Table 2: {}", row),
      "myrmex", 1000.0, {taxels});
  one.assumed =
      "32 and 32 channels, images padded by 1, Adam at 1e-3, 600 steps; stable, translation and rotation are the truth: of the rigid motion that "
      "fits the slip best, the part with more energy; at most 60 frames of a class and trial";
  one.input.window = 64;
  one.input.stride = 8;
  one.input.transform = network::Transform::amplitude;
  one.input.low = 0.0;
  one.input.high = 31.0 * one.input.rate / 64.0;
  one.network = {kept * kept * bins, {Reshape{{kept, kept, bins}}, Permute{{2, 0, 1}}}};
  append(one.network.layers, layers);
  one.classes = ClassRule::kind;
  one.at_most = 60;
  one.training = {
      .steps = 600, .batch = 64, .clip = 1, .optimiser = Optimiser::adam, .learning_rate = 1e-3, .balance = Balance::drawing};
  one.training.validate_every = 50;
  return one;
}

Layers network(std::size_t convolutions, std::size_t hidden) {
  Layers layers;
  for (std::size_t i = 0; i < convolutions; ++i) append(layers, {Conv2d{32, 3, 1}, Tanh{}, MaxPool{}});
  append(layers, {Flatten{}, Linear{hidden}, Tanh{}, Linear{3}});
  return layers;
}

constexpr double skin_rate = 10e3;  // Hz
constexpr double rounding_density =
    1.0 / 12.0 / (0.5 * skin_rate);  // counts^2/Hz, of rounding to whole counts: finite in silence

// The paper's clips of 128 frames. Its RMSProp at 8e-4 needs thousands of steps for what Adam at a greater rate reaches in hundreds.
Recipe piezo_recipe(const char* name, const char* summary, const char* row, std::size_t steps, std::size_t batch, double rate) {
  Recipe one = begun_recipe(
      name, summary,
      fmt::format("Piezoelectric skin, FFT-GRU slip detection (papers/piezo-fft-gru), sections IV.A and IV.B, Table I: {}", row),
      "piezo_skin", skin_rate, {{"signal", {}}});
  one.assumed =
      "four layers, which give the numbers of parameters printed; weights of classes in place of balanced drawing, no label smoothing, no penalty "
      "of changes; steps of Adam, whose rate falls to a fiftieth, in place of 200 epochs of RMSProp at 8e-4";
  one.input.stride = 100;
  one.labels = LabelRule::paper;
  one.training = {
      .steps = steps, .batch = batch, .clip = 128, .optimiser = Optimiser::adam, .learning_rate = rate, .final_rate = 0.02};
  one.training.validate_every = steps / 20;
  return one;
}

// The same, of the signal's spectra.
Recipe spectra_recipe(const char* name, const char* summary, const char* row, std::size_t steps, std::size_t batch, double rate) {
  Recipe one = piezo_recipe(name, summary, row, steps, batch, rate);
  one.input.window = 200;
  one.input.centre = true;
  one.input.transform = network::Transform::log_psd;
  one.input.low = 50.0;
  one.input.high = 600.0;
  one.input.floor = rounding_density;
  return one;
}

Recipe piezo_slip() {
  Recipe slip = slip_recipe("piezo_slip", "Spectra of 20 ms, and what the signal stands at, through two GRUs at 100 Hz",
                            "piezo_skin", skin_rate, {{"signal", {}}});
  slip.input.window = 200;
  slip.input.transform = network::Transform::log_psd;
  slip.input.high = 1500.0;
  slip.input.floor = rounding_density;
  const std::size_t bins = 31;  // 0 to 1500 Hz, 50 Hz each
  slip.network = {bins, {Linear{48}, Relu{}, Gru{48}, Gru{48}, Linear{2}}};
  slip.members = 3;
  return slip;
}

// In a grasp a slip is told by which way the signal goes: shear that builds up, and falls as the box lets go.
Recipe piezo_grasp() {
  Recipe slip =
      slip_recipe("piezo_grasp", "What the signal stands at and how it changes in 2 to 100 ms, through two GRUs at 100 Hz",
                  "piezo_skin", skin_rate, {{"signal", {}}});
  slip.input.transform = network::Transform::levels;
  slip.input.spans = {20, 100, 300, 1000};
  slip.input.floor = 3.0;  // counts, the noise
  slip.network = {slip.input.spans.size() + 1, {Linear{48}, Relu{}, Gru{48}, Gru{48}, Linear{2}}};
  return slip;
}

Layers four(const Layer& layer, bool relu) {
  Layers layers;
  for (int i = 0; i < 4; ++i) {
    layers.push_back(layer);
    if (relu) layers.emplace_back(Relu{});
  }
  layers.emplace_back(Linear{2});
  return layers;
}

}  // namespace

std::vector<Recipe> papillarray_recipes() {
  network::ChannelPick force{"force", {}};
  for (const std::size_t pillar : {0, 1, 2, 3, 5, 6, 7, 8})  // all but the centre one
    force.values.insert(force.values.end(), {3 * pillar, 3 * pillar + 1});
  Recipe one = begun_recipe(
      "papillarray_gru", "Tangential forces of the eight outer pillars, 40 ms at a time, through a GRU",
      "RedmondLabUCD/Incipient-Slip-Detection-PapillArray: its network, its median filter of 21 rows and its stacks of 40 rows at 1 kHz",
      "papillarray", 1000.0, {force});
  one.assumed =
      "Adam, rate, steps and batch; weights of classes; the label latched until contact is lost, since after a brake true slip ends under "
      "full shear";
  one.input.median = 21;
  one.input.window = 40;
  one.input.stride = 40;
  one.scaling = Scaling::common;
  one.network = {640,
                 {Linear{1024}, BatchNorm{}, Relu{}, Linear{128}, BatchNorm{}, Relu{}, Gru{128}, Linear{256}, BatchNorm{}, Relu{},
                  Linear{128}, BatchNorm{}, Relu{}, Linear{2}}};
  one.labels = LabelRule::latched;
  one.training = {.steps = 300, .batch = 64, .clip = 9, .optimiser = Optimiser::adam, .learning_rate = 1e-3};
  one.training.validate_every = 15;
  one.training.patience = 8;
  Recipe five = one;
  five.name = "papillarray_gru5";
  five.summary = "Five such networks, whose probabilities are averaged in one graph";
  five.members = 5;
  return {one, five, grasp_gru(), slip_gru()};
}

std::vector<Recipe> myrmex_recipes() {
  return {
      myrmex_recipe("myrmex_net1", "Spectra of 12 x 12 taxels through one convolution and 512 units", "net 1", network(1, 512)),
      myrmex_recipe("myrmex_net2", "The same through two convolutions", "net 2", network(2, 512)),
      myrmex_recipe("myrmex_net3", "The same through two convolutions and 1024 units", "net 3", network(2, 1024))};
}

std::vector<Recipe> nib_recipes() {
  Recipe slip = slip_recipe("nib_slip", "How much all electrodes move in 0.1 and 0.3 s, and which way, through a GRU at 100 Hz",
                            "nib_pad", 300.0, {{"si", {}}, {"fl", {}}, {"fr", {}}});
  slip.input.transform = network::Transform::spreads;
  slip.input.spans = {90, 30};
  slip.input.floor = 1.0;  // counts, the converter's step
  const std::size_t electrodes = 40;
  slip.network = {(slip.input.spans.size() + 2) * electrodes, {Linear{48}, Relu{}, Gru{48}, Linear{2}}};
  slip.training.steps = 1500;
  return {slip};
}

std::vector<Recipe> piezo_recipes() {
  Recipe mlp =
      spectra_recipe("piezo_mlp", "Spectra of 20 ms, each by itself, through four layers of 32", "MLP 32", 1000, 64, 1e-2);
  mlp.network = {12, four(Linear{32}, true)};
  Recipe mlp_128 = spectra_recipe("piezo_mlp_128", "The same with 128", "MLP 128", 500, 64, 3e-3);
  mlp_128.network = {12, four(Linear{128}, true)};
  Recipe tcn = spectra_recipe("piezo_tcn", "The latest 29 spectra through four causal convolutions of 128, kernel 8",
                              "TCN 128, kernel 8", 800, 16, 1e-3);
  tcn.network = {12, four(Conv1d{128, 8}, true)};
  Recipe fft_gru = spectra_recipe("piezo_fft_gru", "Spectra of 20 ms, one after the other, through four GRUs of 32", "FFT GRU 32",
                                  300, 64, 4e-3);
  fft_gru.network = {12, four(Gru{32}, false)};
  Recipe raw_gru = piezo_recipe("piezo_raw_gru", "The signal at 100 Hz through four GRUs of 32", "raw GRU 32", 300, 64, 4e-3);
  raw_gru.network = {1, four(Gru{32}, false)};
  return {mlp, mlp_128, tcn, fft_gru, raw_gru, piezo_slip(), piezo_grasp()};
}

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

Recipe slip_recipe(const std::string& name, const std::string& summary, const std::string& sensor, double rate,
                   const std::vector<network::ChannelPick>& channels) {
  Recipe slip = begun_recipe(
      name, summary, "none published: for scenes/learn, where device, load, friction and the way differ from trial to trial",
      sensor, rate, channels);
  slip.assumed = "all of it; on a stage frames that stick again after a slip teach nothing; Adam at 3e-3";
  slip.input.window = slip.input.stride = static_cast<std::size_t>(std::lround(rate / 100.0));
  slip.scaling = Scaling::standard;
  slip.labels = LabelRule::tightened;
  slip.training = {
      .steps = 3000, .batch = 64, .clip = 150, .optimiser = Optimiser::adam, .learning_rate = 3e-3, .final_rate = 0.02};
  slip.training.validate_every = 150;
  slip.training.onset_frames = 20;
  return slip;
}

void append(Layers& layers, const Layers& more) { layers.insert(layers.end(), more.begin(), more.end()); }

const std::vector<Recipe>& recipes() {
  static const std::vector<Recipe> all = [] {
    std::vector<Recipe> together;
    for (const auto& family : {piezo_recipes(), papillarray_recipes(), myrmex_recipes(), nib_recipes(), biotac_recipes()})
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
  reject("no recipe {}{}", quote(name), allowed_names(name, names));
}

std::string layers_text(const Layers& layers) {
  std::vector<std::string> words;
  for (const Layer& layer : layers) words.push_back(std::visit([](const auto& kind) { return text(kind); }, layer));
  return fmt::format("{}", fmt::join(words, ", "));
}

}  // namespace slipbench::train
