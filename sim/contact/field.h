// The element field: compliant friction points of a pad against one surface.
//
// Law, per element (massless spring with a Coulomb slider at its tip):
//   penetration  delta = max(0, -gap(tip))                             along the surface normal n
//   normal       f_n   = k_n delta
//   tangential   u     = P (c - a),  P = I - n n'
//                c: contact point, a: anchor, where the tip stuck to the surface
//   stick        |k_t u| <= mu_s f_n
//   slip         |k_t u|  = mu_k f_n; the anchor follows: return mapping (Simo & Hughes,
//                Computational Inelasticity, 1998, sec. 1.2 and 3)
//
// If the face that an element meets changes inside the surface (at an edge, or where its axis
// begins to point at a face behind which it already is), the penetration would jump, and k_n
// delta^2/2 would appear from nothing. Therefore delta is then measured with an offset s, so that
// the element keeps its energy or loses some,
//   delta  = max(0, -gap - s),  s = max(0, -gap - delta before) at such a change,
// and s falls to -gap whenever -gap is smaller: it is 0 once the element is outside. So an element
// swept into a box from the side, at a depth, presses on the top only with the depth that is added
// later. Its stretch, which was along another face, is released.
//
// An element that has begun to slip goes on until its trial force falls under mu_k f_n: the limit
// of a damped tip without mass. Stick and slip are states of the model, not thresholds on a
// velocity. Anchors are in the surface's frame, so surfaces may move and rotate.
//
// A dashpot in parallel with the spring (optional, per element) or a rheology effect gives the
// affine force k u + h (effect.h). An effect may give the tips mass (TipEffect): the anchor is then
// the position of the tip at any time, and the force that the spring transmits differs from the
// friction. An effect may make the pad one elastic body (SkinEffect): an element's penetration and
// stretch are then those of the loaded surface, and its force depends on all elements.
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

#include "sim/api/effect.h"
#include "sim/api/pad_layout.h"
#include "sim/contact/active_set.h"
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

class Field {
 public:
  static constexpr std::size_t max_elements = 4096;

  // Throws std::invalid_argument if the layout is empty or larger than max_elements, a stiffness is
  // not positive and finite, a dashpot is negative, an axis is not a unit vector, units do not tile
  // the elements in order, 0 <= mu_kinetic <= mu_static is violated, tips with mass are combined
  // with a surface other than a plane, another cone, a rheology or a dashpot, or an elastic skin is
  // combined with any of these or tips with mass.
  Field(const PadLayout& layout, const Surface& surface, Friction friction, FieldEffects effects = {});

  // Advances to the relative pose `pad_in_surface` at the end of a step of `dt` > 0 seconds. The
  // first call places the field: elements that touch stick unstrained, and dt is not used.
  // `motion`: the velocity at the end of the step, for friction laws that depend on speed; without
  // it they use the mean velocity of the step. Throws InputError if columns lean (effect.h) and one
  // is loaded beyond the capacity of its stop.
  void step(const Pose& pad_in_surface, double dt, const Twist* motion = nullptr);

