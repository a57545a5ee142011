#include "sim/field/contact_labels.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace slipbench {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// Below this share of the slip's speed a fitted translation or rotation is rounding, not motion.
constexpr double negligible = 1e-6;

// Events of one unit closer than this share of a step happen together: bristles of one tip touch at once, up to rounding.
constexpr double together = 1e-9;

PadState pad_state(std::size_t touching, std::size_t slipping) {
  if (touching == 0) return PadState::no_contact;
  if (slipping == 0) return PadState::non_slip;
  return slipping == touching ? PadState::gross : PadState::incipient;
}

}  // namespace

ContactLabels::ContactLabels(const Field& field) : units_(field.layout().units), counts_(units_.size()) {
  const auto n = static_cast<Eigen::Index>(units_.size());
  unit_of_element_.resize(field.size());
  undeformed_.resize(3, n);
  for (std::size_t u = 0; u < units_.size(); ++u) {
    Eigen::Array3d sum(0.0, 0.0, 0.0);
    for (std::size_t i = 0; i < units_[u].count; ++i) sum += field.layout().elements[units_[u].first + i].tip.array();
    shares_.push_back(1.0 / static_cast<double>(units_[u].count));
    undeformed_.col(static_cast<Eigen::Index>(u)) = shares_[u] * sum;
    for (std::size_t i = 0; i < units_[u].count; ++i) unit_of_element_[units_[u].first + i] = static_cast<std::uint32_t>(u);
  }
  frame_.force.setZero(3, n);
  frame_.contact_force.setZero(3, n);
  frame_.displacement.setZero(3, n);
  frame_.slip_velocity.setZero(2, n);
  frame_.slip_distance.setZero(n);
  frame_.margin.setConstant(n, nan);
  frame_.unit_state.assign(units_.size(), UnitState::detached);
  in_order_.reserve(field.size());
  frame_.events.reserve(3 * field.size());
}

const ContactFrame& ContactLabels::update(Field& field, double time, double dt) {
  frame_.time = time;
  sum_units(field, dt);
  judge_pad();
  fit_slip_motion(field.on_plane(), dt);
  frame_.events.clear();
  if (!field.events().empty()) collect_events(field, time, dt);
  return frame_;
}

void ContactLabels::ContactPlane::face(const Eigen::Vector3d& normal) {
  if (normal == normal_) return;
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  normal_ = normal;
  level_ = normal == z;
  if (normal == -z) {  // all half turns are as short: the one about X
    turn_ = Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();
    return;
  }
  const Eigen::Vector3d middle = normal + z;
  turn_ = Eigen::Matrix3d::Identity() - middle * middle.transpose() / (1.0 + normal.z()) + 2.0 * z * normal.transpose();
}

void ContactLabels::sum_units(Field& field, double dt) {
  field.view_from_pad();
  const Eigen::Matrix3d to_pad = field.pad_in_surface().rotation.transpose();
  const double rate = 1.0 / dt;
  touching_elements_ = 0;
  sticking_elements_ = 0;
  for (std::size_t u = 0; u < units_.size(); ++u) {
    const std::size_t first = units_[u].first, end = first + units_[u].count;
    Eigen::Vector3d force = field.force_on_pad(first), deflection = field.deflection(first), slip = field.slip_in_pad(first);
    Eigen::Vector3d tangential = field.tangential_force(first);
    double limit = field.stick_limit(first), distance = field.slip_path(first);
    UnitCount count;
    const auto tally = [&count](ElementState state) {
      count.touching += state != ElementState::detached ? 1 : 0;
      count.slipping += state == ElementState::slip ? 1 : 0;
    };
    tally(field.state(first));
    for (std::size_t i = first + 1; i < end; ++i) {
      force += field.force_on_pad(i);
      deflection += field.deflection(i);
      slip += field.slip_in_pad(i);
      tangential += field.tangential_force(i);
      limit += field.stick_limit(i);
      distance += field.slip_path(i);
      tally(field.state(i));
    }
    const double share = shares_[u];
    const auto c = static_cast<Eigen::Index>(u);
    if (u == 0 || !field.on_plane()) contact_plane_.face(to_pad * field.normal(first));
    frame_.force.col(c) = force.array();
    frame_.contact_force.col(c) = contact_plane_.turned(force).array();
    frame_.displacement.col(c) = (share * deflection).array();
    frame_.slip_velocity.col(c) = (share * rate) * contact_plane_.turned(slip).head<2>().array();
    frame_.slip_distance[c] = share * distance;
    frame_.margin[c] = count.touching == 0 ? nan : 1.0 - field.cone_gauge(tangential, field.normal(first), limit);
    frame_.unit_state[u] = count.touching == 0                ? UnitState::detached
                           : count.slipping == 0              ? UnitState::stick
                           : count.slipping == count.touching ? UnitState::slip
                                                              : UnitState::partial;
    touching_elements_ += count.touching;
    sticking_elements_ += count.touching - count.slipping;
  }
}

void ContactLabels::judge_pad() {
  std::size_t touching = 0, slipping = 0, touched_by_slip = 0;
  for (const UnitState state : frame_.unit_state) {
    touching += state != UnitState::detached ? 1 : 0;
    slipping += state == UnitState::slip ? 1 : 0;
    touched_by_slip += state == UnitState::slip || state == UnitState::partial ? 1 : 0;
  }
  frame_.state = pad_state(touching, slipping);
  frame_.state_micro = pad_state(touching, touched_by_slip);
  frame_.stuck_fraction = touching == 0 ? nan : static_cast<double>(sticking_elements_) / static_cast<double>(touching_elements_);
}

