#include "sim/mujoco/linear/average_acceleration.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <mujoco/mujoco.h>
#include <Eigen/Geometry>

#include "sim/core/vectorise.h"

namespace slipbench {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// The 6x6 matrix of many springs, translation before rotation.
struct Springs {
  Matrix6d total = Matrix6d::Zero();
  double all_round = 0.0;
  Vector3d first = Vector3d::Zero();
  Matrix3d second = Matrix3d::Zero();

  // Adds an isotropic spring `a` at the lever r: a [I, -[r]x; [r]x, |r|^2 I - r r'].
  void add_all_round(double a, const Vector3d& r) {
    all_round += a;
    first += a * r;
    second.noalias() += a * r * r.transpose();
  }
  // Adds a spring `b` that acts along n only.
  void add_along(double b, const Vector3d& n, const Vector3d& r) {
    Vector6d row;
    row << n, r.cross(n);
    total.noalias() += b * row * row.transpose();
  }
  [[nodiscard]] Matrix6d sum() const {
    Matrix6d result = total;
    const Matrix3d cross = cross_matrix(first);
    result.topLeftCorner<3, 3>().diagonal().array() += all_round;
    result.topRightCorner<3, 3>() -= cross;
    result.bottomLeftCorner<3, 3>() += cross;
    result.bottomRightCorner<3, 3>() -= second;
    result.bottomRightCorner<3, 3>().diagonal().array() += second.trace();
    return result;
  }
};

// Rows of the held body's equations, padded to multiples of four: six columns, then the force.
struct HeldRows {
  static constexpr int columns = 8, force = 6;
  alignas(32) double at[6][columns];

  void set(const Matrix6d& inertia, const Vector6d& on_it) {
    for (int i = 0; i < 6; ++i) {
      for (int j = 0; j < 6; ++j) at[i][j] = inertia(j, i);
      at[i][force] = on_it[i];
      at[i][force + 1] = 0.0;
    }
  }
};

// Rows of a finger's equations: the six columns of P + G, padded, then -G and the force as in
// HeldRows.
struct FingerRows {
  static constexpr int columns = 16, held = 8;
  alignas(32) double at[6][columns];

  void set(const Matrix6d& own, const Matrix6d& pad, const Vector6d& on_it) {
    for (int i = 0; i < 6; ++i) {
      for (int j = 0; j < 6; ++j) {
        at[i][j] = own(j, i);
        at[i][held + j] = -pad(j, i);
      }
      at[i][6] = at[i][7] = at[i][held + 7] = 0.0;
      at[i][held + HeldRows::force] = on_it[i];
    }
  }
  // After eliminate(): returns the finger's acceleration for the held body's acceleration `a`.
  [[nodiscard]] Vector6d follow(const Vector6d& a) const {
    Vector6d result;
    for (int i = 5; i >= 0; --i) {
      double rest = at[i][held + HeldRows::force];
      for (int j = 0; j < 6; ++j) rest -= at[i][held + j] * a[j];
      for (int j = i + 1; j < 6; ++j) rest -= at[i][j] * result[j];
      result[i] = rest / at[i][i];
    }
    return result;
  }
};

// Computes to -= factor * from.
template <int columns>
SLIPBENCH_INLINE void subtract(double* to, double factor, const double* from) {
  for (int j = 0; j < columns; j += static_cast<int>(quad)) {
    put_vector(to + j, vector_at<Quad>(to + j) - factor * vector_at<Quad>(from + j));
  }
}

// Eliminates a finger by Cholesky, P + G = U' U, from the equations of the held body.
SLIPBENCH_DISPATCHED void eliminate(FingerRows& finger, HeldRows& whole) {
  for (int k = 0; k < 6; ++k) {
    double* row = finger.at[k];
    const double scale = 1.0 / std::sqrt(row[k]);
    for (int j = 0; j < FingerRows::columns; ++j) row[j] *= scale;
    for (int i = k + 1; i < 6; ++i) subtract<FingerRows::columns>(finger.at[i], row[i], row);
    const double* of_held = row + FingerRows::held;
    for (int i = 0; i < 6; ++i) subtract<HeldRows::columns>(whole.at[i], of_held[i], of_held);
  }
}

// Returns the held body's acceleration; overwrites `whole`.
Vector6d solve_rows(HeldRows& whole) {
  for (int k = 0; k < 6; ++k) {
    const double inverse = 1.0 / whole.at[k][k];
    for (int i = k + 1; i < 6; ++i) subtract<HeldRows::columns>(whole.at[i], whole.at[i][k] * inverse, whole.at[k]);
  }
  Vector6d result;
  for (int i = 5; i >= 0; --i) {
    double rest = whole.at[i][HeldRows::force];
    for (int j = i + 1; j < 6; ++j) rest -= whole.at[i][j] * result[j];
    result[i] = rest / whole.at[i][i];
  }
  return result;
}

}  // namespace

