#include "sim/mujoco/articulated/articulated.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <variant>

#include <Eigen/Geometry>

#include "sim/core/error.h"
#include "sim/core/math.h"
#include "sim/core/math/rotation.h"
#include "sim/core/quantity.h"
#include "sim/mujoco/linear/stability.h"

namespace slipbench {
namespace {

// The default of `damping` [s]: the time by which a slip begins early.
constexpr double longest_dashpot_time = 1e-3;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::string part(const std::string& prefix, const char* name, std::size_t element) {
  return prefix + '/' + name + '/' + std::to_string(element);
}

bool is_positive(double x) { return std::isfinite(x) && x > 0.0; }

void check(const PadLayout& layout, Friction friction) {
  if (layout.elements.empty()) throw std::invalid_argument("an articulated pad needs at least one element");
  if (layout.element_truth)
    throw SceneValueError(
        "fidelity", "the sensor reads the skin between its units, which articulated pads do not simulate; use fidelity: field");
  for (const Element& e : layout.elements) {
    if (!is_positive(e.k_normal) || !is_positive(e.k_tangential))
      throw std::invalid_argument("stiffness must be positive and finite");
    if (!(e.c_normal >= 0.0) || !(e.c_tangential >= 0.0)) throw std::invalid_argument("a dashpot must not be negative");
    if (!(std::abs(e.axis.norm() - 1.0) < 1e-9)) throw std::invalid_argument("an element's axis must be a unit vector");
  }
  if (!(friction.mu_static >= 0.0) || friction.mu_static != friction.mu_kinetic) {
    throw std::invalid_argument("articulated pads have one coefficient of friction: mu_static must equal mu_kinetic");
  }
}

// Returns the stiffness of an element's normal slide for which slide and contact in series are as
// stiff as the element. The discrete integrator gives a tip on its slide k the effective mass m + c
// dt + k dt^2, and the stiffness of MuJoCo's contact of constant impedance d and solref -s/dt^2 is
// r/(dt^2 (1/m_eff + w)), with r = s/(1 - d) the contact_ratio and w the inverse mass of the tip's
// carrier and of the touched body. The part w dt^2/r of the contact's compliance does not depend on
// k: with 1/k' = 1/k_n - w dt^2/r, k solves r k^2 + (r M - (1 + r) k') k - r M k' = 0, M = (m + c
// dt)/dt^2.
double normal_slide(double wanted, double inverse_mass, double damping, const PillarSettings& settings) {
  const double r = settings.contact_ratio, dt = settings.dt;
  if (std::isinf(r)) return wanted;
  const double k_n = 1.0 / (1.0 / wanted - inverse_mass * dt * dt / r);
  const double free = (settings.tip_mass + damping * dt) / (dt * dt);
  const double b = r * free - (1.0 + r) * k_n;
  return (std::sqrt(b * b + 4.0 * r * r * free * k_n) - b) / (2.0 * r);
}

// Returns the damping of a free tip on a spring [N s/m].
double tip_damping(double stiffness, const PillarSettings& settings) {
  return 2.0 * settings.damping_ratio * std::sqrt(stiffness * settings.tip_mass);
}

// Sets MuJoCo's own defaults for an added part, whatever the model's default class is.
template <class Part, class... Links>
void make_plain(Part* part, void (*set_default)(Part*), Links Part::*... links) {
  Part plain;
  set_default(&plain);
  ((plain.*links = part->*links), ...);
  *part = plain;
}

Eigen::Map<const Eigen::Vector3d> vector3(const mjtNum* v) { return Eigen::Map<const Eigen::Vector3d>(v); }

// Returns the velocity of the second geom relative to the first along the contact's normal and its
// two tangents, from the velocities of all constraint rows. The rows of an elliptic contact are
// these; those of a pyramidal one are the edges n + mu t_1, n - mu t_1, n + mu t_2, n - mu t_2.
Eigen::Vector3d contact_velocity(const mjContact& contact, const mjtNum* rows, bool pyramidal) {
  const mjtNum* row = rows + contact.efc_address;
  if (!pyramidal) return vector3(row);
  const double twice = 2.0 * contact.friction[0];  // for both tangents
  return {0.5 * (row[0] + row[1]), (row[0] - row[1]) / twice, (row[2] - row[3]) / twice};
}

}  // namespace

void refuse_without_field(const Scene& scene) {
  if (!scene.effects.empty()) {
    throw SceneValueError("effects", "articulated pads support no effects; leave them out, or use fidelity: field");
  }
  if (scene.friction.static_coefficient != scene.friction.kinetic_coefficient) {
    throw SceneValueError("friction", "articulated pads have one coefficient of friction, so kinetic must equal static");
  }
  for (const SensorScene& sensor : scene.sensors) {
    if (sensor.damping <= longest_dashpot_time) continue;
    throw SceneValueError(
        "sensors." + sensor.name + ".damping",
        format_quantity(sensor.damping, Quantity::time) +
            ": the dashpots of articulated pads are joint damping: the labels contain it, but the friction cone does not; allowed: 0 to " +
            format_quantity(longest_dashpot_time, Quantity::time) + ", or use fidelity: field");
  }
}

void add_articulated_pad(mjSpec* spec, mjsBody* carrier, const Pose& pad_in_carrier, const PadLayout& layout,
                         std::span<const std::string> touched, Friction friction, const PillarSettings& settings,
                         const std::string& prefix, std::span<const InverseMass> inverse_mass) {
  check(layout, friction);
  for (std::size_t i = 0; i < layout.elements.size(); ++i) {
    const Element& element = layout.elements[i];
    mjsBody* body = mjs_addBody(carrier, nullptr);
    mjs_setName(body->element, part(prefix, "body", i).c_str());
    const Eigen::Vector3d centre = pad_in_carrier * (element.tip - settings.tip_radius * element.axis);
    const Eigen::Quaterniond turn(pad_in_carrier.rotation * element_frame(element.axis));
    mju_copy3(body->pos, centre.data());
    const double quaternion[4] = {turn.w(), turn.x(), turn.y(), turn.z()};
    mju_copy4(body->quat, quaternion);
    body->gravcomp = 1.0;

    const double sideways = element.c_tangential + tip_damping(element.k_tangential, settings);
    const double inwards = element.c_normal + tip_damping(element.k_normal, settings);
    const auto slide = [&](const char* name, int axis, double stiffness, double c) {
      mjsJoint* joint = mjs_addJoint(body, nullptr);
      make_plain(joint, mjs_defaultJoint, &mjsJoint::element, &mjsJoint::userdata, &mjsJoint::info);
      mjs_setName(joint->element, part(prefix, name, i).c_str());
      joint->type = mjJNT_SLIDE;
      mju_zero3(joint->axis);
      joint->axis[axis] = 1.0;
      joint->stiffness[0] = stiffness;
      joint->damping[0] = c;
    };
    slide("x", 0, element.k_tangential, sideways);
    slide("y", 1, element.k_tangential, sideways);
    const double w = inverse_mass.empty() ? 0.0 : inverse_mass[i].most;
    slide("z", 2, normal_slide(element.k_normal, w, inwards, settings), inwards);

    mjsGeom* tip = mjs_addGeom(body, nullptr);
    make_plain(tip, mjs_defaultGeom, &mjsGeom::element, &mjsGeom::material, &mjsGeom::hfieldname, &mjsGeom::meshname,
               &mjsGeom::userdata, &mjsGeom::plugin, &mjsGeom::info);
    const std::string tip_name = part(prefix, "tip", i);
    mjs_setName(tip->element, tip_name.c_str());
    tip->type = mjGEOM_SPHERE;
    tip->size[0] = settings.tip_radius;
    tip->mass = settings.tip_mass;
    tip->contype = 0;
    tip->conaffinity = 0;

    for (const std::string& geom : touched) {
      mjsPair* pair = mjs_addPair(spec, nullptr);
      make_plain(pair, mjs_defaultPair, &mjsPair::element, &mjsPair::geomname1, &mjsPair::geomname2, &mjsPair::info);
      mjs_setString(pair->geomname1, geom.c_str());
      mjs_setString(pair->geomname2, tip_name.c_str());
      pair->condim = 3;
      pair->friction[0] = pair->friction[1] = friction.mu_static;
      std::ranges::copy(settings.solref, pair->solref);
      std::ranges::copy(settings.solreffriction, pair->solreffriction);
      std::ranges::copy(settings.solimp, pair->solimp);
    }
  }
}

void drive_free_joint(const mjModel* model, mjData* data, int joint, const Pose& from, const Pose& to, double dt) {
  const Eigen::Quaterniond turn(from.rotation);
  const Eigen::Vector3d linear = (to.position - from.position) / dt;
  // The angular velocity of a free joint is in the body's own frame.
  const Eigen::Vector3d angular = rotation_vector(from.rotation.transpose() * to.rotation) / dt;
  const double quaternion[4] = {turn.w(), turn.x(), turn.y(), turn.z()};
  mjtNum* qpos = data->qpos + model->jnt_qposadr[joint];
  mjtNum* qvel = data->qvel + model->jnt_dofadr[joint];
  mju_copy3(qpos, from.position.data());
  mju_copy4(qpos + 3, quaternion);
  mju_copy3(qvel, linear.data());
  mju_copy3(qvel + 3, angular.data());
}

void leave_out_of_scale(mjModel* model, const mjData* data, int dof) {
  RowMatrix inertia(model->nv, model->nv);
  mj_fullM(model, data, inertia.data());
  const double others = inertia.trace() - inertia.diagonal().segment<6>(dof).sum();
  model->stat.meaninertia = model->nv > 6 ? others / static_cast<double>(model->nv - 6) : 1.0;
}

ArticulatedContact::ArticulatedContact(const mjModel* model, const std::string& prefix, const PadLayout& layout,
                                       const PillarSettings& settings)
    : layout_(layout), settings_(settings) {
  const auto n = static_cast<Eigen::Index>(layout.units.size());
  const std::size_t elements = layout.elements.size();
  element_of_geom_.assign(static_cast<std::size_t>(model->ngeom), -1);
  for (std::size_t i = 0; i < elements; ++i) {
    const int geom = mj_name2id(model, mjOBJ_GEOM, part(prefix, "tip", i).c_str());
    if (geom < 0) throw std::invalid_argument("the model has no articulated pad '" + prefix + "' of this layout");
    const int body = model->geom_bodyid[geom];
    element_of_geom_[static_cast<std::size_t>(geom)] = static_cast<int>(i);
    bodies_.push_back(body);
    const int joint = model->body_jntadr[body];
    qpos_.push_back(model->jnt_qposadr[joint]);
    tip_in_pad_.push_back(element_frame(layout.elements[i].axis));
  }
  unit_of_element_.resize(elements);
  undeformed_.setZero(3, n);
  for (std::size_t u = 0; u < layout.units.size(); ++u) {
    const UnitRange& range = layout.units[u];
    for (std::size_t i = range.first; i < range.first + range.count; ++i) {
      undeformed_.col(static_cast<Eigen::Index>(u)) += layout.elements[i].tip.array() / static_cast<double>(range.count);
      unit_of_element_[i] = static_cast<std::uint32_t>(u);
    }
  }
  tips_.resize(elements);
  before_.resize(elements);
  path_.resize(elements);
  if (std::isfinite(settings.creep_speed)) mean_.assign(elements, Eigen::Vector3d::Zero());
  frame_.force.setZero(3, n);
  frame_.contact_force.setZero(3, n);
  frame_.displacement.setZero(3, n);
  frame_.slip_velocity.setZero(2, n);
  frame_.slip_distance.setZero(n);
  frame_.margin.setConstant(n, nan);
  frame_.unit_state.assign(layout.units.size(), UnitState::detached);
}

bool ArticulatedContact::begin_on(const mjModel* model, mjData* data, const Surface& surface, const Pose& pad_in_surface) const {
  bool any = false;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const Eigen::Vector3d p = pad_in_surface * layout_.elements[i].tip, axis = pad_in_surface.rotation * layout_.elements[i].axis;
    const SurfacePoint point =
        std::visit([&](const auto& shape) { return shape.at(p.x(), p.y(), p.z(), axis.x(), axis.y(), axis.z()); }, surface);
    const double towards = -(point.nx * axis.x() + point.ny * axis.y() + point.nz * axis.z());
    if (!(point.gap < 0.0 && towards > 0.0)) continue;
    any = true;
    mjtNum& slide = data->qpos[qpos_[i] + 2];
    const double share = layout_.elements[i].k_normal / model->jnt_stiffness[model->body_jntadr[bodies_[i]] + 2];
    slide = std::max(slide, -share * point.gap / towards);
  }
  return any;
}

