// One pad inside MuJoCo: what the plugin `slipbench.field` does for one instance in one mjData.
//
// Everything that outlives a step is in mjData's plugin_state (unless keep_state() has been called), so that mj_getState,
// mj_setState, mj_copyData and resets carry it.
// (MuJoCo's keyframes hold no plugin state: they start the pads afresh.) What stands in this object besides is worked out from there
// and from the kinematics again whenever either has changed.
//
// - A force is that of a trial from the anchors committed last (compute PASSIVE). It commits nothing, so extra mj_forward calls,
//   finite differences and the stages of RK4 leave the anchors alone.
// - `advance` commits the trial of the kinematics that the step began with: MuJoCo has not computed newer ones by then.
// - A pad far from all that it may touch rests: no element is looked at, and what it reads stays. It remembers where it was, so that the step
//   in which it comes back is to the bit what it would have been.
// - The springs obey the friction law of sim/field; the dashpots are added to their force, and the sum is held on the friction
//   cone. Labels and sensors see the springs: what a unit's tip is deflected by.
//
// sensordata of one instance: the values of the sensor, in the order of its channels. With truth="true" these follow, N the
// number of units:
//   unit_state [N] (0 detached, 1 stick, 2 slip, 3 partial), slip_velocity [N,2] m/s, slip_distance [N] m, margin [N],
//   contact_force [N,3] N, state and state_micro (0 none, 1 non-slip, 2 incipient, 3 gross), stuck_fraction
// margin of a unit that does not touch and stuck_fraction without contact are 1, or NaN with unloaded="nan".
// They are those of the state before the step, as all of MuJoCo's sensordata.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <mujoco/mujoco.h>

#include "sim/core/contact_frame.h"
#include "sim/core/sensor.h"
#include "sim/field/contact_labels.h"
#include "sim/field/field.h"
#include "sim/mujoco/linear/stability.h"
#include "sim/mujoco/pads/implicit.h"
#include "sim/mujoco/pads/pad_config.h"
#include "sim/mujoco/pads/pad_misuse.h"

namespace slipbench {

// How many numbers an instance keeps in plugin_state, and how many it writes to sensordata. MuJoCo asks before the model has its
// meshes. pad_state_size() throws InputError when an effect does not suit a geom.
std::size_t pad_state_size(const mjModel* model, const PadConfig& config, const PadCatalogue& catalogue);
std::size_t pad_sensor_size(const PadConfig& config, const PadCatalogue& catalogue);

// A layout whose dashpots are left to the instance: it knows the velocities, which a field would have to guess.
PadLayout without_dashpots(PadLayout layout);

class PadInstance {
 public:
  // Throws InputError when a geom cannot be touched or an effect does not suit it.
  PadInstance(const mjModel* model, int instance, PadConfig config, const PadCatalogue& catalogue);

  // Adds the force of the pad's elements on its body and on the touched ones to qfrc_passive. Needs positions and velocities.
  void add_force(const mjModel* model, mjData* data);
  // Writes the sensordata of every sensor that refers to the instance.
  void write_sensors(const mjModel* model, mjData* data);
  // Makes the trial of the current kinematics the state.
  void commit(const mjModel* model, mjData* data);
  // Takes over what mj_copyData does not: all that a step which is half done needs of its first half.
  void copy_from(const PadInstance& other) { computed_at_ = other.computed_at_; }

  // For the group of all pads (pad_group.h):
  // Whether a step has been committed since the last reset.
  [[nodiscard]] bool placed(const mjModel* model, mjData* data) const;
  // After add_force(): how many elements touch the geom of field `k`.
  [[nodiscard]] std::size_t touching(std::size_t k) const { return rested_ ? 0 : fields_[k].touching(); }
  // The tangent of every touched geom's elements that touch in the trial, taken as stuck.
  void add_touching_tangents(const mjModel* model, const mjData* data, std::vector<PadOnBodies>& bodies,
                             std::vector<PadTangent>& tangents) const;
  // The pad's tangent with all elements stuck on that body among the touched ones on which it vibrates fastest, put down on it where it is away.
  void add_stuck_tangent(const mjModel* model, mjData* data, std::vector<PadOnBodies>& bodies,
                         std::vector<PadTangent>& tangents) const;
  // What implicit.h wants to know of a pad before there is any motion: one entry a touched geom.
  void describe(const mjModel* model, std::vector<ImplicitPad>& pads) const;
  // Instead of add_force(): the trial at the present pose, one entry a touched geom. The fields are the solver's until forget_trial().
  void begin_implicit(const mjModel* model, mjData* data, std::vector<ImplicitContact>& contacts);
  void forget_trial() { evaluated_ = fields_hold_state_ = false; }
  // The solver's memory of this pad, in plugin_state.
  [[nodiscard]] std::span<double> implicit_memory(const mjModel* model, mjData* data) const {
    return parts(model, data).implicit;
  }

