#include "sim/mujoco/pads/implicit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>

#include <Eigen/Geometry>

#include "sim/core/math/rotation.h"
#include "sim/core/quantity.h"
#include "sim/mujoco/pads/effective_metric.h"
#include "sim/mujoco/releases/mujoco_library.h"

namespace slipbench {
namespace {

constexpr int max_iterations = 25;
constexpr double tolerance = 1e-10;  // share of the terms of the predicted velocity
// Share of the last step in the memory. A contact of MuJoCo responds to the field within the step.
// If the next prediction, to which the field responds, used all of that response, a stick-slip
// flicker with the period of the step would persist. With half of it the flicker dies out.
constexpr double newest_share = 0.5;

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

Index block(std::size_t i) { return static_cast<Index>(6 * i); }

Matrix3d rotation_by(const Vector3d& angle) {
  const double size = angle.norm();
  if (size == 0.0) return Matrix3d::Identity();
  return rotation_about(angle / size, size);
}

// Rows of the metric: scale_k (values_k' J)'(values_k' J).
class MetricRows {
 public:
  // `scale` multiplies all of K. J has six rows.
  void add(const Matrix6d& k, double scale, const Eigen::Ref<const RowMatrix>& jacobian) {
    columns_.clear();
    for (Index c = 0; c < jacobian.cols(); ++c) {
      if ((jacobian.col(c).array() != 0.0).any()) columns_.push_back(static_cast<int>(c));
    }
    if (columns_.empty()) return;
    const Squares terms = squares(k);
    for (int term = 0; term < 6; ++term) {
      if (terms.scale[static_cast<std::size_t>(term)] == 0.0) continue;
      indices_.push_back(static_cast<int>(columns_.size()));
      indices_.push_back(0);
      values_.push_back(scale * terms.scale[static_cast<std::size_t>(term)]);
      values_.push_back(0.0);
      for (const int c : columns_) {
        indices_.push_back(c);
        values_.push_back(terms.values.col(term).dot(jacobian.col(c)));
      }
    }
  }

  // Returns false if the arena is full.
  [[nodiscard]] bool write(DataView d) const { return indices_.empty() || append_to_metric(d, indices_, values_); }

