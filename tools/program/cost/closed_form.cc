#include "tools/program/cost/errors.h"

#include <functional>
#include <memory>

#include "sim/simulation/stage_setup.h"
#include "tools/program/catalogue/sensor_catalogue.h"

namespace slipbench {
namespace {

constexpr double shortest_stride = 1e-7;  // s: two crossings of a limit that are closer are not told apart
constexpr std::size_t most_strides = 2'000'000;
constexpr double kept_depth = 1e-12;  // m
constexpr int looks_between = 256;    // at the motion, between the first onset of a unit and its last
constexpr double never = std::numeric_limits<double>::quiet_NaN();

// A function of time that changes by no more than `slope` a second.
struct Bounded {
  std::function<double(double)> value;
  double slope;
};

// Where the function, negative or 0 at `from`, first exceeds 0 on the way to `to`, which may be earlier; NaN: nowhere. No
// crossing is missed, since the way on is never longer than what the bound on its slope leaves, but for a pair closer than
// shortest_stride. `strides`: those left, 0 when there were too few.
double first_above_zero(const Bounded& f, double from, double to, std::size_t& strides) {
  const double sense = to < from ? -1.0 : 1.0;
  double before = from;
  for (double value = f.value(from); strides > 0; --strides) {
    if (value > 0.0) break;
    if (before == to) return never;
    double next = before + sense * std::max(-value / f.slope, shortest_stride);
    if ((to - next) * sense < 0.0) next = to;
    value = f.value(next);
    if (value > 0.0) {
      double under = before, over = next;
      while (true) {
        const double middle = 0.5 * (under + over);
        if (middle == under || middle == over) return over;
        (f.value(middle) > 0.0 ? over : under) = middle;
      }
    }
    before = next;
  }
  return strides == 0 ? never : before;
}

// One element of a pad that moves as prescribed over a plane.
class PrescribedElement {
 public:
  PrescribedElement(const Element& element, const Motion& motion, const Pose& world_in_surface, double mu, double speed)
      : element_(element), motion_(motion), world_in_surface_(world_in_surface), mu_(mu), speed_(speed) {}

  [[nodiscard]] Eigen::Vector3d tip(double t) const { return world_in_surface_ * (motion_.pad_at(t).pose * element_.tip); }
  [[nodiscard]] double depth(double t) const { return std::max(0.0, -tip(t).z()); }
  // What the spring pulls with beyond `share` of what friction can hold, stuck at `anchor` [N].
  [[nodiscard]] double excess(double t, const Eigen::Vector2d& anchor, double share) const {
    const Eigen::Vector3d place = tip(t);
    const double press = std::max(0.0, -place.z());
    return element_.k_tangential * (place.head<2>() - anchor).norm() - share * mu_ * element_.k_normal * press;
  }

  // From t = 0 on. `strides` as in first_above_zero().
  ClosedForm::Onset first_onset(double end, std::size_t& strides) const {
    const Bounded depth_of{[this](double t) { return -tip(t).z(); }, speed_};
    for (double t = 0.0;;) {
      const double touch = first_above_zero(depth_of, t, end, strides);
      if (std::isnan(touch)) return {};
      const Eigen::Vector2d anchor = tip(touch).head<2>();
      const double slope = (element_.k_tangential + mu_ * element_.k_normal) * speed_;
      const Bounded over{[&](double at) { return excess(at, anchor, 1.0); }, slope};
      const Bounded leaves{[this](double at) { return tip(at).z(); }, speed_};
      std::size_t strides_out = strides;
      const double out = first_above_zero(leaves, touch, end, strides_out);
      const double onset = first_above_zero(over, touch, std::isnan(out) ? end : out, strides);
      strides = std::min(strides, strides_out);
      if (!std::isnan(onset) && depth(onset) > 0.0) {
        // Back to where half of it was used up.
        const Bounded under_half{[&](double at) { return -excess(at, anchor, 0.5); }, slope};
        const double half = first_above_zero(under_half, onset, touch, strides);
        return {onset, std::max(least_load_time, std::isnan(half) ? onset - touch : 2.0 * (onset - half))};
      }
      if (std::isnan(out)) return {};
      t = out;
    }
  }

  // Whether from `first` to `last` it keeps its depth and moves on in nearly one direction.
  [[nodiscard]] bool goes_on(double first, double last) const {
    const auto velocity = [&](double t) {
      const BodyState pad = motion_.pad_at(t);
      const Eigen::Vector3d arm = pad.pose.rotation * element_.tip;
      return Eigen::Vector3d(world_in_surface_.rotation * (pad.velocity + pad.angular_velocity.cross(arm)));
    };
    const Eigen::Vector2d at_first = velocity(first).head<2>();
    const double pressed = depth(first);
    for (int i = 0; i <= looks_between; ++i) {
      const double t = first + (last - first) * i / looks_between;
      if (!(velocity(t).head<2>().dot(at_first) > 0.0) || std::abs(depth(t) - pressed) > kept_depth) return false;
    }
    return true;
  }

