// The element field: compliant friction points of a pad against one surface.
//
// Law, per element (massless spring with a Coulomb slider at its tip):
//   penetration  delta = max(0, -gap(tip))                             along the surface normal n
//   normal       f_n   = k_n delta
//   tangential   u     = P (c - a),  P = I - n n'            c contact point, a anchor: where the tip stuck to the surface
//   stick        |k_t u| <= mu_s f_n
//   slip         |k_t u|  = mu_k f_n; the anchor follows: return mapping (Simo & Hughes, Computational Inelasticity, 1998,
//                sec. 1.2 and 3)
// Where the face that an element meets changes inside the surface (at an edge, or where its axis begins to look at a face behind
// which it already is), the penetration would jump, and k_n delta^2/2 would come from nothing. It does not: delta is then counted
// from where it was, so that the element goes on with the energy that it had, or less,
//   delta  = max(0, -gap - s),  s = max(0, -gap - delta before) at such a change,
// and s falls to -gap whenever -gap is below it: back outside nothing is left of it. An element swept into a box from the side, at
// a depth, so presses on the top with what it is pressed further. Its stretch, which was along another face, is let go of.
//
// An element that has begun to slip goes on until its trial force falls under mu_k f_n: the limit of a damped tip without mass.
// Stick and slip are states of the model, not thresholds on a velocity. Anchors live in the surface's frame, so surfaces may move
// and turn.
//
// A dashpot in parallel with the spring (optional, per element) or a rheology effect adds k u + h forms (effect.h). An effect may give the
// tips mass (TipEffect): the anchor is then the place of the tip at any time, and what the spring passes on is not the friction. It may make the
// pad one elastic body (SkinEffect): an element's penetration and stretch are then those of the loaded surface, and the force follows from all.
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

#include "sim/core/pad_layout.h"
#include "sim/core/pose.h"
#include "sim/field/active_set.h"
#include "sim/field/contact_points.h"
#include "sim/field/effect.h"
#include "sim/field/kernel.h"
#include "sim/field/surface/surface.h"

namespace slipbench {

// Coulomb friction of the touched surface.
struct Friction {
  double mu_static = 0.5;
  double mu_kinetic = 0.5;  // <= mu_static
};

class Field {
 public:
  static constexpr std::size_t max_elements = 4096;

  // Throws std::invalid_argument when the layout is empty or larger than max_elements, a stiffness is not positive and finite, a
  // dashpot is negative, an axis is not a unit vector, units do not tile the elements in order, 0 <= mu_kinetic <= mu_static is
  // violated, tips with mass meet what is no plane, another cone, a rheology or a dashpot, or an elastic skin meets these or tips with mass.
  Field(const PadLayout& layout, const Surface& surface, Friction friction, FieldEffects effects = {});

  // Advances to the relative pose `pad_in_surface` at the end of a step of `dt` > 0 seconds. The first call places the field:
  // what it finds touching sticks unstrained, and dt is not used. `motion`: the velocity at the end of the step, for friction
  // laws that depend on speed; without it they see the mean velocity of the step.
  // Throws InputError where columns lean (effect.h) and one is loaded beyond what its stop holds.
  void step(const Pose& pad_in_surface, double dt, const Twist* motion = nullptr);

