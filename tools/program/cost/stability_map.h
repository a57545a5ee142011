// The largest stable step of explicit pads that stick over mass, stiffness, damping and integrator: measured beside predicted. Of pads
// that slip, let go or strike it says nothing.
//
// What is measured, and how far it may be off: sim/mujoco/pads/step_probe.h. What is predicted: sim/mujoco/linear/stability.h.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tools/base/record/json.h"

namespace slipbench::cost {

struct StabilityOptions {
  std::size_t every = 1;  // measures every n-th combination of the whole map; 1: all
};

struct StabilityCombination {
  std::string set_up;  // "two pads hold a box"
  std::string integrator;
  double mass = 0.0;             // kg, of the box
  double stiffness_scale = 0.0;  // times a real pillar's
  double k_normal = 0.0;         // N/m, of an element
  double damping = 0.0;          // s, tau of dashpots tau k
  double omega = 0.0;            // rad/s, of the fastest vibration
  double predicted = 0.0;        // s, beyond which it diverges
  double allowed = 0.0;          // s, the longest step that a scene may take
  double measured = 0.0;         // s, the longest that stayed bounded

  [[nodiscard]] double ratio() const { return predicted / measured; }
};

struct StabilityMap {
  std::vector<StabilityCombination> combinations;

  // Of all ratios predicted / measured. 1 and 0 for an empty map.
  [[nodiscard]] double worst_ratio() const;
  [[nodiscard]] std::size_t above() const;  // how many ratios exceed 1
};

// Deterministic; takes about as long as the CPU time in tools/program/cost/README.md.
StabilityMap measure_stability(const StabilityOptions& options = {});

// {"slipbench_stability": 1, "text": [...], "combinations": [{"case", "integrator", "mass_kg", "stiffness_scale", "k_normal",
// "damping_s", "omega", "predicted_s", "allowed_s", "measured_s", "ratio"}], "worst_ratio", "above", "remarks": [...]}
Json stability_json(const StabilityMap& map);

// A table for a terminal: of each set-up and integrator the least and the largest ratio, and the steps that it spans.
std::string stability_text(const StabilityMap& map);

}  // namespace slipbench::cost
