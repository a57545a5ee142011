// Pads and drives shared by the oracle tests.
#pragma once

#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

#include "sim/contact/contact_labels.h"
#include "sim/contact/field.h"

namespace slipbench::oracle {

// Nine pillars as in the PapillArray's gripper profile: 7 mm pitch, edges 0.20 mm and corners 0.45
// mm lower than the centre. `bristles` share a pillar's load with weights from 1.6 to 0.4 times the
// mean.
inline PadLayout nine_pillars(std::size_t bristles = 1, double k_n = 7100.0, double k_t = 3900.0) {
  PadLayout pad;
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) {
      const double x = 0.007 * (1 - row), y = 0.007 * (1 - column);
      const int off_centre = (row != 1) + (column != 1);
      const double drop = off_centre == 0 ? 0.0 : off_centre == 1 ? 0.20e-3 : 0.45e-3;
      pad.units.push_back({pad.elements.size(), bristles});
      for (std::size_t j = 0; j < bristles; ++j) {
        const double n = static_cast<double>(bristles);
        const double weight = bristles == 1 ? 1.0 : 1.6 - 1.2 * static_cast<double>(j) / (n - 1.0);
        pad.elements.push_back({.tip = {x, y, drop}, .k_normal = k_n * weight / n, .k_tangential = k_t / n});
      }
    }
  }
  return pad;
}

// A flat square grid of n x n elements with the given side [m], one unit each, with k_n and k_t
// [N/m] per element.
inline PadLayout square_grid(int n, double side, double k_n, double k_t) {
  PadLayout pad;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      pad.units.push_back({pad.elements.size(), 1});
      pad.elements.push_back(
          {.tip = {side * ((i + 0.5) / n - 0.5), side * ((j + 0.5) / n - 0.5), 0.0}, .k_normal = k_n, .k_tangential = k_t});
    }
  }
  return pad;
}

// A pose turned by `angle` about the pad's normal around the origin, then moved.
inline Pose turned(double angle, const Eigen::Vector3d& position) {
  return {.rotation = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix(), .position = position};
}

// Steps a field through `pose(t)` for t = 0, dt, ..., duration and passes every frame to `look`.
inline void drive(Field& field, double dt, double duration, const std::function<Pose(double)>& pose,
                  const std::function<void(const ContactFrame&)>& look) {
  ContactLabels labels(field.layout());
  const auto ticks = static_cast<std::size_t>(std::lround(duration / dt));
  for (std::size_t tick = 0; tick <= ticks; ++tick) {
    const double time = static_cast<double>(tick) * dt;
    field.step(pose(time), dt);
    look(labels.update({&field, 1}, time, dt));
  }
}

// First time at which each unit reported an event of `kind`; NaN: never.
class FirstTimes {
 public:
  FirstTimes(std::size_t units, EventKind kind) : times_(units, std::nan("")), kind_(kind) {}
  void operator()(const ContactFrame& frame) {
    for (const ContactEvent& event : frame.events) {
      if (event.kind == kind_ && std::isnan(times_[event.unit])) times_[event.unit] = event.time;
    }
  }
  [[nodiscard]] const std::vector<double>& times() const { return times_; }

 private:
  std::vector<double> times_;
  EventKind kind_;
};

}  // namespace slipbench::oracle
