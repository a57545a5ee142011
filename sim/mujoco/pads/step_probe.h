// The largest stable time step of a model with pads: predicted (stability.h), and measured by
// stepping it.
//
// Measurement: the model is at rest in its initial pose for one step, is kicked, and goes on. It
// diverges if the root of its kinetic energy reaches `growth` times that of the kick within `steps`
// steps, if MuJoCo warns of anything, or if a number is not finite. A too long step is not refused.
// Below the limit the energy swings without growing: for one undamped mode, stepped velocity first,
// to 1/(1 - (h omega/2)^2) of the kick's, which is growth^2 = 1e6 at 5e-7 below the limit. Beyond
// it, at h = (1 + e) limit, a damped mode grows by 1 + 2 e per step or more (dl/dh at l = -1 in
// stability.h), an undamped one by 1 + sqrt(8 e), and RK4's by 1 + 4 e: 1,000 steps detect e = 0.5
// %. So a measured limit is at most 0.5 % too large, and at most the bisection's 0.02 % too small.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "sim/mujoco/linear/stability.h"

namespace slipbench {

struct StepProbeOptions {
  int steps = 1000;
  double growth = 1e3;
  double resolution = 2e-4;  // of the bisection, share of the step
};

class StepProbe {
 public:
  // `model`: MJCF text with pads as instances of `slipbench.field`, which must be registered
  // (register_plugin.h), in a pose of equilibrium. `kick` [nv]: velocities, in the order of the
  // model's degrees of freedom; it should excite every mode, and be so small that growth^2 times
  // its energy causes no separation and no slip. Throws InputError if MuJoCo refuses the model.
  StepProbe(const std::string& model, std::span<const double> kick, const StepProbeOptions& options = {});
  ~StepProbe();

  // For the fields in the initial pose, with each element's tangent according to its state.
  [[nodiscard]] Vibration vibration();
  [[nodiscard]] double predicted_step();  // s

  // True if a run with this step [s] stays bounded.
  [[nodiscard]] bool bounded(double step);
  // Returns the largest step [s] that stays bounded, by bisection starting at twice the predicted
  // one; the fractions 1/4, 1/2, 3/4 and 9/10 of it are run as well, and the least unbounded one
  // counts. Infinite if nothing vibrates.
  [[nodiscard]] double measured_step();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace slipbench