void ArticulatedContact::suit_to_held(mjModel* held) const {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const Element& element = layout_.elements[i];
    const int joint = held->body_jntadr[bodies_[i]], dof = held->body_dofadr[bodies_[i]];
    const double inwards = tip_damping(element.k_normal, settings_);
    held->dof_damping[dof] = held->dof_damping[dof + 1] = tip_damping(element.k_tangential, settings_);
    held->dof_damping[dof + 2] = inwards;
    held->jnt_stiffness[joint + 2] = normal_slide(element.k_normal, 0.0, inwards, settings_);
  }
}

void ArticulatedContact::take_tip_loads(const mjModel* model, mjData* data, const mjModel* held, const mjData* settled) const {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const int slide = model->body_jntadr[bodies_[i]] + 2;
    std::copy_n(settled->qpos + qpos_[i], 3, data->qpos + qpos_[i]);
    data->qpos[qpos_[i] + 2] *= held->jnt_stiffness[slide] / model->jnt_stiffness[slide];
  }
}

const ContactFrame& ArticulatedContact::read(const mjModel* model, const mjData* data, double time, double dt) {
  std::swap(tips_, before_);
  gather(model, data);
  average(dt);
  for (std::size_t i = 0; i < tips_.size(); ++i) {
    tips_[i].fall = before_[i].normal_force - tips_[i].normal_force;
    tips_[i].state = judge(i);
    if (settings_.counts_creep || tips_[i].state == ElementState::slip) path_[i] += dt * tips_[i].velocity.norm();
  }
  const double begun = std::exchange(frame_.time, time);
  sum_units(data);
  unit_rules::judge_pad(frame_, elements_);
  frame_.slip_angle += unit_rules::fit_slip_motion(frame_, undeformed_, most_loaded_plane_) * dt;

  report_events(begun, time, dt);
  return frame_;
}

