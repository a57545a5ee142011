#include "sensors/nib_pad/signal_model.h"

#include <cmath>

#include "sensors/nib_pad/electrodes.h"

namespace slipbench {
namespace nib_pad {
namespace {

// Counts at 13 bit. None is published for this device.
constexpr double si_noise = 1.5, cluster_noise = 1.2;
constexpr double offset = 20.0;
constexpr double drift = 0.02;  // counts/s
constexpr double gain = 0.05;   // of one electrode

}  // namespace

SignalModel signal_model(double rate, double count) {
  SignalModel model;
  model.rate = rate;
  model.sources = value_count;
  for (std::size_t v = 0; v < value_count; ++v) {
    model.source.push_back(v);
    model.noise_sd.push_back(count * (v < si_size ? si_noise : cluster_noise));
    model.offset_sd.push_back(count * offset);
    model.drift_sd.push_back(count * drift);
    // A cluster is the sum of 9 or 12 of the same electrodes, whose gains are drawn apart from one another.
    model.gain_sd.push_back(v < fl_first ? gain : gain / std::sqrt(v < fr_first ? 9.0 : 12.0));
  }
  return model;
}

std::vector<Entry> electronics_parts() {
  return electronics_of(
      "nib pad",
      {{"gain", "assumed: 5 % of what is above rest, from electrode to electrode, as gaps and areas are made"},
       {"offset",
        "assumed: 20 counts of 13 bit, about a third of a step of the 7-bit current source that calibrates the reading at rest"},
       {"drift", "assumed: 0.02 counts/s of 13 bit, 3 ppm/s of the reading at rest, by temperature"},
       {"noise",
        "assumed: 1.5 counts of 13 bit for si, 1.2 for clusters. The maker calls less than 10 counts quiet (Infineon's tuning guide); another capacitive fingertip has 0.8 to 1.3 counts (FabricSlide)",
        {{"corner", "inf", "a converter's noise is white: each reading integrates anew"}}}});
}

}  // namespace nib_pad
}  // namespace slipbench