// The rigid motion is one in the plane that all units touch; on a curved surface, where each has its own, in the pad's.
void ContactLabels::fit_slip_motion(bool on_plane, double dt) {
  frame_.slip_direction = nan;
  frame_.slip_centre.setConstant(nan);
  if (frame_.state_micro == PadState::no_contact || frame_.state_micro == PadState::non_slip) return;

  double n = 0.0, fastest = 0.0;
  double x_sum = 0.0, y_sum = 0.0, z_sum = 0.0, vx_sum = 0.0, vy_sum = 0.0, moment_sum = 0.0, spread_sum = 0.0;
  for (std::size_t u = 0; u < units_.size(); ++u) {
    if (frame_.unit_state[u] != UnitState::slip && frame_.unit_state[u] != UnitState::partial) continue;
    const auto c = static_cast<Eigen::Index>(u);
    // The slipping tips are where the load has bent them to: in a steady turn they trail on smaller circles than their roots.
    const Eigen::Vector3d in_pad = undeformed_.col(c) + frame_.displacement.col(c);
    const Eigen::Vector3d tip = on_plane ? contact_plane_.turned(in_pad) : in_pad;
    const double x = tip.x(), y = tip.y();
    const double vx = frame_.slip_velocity(0, c), vy = frame_.slip_velocity(1, c);
    n += 1.0;
    x_sum += x;
    y_sum += y;
    z_sum += tip.z();
    vx_sum += vx;
    vy_sum += vy;
    moment_sum += x * vy - y * vx;
    spread_sum += x * x + y * y;
    fastest = std::max(fastest, vx * vx + vy * vy);
  }
  const Eigen::Array2d mean_position(x_sum / n, y_sum / n), mean_velocity(vx_sum / n, vy_sum / n);
  const double moment = moment_sum - (x_sum * vy_sum - y_sum * vx_sum) / n;
  const double spread = std::max(0.0, spread_sum - (x_sum * x_sum + y_sum * y_sum) / n);
  fastest = std::sqrt(fastest);
  const double speed = std::sqrt(mean_velocity.square().sum());
  const double rate = n > 1.0 && spread > 0.0 ? moment / spread : 0.0;  // rad/s
  if (speed > negligible * fastest) frame_.slip_direction = std::atan2(mean_velocity.y(), mean_velocity.x());
  if (std::abs(rate) * std::sqrt(spread) > negligible * fastest) {
    const Eigen::Array2d centre = mean_position + Eigen::Array2d(-mean_velocity.y(), mean_velocity.x()) / rate;
    const Eigen::Vector3d in_plane(centre.x(), centre.y(), z_sum / n);
    frame_.slip_centre = (on_plane ? contact_plane_.turned_back(in_plane) : in_plane).head<2>().array();
    frame_.slip_angle += rate * dt;
  }
}

// Replays the step's element events in order of time and reports what each does to its unit.
void ContactLabels::collect_events(const Field& field, double time, double dt) {
  in_order_.assign(field.events().begin(), field.events().end());
  std::stable_sort(in_order_.begin(), in_order_.end(), [this](const ElementEvent& a, const ElementEvent& b) {
    const auto unit_a = unit_of_element_[a.element], unit_b = unit_of_element_[b.element];
    return unit_a != unit_b ? unit_a < unit_b : a.fraction < b.fraction;
  });
  const auto change = [](std::uint32_t& count, bool was, bool is) {
    count += static_cast<std::uint32_t>(is) - static_cast<std::uint32_t>(was);
  };

  for (std::size_t k = 0; k < in_order_.size();) {
    const std::uint32_t unit = unit_of_element_[in_order_[k].element];
    const double fraction = in_order_[k].fraction;
    const UnitCount before = counts_[unit];
    UnitCount& now = counts_[unit];
    for (; k < in_order_.size() && unit_of_element_[in_order_[k].element] == unit && in_order_[k].fraction <= fraction + together;
         ++k) {
      const ElementEvent& event = in_order_[k];
      change(now.touching, event.from != ElementState::detached, event.to != ElementState::detached);
      change(now.slipping, event.from == ElementState::slip, event.to == ElementState::slip);
    }
    const auto report = [&](EventKind kind) { frame_.events.push_back({time - (1.0 - fraction) * dt, unit, kind}); };
    const bool slipped = before.touching > 0 && before.slipping == before.touching;
    const bool slips = now.touching > 0 && now.slipping == now.touching;
    if (before.touching == 0 && now.touching > 0) report(EventKind::touch);
    if (now.slipping > 0 && before.slipping == 0) report(EventKind::micro);
    if (now.slipping > 0 && slipped && !slips) report(EventKind::part_sticks);
    if (slips && !slipped) report(EventKind::slip);
    if (before.slipping > 0 && now.slipping == 0 && now.touching > 0) report(EventKind::stick);
    if (before.touching > 0 && now.touching == 0) report(EventKind::detach);
  }
  std::stable_sort(frame_.events.begin(), frame_.events.end(),
                   [](const ContactEvent& a, const ContactEvent& b) { return a.time < b.time; });
}

}  // namespace slipbench
