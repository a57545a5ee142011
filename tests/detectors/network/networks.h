// The networks of data/make_networks.py, written out.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>

#include "tests/files.h"

namespace slipbench::network {

// True if this process has loaded a library of that name.
inline bool openvino_is_loaded() { return bytes_of("/proc/self/maps").find("openvino") != std::string::npos; }

inline std::string shipped(const std::string& name) {
  return std::string(SLIPBENCH_SOURCE_DIR) + "/tests/detectors/network/data/" + name;
}

// The i-th weight of a network.
inline double weight(std::size_t i) { return (static_cast<double>((7 * i) % 11) - 5.0) / 8.0; }

// A row of a matrix whose first weight is `first`, times x, plus the weight `bias`.
template <class Values>
double row(std::size_t first, const Values& x, std::size_t bias) {
  double sum = weight(bias);
  for (std::size_t i = 0; i < x.size(); ++i) sum += weight(first + i) * static_cast<double>(x[i]);
  return sum;
}

// mlp13.onnx: W1 [4, 6] from 0, B1 from 24, W2 [2, 4] from 28, B2 from 36. Logits.
inline std::array<double, 2> mlp(std::span<const float, 6> input) {
  std::array<double, 4> hidden{};
  for (std::size_t i = 0; i < 4; ++i) hidden[i] = std::fmax(0.0, row(6 * i, input, 24 + i));
  return {row(28, hidden, 36), row(32, hidden, 37)};
}

// gru21.onnx: W [6, 3] from 0, R [6, 2] from 18, W's and R's B [6] each from 30, W2 [2, 2] from 42,
// B2 from 46. The rows of W, R and B belong to the update gate z, the reset gate r and the
// candidate n.
class Gru {
 public:
  // Probabilities.
  std::array<double, 2> step(std::span<const float, 3> input) {
    const auto sigmoid = [](double x) { return 1.0 / (1.0 + std::exp(-x)); };
    std::array<double, 2> next{};
    for (std::size_t i = 0; i < 2; ++i) {
      const auto fed = [&](std::size_t gate) { return row(3 * (2 * gate + i), input, 30 + 2 * gate + i); };
      const auto carried = [&](std::size_t gate) { return row(18 + 2 * (2 * gate + i), h_, 36 + 2 * gate + i); };
      const double z = sigmoid(fed(0) + carried(0));
      const double r = sigmoid(fed(1) + carried(1));
      const double n = std::tanh(fed(2) + r * carried(2));
      next[i] = (1.0 - z) * n + z * h_[i];
    }
    h_ = next;
    const double hold = std::exp(row(42, h_, 46));
    const double slip = std::exp(row(44, h_, 47));
    return {hold / (hold + slip), slip / (hold + slip)};
  }

 private:
  std::array<double, 2> h_{};
};

}  // namespace slipbench::network