 private:
  std::vector<int> columns_, indices_;
  std::vector<double> values_;
};

// True if a tendon in the metric connects the object, or a body welded to it, with the pad's
// kinematic tree.
bool joined(ModelView m, int pad_body, int object_body) {
  const auto moves_with_pad = [&](int body) {
    return body == m.body_weldid()[pad_body] ||
           (m.body_treeid()[body] >= 0 && m.body_treeid()[body] == m.body_treeid()[pad_body]);
  };
  for (int t = 0; t < m.ntendon(); ++t) {
    if (!(m.tendon_damping()[t] > 0.0)) continue;
    bool at_pad = false, at_object = false;
    for (int w = m.tendon_adr()[t]; w < m.tendon_adr()[t] + m.tendon_num()[t]; ++w) {
      if (m.wrap_type()[w] != mj::site_wrap) continue;
      const int body = m.body_weldid()[m.site_bodyid()[m.wrap_objid()[w]]];
      at_pad |= moves_with_pad(body);
      at_object |= body == m.body_weldid()[object_body];
    }
    if (at_pad && at_object) return true;
  }
  return false;
}

std::string body_name(ModelView m, int body) {
  if (const char* name = m.name_of(mj::body, body); name != nullptr) return name;
  return "number " + std::to_string(body);
}

}  // namespace

std::string implicit_refusal(ModelView m, std::span<const ImplicitPad> pads) {
  if (!m.mujoco().has_metric()) {
    return std::string("needs the integrator discrete, with which pads do not work in MuJoCo ") + m.mujoco().mj_versionString() +
           "; use MuJoCo 3.14 or later, or the explicit solver";
  }
  std::vector<std::string> missing;
  if (m.opt_integrator() != m.mujoco().layout.discrete) missing.emplace_back("integrator=\"discrete\"");
  if (m.opt_noslip_iterations() != 0) missing.emplace_back("noslip_iterations=\"0\" (the noslip solver does not see the pads)");
  if (m.opt_iterations() < implicit_iterations) {
    missing.push_back("iterations=\"" + std::to_string(implicit_iterations) + "\" or more, found " +
                      std::to_string(m.opt_iterations()));
  }
  if (m.opt_solver() == mj::pgs) missing.emplace_back("solver=\"Newton\" or \"CG\" (PGS does not see the pads)");
  if ((m.opt_disableflags() & mj::disable_damper) != 0)
    missing.emplace_back("the flag damper enabled (without it MuJoCo ignores tendons in its solver)");
  if (sleep_enabled(m)) missing.emplace_back("the flag sleep disabled");
  for (const ImplicitPad& pad : pads) {
    if (joined(m, pad.pad_body, pad.object_body)) continue;
    const std::string tendon =
        "a tendon between a site on body " + body_name(m, pad.pad_body) + " and a site on body " + body_name(m, pad.object_body) +
        ", <spatial damping=\"1e-9\"><site site=\"...\"/><site site=\"...\"/></spatial> in <tendon> (without it MuJoCo omits the pad from its solver)";
    if (std::ranges::find(missing, tendon) == missing.end()) missing.push_back(tendon);
  }
  std::string all;
  for (const std::string& one : missing) all += (all.empty() ? "needs " : "; ") + one;
  return all;
}

std::string implicit_self_test(ModelView m, std::span<const ImplicitPad> pads) {
  const MujocoLibrary& mujoco = m.mujoco();
  const std::unique_ptr<mjModel_, void (*)(mjModel_*)> owned_model(mujoco.mj_copyModel(nullptr, m.get()), mujoco.mj_deleteModel);
  const ModelView copy(owned_model.get(), mujoco);
  copy.nplugin() = 0;  // the fields themselves are plugins
  std::fill_n(&copy.actuator_plugin()[0], static_cast<Index>(copy.nactuator()), -1);
  // MuJoCo's shortcuts around the metric are those without constraints
  copy.opt_disableflags() |= mj::disable_constraint;
  const std::unique_ptr<mjData_, void (*)(mjData_*)> owned_data(mujoco.mj_makeData(copy.get()), mujoco.mj_deleteData);
  const DataView d(owned_data.get(), mujoco);
  const auto nv = static_cast<Index>(copy.nv());
  const double h = copy.opt_timestep();
  std::mt19937_64 bits(1);
  for (Index i = 0; i < nv; ++i) d.qvel()[i] = static_cast<double>(bits() >> 11) * 0x1p-53 - 0.5;

  MatrixXd metric = MatrixXd::Zero(nv, nv);  // J' h^2 K J
  MetricRows rows;
  mujoco.mj_fwdPosition(copy.get(), d.get());
  for (const ImplicitPad& pad : pads) {
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> turn(d.xmat() + 9 * pad.pad_body);
    const Eigen::Map<const Vector3d> place(d.xpos() + 3 * pad.pad_body);
    const Pose at = Pose{turn, place} * pad.pad_in_body;
    const Matrix6d k = stuck_tangent(*pad.layout, at, at.position, 0.0).stiffness;
    RowMatrix jacobian(6, nv);
    relative_jacobian(copy, d, {pad.pad_body, pad.object_body, at.position}, jacobian.data());
    rows.add(k, h * h, jacobian);
    metric += h * h * jacobian.transpose() * k * jacobian;
  }
  const auto accelerate = [&](bool with_rows) -> std::string {
    mujoco.mj_fwdPosition(copy.get(), d.get());
    mujoco.mj_fwdVelocity(copy.get(), d.get());
    if (with_rows) {
      if (!metric_is_on(d)) return " MuJoCo built no effective metric for this model";
      if (!rows.write(d)) return "MuJoCo's arena is full; raise <size memory=\"...\"/>";
      shift_by_metric(copy, d);
    }
    mujoco.mj_fwdActuation(copy.get(), d.get());
    mujoco.mj_fwdAcceleration(copy.get(), d.get());
    mujoco.mj_fwdConstraint(copy.get(), d.get());
    return {};
  };

  if (std::string error = accelerate(true); !error.empty()) return error;
  const VectorXd with_rows = Eigen::Map<VectorXd>(d.qacc(), nv);
  const VectorXd v = Eigen::Map<VectorXd>(d.qvel(), nv);
  Eigen::Map<VectorXd>(d.qfrc_applied(), nv) = -metric * (v + h * with_rows) / h;
  if (std::string error = accelerate(false); !error.empty()) return error;
  const VectorXd with_force = Eigen::Map<VectorXd>(d.qacc(), nv);
  // Relative to the change made by the rows, so that an ignored field is noticed despite large
  // accelerations. For stiff pads the force is a difference of large numbers, which costs digits:
  // h^2 K / m may be 1e6.
  const double difference = (with_rows - with_force).norm(), size = with_rows.norm() + v.norm() / h;
  if (std::isfinite(difference) && difference <= 1e-6 * size) return {};
  return "self-test failed: with the pads in MuJoCo's metric the acceleration differs by " + format_number(difference) +
         " from the acceleration under their force (size " + format_number(size) +
         "), because MuJoCo omits the pads for this model; use the explicit solver";
}

// Steps the field to the pad's pose after a step with w, the surface at rest; returns that pose.
Pose ImplicitFields::move(const ImplicitContact& contact, const Vector6d& w) const {
  const Pose pad{rotation_by(h_ * w.tail<3>()) * contact.pad.rotation, contact.pad.position + h_ * w.head<3>()};
  contact.field->load_state(contact.state);
  contact.field->step(contact.surface.inverse() * pad, h_);
  return pad;
}

bool ImplicitFields::touches(const ImplicitContact& contact, const Vector6d& w) const {
  move(contact, w);
  return contact.field->touching() > 0;
}

void ImplicitFields::evaluate(const ImplicitContact& contact, const Vector6d& w, Linear& linear) const {
  const Pose pad = move(contact, w);
  const Field& field = *contact.field;
  const Matrix3d& turn = contact.surface.rotation;
  const Wrench wrench = field.damped_wrench_on_pad({turn.transpose() * w.head<3>(), turn.transpose() * w.tail<3>()}, tau_);
  linear.force << turn * wrench.force, turn * wrench.torque;
  const PadTangent tangent = field_tangent(field, contact.surface, pad.position, tau_);
  // a velocity of the step is a displacement over h
  linear.stiffness = tangent.stiffness + tangent.damping / h_;
  linear.coupling.setZero();
  for (std::size_t i = 0; i < field.size(); ++i) {
    if (field.state(i) != ElementState::slip) continue;
    const Element& element = field.layout().elements[i];
    const double gives = 1.0 - field.sliding_share(i);  // share that a faster slip does not take up
    const Matrix3d grip = -gives * (element.k_normal + element.c_normal / h_) / field.normal_force(i) *
                          (turn * field.tangential_force(i)) * (turn * field.normal(i)).transpose();
    const Matrix3d cross = cross_matrix(contact.surface * field.contact_point(i) - pad.position);
    linear.coupling.topLeftCorner<3, 3>() += grip;
    linear.coupling.topRightCorner<3, 3>() -= grip * cross;
    linear.coupling.bottomLeftCorner<3, 3>() += cross * grip;
    linear.coupling.bottomRightCorner<3, 3>() -= cross * grip * cross;
  }
}

// Finds contacts that touch now or would touch at the end of the step without their fields' force.
void ImplicitFields::find_active(std::span<const ImplicitContact> contacts, std::span<const double> memory) {
  active_.clear();
  free_.resize(start_.size());
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (contacts[i].field == nullptr) continue;
    const Vector6d w = start_.segment<6>(block(i)) + h_ * Eigen::Map<const Vector6d>(memory.data() + memory_per_contact * i);
    if (!touches(contacts[i], Vector6d::Zero()) && !touches(contacts[i], w)) continue;
    free_.segment<6>(block(active_.size())) = w;
    active_.push_back(i);
  }
  free_.conservativeResize(block(active_.size()));
}