  // The two halves of step(), for a pad that may touch several surfaces (several_surfaces.h): approach() finds where the elements meet this
  // surface, finish() does the rest. In between an element may be handed over to another surface's field or excluded.
  void approach(const Pose& pad_in_surface, double dt);
  void finish(const Twist* motion = nullptr);
  // Elements that touch nothing here, because they touch another surface, until the next call.
  void exclude(std::span<const std::uint32_t> elements) { excluded_.assign(elements.begin(), elements.end()); }
  // True if, after approach(), an element may touch, or touched in the step before.
  [[nodiscard]] bool is_near() const;
  // Where element i meets the surface when the pad is at `pad_in_surface`.
  [[nodiscard]] SurfacePoint meet(std::size_t i, const Pose& pad_in_surface) const {
    return contacts_.at(pad_in_surface * layout_.elements[i].tip, pad_in_surface.rotation * layout_.elements[i].axis);
  }
  // True if element i, after approach(), is inside of the surface and looks at it, wherever its springs begin.
  [[nodiscard]] bool is_inside(std::size_t i) const { return columns_[gap][i] < 0.0; }
  // True if element i looks at the face that is nearest to it, after approach().
  [[nodiscard]] bool looks_in(std::size_t i) const { return normal(i).dot(pose_.rotation * layout_.elements[i].axis) < 0.0; }
  // How far the tip of an element that looks_in() has come along its axis since it entered, to first order [m]; negative while it is outside.
  [[nodiscard]] double way_inside(std::size_t i) const;
  // True if element i, after approach(), is inside and meets the face that it met in the step before.
  [[nodiscard]] bool keeps_face(std::size_t i) const;
  // After approach(), ContactPoints::entry() of element i; nothing while its group sleeps.
  [[nodiscard]] std::optional<ContactPoints::Entry> entry(std::size_t i, double from) const;
  // After approach(), lets element i meet that face, as far behind its tip as the entry says, where it would meet another face or none: its column
  // comes out of another surface at that face, or goes in there beside its edge.
  void meet_face(std::size_t i, const ContactPoints::Entry& entry);
  // How far behind its tip an element is fixed to the pad [m]; 0: not known.
  [[nodiscard]] double column_length() const { return contacts_.column(); }
  [[nodiscard]] bool on_grid() const { return contacts_.on_grid(); }
  // True if the tip of element i is inside of the surface, whichever way the element looks.
  [[nodiscard]] bool has_tip_inside(std::size_t i) const { return contacts_.is_inside(pose_ * layout_.elements[i].tip); }
  // How far the tip of an element that touched has come in the step, at least to first order [m].
  [[nodiscard]] double travel(std::size_t i) const;
  // After approach() of both: element i, which touched this surface in the step before, goes on at `next`, where it is_inside(), with the stretch
  // that it has and no more depth than it has. `here_in_next`: this surface's frame in that of `next`. A pad with an elastic skin begins anew there.
  void hand_over(std::size_t i, Field& next, const Pose& here_in_next);

  // An element that let go in the last step although its tip did not come out of the surface by the face that it had pressed on: it has come
  // through to where it looks out of another face. The force then vanished without a cause.
  struct Lost {
    std::size_t element;
    double depth;  // m, in the step before
  };
  [[nodiscard]] const std::optional<Lost>& lost() const { return lost_; }

  // The state: all that the next step needs of those before. save_state() writes state_size() values and load_state() takes them
  // back, so that the steps after it are the same to the bit; what the accessors below say of the last step is not part of it.
  // All zero: never stepped. Between load_state() and step() the accessors are not to be read.
  [[nodiscard]] std::size_t state_size() const { return state_size_; }
  void save_state(std::span<double> state);
  void load_state(std::span<const double> state);

  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] const PadLayout& layout() const { return layout_; }
  [[nodiscard]] const Friction& friction() const { return friction_; }

  // Element states and events of the last step; events in order of element, those of one (tips with mass have several) in order of time.
  [[nodiscard]] ElementState state(std::size_t i) const { return state_in(columns_[mode][i]); }
  // The state before the last step.
  [[nodiscard]] ElementState state_before(std::size_t i) const { return state_in(columns_[mode_before][i]); }
  [[nodiscard]] std::span<const ElementEvent> events() const { return events_; }
  // Grows whenever element states may have become others than they were.
  [[nodiscard]] std::uint64_t changes() const { return changes_; }

  // Of element i, in the surface frame S: normal force [N], penetration [m], path slipped since the start [m]. Where it met the surface (normal,
  // contact_point), and the gap of what does not touch, may be of an earlier step in a sparse field: view_from_pad() brings all up to date.
  [[nodiscard]] double normal_force(std::size_t i) const { return std::max(0.0, columns_[f_normal][i]); }
  [[nodiscard]] double penetration(std::size_t i) const { return std::max(0.0, -columns_[gap][i]); }
  [[nodiscard]] double slip_path(std::size_t i) const { return columns_[path][i]; }

  // Tangential force of the pad on the surface, which is the friction [N], stretch of the element [m] (undeformed contact point minus anchored tip; the
  // tip's deflection is minus this), slip of the tip over the surface in the last step [m], and the surface normal.
  [[nodiscard]] Eigen::Vector3d tangential_force(std::size_t i) const { return vector(force_x, i); }
  [[nodiscard]] Eigen::Vector3d stretch(std::size_t i) const { return vector(contact_x, i) - vector(anchor_x, i); }
  [[nodiscard]] Eigen::Vector3d slip_step(std::size_t i) const { return vector(slip_x, i); }
  [[nodiscard]] Eigen::Vector3d normal(std::size_t i) const { return vector(normal_x, i); }
  [[nodiscard]] Eigen::Vector3d contact_point(std::size_t i) const { return vector(contact_x, i); }

