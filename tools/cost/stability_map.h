// The largest stable step of explicit pads in stick, over mass, stiffness, damping and integrator:
// measured and predicted. Not valid for pads that slip, detach or strike.
//
// Measurement and its uncertainty: sim/mujoco/pads/step_probe.h. Prediction:
// sim/mujoco/linear/stability.h.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tools/dataset/record/json.h"

namespace slipbench::cost {

struct StabilityOptions {
  std::size_t every = 1;  // measures every n-th combination of the whole map; 1: all
};

struct StabilityCombination {
  std::string set_up;  // "two pads hold a box"
  std::string integrator;
  double mass = 0.0;             // kg, of the box
  double stiffness_scale = 0.0;  // multiple of a real pillar's
  double k_normal = 0.0;         // N/m, of an element
  double damping = 0.0;          // s, tau of dashpots tau k
  double omega = 0.0;            // rad/s, of the fastest vibration
  double predicted = 0.0;        // s, stability limit
  double allowed = 0.0;          // s, the longest step that a scene allows
  double measured = 0.0;         // s, the longest bounded step

  [[nodiscard]] double ratio() const { return predicted / measured; }
};

struct StabilityMap {
  std::vector<StabilityCombination> combinations;

  // Least ratio predicted / measured, at most 1; 1 for an empty map.
  [[nodiscard]] double worst_ratio() const;
  [[nodiscard]] std::size_t above() const;  // number of ratios above 1
};

// Deterministic; for its CPU time see tools/cost/README.md.
StabilityMap measure_stability(const StabilityOptions& options = {});

// {"slipbench_stability": 1, "text": [...], "combinations": [{"case", "integrator", "mass_kg",
// "stiffness_scale", "k_normal", "damping_s", "omega", "predicted_s", "allowed_s", "measured_s",
// "ratio"}], "worst_ratio", "above", "remarks": [...]}
Json stability_json(const StabilityMap& map);

// A table for a terminal: per set-up and integrator the least and the largest ratio, and the range
// of steps.
std::string stability_text(const StabilityMap& map);

}  // namespace slipbench::cost