// Returns w - w_free - h A F, with linear_ at w.
VectorXd ImplicitFields::residual(std::span<const ImplicitContact> contacts, const VectorXd& w) {
  VectorXd force(w.size());
  for (std::size_t a = 0; a < active_.size(); ++a) {
    evaluate(contacts[active_[a]], w.segment<6>(block(a)), linear_[a]);
    force.segment<6>(block(a)) = linear_[a].force;
  }
  return w - free_ - h_ * (delassus_ * force);
}

// Newton's method on the relative velocities. The force is piecewise smooth; if a full step does
// not help, shorter ones are tried.
void ImplicitFields::predict(std::span<const ImplicitContact> contacts) {
  // Rotations are weighted by the velocity that they cause at the distance at which the bodies
  // rotate as easily as they translate.
  VectorXd weight(free_.size());
  for (std::size_t a = 0; a < active_.size(); ++a) {
    const auto own = delassus_.diagonal().segment<6>(block(a));
    const double moved = own.head<3>().sum(), turned = own.tail<3>().sum();
    weight.segment<6>(block(a)) << Vector3d::Ones(), Vector3d::Constant(turned > 0.0 ? std::sqrt(moved / turned) : 1.0);
  }
  const auto size = [&](const VectorXd& x) { return weight.cwiseProduct(x).norm(); };

  linear_.resize(active_.size());
  VectorXd w(free_.size());
  for (std::size_t a = 0; a < active_.size(); ++a) w.segment<6>(block(a)) = start_.segment<6>(block(active_[a]));
  w_ = w;  // the result if no residual is a number, as with springs that have overflowed
  VectorXd r = residual(contacts, w);
  MatrixXd slope(w.size(), w.size());
  double least = std::numeric_limits<double>::infinity();
  converged_ = false;
  for (iterations_ = 0; iterations_ < max_iterations; ++iterations_) {
    const double error = size(r);
    if (error < least) {
      least = error;
      w_ = w;
    }
    converged_ = error <= tolerance * (size(w) + size(free_) + size(w - free_ - r));
    if (converged_) return;
    for (std::size_t a = 0; a < active_.size(); ++a) {
      slope.middleCols<6>(block(a)).noalias() =
          delassus_.middleCols<6>(block(a)) * (h_ * h_ * (linear_[a].stiffness + linear_[a].coupling));
    }
    slope.diagonal().array() += 1.0;
    const VectorXd full = solution(slope, r);
    // the field itself does not distinguish closer poses
    converged_ = h_ * size(full) <= kernel::shortest_slip;
    if (converged_) {
      w_ = w;
      return;
    }
    const VectorXd from = w;
    for (double part = 1.0; part > 0.05; part *= 0.5) {
      w = from - part * full;
      r = residual(contacts, w);
      if (size(r) < error) break;
    }
    if (size(r) >= error) {  // then go over the kink
      w = from - full;
      r = residual(contacts, w);
    }
  }
  if (size(r) < least) {
    w_ = w;
  } else {
    r = residual(contacts, w_);
  }
}

