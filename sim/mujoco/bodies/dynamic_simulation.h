// A scene whose bodies move by forces: MuJoCo steps them, with the pads as fields or as articulated
// pillars.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "sim/api/contact_frame.h"
#include "sim/api/pad_layout.h"
#include "sim/api/simulation.h"
#include "sim/core/pose.h"
#include "sim/mujoco/modes/dynamic_options.h"
#include "sim/scene/scene.h"

struct mjData_;
struct mjModel_;

namespace slipbench {

// Steps bodies by mj_step, or those of a grasp by FreeBodies (free_bodies.h). Fields are instances
// of the plugin `slipbench.field` (model_builder.h), which must be registered before. The stage,
// and the sensors that ride on it, follow the motion exactly: its state is overwritten at every
// tick.
//
// Truth at tick k is that of the state at k * time_step: with MuJoCo's one-stage integrators the
// state at the start of the step k -> k + 1; with RK4 that of the last stage of the step k - 1 ->
// k, which is accurate to third order in the step.
//
// The step of an explicit field is at most longest_explicit_step() (stability.h), evaluated at the
// start with every element of every pad stuck. When an element touches, the limit is evaluated
// again for the touching elements, and a step a third beyond it (h omega = 1: a slide starts to be
// inaccurate) ends the run. `time_step: auto` takes the longest valid step, at most the fastest
// sensor's sampling time. Implicit fields have no such limit.
//
// With `fidelity: mujoco_contact` the pads are articulated as well, but with the contact and the
// options of the scene's key `contact`: any step is taken, other contacts are allowed, and the
// results are reported as they are.
//
// With `fidelity: articulated` the same scene has MuJoCo bodies, joints and contacts for the pads'
// elements (articulated.h). Tips inside the touched surface at the start are pressed in and settled
// before t = 0, with all else held and without weights. Truth at tick k is that at the end of the
// step k - 1 -> k. The step is at most longest_articulated_step(). Any other contact of MuJoCo with
// friction ends the run, since the pads' recipe makes its friction wrong.
//
// Sensors that follow a pad (pad_follower.h) have their own ticks, read its contact, and change
// nothing: the step depends only on the pads that exert forces.
//
// A diverged run ends in an InputError with the time: on any warning of MuJoCo (autoreset is off),
// and by the rules of watch.h.
class DynamicSimulation final : public Simulation {
 public:
  // As for StageSimulation. Pads beyond the last of `output_rates` touch and push, but only
  // followers read them. Throws SceneValueError if the scene, its model and the step are
  // incompatible.
  DynamicSimulation(const Scene& scene, std::span<const PadLayout* const> pads, std::span<const double> output_rates,
                    std::uint64_t trial, const DynamicSimulationOptions& options = {});
  ~DynamicSimulation() override;

  [[nodiscard]] std::size_t ticks(std::size_t pad) const override;
  [[nodiscard]] double time_step(std::size_t pad) const override;
  [[nodiscard]] std::size_t stride(std::size_t pad) const override;
  void step() override;
  [[nodiscard]] std::span<const std::size_t> stepped() const override;
  [[nodiscard]] const ContactFrame& contact(std::size_t pad) const override { return contact_part(pad, FramePart::all); }
  [[nodiscard]] const ContactFrame& contact_part(std::size_t pad, FramePart part) const override;
  void disable_slip_angle() override;
  // "pad" if sensors ride on the stage, the pad of every sensor with a site under the sensor's
  // name, the scene's own bodies, and those of the model that have a free joint or are named,
  // separated by spaces, in its custom text "slipbench.record".
  [[nodiscard]] const std::vector<NamedBody>& bodies() const override;
  // True if the stage rotates. Pads at sites rotate by forces, which is not reported here.
  [[nodiscard]] bool rotating() const override;

  // True if the current instant is a tick of the simulation (also at the start); otherwise it is a
  // tick of followers only, before the tick to which MuJoCo has already been stepped.
  [[nodiscard]] bool at_tick() const;

  // Returns the sum of the normal forces on a pad at its latest tick [N]. `carrying`: index among
  // the pads that exert forces, in the scene's order, unread ones included.
  [[nodiscard]] double normal_force(std::size_t carrying) const;
  // The same for MuJoCo's own contacts between two bodies of the model; 0 without contact.
  [[nodiscard]] double contact_normal_force(const std::string& body, const std::string& other) const;

  // Sets the acceleration of the carriage of finger 0 or 1 [m/s2, rad/s2], in the world, from the
  // next step on. Implicit springs need it.
  void set_carriage_acceleration(std::size_t finger, const Eigen::Matrix<double, 6, 1>& acceleration);

  // MuJoCo's model and data.
  [[nodiscard]] const mjModel_* model() const;
  [[nodiscard]] mjData_* data() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace slipbench
