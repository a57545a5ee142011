// Interface of the ways in which bodies are stepped together with their pads.
#pragma once

#include <cstddef>
#include <vector>

#include <mujoco/mujoco.h>
#include <Eigen/Core>

#include "sim/api/contact_frame.h"
#include "sim/contact/contact_labels.h"
#include "sim/mujoco/modes/dynamic_world.h"
#include "sim/mujoco/modes/watch.h"

namespace slipbench {

class RunWatch;

// Properties of a mode on which the rules of watch.h depend.
struct WatchSettings {
  WatchLimits limits;
  bool judge_fields = true;  // the energy stored in the pads is known
  // A step evaluates these forces between its two ends:
  bool pads_predicted = false;
  bool constraints_predicted = false;
};

// Energies of all pads at one tick.
struct PadEnergy {
  double elastic = 0.0;    // J
  double slip_loss = 0.0;  // J, in the last step, with the speed at its end
};

// The pads that exert forces, in the scene's order. One class per mode.
class DynamicPads {
 public:
  DynamicPads() = default;
  DynamicPads(const DynamicPads&) = delete;
  DynamicPads& operator=(const DynamicPads&) = delete;
  virtual ~DynamicPads() = default;

  // Prepares the start of the run, after the bodies to record have been selected.
  virtual void begin() = 0;
  // Steps the world so that truth() is that of `tick`, and checks it.
  virtual void take_tick(std::size_t tick, RunWatch& watch) = 0;

  [[nodiscard]] virtual const ContactFrame& truth(std::size_t pad, FramePart part) const = 0;
  [[nodiscard]] virtual double normal_force(std::size_t pad) const = 0;  // N, at the latest tick
  virtual void disable_slip_angle() {}
  [[nodiscard]] virtual std::vector<int> sites() const = 0;

  // For RunWatch:
  [[nodiscard]] virtual WatchSettings watch_settings(const WatchLimits& limits) const = 0;
  // True for a body that belongs to a pad.
  [[nodiscard]] virtual bool is_part(int /*body*/) const { return false; }
  // Computes the generalized force [nv] of all pads in the last step.
  virtual void find_force(Eigen::VectorXd& force) const = 0;
  // Reads the pads at a tick.
  virtual PadEnergy read_energy() { return {}; }
  // Returns the pads' force on a free body [N], at the tick last read. `dof` is the first of its
  // six, and `force` the result of find_force().
  [[nodiscard]] virtual Eigen::Vector3d force_on(int /*body*/, int /*dof*/, const Eigen::VectorXd& /*force*/) const {
    return Eigen::Vector3d::Zero();
  }
  // Returns the kinetic energy [J] with the generalized velocities `v` [nv]. `space`: [nv].
  [[nodiscard]] virtual double kinetic_energy(const DynamicWorld& world, const Eigen::VectorXd& v, Eigen::VectorXd& space) const {
    mj_mulM(world.m(), world.d(), space.data(), v.data());
    return 0.5 * v.dot(space);
  }
};

}  // namespace slipbench
