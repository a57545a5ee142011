// A grasp: a gripper on an arm takes a box from a table, lifts it and may carry it about.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sim/core/pad_layout.h"
#include "sim/grasp/grasp.h"
#include "sim/mujoco/bodies/dynamic_simulation.h"
#include "sim/scene/scene.h"
#include "sim/simulation/simulation.h"

namespace slipbench {

// DynamicSimulation with the fingers of model_builder.h, whose carriages ride on the motion's arm, the box and a table. At the start the fingers are open, at rest, at
// a whole count that leaves the clearance: the loop closes them. The world's origin is the point between the pads, Z up (Grasp).
//
// Who steps it plays the loop between two steps, at the time of the tick last stepped to: when the gripper's read is due it is read and the
// controller asked, when its write is due the command is written. What is written acts from the gripper's own instant on (grasp.h), so that the result does not
// depend on the tick at which it was asked.
//
// Lifted: the box's lowest corner has been more than 1 mm over the table since the lift began, or more than a tenth of motion.distance where that
// is less. So a box with an edge on the table is not lifted, and neither is one that hops while the pads slip on it.
// Dropped: at the first tick after the box was lifted at which the table does not carry the box and a pad does not touch it; or, once the
// arm has risen, at which the table carries it. While the box stands, a pad that is off may come back: nothing is lost yet.
// Left behind: the arm has risen, and the box has not been lifted.
// An arm that a controller commands (motion guided) has never risen for good: the box may turn on the table, and be put down. So it is not said
// whether the box was lifted, and the box is dropped at the first tick at which the table does not carry it and a pad does not touch it.
//
// Besides the rules of watch.cc a run is ended when a pad presses harder than the fingers can make it: beyond twice the largest force that a
// finger's spring has reached, as a mass that falls onto a spring, and what stops a finger that closes at the fastest speed, v sqrt(k m).
class GraspSimulation final : public Simulation, public HeldBox {
 public:
  // `scene.grasp` must be there; the rest as DynamicSimulation's. The first sensor's pad is on the finger that feels; the others follow it, or
  // that of the other finger, second_pad_name.
  GraspSimulation(const Scene& scene, std::span<const PadLayout* const> pads, std::span<const double> output_rates,
                  std::uint64_t trial, const DynamicSimulationOptions& options = {});
  ~GraspSimulation() override;

  [[nodiscard]] std::size_t ticks(std::size_t pad) const override;
  [[nodiscard]] double time_step(std::size_t pad) const override;
  [[nodiscard]] std::size_t stride(std::size_t pad) const override;
  void step() override;
  [[nodiscard]] std::span<const std::size_t> stepped() const override;
  [[nodiscard]] const ContactFrame& contact(std::size_t pad) const override { return contact_part(pad, FramePart::all); }
  [[nodiscard]] const ContactFrame& contact_part(std::size_t pad, FramePart part) const override;
  void leave_slip_angle() override;
  // "arm", the sensor's pad under the sensor's name, "second_pad", "table" and "box". The box has a size, and the silicone pad that of its
  // face: width, height, 0.
  [[nodiscard]] const std::vector<NamedBody>& bodies() const override;
  [[nodiscard]] bool rotating() const override;

  [[nodiscard]] double friction_scale() const override;
  [[nodiscard]] HeldBox* held_box() override { return this; }

  [[nodiscard]] Gripper& gripper() override;
  [[nodiscard]] Guided* arm() override;
  [[nodiscard]] const GraspTruth& truth() const override;
  [[nodiscard]] double ideal_force() const override;
  [[nodiscard]] double lift_start() const override;

  // What was drawn for the trial.
  [[nodiscard]] const Grasp& grasp() const;

  [[nodiscard]] DynamicSimulation& dynamics();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace slipbench
