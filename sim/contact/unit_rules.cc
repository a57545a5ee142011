#include "sim/contact/unit_rules.h"

#include <cmath>
#include <limits>

#include "sim/core/math.h"

namespace slipbench::unit_rules {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// A fitted translation or rotation below this share of the slip's speed is rounding, not motion.
constexpr double negligible = 1e-6;

// `touched_by_slip`: number of units that slip at least in part.
[[gnu::always_inline]] inline void judge(ContactFrame& frame, const Count& elements, const Count& units,
                                         std::uint32_t touched_by_slip) {
  frame.state_micro = pad_state(units.touching, touched_by_slip);
  frame.state = frame.unit_state.size() == 1 ? frame.state_micro : pad_state(units.touching, units.slipping);
  frame.stuck_fraction =
      elements.touching == 0 ? nan : static_cast<double>(elements.touching - elements.slipping) / elements.touching;
}

}  // namespace

void ContactPlane::face(const Eigen::Vector3d& normal) {
  if (normal == normal_) return;
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  normal_ = normal;
  level_ = normal == z;
  if (normal == -z) {  // all half turns are equally short; uses the one about X
    turn_ = Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();
    return;
  }
  const Eigen::Vector3d middle = normal + z;
  turn_ = Eigen::Matrix3d::Identity() - middle * middle.transpose() / (1.0 + normal.z()) + 2.0 * z * normal.transpose();
}

void judge_pad(ContactFrame& frame, const Count& elements) {
  Count units;
  std::uint32_t touched_by_slip = 0;
  for (const UnitState unit : frame.unit_state) {
    units.touching += static_cast<std::uint32_t>(unit != UnitState::detached);
    units.slipping += static_cast<std::uint32_t>(unit == UnitState::slip);
    touched_by_slip += static_cast<std::uint32_t>(unit >= UnitState::slip);  // or partial
  }
  judge(frame, elements, units, touched_by_slip);
}

void judge_pad_of_elements(ContactFrame& frame, const Count& elements) { judge(frame, elements, elements, elements.slipping); }

double fit_slip_motion(ContactFrame& frame, const Eigen::Array3Xd& undeformed, const ContactPlane& plane) {
  frame.slip_direction = nan;
  frame.slip_centre.setConstant(nan);
  if (frame.state_micro == PadState::no_contact || frame.state_micro == PadState::non_slip) return 0.0;

  double n = 0.0, fastest = 0.0;
  double x_sum = 0.0, y_sum = 0.0, z_sum = 0.0, vx_sum = 0.0, vy_sum = 0.0, moment_sum = 0.0, spread_sum = 0.0;
  for (std::size_t u = 0; u < frame.unit_state.size(); ++u) {
    if (frame.unit_state[u] != UnitState::slip && frame.unit_state[u] != UnitState::partial) continue;
    const auto c = static_cast<Eigen::Index>(u);
    // The slipping tips are displaced by the load: in a steady turn they trail on smaller circles
    // than their roots.
    const Eigen::Vector3d tip = plane.turned(undeformed.col(c) + frame.displacement.col(c));
    const double x = tip.x(), y = tip.y();
    const double vx = frame.slip_velocity(0, c), vy = frame.slip_velocity(1, c);
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
  if (speed > negligible * fastest) frame.slip_direction = math::atan2(mean_velocity.y(), mean_velocity.x());
  if (!(std::abs(rate) * std::sqrt(spread) > negligible * fastest)) return 0.0;
  const Eigen::Array2d centre = mean_position + Eigen::Array2d(-mean_velocity.y(), mean_velocity.x()) / rate;
  frame.slip_centre = plane.turned_back({centre.x(), centre.y(), z_sum / n}).head<2>().array();
  return rate;
}

}  // namespace slipbench::unit_rules
