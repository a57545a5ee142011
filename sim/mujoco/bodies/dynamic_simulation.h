// A scene whose bodies move by forces: MuJoCo steps them, with the pads as fields or as articulated pillars.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sim/core/contact_frame.h"
#include "sim/core/pad_layout.h"
#include "sim/mujoco/bodies/watch.h"
#include "sim/scene/scene.h"
#include "sim/simulation/simulation.h"

struct mjModel_;
struct mjData_;

namespace slipbench {

struct Hand;  // gripper_model.h

struct DynamicSimulationOptions {
  bool refuse_long_steps = true;  // false: for tests of the watch, which must see what a step that is too long does
  WatchLimits limits{};
  FieldSolver hand_solver = FieldSolver::explicit_springs;  // of a grasp (average_acceleration.h)
  const Hand* hand =
      nullptr;  // the fingers of a grasp, whose springs whoever steps the simulation applies; needed in the constructor only
};

// Bodies by mj_step; fields by the plugin `slipbench.field` (model_builder.h), which must be registered before; the stage, and the
// sensors that ride on it, exactly as the motion says: its state is overwritten at every tick.
//
// Truth at tick k is that of the state at k * time_step: with MuJoCo's one-stage integrators the state that the step k -> k + 1
// begins with, with RK4 that of the last stage of the step k - 1 -> k, which is of the third order in the step.
//
// The step: an explicit field bears no longer one than longest_explicit_step() (linear_model.h), taken at the start with every element
// of every pad stuck. Where an element touches it is worked out again, for the elements that touch, and a step a third beyond it (h
// omega = 1: there a slide begins to come out wrong) ends the run. `time_step: auto` takes
// the longest that fits, at most the fastest sensor's sampling time. Implicit fields have no such limit.
//
// With `fidelity: mujoco_contact` they are such pads too, but with the contact and the options of the scene's key `contact`: any
// step is taken, other contacts are allowed, and what comes of it is told as it is.
//
// With `fidelity: articulated` the same scene has MuJoCo bodies, joints and contacts for the pads' elements (articulated.h). Tips that
// begin inside what they touch are pressed in and settled, everything else held and without weights, before t = 0. Truth at tick k is
// that of the step k - 1 -> k, at its end. The step is longest_articulated_step() at most. No other contact of MuJoCo's with friction
// may touch: it ends the run, for the pads' recipe makes its friction wrong.
//
// Sensors that follow a pad (pad_follower.h) have ticks of their own, read its contact, and change nothing: the step is that of what carries.
//
// A run that has gone wrong ends in an InputError, with the time: any warning of MuJoCo (autoreset is off), and the rules of
// watch.h.
class DynamicSimulation final : public Simulation {
 public:
  // As StageSimulation's, but for pads after the last of `output_rates`: they touch and push, and a follower alone reads them. Throws SceneValueError where the scene, its model and the step do not suit each other.
  DynamicSimulation(const Scene& scene, std::span<const PadLayout* const> pads, std::span<const double> output_rates,
                    std::uint64_t trial, const DynamicSimulationOptions& options = {});
  ~DynamicSimulation() override;

  [[nodiscard]] std::size_t ticks(std::size_t pad) const override;
  [[nodiscard]] double time_step(std::size_t pad) const override;
  [[nodiscard]] std::size_t stride(std::size_t pad) const override;
  void step() override;
  [[nodiscard]] std::span<const std::size_t> stepped() const override;
  [[nodiscard]] const ContactFrame& contact(std::size_t pad) const override;
  // "pad" where sensors ride on the stage, the pad of every sensor with a site under the sensor's name, the scene's own bodies, and
  // those of the model that have a free joint or that its custom text "slipbench.record" names, with spaces between them.
  [[nodiscard]] const std::vector<NamedBody>& bodies() const override;
  // Whether the stage turns; pads at sites turn as forces make them, which is not said here.
  [[nodiscard]] bool rotating() const override;

  // Whether the instant last stepped to is a tick of what carries (and at the start); else it is one of followers alone, before the tick that
  // MuJoCo has been stepped to already.
  [[nodiscard]] bool at_tick() const;

  // The sum of the normal forces on a pad at its latest tick [N]. `carrying`: counted among the pads that press, in the scene's
  // order, unread ones included.
  [[nodiscard]] double normal_force(std::size_t carrying) const;
  // The same of MuJoCo's own contacts between two bodies of the model; 0 where they do not touch.
  [[nodiscard]] double contact_normal_force(const std::string& body, const std::string& other) const;

  // The acceleration of what the spring of finger 0 or 1 hangs on [m/s2, rad/s2], in the world, for the steps from now on. Implicit springs need it.
  void tell_carriage(std::size_t finger, const Eigen::Matrix<double, 6, 1>& acceleration);

  // What MuJoCo has.
  [[nodiscard]] const mjModel_* model() const;
  [[nodiscard]] mjData_* data() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace slipbench