double ArticulatedContact::normal_force() const {
  double force = 0.0;
  for (const Tip& tip : tips_) force += tip.normal_force;
  return force;
}

std::optional<std::size_t> ArticulatedContact::overcompressed(const mjModel* model, const mjData* data) const {
  if (!std::isfinite(layout_.unit_height)) return std::nullopt;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    // The slide has a share of the depth, since the contact has the rest; see begin_on().
    const double share = layout_.elements[i].k_normal / model->jnt_stiffness[model->body_jntadr[bodies_[i]] + 2];
    if (data->qpos[qpos_[i] + 2] > share * layout_.unit_height) return i;
  }
  return std::nullopt;
}

void ArticulatedContact::begin_run(double time) {
  std::ranges::fill(path_, 0.0);
  std::ranges::fill(mean_, Eigen::Vector3d::Zero());
  std::ranges::fill(before_, Tip{});
  frame_.time = time;
  frame_.slip_distance.setZero();
  frame_.slip_angle = 0.0;
  report_events(time, time, 0.0);
}

// Reports the changes since the states in before_.
void ArticulatedContact::report_events(double begun, double time, double dt) {
  frame_.events.clear();
  changes_.clear();
  for (std::size_t i = 0; i < tips_.size(); ++i) {
    if (tips_[i].state == before_[i].state) continue;
    const auto element = static_cast<std::uint32_t>(i);
    changes_.push_back({{fraction_of_change(i, dt), element, before_[i].state, tips_[i].state}, unit_of_element_[i]});
  }
  const auto count_before = [this](std::uint32_t unit) {
    unit_rules::Count count;
    const UnitRange& range = layout_.units[unit];
    for (std::size_t i = range.first; i < range.first + range.count; ++i) count.add(before_[i].state);
    return count;
  };
  unit_rules::report_unit_events(changes_, count_before, begun, time, dt, frame_.events);
}

