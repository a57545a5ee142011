#include "tools/program/train/recipes/biotac.h"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "tools/program/train/recipes/recipe.h"

namespace slipbench::train {
namespace {

using biotac::electrodes;

// The graph drawn by hand, E1 being 0.
constexpr std::array<Edge, 34> edges{{{0, 1},   {1, 20},  {2, 3},   {3, 4},   {3, 21},  {3, 23},  {4, 6},   {4, 7},   {4, 23},
                                      {5, 6},   {6, 7},   {6, 8},   {7, 8},   {7, 17},  {8, 9},   {10, 11}, {11, 20}, {12, 13},
                                      {13, 14}, {13, 22}, {13, 23}, {14, 16}, {14, 17}, {14, 23}, {15, 16}, {16, 17}, {16, 18},
                                      {17, 18}, {18, 19}, {20, 21}, {20, 22}, {21, 22}, {21, 23}, {22, 23}}};

}  // namespace

namespace biotac {

const std::array<ImageLayout, 3>& image_layouts() {
  static const std::array<ImageLayout, 3> layouts{{
      {"D1", 12, 11, {{{0, 1},  {1, 2}, {4, 0}, {5, 1},  {6, 3}, {7, 0}, {8, 1},  {9, 4},  {10, 2}, {11, 1}, {0, 9}, {1, 8},
                       {4, 10}, {5, 9}, {6, 7}, {7, 10}, {8, 9}, {9, 6}, {10, 8}, {11, 9}, {2, 5},  {3, 4},  {3, 6}, {5, 5}}}},
      {"D2", 6, 5, {{{0, 4}, {1, 4}, {2, 4}, {2, 3}, {3, 3}, {3, 4}, {4, 4}, {4, 3}, {5, 3}, {5, 4}, {0, 0}, {1, 0},
                     {2, 0}, {2, 1}, {3, 1}, {3, 0}, {4, 0}, {4, 1}, {5, 1}, {5, 0}, {0, 2}, {1, 3}, {1, 1}, {2, 2}}}},
      {"D3", 4, 7, {{{0, 6}, {0, 5}, {1, 6}, {1, 5}, {2, 4}, {2, 6}, {2, 5}, {3, 4}, {3, 5}, {3, 6}, {0, 0}, {0, 1},
                     {1, 0}, {1, 1}, {2, 2}, {2, 0}, {2, 1}, {3, 2}, {3, 1}, {3, 0}, {0, 3}, {1, 4}, {1, 2}, {2, 3}}}},
  }};
  return layouts;
}

std::vector<std::vector<std::size_t>> pixels_of(const ImageLayout& layout) {
  std::vector<std::vector<std::size_t>> pixels;
  for (std::size_t row = 0; row < layout.rows; ++row) {
    for (std::size_t column = 0; column < layout.columns; ++column) {
      const auto distance = [&](std::size_t e) {
        const auto across = static_cast<double>(layout.places[e].first) - static_cast<double>(row);
        const auto along = static_cast<double>(layout.places[e].second) - static_cast<double>(column);
        return across * across + along * along;
      };
      std::vector<std::size_t> order(electrodes);
      std::iota(order.begin(), order.end(), 0U);
      std::ranges::stable_sort(order, {}, distance);
      order.resize(distance(order[0]) == 0.0 ? 1 : 3);
      pixels.push_back(order);
    }
  }
  return pixels;
}

std::vector<double> drawn_graph() { return normalised_adjacency(electrodes, edges); }

NetworkShape image_network(const ImageLayout& layout, std::size_t fingers, std::size_t units) {
  return {fingers * layout.rows * layout.columns,
          {Reshape{{fingers, layout.rows, layout.columns}}, Conv2d{32, 3, 0}, BatchNorm{}, Relu{}, Flatten{}, Linear{units},
           Relu{}, Linear{2}}};
}

NetworkShape graph_network(const std::vector<double>& adjacency, std::size_t fingers) {
  NetworkShape shape{electrodes * fingers, {Reshape{{electrodes, fingers}}}};
  for (const std::size_t units : {8, 8, 16, 16, 32})
    append(shape.layers, {GraphConvolution{units, adjacency}, BatchNorm{1}, Relu{}});
  append(shape.layers, {Flatten{}, Linear{128}, Relu{}, Linear{2}});
  return shape;
}

NetworkShape lstm_network(std::size_t layers, std::size_t rows) {
  NetworkShape shape{electrodes, {}};
  for (std::size_t i = 0; i < layers; ++i) shape.layers.emplace_back(Lstm{32});
  append(shape.layers, {Last{rows}, Linear{32}, Relu{}, Linear{32}, Relu{}, Linear{7}});
  return shape;
}

NetworkShape conv_lstm_network(const ImageLayout& layout, std::size_t layers, std::size_t filters, std::size_t rows) {
  NetworkShape shape{layout.rows * layout.columns, {Reshape{{1, layout.rows, layout.columns}}}};
  for (std::size_t i = 0; i < layers; ++i) shape.layers.emplace_back(ConvLstm{filters, 3});
  append(shape.layers, {Last{rows}, GlobalAverage{}, Linear{32}, Relu{}, Linear{32}, Relu{}, Linear{7}});
  return shape;
}

}  // namespace biotac

namespace {

Recipe biotac_recipe(const char* name, const char* summary, const char* section, bool as_image) {
  Recipe one = begun_recipe(
      name, summary, fmt::format("BioTac SP, grasp stability and direction of slip (papers/biotac-stability-slip), {}", section),
      "biotac_sp", 100.0, {{"electrodes", {}}});
  if (as_image) one.input.pixels = biotac::pixels_of(biotac::image_layouts().front());
  one.scaling = Scaling::range;
  one.training = {
      .steps = 600, .batch = 64, .clip = 1, .optimiser = Optimiser::adam, .learning_rate = 1e-3, .balance = Balance::drawing};
  one.training.validate_every = 50;
  return one;
}

}  // namespace

std::vector<Recipe> biotac_recipes() {
  constexpr const char* stability =
      "one finger and its own state, hold or slip, in each frame, since a file is the detector of one sensor; Adam at 1e-3, 600 steps of 64";
  Recipe cnn = biotac_recipe("biotac_cnn", "The electrodes as an image of 12 x 11 through a convolution of 32 and 1024 units",
                             "section 5.1, Table 2", true);
  cnn.assumed = stability;
  cnn.network = biotac::image_network(biotac::image_layouts().front(), 1, 1024);
  Recipe gcn = biotac_recipe("biotac_gcn", "The electrodes as a graph through convolutions of 8, 8, 16, 16, 32 units",
                             "section 5.1, Table 2 and Fig. 12", false);
  gcn.assumed = stability;
  gcn.network = biotac::graph_network(biotac::drawn_graph(), 1);

  constexpr const char* direction =
      "the class is what the motion was told, in each frame in contact, as each public recording is of one class; Adam at 1e-3";
  Recipe lstm = biotac_recipe("biotac_lstm", "Five rows at 100 Hz through five LSTMs of 32; direction of slip, seven classes",
                              "section 5.2, Table 3", false);
  lstm.assumed = direction;
  lstm.network = biotac::lstm_network(5, 5);
  lstm.classes = ClassRule::direction;
  lstm.training.steps = 1000;
  Recipe conv_lstm = biotac_recipe(
      "biotac_convlstm", "Five images of 12 x 11 at 100 Hz through convolutional LSTMs; direction of slip, seven classes",
      "section 5.2, Table 3", true);
  conv_lstm.assumed = fmt::format("{}; two layers of 8 filters, not five of 32, which take 30 times as long to learn", direction);
  conv_lstm.network = biotac::conv_lstm_network(biotac::image_layouts().front(), 2, 8, 5);
  conv_lstm.classes = ClassRule::direction;
  conv_lstm.training.steps = 1000;

  Recipe spreads = biotac_recipe(
      "biotac_gru",
      "How much each electrode moves and drifts in 0.1, 0.2 and 0.5 s, through a GRU at 20 Hz; direction of slip, seven classes",
      "", false);
  spreads.source =
      "none published: levels, by which devices differ, are out; spreads in rising order do not tell where it is touched";
  spreads.assumed =
      "all of it; touch until more than half of what touches slips, then the class that the motion was told, until contact is lost; Adam at 3e-3";
  spreads.input.window = 10;
  spreads.input.stride = 5;
  spreads.input.transform = network::Transform::spreads;
  spreads.input.spans = {10, 20, 50};
  spreads.input.floor = 3.0;  // counts, the noise of an electrode: what is less tells nothing
  spreads.members = 3;
  spreads.scaling = Scaling::standard;
  spreads.network = {5 * electrodes, {Linear{32}, Relu{}, Gru{32}, Linear{7}}};
  spreads.classes = ClassRule::direction;
  spreads.labels = LabelRule::latched;
  spreads.training = {
      .steps = 2400, .batch = 32, .clip = 30, .optimiser = Optimiser::adam, .learning_rate = 3e-3, .label_smoothing = 0.1};
  spreads.training.validate_every = 150;

  Recipe slip = slip_recipe(
      "biotac_slip",
      "Each electrode against its own mean of 0.64 s, through filters across electrodes and in time and a GRU at 50 Hz",
      "biotac_sp", 100.0, {{"electrodes", {}}});
  const std::size_t rows = slip.input.window = 64;
  slip.input.stride = 2;  // half the memory: a frame is all of its rows
  slip.input.centre = true;
  slip.scaling = Scaling::common;
  slip.network = {rows * electrodes,
                  {Reshape{{rows, electrodes}}, Linear{12}, Permute{{1, 0}}, Linear{8}, Relu{}, Flatten{}, Linear{48}, Relu{},
                   Gru{48}, Linear{2}}};
  slip.training.steps = 1500;
  slip.training.clip = 75;
  slip.training.onset_frames = 10;
  slip.members = 3;

  Recipe grasp = slip_recipe(
      "biotac_grasp", "How each electrode and the pressure change in 20 to 300 ms, with their signs, through two GRUs at 100 Hz",
      "biotac_sp", 100.0, {{"electrodes", {}}, {"pdc", {}}, {"pac", {}}});
  constexpr std::size_t values = electrodes + 21;
  grasp.input.window = 2;
  grasp.input.transform = network::Transform::levels;
  grasp.input.spans = {2, 4, 8, 30};
  grasp.input.floor = 3.0;  // counts, the noise
  grasp.network = {5 * values, {Reshape{{5, values}}, Linear{16}, Flatten{}, Linear{48}, Relu{}, Gru{48}, Gru{48}, Linear{2}}};
  return {cnn, gcn, lstm, conv_lstm, spreads, slip, grasp};
}

}  // namespace slipbench::train
