// One pad inside MuJoCo: an instance of the plugin `slipbench.field` in one mjData.
//
// All state that outlives a step is in mjData's plugin_state (plugin_state.h; except after
// keep_state()), so that mj_getState, mj_setState, mj_copyData and resets handle it. (MuJoCo's
// keyframes hold no plugin state: they restart the pads.) All other members are recomputed from it
// and from the kinematics (pad_kinematics.h) whenever either has changed.
//
// - A force is that of a trial from the last committed anchors (compute PASSIVE). It commits
//   nothing, so extra mj_forward calls, finite differences and the stages of RK4 do not change the
//   anchors.
// - `advance` commits the trial at the kinematics of the step's start: MuJoCo has not computed
//   newer ones by then.
// - A pad far from all that it may touch is idle: its elements are not evaluated, and its readings
//   (pad_readout.h) do not change. It stores its last pose, so that the step in which it comes back
//   is bit-identical to one without idling.
// - The springs obey the friction law of sim/contact; the dashpots are added to their force, and the
//   sum is kept inside the friction cone. Labels and sensors read the springs: the force that
//   deflects a unit's tip.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sim/api/contact_frame.h"
#include "sim/api/sensor.h"
#include "sim/contact/field.h"
#include "sim/core/pose.h"
#include "sim/mujoco/pads/implicit.h"
#include "sim/mujoco/pads/pad_config.h"
#include "sim/mujoco/pads/pad_kinematics.h"
#include "sim/mujoco/pads/pad_readout.h"
#include "sim/mujoco/pads/plugin_state.h"
#include "sim/mujoco/releases/mujoco_library.h"

namespace slipbench {

// Content of a pad's fields.
//
// - evaluate() leads from every phase to `evaluated`. From `committed` it need not load the state.
// - measure() leads from `evaluated` to `measured`, and commit() from both to `committed`.
// - New kinematics make a trial `outdated`. Another start of the step or another time are found by
//   evaluate(), which then repeats the trial.
// - After keep_state() the fields are the only copy of the state. evaluate() then refuses every
//   phase but `committed`.
enum class PadPhase : std::uint8_t {
  outdated,   // neither the committed state nor a trial of the present kinematics
  idle,       // likewise, and none is needed: add_force() has found nothing in reach
  committed,  // the committed state
  evaluated,  // the trial of the present kinematics
  measured,   // likewise, and labels and sensor have read it
};

class PadInstance {
 public:
  // Throws InputError if a geom cannot be touched or an effect does not fit it.
  PadInstance(ModelView model, int instance, PadConfig config, const PadCatalogue& catalogue);

  // Callbacks of MuJoCo (field_plugin.cc).
  // Adds the force of the pad's elements on its body and on the touched ones to qfrc_passive. Needs
  // positions and velocities.
  void add_force(ModelView model, DataView data);
  // Writes the sensordata of every sensor that refers to the instance.
  void write_sensors(ModelView model, DataView data);
  // Commits the trial of the current kinematics to the state.
  void commit(ModelView model, DataView data);
  // Copies the state that mj_copyData omits: all that a half-done step needs from its first half.
  void copy_from(const PadInstance& other) { computed_at_ = other.computed_at_; }
  // Draws every element, coloured by its state, with an arrow for the force on it.
  void draw(ModelView model, DataView data, SlipbenchScene* scene);

  // For the group of all pads (pad_group.h):
  // True if a step has been committed since the last reset.
  [[nodiscard]] bool placed(ModelView model, DataView data) const { return state(model, data).placed(); }
  // After add_force(): true if nothing is in reach, so that no field was evaluated.
  [[nodiscard]] bool idle() const { return phase_ == PadPhase::idle; }
  // After add_force(): number of elements that touch the geom of field `k`.
  [[nodiscard]] std::size_t touching(std::size_t k) const { return idle() ? 0 : fields_[k].touching(); }
  // Describes the pad for implicit.h before any motion: one entry per touched geom.
  void describe(ModelView model, std::vector<ImplicitPad>& pads) const;
  // Instead of add_force(): starts the trial at the present pose, one entry per touched geom. The
  // solver owns the fields until forget_trial().
  void begin_implicit(ModelView model, DataView data, std::vector<ImplicitContact>& contacts);
  void forget_trial() { phase_ = PadPhase::outdated; }
  // The solver's memory of this pad, in plugin_state.
  [[nodiscard]] std::span<double> implicit_memory(ModelView model, DataView data) const { return state(model, data).implicit(); }

