// A sensor that reads another sensor's contact.
#pragma once

#include <mujoco/mujoco.h>
#include <cstddef>
#include <vector>

#include "sim/api/contact_frame.h"
#include "sim/api/pad_layout.h"
#include "sim/contact/contact_labels.h"
#include "sim/contact/field.h"
#include "sim/core/pose.h"
#include "sim/mujoco/pads/pad_instance.h"

namespace slipbench {

// A sensor that reads another sensor's contact: its pad is where that pad is, and exerts no force.
//
// Its own elements meet the surfaces that the followed pad meets, with that pad's friction and
// effects installed for these elements, along the same history of relative poses. Their normal
// force acts on no body: only the followed pad exerts forces, so that all bodies move
// bit-identically with or without followers.
//
// It has its own ticks, at whole multiples of its step from 0 on, whatever the simulation's step
// is: its step is its sampling time, or the longest whole fraction of it that the effects allow.
// Between two ticks of the simulation the pose is interpolated, linearly in the origin and in the
// angle: a field assumes a straight path between two poses anyway. Every pose of the simulation is
// visited, if necessary by a step between two of the follower's ticks. Laws of speed use the
// followed pad's velocity if a step ends at a tick of the simulation, otherwise the mean of the
// step.
class PadFollower {
 public:
  // `followed` must outlive the follower, `model` the constructor. `layout`, `ahead` [m] before the
  // pad, `rate` [Hz]: of the sensor. `speed`: the pad's top speed [m/s], for effects; `bench_step`
  // [s]. Throws SceneValueError if an effect does not fit the pad.
  PadFollower(const mjModel* model, const PadInstance& followed, const PadLayout& layout, double ahead, double rate, double speed,
              double bench_step);
  PadFollower(const PadFollower&) = delete;
  PadFollower& operator=(const PadFollower&) = delete;

  [[nodiscard]] double time_step() const { return step_; }      // s
  [[nodiscard]] std::size_t stride() const { return stride_; }  // ticks between readings
  [[nodiscard]] std::size_t ticks(double last_time) const;      // up to `last_time` [s]

  // Reads the followed pad after it has been committed, at the simulation's tick at `time` [s]. All
  // ticks before must have been taken, and catch_up() called.
  void look(double time);
  // When the next tick is due [s]; and whether that is before, or at, the simulation's tick last
  // read, within the rounding of times.
  [[nodiscard]] double due() const { return due_; }
  [[nodiscard]] bool due_before() const { return due_ < now_ - slack_; }
  [[nodiscard]] bool due_now() const { return due_ <= now_ + slack_; }
  // Takes the tick that is due.
  void step();
  // Advances to the simulation's tick last read, if no tick of the follower coincided with it.
  void catch_up();

  // The contact at the latest tick, with all events since the previous one.
  [[nodiscard]] const ContactFrame& contact() const { return *shown_; }

 private:
  struct Way {
    Pose from, to;  // of the pad in the surface, at the simulation's last two ticks
  };

  void go_to(double time, bool arrives);

  const PadInstance& followed_;
  std::vector<Field> fields_;  // one per touched geom
  std::vector<Way> ways_;
  std::vector<Pose> poses_;  // of the last step, one per field
  std::vector<Twist> motions_;
  ContactLabels labels_;
  double step_ = 0.0, slack_;  // s
  std::size_t stride_ = 1, tick_ = 0;
  double due_ = 0.0, time_ = 0.0;    // s, of the next tick; of the fields
  double before_ = 0.0, now_ = 0.0;  // s, of the simulation's ticks
  // fields have been stepped; are at the simulation's tick
  bool placed_ = false, arrived_ = false;
  std::vector<ContactEvent> since_;  // events of steps between two ticks
  ContactFrame frame_;               // the latest tick's, if it differs from the labels' frame
  const ContactFrame* shown_;
};

}  // namespace slipbench
