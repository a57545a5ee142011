// The state of an element field after a step, as its readers see it: labels, sensors, simulations.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "sim/api/contact_frame.h"
#include "sim/api/effect.h"
#include "sim/api/pad_layout.h"
#include "sim/contact/active_set.h"
#include "sim/contact/columns.h"
#include "sim/contact/contact_points.h"
#include "sim/contact/kernel.h"
#include "sim/contact/label_kernel.h"
#include "sim/contact/surface/surface.h"
#include "sim/core/pose.h"

namespace slipbench {

// Coulomb friction of the touched surface.
struct Friction {
  double mu_static = 0.5;
  double mu_kinetic = 0.5;  // <= mu_static
};

// The columns of a field and what is computed from them. field.h states the law and has the steps.
//
// It has many accessors, because each reads one quantity of an element. Those that are not const
// bring the columns of a sparse field up to date.
class FieldResults {
 public:
  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] const PadLayout& layout() const { return layout_; }
  [[nodiscard]] const Friction& friction() const { return friction_; }

  // Element states and events of the last step. Events are in order of element, those of one
  // element (tips with mass have several) in order of time.
  [[nodiscard]] ElementState state(std::size_t i) const { return state_in(columns_.mode[i]); }
  // The state before the last step.
  [[nodiscard]] ElementState state_before(std::size_t i) const { return state_in(columns_.before.mode[i]); }
  [[nodiscard]] std::span<const ElementEvent> events() const { return events_; }
  // Increases whenever element states may have changed.
  [[nodiscard]] std::uint64_t changes() const { return changes_; }

  // Values of element i in the surface frame S: normal force [N], penetration [m], path slipped
  // since the start [m]. Its contact (normal, contact_point), and its gap if it touches nothing,
  // may be of an earlier step in a sparse field: view_from_pad() brings all up to date.
  [[nodiscard]] double normal_force(std::size_t i) const { return std::max(0.0, columns_.f_normal[i]); }
  [[nodiscard]] double penetration(std::size_t i) const { return std::max(0.0, -columns_.gap[i]); }
  [[nodiscard]] double slip_path(std::size_t i) const { return columns_.path[i]; }

  // Tangential force of the pad on the surface, i.e. the friction [N]; stretch of the element [m]
  // (undeformed contact point minus anchored tip; the tip's deflection is minus this); slip of the
  // tip over the surface in the last step [m]; surface normal; contact point [m].
  [[nodiscard]] Eigen::Vector3d tangential_force(std::size_t i) const { return columns_.force.at(i); }
  [[nodiscard]] Eigen::Vector3d stretch(std::size_t i) const { return columns_.contact.at(i) - columns_.anchor.at(i); }
  [[nodiscard]] Eigen::Vector3d slip_step(std::size_t i) const { return columns_.slip.at(i); }
  [[nodiscard]] Eigen::Vector3d normal(std::size_t i) const { return columns_.normal.at(i); }
  [[nodiscard]] Eigen::Vector3d contact_point(std::size_t i) const { return columns_.contact.at(i); }

  // The groups that may touch, and those that may have touched in a step after step number `since`,
  // brought up to date: of all others only the gap has changed since then. Valid until the next
  // call. A reader passes the steps() of its last call; any number of readers may call, as often as
  // they want.
  [[nodiscard]] kernel::Groups active() const { return active_set_ ? active_set_->active() : all(); }
  kernel::Groups active_since(std::uint64_t since) {
    return active_set_ ? active_set_->active_since(since, contacts_, columns_) : all();
  }
  // Computes the three values below for those groups, or the first `vectors` of the values; or all
  // for all groups.
  void view_from_pad(const kernel::Groups& groups, std::size_t vectors) {
    kernel::view_from_pad(columns_, pose_.rotation, transmitted(), groups, vectors);
  }
  void view_from_pad() { view_from_pad(active_since(0), 3); }
  // True if label_level() may replace that: a plane whose normal is exactly the pad's Z, the
  // circular cone, no elastic skin.
  [[nodiscard]] bool level() const;
  // Fills a frame of one-element units with `part` of the results of kernel::label_units(); with
  // all of it also their states. `rate`: 1/step [1/s].
  void label_level(double rate, FramePart part, ContactFrame& frame) const {
    kernel::label_level_elements(columns_, pose_.rotation, transmitted(), rate, count_, part, frame);
  }
  // Number of steps taken; load_state() does not set it back. Only a sparse field counts.
  [[nodiscard]] std::uint64_t steps() const { return active_set_ ? active_set_->steps() : 0; }
  // Values of element i in the pad frame P: force of the surface on the pad, as the element
  // transmits it [N], deformed minus undeformed tip [m], and slip of the tip over the surface in
  // the last step [m].
  [[nodiscard]] Eigen::Vector3d force_on_pad(std::size_t i) const { return columns_.pad.force.at(i); }
  [[nodiscard]] Eigen::Vector3d deflection(std::size_t i) const { return columns_.pad.deflection.at(i); }
  [[nodiscard]] Eigen::Vector3d slip_in_pad(std::size_t i) const { return columns_.pad.slip.at(i); }

  // For the groups' elements: adds their depth in the surface to `depth` [m], and their tips'
  // deflections along the surface, in P, to the three of `shear` [m]. For an elastic skin also its
  // displacement where nothing touches.
  void add_elements(const kernel::Groups& groups, double* depth, const std::array<double*, 3>& shear) const {
    kernel::add_elements(columns_, pose_.rotation.transpose(), groups, depth, shear, count_);
    if (effects_.skin) add_sunk(depth);
  }