double longest_averaged_step(const Vibration& vibration) {
  if (!(vibration.omega > 0.0)) return std::numeric_limits<double>::infinity();
  const double beyond = vibration.damping_rate * vibration.damping_rate - 4.0 * vibration.omega * vibration.omega;
  return 2.0 / (beyond > 0.0 ? 0.5 * (vibration.damping_rate + std::sqrt(beyond)) : vibration.omega);
}

Matrix6d added_inertia(const PadTangent& tangent, double h) {
  return 0.5 * h * tangent.damping + 0.25 * h * h * tangent.stiffness;
}

Matrix6d added_inertia(const Field& field, double viscous_time, double h) {
  const double of_spring = 0.25 * h * h, of_dashpot = 0.5 * h * viscous_time;
  Springs springs;
  for (std::size_t i = 0; i < field.size(); ++i) {
    const ElementState state = field.state(i);
    if (!field.bears(i)) continue;
    const Element& element = field.layout().elements[i];
    const Vector3d n = field.normal(i), r = field.contact_point(i), slip = field.slip_step(i);
    const double normal = (of_spring + of_dashpot) * element.k_normal;
    double across = of_spring * element.k_tangential;
    const double distance = state == ElementState::slip ? slip.norm() : 0.0;
    if (distance > 0.0) {
      const double held = field.tangential_force(i).norm(), along = field.sliding_share(i) * across;
      across *= held / (held + element.k_tangential * distance);
      springs.add_along(along - across, slip / distance, r);
    } else if (state == ElementState::stick) {
      across += of_dashpot * element.k_tangential;
    }
    springs.add_all_round(across, r);
    springs.add_along(normal - across, n, r);
  }
  return springs.sum();
}

// With v = Q' (v_frame - w x p) and w = Q' w_frame for the frame at p, rotated by Q:
//   [A, B; B', D] -> [A, B - A p; ., D + p B + (p B)' - p A p] of the rotated blocks,
// with p the matrix of p x.
Matrix6d seen_from(const Pose& frame, const Matrix6d& inertia) {
  const Matrix3d& q = frame.rotation;
  const Matrix3d p = cross_matrix(frame.position);
  const Matrix3d a = q * inertia.topLeftCorner<3, 3>() * q.transpose();
  const Matrix3d d = q * inertia.bottomRightCorner<3, 3>() * q.transpose();
  const Matrix3d ap = a * p;
  Matrix6d result;
  if (inertia.topRightCorner<3, 3>().isZero(0.0)) {  // a finger's
    result << a, -ap, -ap.transpose(), d - p * ap;
    return result;
  }
  const Matrix3d b = q * inertia.topRightCorner<3, 3>() * q.transpose(), pb = p * b;
  result << a, b - ap, (b - ap).transpose(), d + pb + pb.transpose() - p * ap;
  return result;
}

HeldBodies::Body HeldBodies::free_body(const mjModel* m, int body) {
  if (m->body_jntnum[body] != 1 || m->jnt_type[m->body_jntadr[body]] != mjJNT_FREE ||
      m->body_subtreemass[body] != m->body_mass[body]) {
    throw std::logic_error("HeldBodies: a body that is not free and alone");
  }
  mjtNum turn[9];
  mju_quat2Mat(turn, m->body_iquat + 4 * body);
  const Pose centre{Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(turn),
                    Eigen::Map<const Vector3d>(m->body_ipos + 3 * body)};
  Vector6d about_centre;
  about_centre << Vector3d::Constant(m->body_mass[body]), Eigen::Map<const Vector3d>(m->body_inertia + 3 * body);
  return {body, m->body_dofadr[body], seen_from(centre, about_centre.asDiagonal())};
}

