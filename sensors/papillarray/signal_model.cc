#include "sensors/papillarray/signal_model.h"

#include <array>
#include <string>
#include <vector>

namespace slipbench {
namespace papillarray {
namespace {

// Measured disturbances by axis x, y, z, at the stiffness of the profile `gripper`.
struct Figures {
  std::array<double, axes> force;         // N, or N/s
  std::array<double, axes> displacement;  // m, or m/s
};
constexpr Figures noise_figures{{1.4e-3, 2.5e-3, 5.3e-3}, {0.4e-6, 0.7e-6, 1.4e-6}};
constexpr Figures offset_figures{{5.3e-3, 9.4e-3, 20e-3}, {0.86e-6, 1.5e-6, 3.0e-6}};
constexpr Figures drift_figures{{0.24e-3, 0.43e-3, 0.91e-3}, {0.07e-6, 0.12e-6, 0.24e-6}};
constexpr std::array<double, axes> gain_figures{0.18, 0.18, 0.093};  // force only
constexpr double coupling_figure = 0.042;                            // N lateral over N normal

std::string recorded(const std::string& figures) {
  return figures +
         " (public gripper recordings, Contactile_Data_Viz, 2022, stiffness profile gripper; force in proportion to the stiffness otherwise, assumed since the device computes force from displacement)";
}

}  // namespace

SignalModel signal_model(const PillarStiffness& stiffness, double rate) {
  const double tangential = stiffness.tangential / gripper_stiffness.tangential;
  const std::array<double, axes> force_factor{tangential, tangential, stiffness.normal / gripper_stiffness.normal};

  SignalModel model;
  model.rate = rate;
  model.sources = channel_size;
  const auto append = [&](const std::array<double, axes>& factor, std::array<double, axes> Figures::*channel, bool has_gain) {
    for (std::size_t pillar = 0; pillar < pillars; ++pillar) {
      for (std::size_t axis = 0; axis < axes; ++axis) {
        model.source.push_back(axes * pillar + axis);
        model.noise_sd.push_back(factor[axis] * (noise_figures.*channel)[axis]);
        model.offset_sd.push_back(factor[axis] * (offset_figures.*channel)[axis]);
        model.drift_sd.push_back(factor[axis] * (drift_figures.*channel)[axis]);
        model.gain_sd.push_back(has_gain ? gain_figures[axis] : 0.0);
      }
    }
  };
  append(force_factor, &Figures::force, true);
  append({1.0, 1.0, 1.0}, &Figures::displacement, false);

  for (std::size_t pillar = 0; pillar < pillars; ++pillar) {
    const std::size_t x = axes * pillar;
    model.couplings.push_back({x, x + 2, coupling_figure});
    model.couplings.push_back({x + 1, x + 2, coupling_figure});
  }
  return model;
}

std::vector<Entry> electronics_parts() {
  return electronics_of(
      "PapillArray",
      {{"coupling",
        recorded("FX and FY gain 0 to 0.3 N/mm of DZ, at 7.1 N/mm: limit 0.042 of FZ; sign and distribution assumed")},
       {"gain",
        recorded(
            "ratio of reported force to reported displacement over the pillars of two devices: sd 9.3 % for FZ, 18 % for FX and FY. Both include the error of the fits and real differences of stiffness. Displacement has no gain error")},
       {"offset", recorded("at the start of 45 recordings: sd FZ 20 mN, DZ 3 um; x and y assumed in proportion to their noise")},
       {"drift",
        recorded(
            "90 % of slopes within 5 s below 1.5 mN/s FZ and 0.4 um/s DZ: sd 0.91 mN/s, 0.24 um/s; x and y assumed in proportion to their noise")},
       {"noise",
        recorded(
            "unloaded pillars over 5 s, less a linear trend: sd FX 1.4, FY 2.5, FZ 5.3 mN, DX 0.4, DY 0.7, DZ 1.4 um. The sd includes the rise below 3 Hz, which has no pole of its own")}});
}

}  // namespace papillarray
}  // namespace slipbench