  // Returns how far a tangential force t [N] reaches towards the friction cone of `limit` [N]
  // around the normal n: |t|/limit for the circular cone; 1 on the cone of an effect and where the
  // limit is 0.
  [[nodiscard]] double cone_gauge(const Eigen::Vector3d& t, const Eigen::Vector3d& n, double limit) const {
    if (limit == 0.0) return 1.0;
    return effects_.cone ? effects_.cone->gauge(t.data(), n.data(), limit) : t.norm() / limit;
  }
  // mu_s f_n of the element with all effects [N]; with a rate law (effect.h) a slipping tip may
  // carry more.
  [[nodiscard]] double stick_limit(std::size_t i) const { return columns_.limit[i]; }
  // Returns the share of k by which the force of a slipping element grows with a stretch along its
  // slip within the last step: 0 by Coulomb's law; by a rate law r/(k + r) with r = f g'(w)/(g(w)
  // dt), nearly 1 where the tip creeps.
  [[nodiscard]] double sliding_share(std::size_t i) const;

  // The wrench of the surface on the pad, about the pad's origin, in the pad frame P; and of the
  // pad on the surface, about the surface's origin, in S.
  [[nodiscard]] Wrench wrench_on_pad() const;
  [[nodiscard]] Wrench wrench_on_surface() const;
  // The wrench of the surface on the pad, about the pad's origin, in S, if a dashpot `tau` k [N
  // s/m] is added in parallel to every spring of the layout and the pad has the velocity `motion`.
  // Normal dashpots act on all touching elements and never pull; tangential ones act on all
  // sticking elements, and their total force is kept inside the cone of stick_limit().
  [[nodiscard]] Wrench damped_wrench_on_pad(const Twist& motion, double tau) const;

  // Sums over the springs of all elements: force on the pad, stored energy, and loss by slip in the
  // last step. With a rheology the energy is not the stored energy.
  [[nodiscard]] kernel::SpringSums spring_sums() const {
    if (effects_.skin) return skin_sums();
    return touching_ == 0 ? kernel::SpringSums{{0.0, 0.0, 0.0}, 0.0, 0.0} : kernel::sum_springs(columns_, active());
  }

  // The groups of all elements.
  [[nodiscard]] kernel::Groups all() const { return {nullptr, padded_ / kernel::lanes}; }
  // The structure of arrays, in the order of elements, for reading.
  [[nodiscard]] const kernel::Columns& columns() const { return columns_; }
  // Number of elements that touch after the last step, and of those that slip.
  [[nodiscard]] std::size_t touching() const { return touching_; }
  [[nodiscard]] std::size_t slipping() const { return slipping_; }
  // The effect that replaces the circular friction cone, or null.
  [[nodiscard]] const ConeEffect* effect_cone() const { return effects_.cone.get(); }
  // True if an effect moves the surface: an element may then touch a bump while it is outside the
  // shape.
  [[nodiscard]] bool has_bumps() const { return !effects_.surface.empty(); }
  // True if the pad is one elastic body. The springs of layout() are then its stiffness if all of
  // it touches, which no part of it exceeds.
  [[nodiscard]] bool has_skin() const { return effects_.skin != nullptr; }
  // True if the spring of element i counts in an upper bound of the pad's stiffness.
  [[nodiscard]] bool bears(std::size_t i) const { return has_skin() ? touching_ > 0 : state(i) != ElementState::detached; }
  // True if tips have mass: a tip without contact then goes on swinging, and its root feels that.
  [[nodiscard]] bool has_tips() const { return effects_.tip != nullptr; }

  // True if the field has many elements of which few touch, and computes only those (active_set.h).
  [[nodiscard]] bool sparse() const { return active_set_.has_value(); }
  // Updates the contact point of element i to the last step.
  void update_contact_point(std::size_t i) {
    if (active_set_) active_set_->update_element(i, contacts_, columns_);
  }

  // Distance behind its tip at which an element is fixed to the pad [m]; 0: unknown.
  [[nodiscard]] double column_length() const { return contacts_.column(); }
  [[nodiscard]] bool on_grid() const { return contacts_.on_grid(); }
  // True if the surface is a plane, so that all elements have the same normal.
  [[nodiscard]] bool on_plane() const { return contacts_.on_plane(); }
  // The pose of the last step.
  [[nodiscard]] const Pose& pad_in_surface() const { return pose_; }

 protected:
  FieldResults(const PadLayout& layout, const Surface& surface, Friction friction, FieldEffects&& effects);

  [[nodiscard]] static ElementState state_in(double mode) { return static_cast<ElementState>(static_cast<int>(mode)); }
  void add_sunk(double* depth_of) const;
  [[nodiscard]] kernel::SpringSums skin_sums() const;
  // The tangential force that the pad feels; with a massless tip it is the friction.
  [[nodiscard]] const kernel::VectorColumns& transmitted() const { return effects_.tip ? columns_.transmitted : columns_.force; }

  PadLayout layout_;
  ContactPoints contacts_;
  Friction friction_;
  FieldEffects effects_;
  std::size_t count_;
  // count_ rounded up to whole SIMD vectors; the extra entries have no stiffness and never touch
  std::size_t padded_;
  struct Free {
    void operator()(double* block) const;
  };
  std::unique_ptr<double[], Free> block_;
  // into block_; a step swaps its values with those before it instead of copying them
  kernel::Columns columns_{};
  std::vector<ElementEvent> events_;
  Pose pose_;
  // for many plain springs on a surface other than a plane
  std::optional<ActiveSet> active_set_;
  double step_ = 0.0;  // s, the last one
  std::size_t touching_ = 0, slipping_ = 0;
  std::uint64_t changes_ = 0;
};

}  // namespace slipbench
