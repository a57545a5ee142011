#include "sim/mujoco/bodies/pad_follower.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Geometry>

#include "sim/effects/effect_catalogue.h"
#include "sim/mujoco/pads/geom_surface.h"
#include "sim/simulation/step_plan.h"

namespace slipbench {
namespace {

// Two times are one when they differ by less than this share of the simulation's step: where a step is no whole part of a second they are rounded.
constexpr double same_time = 1e-6;

Pose between(const Pose& from, const Pose& to, double share) {
  const Eigen::Quaterniond start(from.rotation), end(to.rotation);
  return {start.slerp(share, end).toRotationMatrix(), from.position + share * (to.position - from.position)};
}

}  // namespace

PadFollower::PadFollower(const mjModel* model, const PadInstance& followed, const PadLayout& layout, double rate, double speed,
                         double bench_step)
    : followed_(followed), labels_(layout), slack_(same_time * bench_step), shown_(&labels_.frame()) {
  const PadConfig& config = followed.config();
  const PadLayout springs = without_dashpots(layout);
  double longest = std::numeric_limits<double>::infinity();
  for (const int geom : config.geoms) {
    const GeomSurface surface = surface_of_geom(model, geom);
    FieldEffects effects = install_effects(config.effects, springs, surface.shape, config.seed, config.trial);
    longest = std::min(longest, longest_step(effects, speed));
    fields_.emplace_back(springs, surface.shape, config.friction, std::move(effects));
  }
  ways_.resize(fields_.size());
  // No step is longer than one of the simulation.
  if (bench_step > longest) stride_ = std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(1.0 / (rate * longest))));
  step_ = 1.0 / rate / static_cast<double>(stride_);
}

std::size_t PadFollower::ticks(double last_time) const {
  return static_cast<std::size_t>(std::floor((last_time + slack_) / step_)) + 1;
}

void PadFollower::look(double time) {
  before_ = std::exchange(now_, time);
  for (std::size_t k = 0; k < ways_.size(); ++k) ways_[k].from = std::exchange(ways_[k].to, followed_.pad_in_surface(k));
  arrived_ = false;
}

void PadFollower::go_to(double time, bool arrives) {
  const double dt = placed_ ? time - time_ : step_;
  for (std::size_t k = 0; k < fields_.size(); ++k) {
    const Way& way = ways_[k];
    const Pose pose = arrives ? way.to : between(way.from, way.to, (time - before_) / (now_ - before_));
    fields_[k].step(pose, dt, arrives ? &followed_.motion(k) : nullptr);
  }
  labels_.update(fields_, time, dt);
  time_ = time;
  placed_ = true;
  arrived_ = arrives;
}

void PadFollower::step() {
  go_to(due_, !due_before());
  shown_ = &labels_.frame();
  if (!since_.empty()) {
    frame_ = labels_.frame();
    frame_.events.insert(frame_.events.begin(), since_.begin(), since_.end());
    shown_ = &frame_;
    since_.clear();
  }
  due_ = TickTimes(step_).at(++tick_);
}

void PadFollower::catch_up() {
  if (arrived_) return;
  if (shown_ != &frame_) frame_ = labels_.frame();
  shown_ = &frame_;
  go_to(now_, true);
  const std::vector<ContactEvent>& events = labels_.frame().events;
  since_.insert(since_.end(), events.begin(), events.end());
}

}  // namespace slipbench
