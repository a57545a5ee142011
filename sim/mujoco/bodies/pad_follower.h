// A sensor that reads another one's contact: its pad stands where that pad stands, and presses on nothing.
#pragma once

#include <cstddef>
#include <vector>

#include <mujoco/mujoco.h>

#include "sim/core/contact_frame.h"
#include "sim/core/pad_layout.h"
#include "sim/field/contact_labels.h"
#include "sim/field/field.h"
#include "sim/mujoco/pads/pad_instance.h"

namespace slipbench {

// Elements of its own meet the surfaces that the followed pad meets, with that pad's friction and effects installed for these elements, along
// the very history of relative poses that the followed pad has. Their normal force acts on no body: the followed pad alone carries,
// so that with or without followers every body moves alike, to the bit.
//
// Its ticks are its own, at whole multiples of its step from 0 on, whatever the simulation's step is: that step is its sampling time, or the
// longest part of it that the effects bear. Between two ticks of the simulation the pose is interpolated, linearly in the origin and in the angle:
// a field takes the way between two poses to be straight in any case. Every pose that the simulation had is met: where none of the follower's
// ticks falls on it, by a step between two of them. The velocity that laws of speed see is the followed pad's where a step ends at a tick
// of the simulation, else the mean of the step.
class PadFollower {
 public:
  // `followed` must outlive the follower, `model` the constructor. `layout`, `rate` [Hz]: of the sensor. `speed`: the fastest that the pad
  // moves [m/s], as effects ask it; `bench_step` [s]. Throws SceneValueError where an effect does not suit the pad.
  PadFollower(const mjModel* model, const PadInstance& followed, const PadLayout& layout, double rate, double speed,
              double bench_step);
  PadFollower(const PadFollower&) = delete;
  PadFollower& operator=(const PadFollower&) = delete;

  [[nodiscard]] double time_step() const { return step_; }      // s
  [[nodiscard]] std::size_t stride() const { return stride_; }  // ticks between readings
  [[nodiscard]] std::size_t ticks(double last_time) const;      // up to `last_time` [s]

  // Takes over where the followed pad has been committed, at the simulation's tick at `time` [s]. The ticks before it must have been taken, and
  // catch_up() called.
  void look(double time);
  // When the next tick is due [s]; and whether that is before the simulation's tick looked at last, or with it, times being as good as their
  // rounding.
  [[nodiscard]] double due() const { return due_; }
  [[nodiscard]] bool due_before() const { return due_ < now_ - slack_; }
  [[nodiscard]] bool due_now() const { return due_ <= now_ + slack_; }
  // Takes the tick that is due.
  void step();
  // Goes on to the simulation's tick looked at last, where no tick of the follower fell on it.
  void catch_up();

  // The contact at the latest tick, with all events since the one before.
  [[nodiscard]] const ContactFrame& contact() const { return *shown_; }

 private:
  struct Way {
    Pose from, to;  // of the pad in the surface, at the simulation's two ticks looked at last
  };

  void go_to(double time, bool arrives);

  const PadInstance& followed_;
  std::vector<Field> fields_;  // one a touched geom
  std::vector<Way> ways_;
  ContactLabels labels_;
  double step_ = 0.0, slack_;  // s
  std::size_t stride_ = 1, tick_ = 0;
  double due_ = 0.0, time_ = 0.0;          // s, of the next tick; of the fields
  double before_ = 0.0, now_ = 0.0;        // s, of the simulation's ticks
  bool placed_ = false, arrived_ = false;  // the fields have been stepped; are at the simulation's tick
  std::vector<ContactEvent> since_;        // events of steps between two ticks
  ContactFrame frame_;                     // the latest tick's, where the labels' is not
  const ContactFrame* shown_;
};

}  // namespace slipbench
