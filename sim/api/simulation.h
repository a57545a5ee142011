// A trial's bodies and pads, stepped in time. Code that runs a trial does not depend on the kind of
// simulation.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "sim/api/contact_frame.h"
#include "sim/core/pose.h"

namespace slipbench {

// A body whose pose is recorded under truth/<name>.
struct NamedBody {
  std::string name;
  BodyState state;
  std::vector<double> size = {};  // [3] m, extent along its own axes; empty: not given
};

// Every pad has its own ticks, the k-th (from 0) at t = k * time_step (step_plan.h). The ticks do
// not depend on other pads, and so neither do the results of a pad. The simulation advances from
// one instant at which a pad has a tick to the next.
class Simulation {
 public:
  virtual ~Simulation() = default;

  // of the pad in the whole trial
  [[nodiscard]] virtual std::size_t ticks(std::size_t pad) const = 0;
  [[nodiscard]] virtual double time_step(std::size_t pad) const = 0;  // s
  // the pad's ticks per sensor reading
  [[nodiscard]] virtual std::size_t stride(std::size_t pad) const = 0;

  // Advances to the next instant; the first call evaluates t = 0. A trial is over when every pad
  // has had its ticks. Throws InputError if the run has diverged and cannot continue.
  virtual void step() = 0;

  // The pads with a tick at the current instant, in the scene's order. Valid until the next step.
  [[nodiscard]] virtual std::span<const std::size_t> stepped() const = 0;
  // Truth at the pad's latest tick.
  [[nodiscard]] virtual const ContactFrame& contact(std::size_t pad) const = 0;
  // The same frame, of which at least `part` is valid: parts that are not read are not computed.
  [[nodiscard]] virtual const ContactFrame& contact_part(std::size_t pad, FramePart /*part*/) const { return contact(pad); }
  // Stops accumulating the angle of the slip, because labels are no longer read at every tick.
  virtual void disable_slip_angle() {}
  // The recorded bodies at the current instant.
  [[nodiscard]] virtual const std::vector<NamedBody>& bodies() const = 0;
  // True if the scene's motion rotates the pads that ride on it.
  [[nodiscard]] virtual bool rotating() const = 0;
  // The trial's factor on the scene's friction.
  [[nodiscard]] virtual double friction_scale() const { return 1.0; }

 protected:
  Simulation() = default;
  Simulation(const Simulation&) = default;
  Simulation& operator=(const Simulation&) = default;
};

}  // namespace slipbench
