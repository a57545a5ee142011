// A trial's bodies and pads, stepped in time: what runs a trial need not know which kind of bench it steps.
#pragma once

#include <cstddef>
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

class HeldBox;  // sim/grasp/held_box.h

class Bench {
 public:
  virtual ~Bench() = default;

  [[nodiscard]] virtual std::size_t ticks() const = 0;                  // duration / time_step
  [[nodiscard]] virtual double time_step() const = 0;                   // s
  [[nodiscard]] virtual std::size_t stride(std::size_t pad) const = 0;  // ticks between readings of this pad's sensor

  // Advances to the next tick. The first call evaluates t = 0; call k (from 0) evaluates t = k * time_step.
  // Throws InputError when the run has gone wrong and cannot be gone on with.
  virtual void step() = 0;

  // Truth at the tick last stepped to.
  [[nodiscard]] virtual const ContactFrame& contact(std::size_t pad) const = 0;
  // All recorded bodies at that tick.
  [[nodiscard]] virtual const std::vector<NamedBody>& bodies() const = 0;
  // Whether the scene's motion turns the pads that ride on it.
  [[nodiscard]] virtual bool rotating() const = 0;
  // What the trial multiplies the scene's friction by.
  [[nodiscard]] virtual double friction_scale() const { return 1.0; }
  // The gripper and its box; null on a bench without.
  [[nodiscard]] virtual HeldBox* held_box() { return nullptr; }

 protected:
  Bench() = default;
  Bench(const Bench&) = default;
  Bench& operator=(const Bench&) = default;
};

}  // namespace slipbench