  // For scenes of this program (sim/mujoco/bodies):
  // The last committed contact: at the time of the state before the step. Events are those of that
  // step. Available for pads with a sensor in the model; for others only after watch(), which must
  // be called before the first step, since their contact could not be read.
  [[nodiscard]] const ContactFrame& truth(FramePart part) { return readout_.truth(fields_, part); }
  void disable_slip_angle() { readout_.disable_slip_angle(); }
  void watch() { readout_.watch(); }
  // Excludes the fields' state from plugin_state from here on, which takes a quarter of a large
  // pad's time. For the sole user of an mjData, who steps it in sequence from its start, explicitly
  // and by a one-stage integrator; call it between two steps. mj_setState, mj_copyData and resets
  // then do not include this state, and a second trial from the same state is a std::logic_error.
  // The plugin's sensor is then not read, and its sensordata does not change.
  void keep_state();
  [[nodiscard]] Sensor& sensor() { return readout_.sensor(); }
  [[nodiscard]] const PadConfig& config() const { return config_; }
  [[nodiscard]] std::span<const Field> fields() const { return fields_; }
  [[nodiscard]] const PadKinematics& kinematics() const { return kinematics_; }
  // After add_force(): force and torque of the elements of field `k` on the pad, springs and
  // dashpots, in the frame of its surface.
  [[nodiscard]] const Wrench& applied(std::size_t k) const { return applied_[k]; }
  // After a commit and until the next kinematics: pose and velocity of the pad in the frame of
  // field `k`'s surface.
  [[nodiscard]] const Pose& pad_in_surface(std::size_t k) const { return kinematics_.touched()[k].pad_in_surface; }
  [[nodiscard]] const Twist& motion(std::size_t k) const { return kinematics_.touched()[k].motion; }

 private:
  [[nodiscard]] PluginState state(ModelView model, DataView data) const;
  [[nodiscard]] bool holds_trial() const { return phase_ == PadPhase::evaluated || phase_ == PadPhase::measured; }
  void locate(ModelView model, DataView data);
  [[nodiscard]] bool is_idle(ModelView model, DataView data, const PluginState& state, double time);
  void evaluate(const PluginState& state, double time);
  void load(const PluginState& state);
  void save(const PluginState& state);
  void step_fields(double dt);
  void measure(const PluginState& state);
  void check_model(ModelView model) const;
  void check_site(ModelView model, const PluginState& state);
  [[noreturn]] void refuse(const std::string& what) const;
  void refuse_lost(ModelView model) const;
  void refuse_overcompressed(ModelView model) const;
  void follow_shapes(ModelView model);

  PadConfig config_;
  int instance_;
  double step_;  // s
  PadReadout readout_;
  PadKinematics kinematics_;
  std::vector<Field> fields_;  // one per touched geom
  PluginStateLayout layout_;
  bool may_be_idle_;          // readings without contact never change, and only the sensor reads it
  bool keeps_state_ = false;  // keep_state()
  bool warned_ = false;       // of the site

  // s, time of the kinematics: MuJoCo is at the end of the step when it calls for a commit.
  double computed_at_ = 0.0;

  PadPhase phase_ = PadPhase::outdated;
  double time_ = 0.0, dt_ = 0.0;    // s, of the last trial: its end, and since the commit
  std::vector<double> began_with_;  // PluginState::start() of the last trial
  std::vector<double> ended_with_;  // the fields' state after the trial, for the implicit solver
  std::vector<Wrench> applied_;     // of the last add_force()
  std::vector<Pose> poses_;         // space for the pad in each surface, and its motion there
  std::vector<Twist> motions_;
};

}  // namespace slipbench
