// MuJoCo models from text, and the pad used by most tests of pads.
#pragma once

#include <array>
#include <stdexcept>
#include <string>

#include <mujoco/mujoco.h>

#include "sim/core/pose.h"
#include "sim/mujoco/mujoco_call.h"
#include "tests/oracle/pads.h"

namespace slipbench {

using Spec = SpecPointer;
using Model = ModelPointer;
using Data = DataPointer;

// Both throw std::runtime_error with MuJoCo's text.
inline Spec parse(const std::string& xml) {
  std::array<char, 2000> error{};
  Spec spec(mj_parseXMLString(xml.c_str(), nullptr, error.data(), static_cast<int>(error.size())));
  if (!spec) throw std::runtime_error(error.data());
  return spec;
}
inline Model compile(mjSpec* spec) {
  Model model(mj_compile(spec, nullptr));
  if (!model) throw std::runtime_error(mjs_getError(spec));
  return model;
}

inline Pose pose_of(const double* position, const double* rotation) {
  return {Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rotation), Eigen::Map<const Eigen::Vector3d>(position)};
}

// Nine pillars at 7 mm, flat: k_n 3 kN/m and k_t 500 N/m, times `stiffer`.
inline PadLayout nine_flat_pillars(double stiffer) { return oracle::square_grid(3, 0.021, 3000.0 * stiffer, 500.0 * stiffer); }

}  // namespace slipbench