  // The two halves of step(), for a pad that may touch several surfaces (several_surfaces.h):
  // approach() finds the contact points on this surface, finish() does the rest. In between an
  // element may be handed over to another surface's field or excluded.
  void approach(const Pose& pad_in_surface, double dt);
  void finish(const Twist* motion = nullptr);
  // Sets the elements that touch nothing here because they touch another surface, until the next
  // call.
  void exclude(std::span<const std::uint32_t> elements) { excluded_.assign(elements.begin(), elements.end()); }
  // True if, after approach(), an element may touch, or touched in the last step.
  [[nodiscard]] bool is_near() const;
  // Returns the contact of element i with the pad at `pad_in_surface`.
  [[nodiscard]] SurfacePoint meet(std::size_t i, const Pose& pad_in_surface) const {
    return contacts_.at(pad_in_surface * layout_.elements[i].tip, pad_in_surface.rotation * layout_.elements[i].axis);
  }
  // True if element i, after approach(), is inside the surface and points at it, whatever its
  // offset.
  [[nodiscard]] bool is_inside(std::size_t i) const { return columns_[gap][i] < 0.0; }
  // True if element i, after approach(), points at the face nearest to it.
  [[nodiscard]] bool looks_in(std::size_t i) const { return normal(i).dot(pose_.rotation * layout_.elements[i].axis) < 0.0; }
  // Returns how far the tip of an element that looks_in() has come along its axis since it entered,
  // to first order [m]; negative while it is outside.
  [[nodiscard]] double way_inside(std::size_t i) const;
  // True if element i, after approach(), is inside and meets the face that it met in the last step.
  [[nodiscard]] bool keeps_face(std::size_t i) const;
  // Returns ContactPoints::entry() of element i, after approach(); nothing while its group sleeps.
  [[nodiscard]] std::optional<ContactPoints::Entry> entry(std::size_t i, double from) const;
  // After approach(), makes element i meet the face of `entry`, at the entry's distance behind its
  // tip, instead of another face or none: its column leaves another surface at that face, or enters
  // there beside its edge.
  void meet_face(std::size_t i, const ContactPoints::Entry& entry);
  // Distance behind its tip at which an element is fixed to the pad [m]; 0: unknown.
  [[nodiscard]] double column_length() const { return contacts_.column(); }
  [[nodiscard]] bool on_grid() const { return contacts_.on_grid(); }
  // True if the tip of element i is inside the surface, whichever way the element points.
  [[nodiscard]] bool has_tip_inside(std::size_t i) const { return contacts_.is_inside(pose_ * layout_.elements[i].tip); }
  // Returns the travel of the tip of an element that touched, in this step, at least to first order
  // [m].
  [[nodiscard]] double travel(std::size_t i) const;
  // After approach() of both fields: moves element i, which touched this surface in the last step,
  // to `next`, where it is_inside(). It keeps its stretch and no more than its depth.
  // `here_in_next`: this surface's frame in that of `next`. A pad with an elastic skin restarts
  // there.
  void hand_over(std::size_t i, Field& next, const Pose& here_in_next);

  // An element that separated in the last step although its tip did not leave the surface through
  // the face that it pressed on: it has passed through to where it points out of another face. The
  // force then vanished without a physical cause.
  struct Lost {
    std::size_t element;
    double depth;  // m, in the last step
  };
  [[nodiscard]] const std::optional<Lost>& lost() const { return lost_; }

