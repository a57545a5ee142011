#include "sim/field/contact_labels.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace slipbench {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

}  // namespace

// Sums a unit's elements on one surface and hands over what came out, in the pad frame but for the tangential force and the normal, which is
// that of the element that is pressed hardest: one beside the surface meets another face. Handed over one by one and not as a struct, so that
// all of it stays in registers: this is a third of a labelled step.
template <class Use>
[[gnu::always_inline]] inline void ContactLabels::sum_unit(const Field& field, const UnitRange& unit, Use&& use) {
  const std::size_t first = unit.first, end = unit.first + unit.count;
  Eigen::Vector3d force = field.force_on_pad(first), deflection = field.deflection(first), slip = field.slip_in_pad(first);
  Eigen::Vector3d tangential = field.tangential_force(first), normal = field.normal(first);
  double distance = field.slip_path(first), limit = field.stick_limit(first), press = field.normal_force(first), hardest = press;
  unit_rules::Count count;
  count.add(field.state(first));
  for (std::size_t i = first + 1; i < end; ++i) {
    force += field.force_on_pad(i);
    deflection += field.deflection(i);
    slip += field.slip_in_pad(i);
    tangential += field.tangential_force(i);
    distance += field.slip_path(i);
    limit += field.stick_limit(i);
    press += field.normal_force(i);
    count.add(field.state(i));
    if (field.normal_force(i) > hardest) {
      hardest = field.normal_force(i);
      normal = field.normal(i);
    }
  }
  use(force, deflection, slip, distance, tangential, normal, limit, press, count);
}

ContactLabels::ContactLabels(const PadLayout& layout) : units_(layout.units) {
  const auto n = static_cast<Eigen::Index>(units_.size());
  unit_of_element_.resize(layout.elements.size());
  undeformed_.resize(3, n);
  for (std::size_t u = 0; u < units_.size(); ++u) {
    Eigen::Array3d sum(0.0, 0.0, 0.0);
    for (std::size_t i = 0; i < units_[u].count; ++i) sum += layout.elements[units_[u].first + i].tip.array();
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
  changes_.reserve(layout.elements.size());
  frame_.events.reserve(3 * layout.elements.size());
}

const ContactFrame& ContactLabels::update(std::span<Field> fields, double time, double dt) {
  judge(fields, time, dt);
  settle(fields, dt);
  return frame_;
}

const ContactFrame& ContactLabels::judge(std::span<Field> fields, double time, double dt) {
  frame_.time = time;
  sum_units(fields, dt);
  unit_rules::judge_pad(frame_, elements_);
  const bool one_plane = fields.size() == 1 && fields.front().on_plane();
  slip_rate_ = unit_rules::fit_slip_motion(frame_, undeformed_, one_plane ? contact_plane_ : unit_rules::ContactPlane{});
  return frame_;
}

void ContactLabels::settle(std::span<const Field> fields, double dt) {
  frame_.slip_angle += slip_rate_ * dt;
  frame_.events.clear();
  changes_.clear();
  for (const Field& field : fields) {
    for (const ElementEvent& event : field.events()) changes_.push_back({event, unit_of_element_[event.element]});
  }
  if (changes_.empty()) return;
  const auto before = [&](std::uint32_t unit) { return count_before(fields, unit); };
  unit_rules::report_unit_events(changes_, before, frame_.time, dt, frame_.events);
}

void ContactLabels::sum_units(std::span<Field> fields, double dt) {
  for (Field& field : fields) field.view_from_pad();
  const double rate = 1.0 / dt;
  elements_ = {};
  Eigen::Vector3d faced(0.0, 0.0, 0.0);  // the normal that the contact plane was turned for last
  for (std::size_t u = 0; u < units_.size(); ++u) {
    const double share = shares_[u];
    const auto c = static_cast<Eigen::Index>(u);
    // `field`: that of the surface that presses hardest.
    const auto write = [&](const Field& field, const Eigen::Vector3d& force, const Eigen::Vector3d& deflection,
                           const Eigen::Vector3d& slip, double distance, const Eigen::Vector3d& tangential,
                           const Eigen::Vector3d& normal, double limit, const unit_rules::Count& count)
        __attribute__((always_inline)) {
      frame_.force.col(c) = force.array();
      frame_.contact_force.col(c) = contact_plane_.turned(force).array();
      frame_.displacement.col(c) = (share * deflection).array();
      frame_.slip_velocity.col(c) = (share * rate) * contact_plane_.turned(slip).head<2>().array();
      frame_.slip_distance[c] = share * distance;
      frame_.margin[c] = count.touching == 0 ? nan : 1.0 - field.cone_gauge(tangential, normal, limit);
      frame_.unit_state[u] = unit_rules::unit_state(count);
      elements_.touching += count.touching;
      elements_.slipping += count.slipping;
    };
    const auto face = [&](const Field& field, const Eigen::Vector3d& normal) {
      contact_plane_.face(field.pad_in_surface().rotation.transpose() * normal);
    };

    if (fields.size() == 1) {
      const Field& field = fields.front();
      sum_unit(
          field, units_[u],
          [&](const auto& force, const auto& deflection, const auto& slip, double distance, const auto& tangential,
              const auto& normal, double limit, double /*press*/, const unit_rules::Count& count) __attribute__((always_inline)) {
            if (u == 0 || (!field.on_plane() && normal != faced)) {
              faced = normal;
              face(field, normal);
            }
            write(field, force, deflection, slip, distance, tangential, normal, limit, count);
          });
      continue;
    }
    UnitSum sum;
    const Field* hardest = &fields.front();
    for (const Field& field : fields) {
      sum_unit(field, units_[u],
               [&](const auto& force, const auto& deflection, const auto& slip, double distance, const auto& tangential,
                   const auto& normal, double limit, double press, const unit_rules::Count& count) {
                 sum.force += force;
                 sum.deflection += deflection;
                 sum.slip += slip;
                 sum.distance += distance;
                 sum.count.touching += count.touching;
                 sum.count.slipping += count.slipping;
                 if (!(press > sum.press)) return;
                 sum.press = press;
                 sum.limit = limit;
                 sum.tangential = tangential;
                 sum.normal = normal;
                 hardest = &field;
               });
    }
    face(*hardest, sum.normal);
    write(*hardest, sum.force, sum.deflection, sum.slip, sum.distance, sum.tangential, sum.normal, sum.limit, sum.count);
  }
}

unit_rules::Count ContactLabels::count_before(std::span<const Field> fields, std::uint32_t unit) const {
  unit_rules::Count count;
  for (const Field& field : fields) {
    for (std::size_t i = 0; i < units_[unit].count; ++i) count.add(field.state_before(units_[unit].first + i));
  }
  return count;
}

}  // namespace slipbench
