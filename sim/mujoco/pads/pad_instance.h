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
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <mujoco/mujoco.h>
#include <Eigen/Core>

#include "sim/core/contact_frame.h"
#include "sim/core/pad_layout.h"
#include "sim/core/pose.h"
#include "sim/core/sensor.h"
#include "sim/field/contact_labels.h"
#include "sim/field/field.h"
#include "sim/field/surface/surface.h"
#include "sim/mujoco/linear/stability.h"
#include "sim/mujoco/pads/implicit.h"
#include "sim/mujoco/pads/register_plugin.h"
#include "sim/scene/scene.h"
#include "sim/scene/yaml_tree.h"

namespace slipbench {

// What a MuJoCo model says of one pad: the attributes of a `slipbench.field` plugin instance, read and checked.

// The attributes in the order in which MuJoCo hands them over. All but `pad`, `touch` and one of `sensor` and
// `elements` have defaults.
//   pad       site whose frame is the pad frame P: +Z from the touched object into the pad, origin at the undeformed tips
//   touch     what is touched, with blanks between: names of geoms, body:NAME, which are the geoms of a body that can collide (all, where none
//             can), subtree:NAME, the same of a body and all below it, group:N, the geoms of a group but those that move with the pad. A pad may
//             touch several geoms at once or in turn
//   sensor    {type: papillarray, ...} as under `sensors` in a scene, electronics included
//   elements  [[x, y, z, k_n, k_t], ...]: tip [m] in P and stiffness [N/m] of each element, and its axis in three more columns
//             [ax, ay, az] where it is not -Z. In models that the program builds: a name by HandedLayouts, with units and element_truth in it
//   units     [6, 6, ...]: how many elements each unit of `elements` has; default: one
//   element_truth  true: the contact of the pad also tells of each element (PadLayout::element_truth), for who reads it in C++; read: so do
//             two more channels of `elements`, depth [E] m and shear [3, E] m
//   material, friction, effects, seed  as in a scene
//   trial     keys the random draws together with the seed; default 0
//   damping   time tau of a dashpot tau*k beside each spring; default 1 ms (assumed)
//   truth     true: the sensor's values are followed by the truth (pad_instance.h)
//   solver    explicit or implicit
//   unloaded  what margin of units that do not touch and stuck_fraction without contact are: 1 (default) or nan
//   check     what a mistake is (possible_contact): error (default), warn, which prints it once, or off, as in models that the
//             program builds: it has checks of its own, and MuJoCo's compiler takes a step before bodies are where the scene has them
//   name      the instance's name before MjSpec.attach gave it a prefix or a suffix: pad and touch are then looked for with the same ones first.
//             Without it, a name that is not there is looked for with each beginning of the instance's name before it
inline constexpr const char* pad_attributes[] = {"pad",     "touch",    "sensor", "element_truth", "material", "friction",
                                                 "effects", "seed",     "trial",  "damping",       "truth",    "solver",
                                                 "units",   "elements", "name",   "check",         "unloaded"};

struct PadConfig {
  std::string name;  // of the instance
  int site = -1;
  std::vector<int> geoms;
  std::vector<PadLayout> table;  // one layout, where `elements` gives it
  bool reads_elements = false;   // its depth and shear are channels
  SensorScene sensor;            // else
  Friction friction;
  std::vector<Named> effects;
  std::uint64_t seed = 0, trial = 0;
  double damping = 0.0;  // s
  bool truth = false;
  bool implicit = false;
  double unloaded = 1.0;
  bool warn = false;       // of mistakes
  bool unchecked = false;  // nor that

  // Throws InputError, or where the model says so prints by mju_warning: "plugin 'left': " and `mistake`.
  void report(const std::string& mistake) const;

  [[nodiscard]] std::unique_ptr<Sensor> make_sensor(const PadCatalogue& catalogue) const;
};

// Layouts that a program hands to the pads of its own models in memory, where writing and reading an element table would take longer than a trial.
class HandedLayouts {
 public:
  HandedLayouts() = default;
  HandedLayouts(const HandedLayouts&) = delete;
  HandedLayouts& operator=(const HandedLayouts&) = delete;
  ~HandedLayouts();