HeldBodies::HeldBodies(const mjModel* m, const std::array<int, 2>& fingers, int held, const PadTangent& spring, double h)
    : fingers_{free_body(m, fingers[0]), free_body(m, fingers[1])}, held_(free_body(m, held)) {
  for (Body& finger : fingers_) {
    finger.spring = added_inertia(spring, h);
    finger.stiffness = 0.25 * h * h * spring.stiffness;
    finger.inertia += finger.spring;
  }
}

void HeldBodies::solve(const mjModel* m, mjData* d, const std::array<Matrix6d, 2>& pads, const Matrix6d& ground,
                       const std::array<Vector6d, 2>& carriages) const {
  const auto pose_of = [d](int body) {
    return Pose{Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(d->xmat + 9 * body),
                Eigen::Map<const Vector3d>(d->xpos + 3 * body)};
  };
  const Pose held = pose_of(held_.body);
  // A free joint's translations are in the world, its rotations in the body's own frame. These
  // convert to the held body's axes, about its frame, in which the body is `placed`: forces there,
  // and accelerations back.
  const auto force_on = [&](const Body& body, const Pose& placed) {
    const Eigen::Map<const Vector6d> joint(d->qfrc_smooth + body.dof);
    const Vector3d force = held.rotation.transpose() * joint.head<3>();
    Vector6d result;
    result << force, placed.rotation * joint.tail<3>() + placed.position.cross(force);
    return result;
  };
  const auto accelerate = [&](const Body& body, const Pose& placed, const Vector6d& a) {
    Eigen::Map<Vector6d> joint(d->qacc + body.dof);
    const Vector3d turning = a.tail<3>();
    joint.head<3>() = held.rotation * (a.head<3>() + turning.cross(placed.position));
    joint.tail<3>() = placed.rotation.transpose() * turning;
  };
  // To a finger's own axes, and from them to those of its joint.
  const auto in_finger = [&](const Body& finger, const Vector3d& moving, const Vector3d& turning) {
    Vector6d result;
    result << pose_of(finger.body).rotation.transpose() * moving, turning;
    return result;
  };
  const auto apply = [&](const Body& finger, const Vector6d& force, mjtNum* to) {
    Eigen::Map<Vector6d> joint(to + finger.dof);
    joint.head<3>() += pose_of(finger.body).rotation * force.head<3>();
    joint.tail<3>() += force.tail<3>();
  };
  for (std::size_t k = 0; k < 2; ++k) {
    const Body& finger = fingers_[k];
    const Vector3d turning = pose_of(finger.body).rotation.transpose() * carriages[k].tail<3>();
    const Vector6d carried = finger.stiffness * in_finger(finger, carriages[k].head<3>(), turning);
    apply(finger, carried, d->qfrc_smooth);
    apply(finger, carried, d->qfrc_applied);
  }
  mju_zero(d->qacc, static_cast<int>(m->nv));
  HeldRows whole;
  whole.set(held_.inertia + ground + pads[0] + pads[1], force_on(held_, Pose{}));
  std::array<Pose, 2> placed;
  std::array<FingerRows, 2> fingers;
  for (std::size_t k = 0; k < 2; ++k) {
    placed[k] = held.inverse() * pose_of(fingers_[k].body);
    fingers[k].set(seen_from(placed[k], fingers_[k].inertia) + pads[k], pads[k], force_on(fingers_[k], placed[k]));
    eliminate(fingers[k], whole);
  }
  const Vector6d a = solve_rows(whole);
  accelerate(held_, Pose{}, a);
  for (std::size_t k = 0; k < 2; ++k) {
    const Body& finger = fingers_[k];
    accelerate(finger, placed[k], fingers[k].follow(a));
    const Eigen::Map<const Vector6d> joint(d->qacc + finger.dof);
    apply(finger, -(finger.spring * in_finger(finger, joint.head<3>(), joint.tail<3>())), d->qfrc_applied);
  }
}

}  // namespace slipbench
