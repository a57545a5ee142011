#include "sim/contact/field_results.h"

#include <bit>
#include <cstdlib>
#include <utility>

namespace slipbench {

FieldResults::FieldResults(const PadLayout& layout, const Surface& surface, Friction friction, FieldEffects&& effects)
    : layout_(layout),
      contacts_(layout, surface),
      friction_(friction),
      effects_(std::move(effects)),
      count_(layout.elements.size()),
      padded_((count_ + kernel::lanes - 1) / kernel::lanes * kernel::lanes) {}

void FieldResults::Free::operator()(double* block) const { std::free(block); }

double FieldResults::sliding_share(std::size_t i) const {
  if (!effects_.rate || state(i) != ElementState::slip || !(step_ > 0.0)) return 0.0;
  const double resists = tangential_force(i).norm() * effects_.rate->growth(slip_step(i).norm() / step_) / step_;
  return resists / (columns_[k_tangential][i] + resists);
}

bool FieldResults::level() const {
  const Eigen::Matrix3d& r = pose_.rotation;
  const auto bits = [&r](int row, int column) { return std::bit_cast<std::uint64_t>(r(row, column)); };
  return (bits(0, 2) | bits(1, 2) | bits(2, 0) | bits(2, 1)) == 0 && r(2, 2) == 1.0 && on_plane() && !has_skin() &&
         !effects_.cone && count_ >= kernel::lanes;
}

Wrench FieldResults::wrench_on_surface() const {
  Wrench total{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  for (std::size_t i = 0; i < count_; ++i) {
    const Eigen::Vector3d force = vector(force_x, i) - vector(normal_x, i) * normal_force(i);
    total.force += force;
    total.torque += vector(contact_x, i).cross(force);
  }
  return total;
}

Wrench FieldResults::wrench_on_pad() const {
  Wrench total{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  for (std::size_t i = 0; i < count_; ++i) {
    const Eigen::Vector3d force = vector(normal_x, i) * normal_force(i) - vector(transmitted_, i);
    total.force += force;
    total.torque += (vector(contact_x, i) - pose_.position).cross(force);
  }
  return {pose_.rotation.transpose() * total.force, pose_.rotation.transpose() * total.torque};
}

Wrench FieldResults::damped_wrench_on_pad(const Twist& motion, double tau) const {
  if (touching_ == 0) return {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  return kernel::damped_wrench_on_pad(columns_, pose_.position, motion, tau, effects_.cone.get(), active());
}

}  // namespace slipbench
