#include "sim/mujoco/linear/stability.h"
#include "sim/mujoco/releases/mujoco_library.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace slipbench {
namespace {

// Adds G' B G of a 3x3 spring B at the lever r.
void add_spring(Matrix6d& total, const Eigen::Matrix3d& spring, const Eigen::Vector3d& r) {
  const Eigen::Matrix3d cross = cross_matrix(r);
  const Eigen::Matrix3d turned = spring * cross;
  total.topLeftCorner<3, 3>() += spring;
  total.topRightCorner<3, 3>() -= turned;
  total.bottomLeftCorner<3, 3>() -= turned.transpose();
  total.bottomRightCorner<3, 3>() += cross.transpose() * turned;
}

// Returns k_n n n' + k_t across.
Eigen::Matrix3d spring(double k_n, const Eigen::Vector3d& n, double k_t, const Eigen::Matrix3d& across) {
  return k_n * n * n.transpose() + k_t * across;
}

// Returns J M^-1 J' of all pads.
Eigen::MatrixXd delassus_of(ModelView m, DataView d, std::span<const PadOnBodies> pads) {
  RowMatrix jacobians(static_cast<Eigen::Index>(6 * pads.size()), static_cast<Eigen::Index>(m.nv()));
  for (std::size_t i = 0; i < pads.size(); ++i) {
    relative_jacobian(m, d, pads[i], jacobians.row(static_cast<Eigen::Index>(6 * i)).data());
  }
  return delassus(m, d, jacobians);
}

// Returns the largest eigenvalue of R A R' with R = diag(roots).
double rooted_eigenvalue(const Eigen::MatrixXd& a, std::span<const Matrix6d> roots) {
  Eigen::MatrixXd product(a.rows(), a.cols());
  for (std::size_t i = 0; i < roots.size(); ++i) {
    for (std::size_t j = 0; j < roots.size(); ++j) {
      const auto row = static_cast<Eigen::Index>(6 * i), column = static_cast<Eigen::Index>(6 * j);
      product.block<6, 6>(row, column) = roots[i] * a.block<6, 6>(row, column) * roots[j].transpose();
    }
  }
  return std::max(0.0, largest_eigenvalue(product));
}

}  // namespace

PadTangent stuck_tangent(const PadLayout& layout, const Pose& pad, const Eigen::Vector3d& point, double viscous_time) {
  PadTangent tangent;
  for (const Element& element : layout.elements) {
    const Eigen::Vector3d n = -(pad.rotation * element.axis);
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - n * n.transpose();
    const Eigen::Vector3d r = pad * element.tip - point;
    const double c_n = element.c_normal + viscous_time * element.k_normal;
    const double c_t = element.c_tangential + viscous_time * element.k_tangential;
    add_spring(tangent.stiffness, spring(element.k_normal, n, element.k_tangential, across), r);
    add_spring(tangent.damping, spring(c_n, n, c_t, across), r);
  }
  return tangent;
}

PadTangent field_tangent(const Field& field, const Pose& surface, const Eigen::Vector3d& point, double viscous_time) {
  PadTangent tangent;
  for (std::size_t i = 0; i < field.size(); ++i) {
    if (field.state(i) == ElementState::detached) continue;
    const Element& element = field.layout().elements[i];
    const Eigen::Vector3d n = surface.rotation * field.normal(i);
    Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - n * n.transpose();
    const bool slips = field.state(i) == ElementState::slip;
    if (slips && field.slip_step(i) != Eigen::Vector3d::Zero()) {
      const Eigen::Vector3d slip = surface.rotation * field.slip_step(i);
      const double held = field.tangential_force(i).norm(), distance = slip.norm();
      const Eigen::Vector3d along = slip / distance;
      across = held / (held + element.k_tangential * distance) * (across - along * along.transpose()).eval() +
               field.sliding_share(i) * along * along.transpose();
    }
    const Eigen::Vector3d r = surface * field.contact_point(i) - point;
    add_spring(tangent.stiffness, spring(element.k_normal, n, element.k_tangential, across), r);
    const double c_n = element.c_normal + viscous_time * element.k_normal;
    const double c_t = element.c_tangential + (slips ? 0.0 : viscous_time * element.k_tangential);
    if (c_n > 0.0 || c_t > 0.0) add_spring(tangent.damping, spring(c_n, n, c_t, across), r);
  }
  return tangent;
}