std::string ImplicitFields::apply(ModelView m, DataView d, std::span<const ImplicitContact> contacts,
                                  std::span<const double> memory, double viscous_time) {
  if (!metric_is_on(d)) return "MuJoCo has no effective metric in this step";
  h_ = m.opt_timestep();
  tau_ = viscous_time;
  const auto nv = static_cast<Index>(m.nv());
  jacobians_.resize(block(contacts.size()), nv);
  start_.resize(block(contacts.size()));
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    // Rows of dynamic size: with a fixed size of six Eigen would sum in another order.
    auto rows = jacobians_.middleRows(block(i), 6);
    relative_jacobian(m, d, {contacts[i].pad_body, contacts[i].object_body, contacts[i].pad.position}, rows.data());
    if (contacts[i].field != nullptr) start_.segment<6>(block(i)).noalias() = rows * Eigen::Map<const VectorXd>(d.qvel(), nv);
  }
  find_active(contacts, memory);
  iterations_ = 0;
  converged_ = true;
  if (active_.empty()) return {};

  RowMatrix jacobian(block(active_.size()), nv);
  for (std::size_t a = 0; a < active_.size(); ++a) jacobian.middleRows<6>(block(a)) = jacobians_.middleRows<6>(block(active_[a]));
  delassus_ = delassus(m, d, jacobian);
  predict(contacts);

  MetricRows rows;
  for (std::size_t a = 0; a < active_.size(); ++a) {
    rows.add(linear_[a].stiffness, h_ * h_, jacobian.middleRows<6>(block(a)));
  }
  if (!rows.write(d)) return "MuJoCo's arena is full; raise <size memory=\"...\"/>";
  for (std::size_t a = 0; a < active_.size(); ++a) {
    // MuJoCo itself subtracts h K w' (mj_effShift and the metric).
    const Vector6d force = linear_[a].force + h_ * linear_[a].stiffness * w_.segment<6>(block(a));
    Eigen::Map<VectorXd>(d.qfrc_passive(), nv) += jacobian.middleRows<6>(block(a)).transpose() * force;
  }
  return {};
}

void ImplicitFields::finish(ModelView m, DataView d, std::span<double> memory) {
  const VectorXd change = jacobians_ * Eigen::Map<const VectorXd>(d.qacc(), static_cast<Index>(m.nv()));
  VectorXd rest = change;
  applied_.assign(memory.size() / memory_per_contact, {Vector3d::Zero(), Vector3d::Zero()});
  if (!active_.empty()) {
    VectorXd force(free_.size());
    for (std::size_t a = 0; a < active_.size(); ++a) {
      const Index at = block(active_[a]);
      const Vector6d end = start_.segment<6>(at) + h_ * change.segment<6>(at);
      force.segment<6>(block(a)) = linear_[a].force + linear_[a].stiffness * (h_ * (w_.segment<6>(block(a)) - end));
      applied_[active_[a]] = {force.segment<3>(block(a)), force.segment<3>(block(a) + 3)};
    }
    const VectorXd by_fields = delassus_ * force;
    for (std::size_t a = 0; a < active_.size(); ++a) rest.segment<6>(block(active_[a])) -= by_fields.segment<6>(block(a));
  }
  Eigen::Map<VectorXd> kept(memory.data(), rest.size());
  kept = (1.0 - newest_share) * kept + newest_share * rest;
}

}  // namespace slipbench