// The rotations, contacts and Jacobian in mjData after mj_step() are those of the step's start,
// where the solver found the forces, while qvel is that of its end. So a pad that rotates at w sees
// its forces rotated by w dt, 0.03 degrees at 0.5 rad/s and 1 ms.
void ArticulatedContact::gather(const mjModel* model, const mjData* data) {
  std::fill(tips_.begin(), tips_.end(), Tip{});
  if (data->nefc == 0) return;
  constraint_velocity_.resize(static_cast<std::size_t>(data->nefc));
  mj_mulJacVec(model, data, constraint_velocity_.data(), data->qvel);

  const bool pyramidal = model->opt.cone == mjCONE_PYRAMIDAL;
  using Rows = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  const Eigen::Matrix3d pad_from_world = tip_in_pad_[0] * Eigen::Map<const Rows>(data->xmat + 9 * bodies_.front()).transpose();
  for (int c = 0; c < data->ncon; ++c) {
    const mjContact& contact = data->contact[c];
    if (contact.efc_address < 0 || contact.geom[0] < 0 || contact.geom[1] < 0) continue;
    const int first = element_of_geom_[static_cast<std::size_t>(contact.geom[0])];
    const int second = element_of_geom_[static_cast<std::size_t>(contact.geom[1])];
    if (first < 0 && second < 0) continue;
    // MuJoCo's normal, forces and velocities are those of the second geom relative to the first.
    const double side = second >= 0 ? 1.0 : -1.0;
    Tip& tip = tips_[static_cast<std::size_t>(second >= 0 ? second : first)];

    mjtNum force[6];
    mj_contactForce(model, data, c, force);
    if (!(force[0] > 0.0)) continue;
    const Eigen::Matrix3d axes = side * pad_from_world * Eigen::Map<const Rows>(contact.frame).transpose();
    tip.force += axes * vector3(force);
    if (!(force[0] > tip.normal_force)) continue;
    tip.normal_force = force[0];
    tip.limit = contact.friction[0] * force[0];
    tip.normal = axes.col(0);
    tip.tangential = axes.col(1) * force[1] + axes.col(2) * force[2];
    tip.drawn = pyramidal ? std::abs(force[1]) + std::abs(force[2]) : tip.tangential.norm();
    const Eigen::Vector3d velocity = contact_velocity(contact, constraint_velocity_.data(), pyramidal);
    tip.velocity = axes.col(1) * velocity[1] + axes.col(2) * velocity[2];
    tip.approach = -contact_velocity(contact, data->efc_vel, pyramidal)[0];
  }
}

