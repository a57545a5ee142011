#include "sim/mujoco/bodies/pad_follower.h"

#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "sim/core/error.h"

#include "sim/contact/several_surfaces.h"
#include "sim/core/math/rotation.h"
#include "sim/effects/effect_catalogue.h"
#include "sim/effects/install.h"
#include "sim/mujoco/pads/geom_surface.h"
#include "sim/mujoco/pads/pad_field.h"
#include "sim/stage/step_plan.h"

namespace slipbench {
namespace {

// Two times are equal if they differ by less than this share of the simulation's step: they are
// rounded if a step does not divide a second.
constexpr double same_time = 1e-6;

Pose between(const Pose& from, const Pose& to, double share) {
  return {interpolated_rotation(from.rotation, to.rotation, share), from.position + share * (to.position - from.position)};
}

}  // namespace

PadFollower::PadFollower(const mjModel* model, const PadInstance& followed, const PadLayout& layout, double ahead, double rate,
                         double speed, double bench_step)
    : followed_(followed), labels_(layout), slack_(same_time * bench_step), shown_(&labels_.frame()) {
  const PadConfig& config = followed.config();
  PadLayout springs = without_dashpots(layout);
  // Z of the pad frame points into the pad: with the pad at depth d [m] the follower is at
  // d + ahead, with k_n ahead [N] more in each spring.
  for (Element& element : springs.elements) element.tip.z() -= ahead;
  double longest = std::numeric_limits<double>::infinity();
  for (const int geom : config.geoms) {
    const GeomSurface surface = surface_of_geom(model, geom);
    FieldEffects effects = install_effects(config.effects, springs, surface.shape, config.seed, config.trial);
    longest = std::min(longest, longest_step(effects, speed));
    fields_.emplace_back(springs, surface.shape, config.friction, std::move(effects));
  }
  ways_.resize(fields_.size());
  poses_.resize(fields_.size());
  motions_.resize(fields_.size());
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
    poses_[k] = pose;
    motions_[k] = followed_.motion(k);
  }
  step_on_surfaces(fields_, poses_, dt, arrives ? std::span<const Twist>(motions_) : std::span<const Twist>());
  for (const Field& field : fields_) {
    if (field.overcompressed()) {
      throw InputError(fmt::format(
          "the sensor that follows '{}': at {:.6g} s its element {} is compressed by more than the height of a unit, {:.3g} mm; press less",
          followed_.config().name, time, *field.overcompressed(), 1e3 * field.layout().unit_height));
    }
    if (!field.lost()) continue;
    throw SceneValueError(
        "sensors",
        fmt::format(
            "the sensor that follows '{}': at {:.6g} s its element {}, which was {:.3g} mm deep, passed through the touched body; press less or make the body thicker",
            followed_.config().name, time, field.lost()->element, 1e3 * field.lost()->depth));
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
