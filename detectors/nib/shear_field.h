// The nib pad's static image: what the 36 electrodes of its nine taxels say of normal and shear load.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include <Eigen/Core>

namespace slipbench::nib {

// A taxel has index 3*row + column, rows from north (+y) to south, columns from west (-x) to east, and its electrodes the order W, N, E, S.
inline constexpr std::size_t taxels = 9;
inline constexpr std::size_t electrodes = 4;

// Changes of capacitance against the unloaded pad, in counts.
struct ShearField {
  std::array<double, taxels> normal{};          // W + N + E + S: grows with compression
  std::array<Eigen::Vector2d, taxels> shear{};  // (E - W, N - S): points where the surface drags the nibs

  [[nodiscard]] double total_normal() const;
  [[nodiscard]] Eigen::Vector2d total_shear() const;
};

// Equations (1) and (2) of the paper. `change`: [9,4] counts.
ShearField shear_field(std::span<const double, taxels * electrodes> change);

// Curl of the shear about the centre taxel with the distance of taxels as unit length [counts]: the slopes dFy/dx - dFx/dy of the straight
// lines of least squares over all nine taxels. A rigid rotation F = w (-y, x) has 2 w, a translation 0.
double curl(const ShearField& field);

// The same of the field divided by the mean length of its nine vectors; without shear 0. A rigid rotation about the centre taxel has
// +-9/(2 + 2 sqrt 2) = 1.864, a translation 0; no field has more than 1.5 sqrt 2, which takes shear at the corners alone. Dimensionless.
double normalised_curl(const ShearField& field);

}  // namespace slipbench::nib
