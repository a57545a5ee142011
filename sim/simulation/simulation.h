// A trial's bodies and pads, stepped in time: what runs a trial need not know which kind of simulation it steps.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "sim/core/contact_frame.h"
#include "sim/core/pose.h"

namespace slipbench {

// A body whose pose is recorded under truth/<name>.
struct NamedBody {
  std::string name;
  BodyState state;
  std::vector<double> size = {};  // [3] m, its extent along its own axes; empty: not said
};

class HeldBox;  // sim/grasp/grasp.h

// Every pad has ticks of its own, the k-th (from 0) at t = k * time_step (step_plan.h): those that it would have if it were alone, so that what it is told
// does not depend on who is beside it. The simulation goes from one instant at which a pad has a tick to the next.
class Simulation {
 public:
  virtual ~Simulation() = default;

  [[nodiscard]] virtual std::size_t ticks(std::size_t pad) const = 0;   // of the pad in the whole trial
  [[nodiscard]] virtual double time_step(std::size_t pad) const = 0;    // s
  [[nodiscard]] virtual std::size_t stride(std::size_t pad) const = 0;  // of the pad's ticks between readings of its sensor

  // Advances to the next instant; the first call evaluates t = 0. A trial is over when every pad has had its ticks.
  // Throws InputError when the run has gone wrong and cannot be gone on with.
  virtual void step() = 0;

  // The pads that have a tick at the instant last stepped to, in the scene's order. Stays until the next step.
  [[nodiscard]] virtual std::span<const std::size_t> stepped() const = 0;
  // Truth at the pad's latest tick.
  [[nodiscard]] virtual const ContactFrame& contact(std::size_t pad) const = 0;
  // The same frame, of which no more need be right than `part`: what nobody reads need not be worked out.
  [[nodiscard]] virtual const ContactFrame& contact_part(std::size_t pad, FramePart /*part*/) const { return contact(pad); }
  // From here on nobody reads labels at every tick, so that the slip's angle need not be added up.
  virtual void leave_slip_angle() {}
  // All recorded bodies at that instant.
  [[nodiscard]] virtual const std::vector<NamedBody>& bodies() const = 0;
  // Whether the scene's motion turns the pads that ride on it.
  [[nodiscard]] virtual bool rotating() const = 0;
  // What the trial multiplies the scene's friction by.
  [[nodiscard]] virtual double friction_scale() const { return 1.0; }
  // The gripper and its box; null on a simulation without.
  [[nodiscard]] virtual HeldBox* held_box() { return nullptr; }

 protected:
  Simulation() = default;
  Simulation(const Simulation&) = default;
  Simulation& operator=(const Simulation&) = default;
};

}  // namespace slipbench