  // The groups that may touch, and those that may have touched in a step after the first `since`, brought up to date: of all others nothing has
  // changed since then but the gap. These hold until the next call. A reader passes the steps() of its last look; any number of readers may look, as
  // often as they want.
  [[nodiscard]] kernel::Groups active() const { return active_set_ ? active_set_->active() : all(); }
  kernel::Groups active_since(std::uint64_t since) {
    return active_set_ ? active_set_->active_since(since, contacts_, columns_) : all();
  }
  // Works out the three below for those groups, or the first `vectors` of them; or for all.
  void view_from_pad(const kernel::Groups& groups, std::size_t vectors) {
    kernel::view_from_pad(columns_, pose_.rotation, transmitted_, groups, vectors);
  }
  void view_from_pad() { view_from_pad(active_since(0), 3); }
  // Whether label_level() may stand for that: a plane whose normal is the pad's Z to the bit, the circular cone, no elastic skin.
  [[nodiscard]] bool level() const;
  // Fills a frame of units of one element with `part` of what kernel::label_units() does, and all of it with their states. `rate`: 1/step [1/s].
  void label_level(double rate, FramePart part, ContactFrame& frame) const {
    kernel::label_level_elements(columns_, pose_.rotation, transmitted_, rate, count_, part, frame);
  }
  // How many steps the field has taken; what load_state() brings back does not take them back. Only a sparse field counts.
  [[nodiscard]] std::uint64_t steps() const { return active_set_ ? active_set_->steps() : 0; }
  // Of element i, in the pad frame P: force of the surface on the pad, as the element passes it on [N], deformed tip minus undeformed
  // tip [m], and slip of the tip over the surface in the last step [m].
  [[nodiscard]] Eigen::Vector3d force_on_pad(std::size_t i) const { return vector(pad_force_x, i); }
  [[nodiscard]] Eigen::Vector3d deflection(std::size_t i) const { return vector(deflection_x, i); }
  [[nodiscard]] Eigen::Vector3d slip_in_pad(std::size_t i) const { return vector(pad_slip_x, i); }

  // Of the groups' elements: adds to `depth` [m] how deep they are in the surface, and to the three of `shear` [m] their tips' deflections along
  // the surface, in P. Of an elastic skin also how far it has sunk and shifted beside what touches.
  void add_elements(const kernel::Groups& groups, double* depth, const std::array<double*, 3>& shear) const {
    kernel::add_elements(columns_, pose_.rotation.transpose(), groups, depth, shear, count_);
    if (effects_.skin) add_sunk(depth);
  }

  // How far a tangential force t [N] reaches towards the friction cone of `limit` [N] around the normal n: |t|/limit for the
  // circular cone, 1 on the cone of an effect and where there is no friction at all.
  [[nodiscard]] double cone_gauge(const Eigen::Vector3d& t, const Eigen::Vector3d& n, double limit) const {
    if (limit == 0.0) return 1.0;
    return effects_.cone ? effects_.cone->gauge(t.data(), n.data(), limit) : t.norm() / limit;
  }
  // mu_s f_n of the element as the effects leave it [N]; by a rate law (effect.h) a tip in slip may carry more.
  [[nodiscard]] double stick_limit(std::size_t i) const { return columns_[limit][i]; }
  // What share of k the force of a slipping element gains with a stretch along its slip within the last step: 0 by Coulomb's law, by a rate
  // law r/(k + r) with r = f g'(w)/(g(w) dt), nearly 1 where the tip creeps.
  [[nodiscard]] double sliding_share(std::size_t i) const;

  // What the surface does to the pad, about the pad's origin, in the pad frame P; and what the pad does to the surface, about the
  // surface's origin, in S.
  [[nodiscard]] Wrench wrench_on_pad() const;
  [[nodiscard]] Wrench wrench_on_surface() const;
  // What the surface does to the pad, about the pad's origin, in S, when a dashpot `tau` k [N s/m] stands beside every spring of
  // the layout and the pad has the velocity `motion`: the normal ones of all that touch, never pulling; the tangential ones of
  // all that stick, with what they add held inside the cone of stick_limit().
  [[nodiscard]] Wrench damped_wrench_on_pad(const Twist& motion, double tau) const;