void ArticulatedContact::average(double dt) {
  const double kept = math::exp(-dt / settings_.creep_time);
  for (std::size_t i = 0; i < mean_.size(); ++i) {
    if (tips_[i].normal_force > 0.0) {
      mean_[i] = kept * mean_[i] + (1.0 - kept) * tips_[i].velocity;
    } else {
      mean_[i].setZero();
    }
  }
}

ElementState ArticulatedContact::judge(std::size_t i) const {
  const Tip& tip = tips_[i];
  if (!(tip.normal_force > 0.0)) return ElementState::detached;
  const double speed = tip.velocity.norm();
  if (speed > settings_.creep_speed && mean_[i].norm() > settings_.creep_speed) return ElementState::slip;
  const bool on_cone = tip.drawn >= (1.0 - settings_.cone_share) * tip.limit;
  return on_cone && speed > settings_.least_speed ? ElementState::slip : ElementState::stick;
}

// Returns the fraction of the step [0, 1] at which the element changed its state.
double ArticulatedContact::fraction_of_change(std::size_t i, double dt) const {
  const Tip &now = tips_[i], &before = before_[i];
  const Element& element = layout_.elements[i];
  const auto share = [](double part, double whole) { return whole > 0.0 ? std::clamp(part / whole, 0.0, 1.0) : 0.0; };
  // Touch: the force at the end of the step has grown at k_n times the speed of approach.
  if (before.state == ElementState::detached) return 1.0 - share(now.normal_force, element.k_normal * now.approach * dt);
  // Detach: the normal force went on falling at the rate of the last step.
  if (now.state == ElementState::detached) return share(before.normal_force, before.fall);
  // Onset: the drive divides into the stretch of the spring, before it, and the slip, after it.
  if (now.state == ElementState::slip) {
    const double stretched = (now.tangential - before.tangential).norm();
    return share(stretched, stretched + element.k_tangential * now.velocity.norm() * dt);
  }
  // Stop: the tip went on at the speed of the last step.
  return share(now.velocity.norm(), before.velocity.norm());
}

