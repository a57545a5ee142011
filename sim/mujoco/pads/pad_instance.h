// One pad inside MuJoCo: an instance of the plugin `slipbench.field` in one mjData.
//
// All state that outlives a step is in mjData's plugin_state (except after keep_state()), so that
// mj_getState, mj_setState, mj_copyData and resets handle it. (MuJoCo's keyframes hold no plugin
// state: they restart the pads.) All other members are recomputed from it and from the kinematics
// whenever either has changed.
//
// - A force is that of a trial from the last committed anchors (compute PASSIVE). It commits
//   nothing, so extra mj_forward calls, finite differences and the stages of RK4 do not change the
//   anchors.
// - `advance` commits the trial at the kinematics of the step's start: MuJoCo has not computed
//   newer ones by then.
// - A pad far from all that it may touch rests: its elements are not evaluated, and its readings do
//   not change. It stores its last pose, so that the step in which it comes back is bit-identical
//   to one without rest.
// - The springs obey the friction law of sim/contact; the dashpots are added to their force, and
//   the sum is kept inside the friction cone. Labels and sensors read the springs: the force that
//   deflects a unit's tip.
//
// sensordata of one instance: the values of the sensor, in the order of its channels. With
// truth="true" these follow, with N units:
//   unit_state [N] (0 detached, 1 stick, 2 slip, 3 partial), slip_velocity [N,2] m/s,
//   slip_distance [N] m, margin [N], contact_force [N,3] N,
//   state and state_micro (0 none, 1 non-slip, 2 incipient, 3 gross), stuck_fraction
// The margin of a separated unit and stuck_fraction without contact are 1, or NaN with
// unloaded="nan". The values are those of the state before the step, like all of MuJoCo's
// sensordata.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <mujoco/mujoco.h>
#include <Eigen/Core>

#include "sim/api/contact_frame.h"
#include "sim/api/pad_layout.h"
#include "sim/api/sensor.h"
#include "sim/contact/contact_labels.h"
#include "sim/contact/field.h"
#include "sim/contact/surface/surface.h"
#include "sim/core/pose.h"
#include "sim/mujoco/linear/stability.h"
#include "sim/mujoco/pads/implicit.h"
#include "sim/mujoco/pads/pad_config.h"
#include "sim/mujoco/pads/site_watch.h"

namespace slipbench {

// Number of values of an instance in plugin_state, and in sensordata. MuJoCo asks for them before
// the model has its meshes. pad_state_size() throws InputError if an effect does not fit a geom.
std::size_t pad_state_size(const mjModel* model, const PadConfig& config, const PadCatalogue& catalogue);
std::size_t pad_sensor_size(const PadConfig& config, const PadCatalogue& catalogue);

// Returns a layout without dashpots, which the instance computes itself: it knows the velocities,
// which a field would have to estimate.
PadLayout without_dashpots(PadLayout layout);

class PadInstance {
 public:
  // Throws InputError if a geom cannot be touched or an effect does not fit it.
  PadInstance(const mjModel* model, int instance, PadConfig config, const PadCatalogue& catalogue);

  // Adds the force of the pad's elements on its body and on the touched ones to qfrc_passive. Needs
  // positions and velocities.
  void add_force(const mjModel* model, mjData* data);
  // Writes the sensordata of every sensor that refers to the instance.
  void write_sensors(const mjModel* model, mjData* data);
  // Commits the trial of the current kinematics to the state.
  void commit(const mjModel* model, mjData* data);
  // Copies the state that mj_copyData omits: all that a half-done step needs from its first half.
  void copy_from(const PadInstance& other) { computed_at_ = other.computed_at_; }

  // For the group of all pads (field_plugin.h):
  // True if a step has been committed since the last reset.
  [[nodiscard]] bool placed(const mjModel* model, mjData* data) const;
  // After add_force(): force and torque of the elements of field `k` on the pad, springs and
  // dashpots, in the frame of its surface.
  [[nodiscard]] const Wrench& applied(std::size_t k) const { return touched_[k].applied; }
  // After add_force(): number of elements that touch the geom of field `k`.
  [[nodiscard]] std::size_t touching(std::size_t k) const { return rested_ ? 0 : fields_[k].touching(); }
  // Adds, for every touched geom, the tangent of the elements that touch in the trial, taken as
  // stuck.
  void add_touching_tangents(const mjModel* model, const mjData* data, PadTangents& pads) const;
  // Adds the pad's tangent with all elements stuck on the touched body on which it vibrates
  // fastest, moved onto that body if it is separated.
  void add_stuck_tangent(const mjModel* model, mjData* data, PadTangents& pads) const;
  // Describes the pad for implicit.h before any motion: one entry per touched geom.
  void describe(const mjModel* model, std::vector<ImplicitPad>& pads) const;
  // Instead of add_force(): starts the trial at the present pose, one entry per touched geom. The
  // solver owns the fields until forget_trial().
  void begin_implicit(const mjModel* model, mjData* data, std::vector<ImplicitContact>& contacts);
  void forget_trial() { evaluated_ = fields_hold_state_ = false; }
  // The solver's memory of this pad, in plugin_state.
  [[nodiscard]] std::span<double> implicit_memory(const mjModel* model, mjData* data) const {
    return parts(model, data).implicit;
  }

