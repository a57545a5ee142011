// What the BioTac SP's recipes and the paper's studies share: tactile images, the tactile graph, and the paper's networks.
#pragma once

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "tools/program/train/network/network.h"

namespace slipbench::train::biotac {

inline constexpr std::size_t electrodes = 24;  // E1 is number 0

// A tactile image of the paper's Fig. 3.
struct ImageLayout {
  const char* name;  // "D1"
  std::size_t rows, columns;
  std::array<std::pair<std::size_t, std::size_t>, electrodes> places;  // row and column of each electrode
};

// D1 12 x 11, D2 6 x 5, D3 4 x 7, as the authors' code has them (yayaneath/biotac-sp-images); of its two of 6 x 5 the one with E2 in
// the second row.
const std::array<ImageLayout, 3>& image_layouts();

// Of each pixel, row by row, the electrodes whose mean it is: its own, else the three nearest in the image.
std::vector<std::vector<std::size_t>> pixels_of(const ImageLayout& layout);

// The normalised adjacency of the graph drawn by hand [electrodes, electrodes].
std::vector<double> drawn_graph();

// The CNN, two classes, of frames [fingers, rows, columns]: 32 filters 3 x 3, then `units`.
NetworkShape image_network(const ImageLayout& layout, std::size_t fingers, std::size_t units);
// The GCN, two classes, of frames [electrodes, fingers].
NetworkShape graph_network(const std::vector<double>& adjacency, std::size_t fingers);
// The LSTM, seven classes, of windows of `rows` frames [electrodes]; 32 units a layer.
NetworkShape lstm_network(std::size_t layers, std::size_t rows);
// The ConvLSTM, seven classes, of windows of `rows` frames [rows of the layout, columns]; filters 3 x 3.
NetworkShape conv_lstm_network(const ImageLayout& layout, std::size_t layers, std::size_t filters, std::size_t rows);

}  // namespace slipbench::train::biotac
