// A grasp: a gripper on an arm takes a box from a table, lifts it and may move it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sim/api/pad_layout.h"
#include "sim/api/simulation.h"
#include "sim/grasp/grasp.h"
#include "sim/mujoco/bodies/dynamic_simulation.h"
#include "sim/scene/scene.h"

namespace slipbench {

// DynamicSimulation with the fingers of model_builder.h, whose carriages ride on the motion's arm,
// the box and a table. At the start the fingers are at rest, open at a whole count that leaves the
// clearance: the loop closes them. The world's origin is the point between the pads, Z up (Grasp).
//
// The caller of step() runs the control loop between two steps, at the time of the last tick: when
// the gripper's read is due it reads and calls the controller; when its write is due it writes the
// command. A command acts from the gripper's own instant on (grasp.h), so that the result does not
// depend on the tick at which it is handled.
//
// Lifted: the box's lowest corner has been more than 1 mm over the table since the lift began, or
// more than a tenth of motion.distance if that is less. So a box with an edge on the table is not
// lifted, and neither is one that hops while the pads slip on it.
//
// Dropped: at the first tick after the box was lifted at which the table does not carry the box and
// a pad does not touch it; or, once the arm has risen, at which the table carries it. While the box
// stands, a separated pad may touch again: nothing is lost yet.
//
// Left behind: the arm has risen without lifting the box.
// An arm that a controller commands (motion guided) never ends its lift: the box may rotate on the
// table, and be put down. So the truth does not say whether the box was lifted, and the box is
// dropped at the first tick at which the table does not carry it and a pad does not touch it.
//
// In addition to the rules of watch.cc a run ends when a pad presses harder than the fingers can:
// beyond twice the largest force of a finger's spring so far, as for a mass that falls onto a
// spring, plus the force that stops a finger closing at the fastest speed, v sqrt(k m).
class GraspSimulation final : public Simulation, public HeldBox {
 public:
  // `scene.grasp` must be set; the rest as for DynamicSimulation. The first sensor's pad is on the
  // finger with the sensor; the other sensors follow it, or the pad of the other finger,
  // second_pad_name.
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
  void disable_slip_angle() override;
  // "arm", the sensor's pad under the sensor's name, "second_pad", "table" and "box". The box has a
  // size, and the silicone pad that of its face: width, height, 0.
  [[nodiscard]] const std::vector<NamedBody>& bodies() const override;
  [[nodiscard]] bool rotating() const override;

  [[nodiscard]] double friction_scale() const override;

  [[nodiscard]] Gripper& gripper() override;
  [[nodiscard]] Guided* arm() override;
  [[nodiscard]] const GraspTruth& truth() const override;
  [[nodiscard]] double ideal_force() const override;
  [[nodiscard]] double lift_start() const override;

  // The trial's random draws.
  [[nodiscard]] const Grasp& grasp() const;

  [[nodiscard]] DynamicSimulation& dynamics();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace slipbench
