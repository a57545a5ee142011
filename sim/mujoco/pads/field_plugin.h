// The pads of the engine plugin `slipbench.field`, for those who step the model themselves.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <mujoco/mujoco.h>

#include "sim/mujoco/pads/implicit.h"
#include "sim/mujoco/pads/pad_instance.h"

namespace slipbench {

// All pads of one mjData together: what one of them cannot know alone.
//
// - Explicit pads bear no step with h omega > 1 (stability.h), omega that of all of them on their bodies. It is worked out for the elements
//   that touch, taken as stuck, whenever more of them touch than in the step before. A step that is too long is refused from the second one
//   on: the first is also taken by MuJoCo's compiler, before the caller could set its length.
// - Implicit pads are solved together (implicit.h).
class PadGroup {
 public:
  // `pads`: every pad of the mjData, in MuJoCo's order; they must outlive the group. Throws InputError when implicit pads do not suit the
  // model or each other.
  PadGroup(const mjModel* model, const std::vector<PadInstance*>& pads);

  // After every explicit pad has added its force: refuses a step that is too long (InputError), and adds the force of the implicit pads.
  void add_force(const mjModel* model, mjData* data);
  // When the step has found its acceleration.
  void finish(const mjModel* model, mjData* data);
  // After finish(): adds to `force` [nv] what the implicit pads applied in the step. Before anything moves the kinematics on.
  void add_applied(const mjModel* model, mjData* data, mjtNum* force) const;
  // What mj_copyData does not copy.
  void copy_from(const PadGroup& other);

  // The longest step [s] that the explicit pads bear with all their elements touching at once; infinite without such pads.
  [[nodiscard]] double longest_step(const mjModel* model, mjData* data) const;

  // For a host that sees to the step itself.
  void allow_long_steps() { guarded_ = false; }
  // Steps whose implicit prediction did not meet its tolerance and stood on the best guess.
  [[nodiscard]] std::size_t unconverged_steps() const { return unconverged_; }

 private:
  void refuse_long_step(const mjModel* model, mjData* data);

  std::vector<PadInstance*> explicit_, implicit_;
  bool guarded_ = true;
  std::string pending_;  // why the next step is to be refused
  std::vector<std::size_t> touching_,
      touching_now_;  // elements of each explicit pad and touched geom in the step before, and in this one
  std::vector<ImplicitPad> described_;
  std::vector<ImplicitContact> contacts_;  // of the step in progress
  ImplicitFields solver_;
  std::vector<double> memory_;  // of the solver, gathered from the pads' states
  std::size_t unconverged_ = 0;
};

// The pad of a plugin instance in `data`; null when the instance is another plugin's.
PadInstance* pad_of(const mjModel* model, const mjData* data, int instance);

// What all pads of `data` share; null when there is none.
PadGroup* pad_group_of(const mjModel* model, const mjData* data);

}  // namespace slipbench