// Bit-identical to the difference of mj_jac's results for both bodies, along the degrees of freedom
// of either.
void relative_jacobian(ModelView m, DataView d, const PadOnBodies& pad, double* rows) {
  Eigen::Map<RowMatrix> jacobian(rows, 6, static_cast<Eigen::Index>(m.nv()));
  std::fill_n(rows, jacobian.size(), 0.0);
  for (const bool of_pad : {true, false}) {
    const int body = of_pad ? pad.pad_body : pad.object_body;
    const int moving = m.body_weldid()[body];
    const Eigen::Vector3d arm = pad.point - Eigen::Map<const Eigen::Vector3d>(d.subtree_com() + 3 * m.body_rootid()[body]);
    for (int dof = moving == 0 ? -1 : m.body_dofadr()[moving] + m.body_dofnum()[moving] - 1; dof >= 0;
         dof = m.dof_parentid()[dof]) {
      const Eigen::Map<const Eigen::Vector3d> turn(d.cdof() + 6 * dof), shift(d.cdof() + 6 * dof + 3);
      Vector6d column;
      column << turn.cross(arm) + shift, turn;
      of_pad ? jacobian.col(dof) = column : jacobian.col(dof) -= column;
    }
  }
}

Eigen::MatrixXd delassus(ModelView m, DataView d, const RowMatrix& jacobians) {
  RowMatrix solved(jacobians.rows(), jacobians.cols());
  m.mujoco().mj_solveM(m.get(), d.get(), solved.data(), jacobians.data(), static_cast<int>(jacobians.rows()));
  const Eigen::MatrixXd a = jacobians * solved.transpose();
  return 0.5 * (a + a.transpose());  // asymmetry is only rounding
}

Vibration fastest_vibration(ModelView m, DataView d, std::span<const PadOnBodies> pads, std::span<const PadTangent> tangents) {
  if (pads.size() != tangents.size()) throw std::invalid_argument("fastest_vibration: every pad needs one tangent");
  if (pads.empty() || m.nv() == 0) return {};
  std::vector<Matrix6d> stiffness, damping;
  for (const PadTangent& tangent : tangents) {
    stiffness.push_back(root(tangent.stiffness));
    damping.push_back(root(tangent.damping));
  }
  const Eigen::MatrixXd a = delassus_of(m, d, pads);
  return {std::sqrt(rooted_eigenvalue(a, stiffness)), rooted_eigenvalue(a, damping)};
}

Vibration vibration_bound(ModelView m, DataView d, std::span<const PadOnBodies> pads, std::span<const PadTangent> tangents) {
  if (pads.size() != tangents.size()) throw std::invalid_argument("vibration_bound: every pad needs one tangent");
  if (pads.empty() || m.nv() == 0) return {};
  const Eigen::MatrixXd a = delassus_of(m, d, pads);
  Eigen::MatrixXd product(a.rows(), a.cols());
  const auto bound = [&](Matrix6d PadTangent::*part) {
    for (std::size_t i = 0; i < tangents.size(); ++i) {
      const auto column = static_cast<Eigen::Index>(6 * i);
      product.middleCols<6>(column).noalias() = a.middleCols<6>(column) * tangents[i].*part;
    }
    return std::sqrt(product.cwiseProduct(product.transpose()).sum());
  };
  return {std::sqrt(bound(&PadTangent::stiffness)), bound(&PadTangent::damping)};
}

LinearModel linear_model(ModelView m, DataView d, std::span<const PadOnBodies> pads, std::span<const PadTangent> tangents) {
  if (pads.size() != tangents.size()) throw std::invalid_argument("linear_model: every pad needs one tangent");
  const auto nv = static_cast<Eigen::Index>(m.nv());
  const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(nv, nv);
  LinearModel model{none, none, none, none};
  RowMatrix mass(nv, nv);
  full_inertia(m, d, mass.data());
  model.mass = mass;
  RowMatrix jacobian(6, nv);
  for (std::size_t i = 0; i < pads.size(); ++i) {
    relative_jacobian(m, d, pads[i], jacobian.data());
    model.stiffness += jacobian.transpose() * tangents[i].stiffness * jacobian;
    model.damping += jacobian.transpose() * tangents[i].damping * jacobian;
  }
  if ((m.opt_disableflags() & mj::disable_damper) == 0) {
    const bool explicitly = m.opt_integrator() == mj::euler && (m.opt_disableflags() & mj::disable_eulerdamp) != 0;
    (explicitly ? model.damping : model.joint_damping).diagonal() += Eigen::Map<const Eigen::VectorXd>(m.dof_damping(), nv);
  }
  return model;
}

Stepping stepping_of(ModelView m) {
  return m.opt_integrator() == mj::runge_kutta ? Stepping::runge_kutta : Stepping::velocity_first;
}

}  // namespace slipbench
