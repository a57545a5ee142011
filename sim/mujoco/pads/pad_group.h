// All pads of one mjData.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sim/mujoco/pads/implicit.h"
#include "sim/mujoco/pads/pad_instance.h"
#include "sim/mujoco/releases/mujoco_library.h"

namespace slipbench {

// All pads of one mjData: tasks that need more than one pad.
//
// - Explicit pads allow no step with h omega > 1 (stability.h), with omega of all of them on their
//   bodies. It is evaluated for the touching elements, taken as stuck, whenever more of them touch
//   than in the last step. A too long step is refused from the second one on: the first one is also
//   taken by MuJoCo's compiler, before the caller could set its length.
// - Implicit pads are solved together (implicit.h).
class PadGroup {
 public:
  // `pads`: every pad of the mjData, in MuJoCo's order; they must outlive the group. Throws
  // InputError if implicit pads do not fit the model or each other.
  PadGroup(ModelView model, const std::vector<PadInstance*>& pads);

  // After every explicit pad has added its force: refuses a too long step (InputError), and adds
  // the force of the implicit pads.
  void add_force(ModelView model, DataView data);
  // After the step has computed its acceleration.
  void finish(ModelView model, DataView data);
  // After finish(): adds the force that the implicit pads applied in the step to `force` [nv]. Must
  // be called before the kinematics are updated.
  void add_applied(ModelView model, DataView data, double* force) const;
  // Copies the state that mj_copyData omits.
  void copy_from(const PadGroup& other);

  // Returns the longest step [s] for the explicit pads with all their elements touching at
  // once; infinite without such pads.
  [[nodiscard]] double longest_step(ModelView model, DataView data) const;

  // For a host that checks the step itself.
  void allow_long_steps() { guarded_ = false; }
  // Number of steps whose implicit prediction did not converge and used the best guess.
  [[nodiscard]] std::size_t unconverged_steps() const { return unconverged_; }

 private:
  void refuse_long_step(ModelView model, DataView data);

  std::vector<PadInstance*> explicit_, implicit_;
  bool guarded_ = true;
  std::string pending_;  // reason for refusing the next step
  // Elements of each explicit pad and touched geom in the last step, and in this one.
  std::vector<std::size_t> touching_, touching_now_;
  std::vector<ImplicitPad> described_;
  std::vector<ImplicitContact> contacts_;  // of the step in progress
  ImplicitFields solver_;
  std::vector<double> memory_;  // of the solver, gathered from the pads' states
  std::size_t unconverged_ = 0;
};

}  // namespace slipbench
