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
  return resists / (columns_.k_tangential[i] + resists);
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
    const Eigen::Vector3d force = columns_.force.at(i) - columns_.normal.at(i) * normal_force(i);
    total.force += force;
    total.torque += columns_.contact.at(i).cross(force);
  }
  return total;
}

Wrench FieldResults::wrench_on_pad() const {
  Wrench total{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  for (std::size_t i = 0; i < count_; ++i) {
    const Eigen::Vector3d force = columns_.normal.at(i) * normal_force(i) - transmitted().at(i);
    total.force += force;
    total.torque += (columns_.contact.at(i) - pose_.position).cross(force);
  }
  return {pose_.rotation.transpose() * total.force, pose_.rotation.transpose() * total.torque};
}

Wrench FieldResults::damped_wrench_on_pad(const Twist& motion, double tau) const {
  if (touching_ == 0) return {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  return kernel::damped_wrench_on_pad(columns_, pose_.position, motion, tau, effects_.cone.get(), active());
}

void FieldResults::add_sunk(double* depth_of) const {
  for (std::size_t i = 0; i < count_; ++i) {
    if (state(i) == ElementState::detached) depth_of[i] += columns_.depth[i];
  }
}

// p'C p/2 + q'C q/2: forces times displacements of the surface.
kernel::SpringSums FieldResults::skin_sums() const {
  kernel::SpringSums sums{Eigen::Vector3d::Zero(), 0.0, 0.0};
  for (std::size_t i = 0; i < count_; ++i) {
    if (state(i) == ElementState::detached) continue;
    const Eigen::Vector3d t = tangential_force(i);
    sums.force_on_pad += normal_force(i) * normal(i) - t;
    sums.elastic += 0.5 * (normal_force(i) * penetration(i) + t.dot(stretch(i)));
    sums.slip_loss += t.dot(slip_step(i));
  }
  return sums;
}

}  // namespace slipbench