  // Draws every element, coloured by its state, with an arrow for the force on it.
  void draw(const mjModel* model, mjData* data, mjvScene* scene);

  // The last committed contact: at the time of the state before the step. Events are those of that
  // step. Available for pads with a sensor in the model; for others only after watch(), which must
  // be called before the first step, since their contact could not be read.
  [[nodiscard]] const ContactFrame& truth(FramePart part) { return labels_.fill(fields_, part); }
  void disable_slip_angle() { labels_.disable_slip_angle(); }
  void watch() { watched_ = true; }
  // Excludes the fields' state from plugin_state from here on, which takes a quarter of a large
  // pad's time. For the sole user of an mjData, who steps it in sequence from its start, explicitly
  // and by a one-stage integrator. mj_setState, mj_copyData and resets then do not include this
  // state, and a second trial from the same state is refused. The plugin's sensor is then not read,
  // and its sensordata does not change.
  void keep_state() {
    keeps_state_ = true;
    feels_every_tick_ = false;
  }
  [[nodiscard]] Sensor& sensor() { return *sensor_; }
  [[nodiscard]] const PadConfig& config() const { return config_; }
  [[nodiscard]] std::span<const Field> fields() const { return fields_; }
  // After a commit and until the next kinematics: pose and velocity of the pad in the frame of
  // field `k`'s surface.
  [[nodiscard]] const Pose& pad_in_surface(std::size_t k) const { return touched_[k].pad_in_surface; }
  [[nodiscard]] const Twist& motion(std::size_t k) const { return touched_[k].motion; }

 private:
  // A touched geom and its surface.
  struct Touched {
    int geom;
    int body;
    Pose surface_in_geom;
    Surface shape;
    SiteWatch watch;
    // m, distance between the origins of pad and geom beyond which nothing touches; 0: unknown.
    double reach;
    Pose pad_in_surface{};
    Twist motion{};  // of the pad in the surface's frame
    // of the last add_force()
    Wrench applied{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  };
  // Parts of the instance's share of plugin_state. `fields`: the fields' states, the poses of the
  // pad and its touched geoms when it was last found at rest, and its phase.
  struct Parts {
    std::span<double> header, fields, implicit, memory, held, truth;
  };

  [[nodiscard]] Parts parts(const mjModel* model, mjData* data) const;
  bool locate(const mjModel* model, const mjData* data);
  [[nodiscard]] bool sees_the_same(const mjModel* model, const mjData* data);
  void evaluate(const Parts& state, double time);
  [[nodiscard]] bool is_idle(const mjModel* model, const mjData* data, const Parts& state, double time);
  void commit_idle(const mjData* data, const Parts& state, double time);
  [[nodiscard]] bool sample_is_due(double time, double next) const;
  [[nodiscard]] bool stays_clear(const mjModel* model, const mjData* data, const Parts& state);
  void check_site(const mjModel* model, bool placed);
  void refuse_lost(const mjModel* model) const;
  void judge(const Parts& state);
  void measure(const Parts& state);
  void remember_readings(const Parts& state);
  void refuse_what_cannot_work(const mjModel* model) const;

  PadConfig config_;
  int instance_;
  std::unique_ptr<Sensor> sensor_;
  std::vector<std::span<double>> sensor_memory_;
  bool feels_every_tick_;             // the sensor also uses the contact at steps without a sample
  std::vector<double> first_memory_;  // of a new sensor: meaning of a state of zeros
  std::vector<Touched> touched_;
  std::vector<Field> fields_;           // one per touched geom
  std::vector<Pose> pads_in_surfaces_;  // of the last trial
  std::vector<Twist> motions_;
  ContactLabels labels_;
  std::size_t readings_;      // number of values of the sensor and the truth
  std::size_t truth_;         // number of values of the truth
  std::vector<int> outputs_;  // addresses in sensordata
  bool watched_;              // labels and sensor are read
  double step_;               // s
  double sample_time_;        // s, 0: every step

  // s, time of the kinematics: MuJoCo is at the end of the step when it calls for a commit.
  double computed_at_ = 0.0;

  // The kinematics of the last locate(), and space for those of the next.
  std::vector<double> seen_, sees_;

  // The trial that the fields hold.
  // The fields' state after the trial, for the implicit solver.
  std::vector<double> ended_with_;
  // The fields' state at the start of the trial.
  std::vector<double> began_with_;
  bool warned_ = false;  // of the site
  bool evaluated_ = false;
  bool judged_ = false;
  bool measured_ = false;
  // Readings without contact never change, and only the sensor reads it.
  bool may_rest_ = false;
  bool rested_ = false;  // in the last add_force()
  // True if the pad is far from all that it may touch, at the pose of locate().
  std::optional<bool> clear_;
  // keep_state(); the fields are beyond the last committed state.
  bool keeps_state_ = false, tried_ = false;
  // The fields are in the stored state: no load needed.
  bool fields_hold_state_ = false;
  double time_ = 0.0;  // s
  double dt_ = 0.0;    // s, since the commit
  // The sensor has taken a sample; otherwise its values are in the state.
  bool sampled_ = false;
  std::span<const float> sample_;  // valid until the next sample
  double next_sample_ = 0.0;
};

}  // namespace slipbench