  // What the attribute `elements` of a pad of this layout says, in models that are compiled and whose data is made while the object lives.
  std::string add(PadLayout layout);

 private:
  std::vector<std::string> names_;
};

// Throws InputError: "plugin 'left' effects=...: unknown effect 'agein'; did you mean 'ageing'? allowed: ...".
PadConfig read_pad_config(const mjModel* model, int instance, const PadCatalogue& catalogue);

// Contacts of MuJoCo's own that are possible between a geom that moves with the pad (that of the site's body and of bodies welded to it; of what is
// fixed to the world only the site's own body) and a touched one, as a sentence with what to write; empty: none is.
[[nodiscard]] std::string possible_contact(const mjModel* model, const PadConfig& config);

// Watches one pad on one surface until it has touched rightly: an element that is inside and looks out exerts no force.
class SiteWatch {
 public:
  // At least the tip farthest from the pad's origin is looked at, and 16 at most.
  explicit SiteWatch(const PadLayout& layout);

  // Whether a tip is inside the surface by more than 10 um and looks out of it. `touching`: elements of the pad that touch.
  [[nodiscard]] bool looks_out(const Surface& shape, const Pose& pad_in_surface, std::size_t touching);
  // How far the pad is from the surface at least [m], whichever way it is turned about its origin; negative: it may touch.
  [[nodiscard]] double clearance(const Surface& shape, const Pose& pad_in_surface) const;
  [[nodiscard]] double radius() const { return radius_; }  // m, of the pad about its origin
  // How far a pad may be pressed in where a simulation begins [m]: a unit's height, or the pad's radius where nobody knows it; infinite for a
  // single element.
  [[nodiscard]] double deepest_start() const { return deepest_start_; }

 private:
  std::vector<Element> looked_at_;
  double radius_ = 0.0;  // m, of the pad about its origin
  double deepest_start_;
  bool sure_ = false;  // it has touched
  Eigen::Vector3d clear_at_{0.0, 0.0, 0.0};
  double clear_ = -1.0;  // m, how far from there the pad meets nothing
};

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

  // For the group of all pads (field_plugin.h):
  // Whether a step has been committed since the last reset.
  [[nodiscard]] bool placed(const mjModel* model, mjData* data) const;
  // After add_force(): the force and torque of the elements of field `k` on the pad, springs and dashpots, in the frame of the surface that it meets.
  [[nodiscard]] const Wrench& applied(std::size_t k) const { return touched_[k].applied; }
  // After add_force(): how many elements touch the geom of field `k`.
  [[nodiscard]] std::size_t touching(std::size_t k) const { return rested_ ? 0 : fields_[k].touching(); }
  // The tangent of every touched geom's elements that touch in the trial, taken as stuck.
  void add_touching_tangents(const mjModel* model, const mjData* data, PadTangents& pads) const;
  // The pad's tangent with all elements stuck on that body among the touched ones on which it vibrates fastest, put down on it where it is away.
  void add_stuck_tangent(const mjModel* model, mjData* data, PadTangents& pads) const;
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
  [[nodiscard]] const ContactFrame& truth(FramePart part) { return labels_.fill(fields_, part); }
  void leave_slip_angle() { labels_.leave_slip_angle(); }
  void watch() { watched_ = true; }
  // Leaves the fields' state out of plugin_state from here on, which a large pad spends a quarter of its time on. For the only user of an mjData,
  // who steps it straight on from its beginning, explicitly and by an integrator of one stage: mj_setState, mj_copyData and resets then do not
  // carry it, and a second trial from the same state is refused. The sensor of the plugin is then not read, and its sensordata stays.
  void keep_state() {
    keeps_state_ = true;
    feels_every_tick_ = false;
  }
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
    Twist motion{};                                                    // of the pad in the surface's frame
    Wrench applied{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};  // of the last add_force()
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
  bool feels_every_tick_;             // the sensor takes in the contact at steps without a sample, too
  std::vector<double> first_memory_;  // as the sensor was made: what a state of zeros stands for
  std::vector<Touched> touched_;
  std::vector<Field> fields_;           // one a touched geom
  std::vector<Pose> pads_in_surfaces_;  // of the last trial
  std::vector<Twist> motions_;
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