  // The state: all that the next step needs from earlier ones. save_state() writes state_size()
  // values and load_state() restores them, so that the following steps are bit-identical; the
  // results of the last step, returned by the accessors below, are not part of it. All zero: never
  // stepped. Between load_state() and step() the accessors must not be read.
  [[nodiscard]] std::size_t state_size() const { return state_size_; }
  void save_state(std::span<double> state);
  void load_state(std::span<const double> state);

  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] const PadLayout& layout() const { return layout_; }
  [[nodiscard]] const Friction& friction() const { return friction_; }

  // Element states and events of the last step. Events are in order of element, those of one
  // element (tips with mass have several) in order of time.
  [[nodiscard]] ElementState state(std::size_t i) const { return state_in(columns_[mode][i]); }
  // The state before the last step.
  [[nodiscard]] ElementState state_before(std::size_t i) const { return state_in(columns_[mode_before][i]); }
  [[nodiscard]] std::span<const ElementEvent> events() const { return events_; }
  // Increases whenever element states may have changed.
  [[nodiscard]] std::uint64_t changes() const { return changes_; }

  // Values of element i in the surface frame S: normal force [N], penetration [m], path slipped
  // since the start [m]. Its contact (normal, contact_point), and its gap if it touches nothing,
  // may be of an earlier step in a sparse field: view_from_pad() brings all up to date.
  [[nodiscard]] double normal_force(std::size_t i) const { return std::max(0.0, columns_[f_normal][i]); }
  [[nodiscard]] double penetration(std::size_t i) const { return std::max(0.0, -columns_[gap][i]); }
  [[nodiscard]] double slip_path(std::size_t i) const { return columns_[path][i]; }

  // Tangential force of the pad on the surface, i.e. the friction [N]; stretch of the element [m]
  // (undeformed contact point minus anchored tip; the tip's deflection is minus this); slip of the
  // tip over the surface in the last step [m]; surface normal; contact point [m].
  [[nodiscard]] Eigen::Vector3d tangential_force(std::size_t i) const { return vector(force_x, i); }
  [[nodiscard]] Eigen::Vector3d stretch(std::size_t i) const { return vector(contact_x, i) - vector(anchor_x, i); }
  [[nodiscard]] Eigen::Vector3d slip_step(std::size_t i) const { return vector(slip_x, i); }
  [[nodiscard]] Eigen::Vector3d normal(std::size_t i) const { return vector(normal_x, i); }
  [[nodiscard]] Eigen::Vector3d contact_point(std::size_t i) const { return vector(contact_x, i); }

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
    kernel::view_from_pad(columns_, pose_.rotation, transmitted_, groups, vectors);
  }
  void view_from_pad() { view_from_pad(active_since(0), 3); }
  // True if label_level() may replace that: a plane whose normal is exactly the pad's Z, the
  // circular cone, no elastic skin.
  [[nodiscard]] bool level() const;
  // Fills a frame of one-element units with `part` of the results of kernel::label_units(); with
  // all of it also their states. `rate`: 1/step [1/s].
  void label_level(double rate, FramePart part, ContactFrame& frame) const {
    kernel::label_level_elements(columns_, pose_.rotation, transmitted_, rate, count_, part, frame);
  }
  // Number of steps taken; load_state() does not set it back. Only a sparse field counts.
  [[nodiscard]] std::uint64_t steps() const { return active_set_ ? active_set_->steps() : 0; }
  // Values of element i in the pad frame P: force of the surface on the pad, as the element
  // transmits it [N], deformed minus undeformed tip [m], and slip of the tip over the surface in
  // the last step [m].
  [[nodiscard]] Eigen::Vector3d force_on_pad(std::size_t i) const { return vector(pad_force_x, i); }
  [[nodiscard]] Eigen::Vector3d deflection(std::size_t i) const { return vector(deflection_x, i); }
  [[nodiscard]] Eigen::Vector3d slip_in_pad(std::size_t i) const { return vector(pad_slip_x, i); }

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
  [[nodiscard]] double stick_limit(std::size_t i) const { return columns_[limit][i]; }
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
  // last step. With a rheology or leaning columns the energy is not the stored energy.
  [[nodiscard]] kernel::SpringSums spring_sums() const {
    if (effects_.skin) return skin_sums();
    return touching_ == 0 ? kernel::SpringSums{{0.0, 0.0, 0.0}, 0.0, 0.0} : kernel::sum_springs(columns_, active());
  }

  // The groups of all elements.
  [[nodiscard]] kernel::Groups all() const { return {nullptr, padded_ / kernel::lanes}; }
  // A column of the structure of arrays, in the order of elements.
  [[nodiscard]] const double* column(kernel::Column c) const { return columns_[c]; }
  // Number of elements that touch after the last step, and of those that slip.
  [[nodiscard]] std::size_t touching() const { return touching_; }
  [[nodiscard]] std::size_t slipping() const { return slipping_; }
  // Largest contribution of a column's stop to the tangential stiffness of an element [N/m]; 0 if
  // none leans.
  [[nodiscard]] double stop_stiffness() const { return effects_.lean ? effects_.lean->stop_stiffness : 0.0; }
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

  // True if the surface is a plane, so that all elements have the same normal.
  [[nodiscard]] bool on_plane() const { return contacts_.on_plane(); }
  // The pose of the last step.
  [[nodiscard]] const Pose& pad_in_surface() const { return pose_; }

 private:
  using enum kernel::Column;
  using Column = kernel::Column;

  void begin_step(const Pose& pad_in_surface, double dt);
  void find_contacts();
  void find_forces(const Twist* motion);
  void end_step();
  void open_excluded();
  [[nodiscard]] static ElementState state_in(double mode) { return static_cast<ElementState>(static_cast<int>(mode)); }
  template <class Visit>
  void for_each_kept(Visit&& visit);
  void step_in_stages(const Twist* motion);
  void prepare_skin();
  // The pad's pose in the last step, as a skin stores it: rotation and position.
  [[nodiscard]] std::span<double> skin_pose() { return std::span(skin_).last(12); }
  [[nodiscard]] bool skin_rests();
  void approach_on_skin();
  void step_on_skin(const Twist* motion);
  void step_resting_skin();
  void shear_skin();
  void add_sunk(double* depth_of) const;
  [[nodiscard]] kernel::SpringSums skin_sums() const;
  // Calls visit(i) for each element of the groups, in order.
  template <class Visit>
  void for_each_element(const kernel::Groups& groups, Visit&& visit) {
    for (std::size_t k = 0; k < groups.count; ++k) {
      const std::size_t first = groups[k], end = std::min(count_, first + kernel::lanes);
      for (std::size_t i = first; i < end; ++i) visit(i);
    }
  }
  void place_tips();
  [[nodiscard]] bool share_face(std::size_t i) const;
  void keep_energy(std::size_t i);
  void prepare_rheology(double dt);
  void commit_rheology(double dt);
  void rate_friction(double dt, const Twist* motion);
  [[nodiscard]] double raw_normal_force(std::size_t i) const;
  [[nodiscard]] double touch_fraction(std::size_t i) const;
  void anchor_touched(std::size_t i);
  void map_to_cone();
  void move_tips(double dt);
  void count_states(const kernel::Groups& groups);
  void resolve_events();
  void resolve_event(std::size_t i);
  void note_lost(std::size_t i);
  [[nodiscard]] double onset_fraction(std::size_t i) const;
  [[nodiscard]] ElementColumns view(double dt) const;
  [[nodiscard]] bool has_memory() const { return !effects_.rheology.empty(); }
  void keep_as_before(Column now, Column before) { std::swap(columns_[now], columns_[before]); }

  [[nodiscard]] Eigen::Vector3d vector(Column x, std::size_t i) const {
    return {columns_[x][i], columns_[x + 1][i], columns_[x + 2][i]};
  }
  PadLayout layout_;
  ContactPoints contacts_;
  Friction friction_;
  FieldEffects effects_;
  std::size_t count_;
  std::size_t state_size_ = 1;
  // count_ rounded up to whole SIMD vectors; the extra entries have no stiffness and never touch
  std::size_t padded_;
  struct Free {
    void operator()(double* block) const;
  };
  std::unique_ptr<double[], Free> block_;
  // into block_; "now" and "before" swap places instead of being copied
  kernel::Columns columns_{};
  std::vector<ElementEvent> events_;
  Pose pose_;
  // The tangential force that the pad feels; with a massless tip it is the friction.
  Column transmitted_ = force_x;
  bool extended_;              // true if the columns from plain_columns on exist
  bool may_update_separated_;  // kernel::update_if_separated() may replace a step without contact
  bool plain_;                 // springs on a plane without effects: a single pass suffices
  // for many plain springs on a surface other than a plane
  std::optional<ActiveSet> active_set_;
  bool placed_ = false;
  std::vector<double> skin_;  // elastic body: its elements' frames and work space (skin.cc)
  bool one_axis_ = false;     // true if all its elements have the same axis
  bool at_rest_ = false;      // true if the pad has not moved in this step
  double step_ = 0.0;         // s, the last one
  // elements that touch another surface
  std::vector<std::uint32_t> excluded_;
  kernel::Groups candidates_{};  // of approach()
  std::optional<Lost> lost_;
  std::size_t touching_ = 0, slipping_ = 0;
  std::uint64_t changes_ = 0;
};

}  // namespace slipbench