 private:
  const Element& element_;
  const Motion& motion_;
  const Pose& world_in_surface_;
  double mu_, speed_;
};

// Whether the pad's elements are springs alone, whose axes look at the plane all the time.
bool has_closed_form(const PadLayout& pad, const Motion& motion, const Pose& world_in_surface, double duration) {
  return std::ranges::all_of(pad.elements, [&](const Element& element) {
    if (element.c_normal != 0.0 || element.c_tangential != 0.0) return false;
    for (int i = 0; i <= looks_between; ++i) {
      const Eigen::Matrix3d& turned = motion.pad_at(duration * i / looks_between).pose.rotation;
      if (!((world_in_surface.rotation * turned * element.axis).z() < 0.0)) return false;
    }
    return true;
  });
}

// The later of two onsets, of which NaN is the latest.
bool is_later(const ClosedForm::Onset& a, const ClosedForm::Onset& b) {
  return (std::isnan(a.time) && !std::isnan(b.time)) || a.time > b.time;
}

// Empty where the unit has no closed form.
std::optional<ClosedForm::Unit> solve_unit(const std::vector<PrescribedElement>& elements, double end) {
  std::size_t strides = most_strides;
  std::vector<ClosedForm::Onset> onsets;
  for (const PrescribedElement& element : elements) onsets.push_back(element.first_onset(end, strides));
  if (strides == 0) return std::nullopt;
  // Elements that never touch have no say in whether the whole of the unit slips; those that touch after the first onset do, from
  // then on.
  ClosedForm::Unit unit;
  unit.micro = *std::ranges::min_element(onsets, [](const auto& a, const auto& b) { return is_later(b, a); });
  if (elements.size() == 1 || std::isnan(unit.micro.time)) {
    unit.whole = unit.micro;
    return unit;
  }
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const bool touches = elements[i].depth(unit.micro.time) > 0.0;
    if (touches && (std::isnan(unit.whole.time) || is_later(onsets[i], unit.whole))) unit.whole = onsets[i];
    if (touches && std::isnan(onsets[i].time)) {
      unit.whole = {};
      break;
    }
  }
  const double last = std::isnan(unit.whole.time) ? end : unit.whole.time;
  const bool all_go_on =
      std::ranges::all_of(elements, [&](const PrescribedElement& element) { return element.goes_on(unit.micro.time, last); });
  return all_go_on ? std::optional(unit) : std::nullopt;
}

}  // namespace

std::optional<ClosedForm> closed_form(const Scene& scene, std::uint64_t trial) {
  const double mu = scene.friction.static_coefficient;
  if (scene.dynamic() || scene.surface.name != "plane" || !scene.effects.empty() || !(mu > 0.0)) return std::nullopt;
  const StageSetup stage = set_up_stage(scene, trial);
  const Pose world_in_surface = stage.surface.pose.inverse();
  ClosedForm exact;
  for (const SensorScene& description : scene.sensors) {
    const std::unique_ptr<Sensor> sensor = make_sensor(description, scene.seed, trial);
    const PadLayout& pad = sensor->layout();
    const double speed = stage.motion->top_speed(reach_of(pad));
    if (!(speed > 0.0) || !has_closed_form(pad, *stage.motion, world_in_surface, scene.duration)) return std::nullopt;
    exact.units.emplace_back();
    for (const UnitRange& range : pad.units) {
      std::vector<PrescribedElement> elements;
      for (std::size_t i = range.first; i < range.first + range.count; ++i) {
        elements.emplace_back(pad.elements[i], *stage.motion, world_in_surface, mu, speed);
      }
      const std::optional<ClosedForm::Unit> unit = solve_unit(elements, scene.duration);
      if (!unit) return std::nullopt;
      exact.units.back().push_back(*unit);
    }
  }
  return exact;
}

Errors compare(const Scene& scene, const TrialResult& run, const ClosedForm& exact) {
  MeasureValues micro, whole;
  for (std::size_t s = 0; s < exact.units.size(); ++s) {
    const LabelRecord& labels = run.record.sensors.at(s).labels;
    for (std::size_t u = 0; u < exact.units[s].size(); ++u) {
      const ClosedForm::Unit& unit = exact.units[s][u];
      micro.add_onsets(labels.micro_onset_time.at(u), unit.micro.time, unit.micro.load_time, scene.duration);
      whole.add_onsets(labels.onset_time.at(u), unit.whole.time, unit.whole.load_time, scene.duration);
    }
  }
  Errors errors;
  at(errors, Measure::onset) = whole.error();
  at(errors, Measure::micro_onset) = micro.error();
  return errors;
}

}  // namespace slipbench