  // What the springs of all elements together do to the pad, hold, and have lost by slip in the last step. Where a rheology takes
  // part or columns lean the energy is not what is held.
  [[nodiscard]] kernel::SpringSums spring_sums() const {
    if (effects_.skin) return skin_sums();
    return touching_ == 0 ? kernel::SpringSums{{0.0, 0.0, 0.0}, 0.0, 0.0} : kernel::sum_springs(columns_, active());
  }

  // The groups of all elements.
  [[nodiscard]] kernel::Groups all() const { return {nullptr, padded_ / kernel::lanes}; }
  // Of all elements, where entries come in the order of elements: a column of the structure of arrays.
  [[nodiscard]] const double* column(kernel::Column c) const { return columns_[c]; }
  // How many elements touch after the last step, and how many of them slip.
  [[nodiscard]] std::size_t touching() const { return touching_; }
  [[nodiscard]] std::size_t slipping() const { return slipping_; }
  // What a column's stop may add to the tangential stiffness of an element [N/m]; 0 where none leans.
  [[nodiscard]] double stop_stiffness() const { return effects_.lean ? effects_.lean->stop_stiffness : 0.0; }
  // The effect that replaces the circular friction cone, or null.
  [[nodiscard]] const ConeEffect* effect_cone() const { return effects_.cone.get(); }
  // Returns true if an effect moves the surface: an element may then touch a bump while it is outside the shape.
  [[nodiscard]] bool has_bumps() const { return !effects_.surface.empty(); }
  // Whether the pad is one elastic body. The springs of layout() are then its stiffness where it touches as a whole, which no part of it exceeds.
  [[nodiscard]] bool has_skin() const { return effects_.skin != nullptr; }
  // Whether the spring of element i counts where the pad is as stiff as it may be.
  [[nodiscard]] bool bears(std::size_t i) const { return has_skin() ? touching_ > 0 : state(i) != ElementState::detached; }
  // Whether tips have mass: what touches nothing then goes on swinging, and its root feels that.
  [[nodiscard]] bool has_tips() const { return effects_.tip != nullptr; }

  // Whether the field has many elements of which few touch, and works out those alone (active_set.h).
  [[nodiscard]] bool sparse() const { return active_set_.has_value(); }
  // Brings up to date where element i met the surface in the last step.
  void update_contact_point(std::size_t i) {
    if (active_set_) active_set_->update_element(i, contacts_, columns_);
  }

  // Whether the surface is a plane, so that all elements meet one normal.
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
  // Where the pad was in the last step, as a skin remembers it: rotation and position.
  [[nodiscard]] std::span<double> skin_pose() { return std::span(skin_).last(12); }
  [[nodiscard]] bool skin_rests();
  void approach_on_skin();
  void step_on_skin(const Twist* motion);
  void rest_on_skin();
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
  std::size_t padded_;  // count_ rounded up to whole SIMD vectors; the rest has no stiffness and so never touches
  struct Free {
    void operator()(double* block) const;
  };
  std::unique_ptr<double[], Free> block_;
  kernel::Columns columns_{};  // into block_; "now" and "before" swap places instead of being copied
  std::vector<ElementEvent> events_;
  Pose pose_;
  Column transmitted_ = force_x;         // the tangential force that the pad feels: of a spring with a massless tip the friction
  bool extended_;                        // the columns from plain_columns on are there
  bool may_stay_apart_;                  // what its effects remember of a step without contact is nothing
  bool plain_;                           // springs on a plane, and no effect: one pass does it all
  std::optional<ActiveSet> active_set_;  // of many plain springs on no plane
  bool placed_ = false;
  std::vector<double> skin_;             // of an elastic body: its elements' frames and what its step works with (skin.cc)
  bool one_axis_ = false;                // its elements all point one way
  bool at_rest_ = false;                 // its pad has not moved in this step
  double step_ = 0.0;                    // s, the last one
  std::vector<std::uint32_t> excluded_;  // elements that touch another surface
  kernel::Groups candidates_{};          // of approach()
  std::optional<Lost> lost_;
  std::size_t touching_ = 0, slipping_ = 0;
  std::uint64_t changes_ = 0;
};

}  // namespace slipbench