void ArticulatedContact::sum_units(const mjData* data) {
  elements_ = {};
  double greatest_force = 0.0;
  for (std::size_t u = 0; u < layout_.units.size(); ++u) {
    const UnitRange& range = layout_.units[u];
    const double share = 1.0 / static_cast<double>(range.count);
    const auto c = static_cast<Eigen::Index>(u);
    unit_rules::Count count;
    Eigen::Vector3d force = Eigen::Vector3d::Zero(), displacement = force, tangential = force, slip = force;
    double limit = 0.0, path = 0.0;
    const Tip* most_loaded = &tips_[range.first];
    for (std::size_t i = range.first; i < range.first + range.count; ++i) {
      const Tip& tip = tips_[i];
      if (tip.normal_force > most_loaded->normal_force) most_loaded = &tip;
      count.add(tip.state);
      force += tip.force;
      tangential += tip.tangential;
      limit += tip.limit;
      displacement += share * (tip_in_pad_[i] * vector3(data->qpos + qpos_[i]));
      if (tip.state == ElementState::slip) slip += share * tip.velocity;
      path += share * path_[i];
    }
    unit_rules::ContactPlane plane;
    plane.face(most_loaded->normal);
    if (most_loaded->normal_force > greatest_force) {
      greatest_force = most_loaded->normal_force;
      most_loaded_plane_ = plane;
    }
    frame_.force.col(c) = force.array();
    frame_.contact_force.col(c) = plane.turned(force).array();
    frame_.displacement.col(c) = displacement.array();
    frame_.slip_velocity.col(c) = plane.turned(slip).head<2>().array();
    frame_.slip_distance[c] = path;
    frame_.margin[c] = count.touching == 0 ? nan : 1.0 - (limit > 0.0 ? tangential.norm() / limit : 1.0);
    frame_.unit_state[u] = unit_rules::unit_state(count);
    elements_.touching += count.touching;
    elements_.slipping += count.slipping;
  }
}

}  // namespace slipbench
