// The largest time step that a model with pads bears: predicted (stability.h), and measured by stepping it.
//
// Measured: the model stands still in its initial pose for one step, is kicked, and goes on. It diverges where the root of its kinetic
// energy comes to `growth` times that of the kick within `steps` steps, where MuJoCo warns of anything, or where a number is not
// finite. Nothing refuses a step that is too long. Under the limit the energy swings and does not grow: of one undamped mode, stepped velocity
// first, to 1/(1 - (h omega/2)^2) of the kick's, which is growth^2 = 1e6 at 5e-7 under the limit. Beyond it, at h = (1 + e) limit, a
// damped mode grows by 1 + 2 e a step or more (dl/dh at l = -1 in stability.h) and an undamped one by 1 + sqrt(8 e), RK4's by 1 + 4 e: 1,000
// steps find e = 0.5 %. So a measured limit is at most 0.5 % too large, and at most the bisection's 0.02 % too small.
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
  // `model`: MJCF text with pads as instances of `slipbench.field`, which must be registered (register_plugin.h), in a pose of
  // equilibrium. `kick` [nv]: velocities, in the order of the model's degrees of freedom; it should excite every mode and stay so small that
  // growth^2 times its energy lifts nothing off and lets nothing slip. Throws InputError when MuJoCo refuses the model.
  StepProbe(const std::string& model, std::span<const double> kick, const StepProbeOptions& options = {});
  ~StepProbe();

  // Of the fields as they stand in the initial pose, each element's tangent taken as its state says.
  [[nodiscard]] Vibration vibration();
  [[nodiscard]] double predicted_step();  // s

  // Whether a run with this step [s] stays bounded.
  [[nodiscard]] bool bounded(double step);
  // The largest step [s] that stays bounded, by bisection from twice the predicted one on; the parts 1/4, 1/2, 3/4 and 9/10 of it are
  // run as well, and the least that is not bounded counts. Infinite when nothing vibrates.
  [[nodiscard]] double measured_step();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace slipbench