  // Draws every element, coloured by its state, with an arrow for the force on it.
  void draw(const mjModel* model, mjData* data, mjvScene* scene);

  // The contact as committed last: at the time of the state before the step. Events are those of that step. Kept for pads that a
  // sensor of the model refers to; for others only after watch(), to be called before the first step, since it could not be read.
  [[nodiscard]] const ContactFrame& truth() const { return labels_.frame(); }
  void watch() { watched_ = true; }
  // Leaves the fields' state out of plugin_state from here on, which a large pad spends a quarter of its time on. For the only user of an mjData,
  // who steps it straight on from its beginning, explicitly and by an integrator of one stage: mj_setState, mj_copyData and resets then do not
  // carry it, and a second trial from the same state is refused. The sensor of the plugin is then not read, and its sensordata stays.
  void keep_state() { keeps_state_ = true; }
  [[nodiscard]] Sensor& sensor() { return *sensor_; }
  [[nodiscard]] const PadConfig& config() const { return config_; }
  [[nodiscard]] std::span<const Field> fields() const { return fields_; }
  // After a commit and until the next kinematics: where the pad was in the frame of the surface that field `k` meets, and how it moved.
  [[nodiscard]] const Pose& pad_in_surface(std::size_t k) const { return touched_[k].pad_in_surface; }
  [[nodiscard]] const Twist& motion(std::size_t k) const { return touched_[k].motion; }

 private:
  // A touched geom, as the field sees it.
  struct Touched {
    int geom;
    int body;
    Pose surface_in_geom;
    Surface shape;
    SiteWatch watch;
    double reach;  // m, between the origins of pad and geom, beyond which nothing touches; 0: not known
    Pose pad_in_surface{};
    Twist motion{};  // of the pad in the surface's frame
  };
  // Parts of the instance's share of plugin_state. `fields`: the fields' states, where the pad and all that it may
  // touch were when it was last found at rest, and what it may leave out.
  struct Parts {
    std::span<double> header, fields, implicit, memory, held, truth;
  };

  [[nodiscard]] Parts parts(const mjModel* model, mjData* data) const;
  bool locate(const mjModel* model, const mjData* data);
  [[nodiscard]] bool sees_the_same(const mjModel* model, const mjData* data);
  void evaluate(const Parts& state, double time);
  [[nodiscard]] bool rests(const mjModel* model, const mjData* data, const Parts& state, double time);
  void rest(const mjData* data, const Parts& state, double time);
  [[nodiscard]] bool sample_is_due(double time, double next) const;
  [[nodiscard]] bool stays_clear(const Parts& state) const;
  void check_site(const mjModel* model, bool placed);
  void judge(const Parts& state);
  void measure(const Parts& state);
  void remember_readings(const Parts& state);
  void refuse_what_cannot_work(const mjModel* model) const;

  PadConfig config_;
  int instance_;
  std::unique_ptr<Sensor> sensor_;
  std::vector<std::span<double>> sensor_memory_;
  std::vector<double> first_memory_;  // as the sensor was made: what a state of zeros stands for
  std::vector<Touched> touched_;
  std::vector<Field> fields_;  // one a touched geom
  ContactLabels labels_;
  std::size_t readings_;      // how many numbers the sensor and the truth give
  std::size_t truth_;         // of them the truth
  std::vector<int> outputs_;  // addresses in sensordata
  bool watched_;              // somebody reads the labels and the sensor
  double step_;               // s
  double sample_time_;        // s, 0: every step

  double computed_at_ = 0.0;  // s, time of the kinematics: MuJoCo has gone on to the end of the step when it asks for a commit

  std::vector<double> seen_, sees_;  // the kinematics that locate() has looked at, and room for those that it looks at

  // The trial that the fields hold.
  std::vector<double> ended_with_;  // the state of the fields after the trial, for the implicit solver
  std::vector<double> began_with_;  // the state from which it started, as far as fields are concerned
  bool warned_ = false;             // of the site
  bool evaluated_ = false;
  bool judged_ = false;
  bool measured_ = false;
  bool may_rest_ = false;                     // what is read without contact never changes, and nobody but the sensor reads it
  bool rested_ = false;                       // in the last add_force()
  std::optional<bool> clear_;                 // whether the pad is far from all that it may touch, where locate() has found it
  bool keeps_state_ = false, tried_ = false;  // keep_state(); the fields are beyond the state committed last
  bool fields_hold_state_ = false;            // the fields are as the state says: no load needed
  double time_ = 0.0;                         // s
  double dt_ = 0.0;                           // s, since the commit
  bool sampled_ = false;                      // the sensor has taken a sample; else what it holds is in the state
  std::span<const float> sample_;             // valid until it takes the next one
  double next_sample_ = 0.0;
};

}  // namespace slipbench
