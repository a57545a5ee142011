// The element field: compliant friction points of a pad against one surface.
//
// Law, per element (massless spring with a Coulomb slider at its tip):
//   penetration  delta = max(0, -gap(tip))                             along the surface normal n
//   normal       f_n   = k_n delta
//   tangential   u     = P (c - a),  P = I - n n'
//                c: contact point, a: anchor, where the tip stuck to the surface
//   stick        |k_t u| <= mu_s f_n
//   slip         |k_t u|  = mu_k f_n; the anchor follows: return mapping
//                ([simo1998], sec. 1.2 and 3)
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
#include "sim/contact/contact_points.h"
#include "sim/contact/field_results.h"
#include "sim/contact/kernel.h"
#include "sim/contact/skin.h"
#include "sim/contact/surface/surface.h"
#include "sim/core/pose.h"

namespace slipbench {

// A field and its steps. The base class returns the results of the last step.
class Field : public FieldResults {
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
  // it they use the mean velocity of the step. Throws SceneValueError if an elastic skin
  // does not converge.
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
  [[nodiscard]] bool is_inside(std::size_t i) const { return columns_.gap[i] < 0.0; }
  // True if element i, after approach(), points at the face nearest to it.
  [[nodiscard]] bool faces_surface(std::size_t i) const { return normal(i).dot(pose_.rotation * layout_.elements[i].axis) < 0.0; }
  // Returns how far the tip of an element that faces_surface() has come along its axis since it entered,
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
  // Returns the first element whose penetration exceeds the height of a unit, if one does: a real
  // unit has no such compression.
  [[nodiscard]] std::optional<std::size_t> overcompressed() const;

  // The state: all that the next step needs from earlier ones. save_state() writes state_size()
  // values and load_state() restores them, so that the following steps are bit-identical; the
  // results of the last step, returned by FieldResults, are not part of it. All zero: never
  // stepped. Between load_state() and step() the accessors must not be read.
  [[nodiscard]] std::size_t state_size() const { return state_size_; }
  void save_state(std::span<double> state);
  void load_state(std::span<const double> state);

 private:
  void begin_step(const Pose& pad_in_surface, double dt);
  void find_contacts();
  void find_forces(const Twist* motion);
  void end_step();
  void open_excluded();
  template <class Visit>
  void for_each_kept(Visit&& visit);
  void step_in_stages(const Twist* motion);
  void find_contacts_of_skin();
  void step_on_skin(const Twist* motion);
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
  void note_passed();
  void keep_faces_of_grid();
  [[nodiscard]] Pose pose_before() const;
  [[nodiscard]] double onset_fraction(std::size_t i) const;
  [[nodiscard]] ElementColumns view(double dt) const;
  [[nodiscard]] bool has_memory() const { return !effects_.rheology.empty(); }

  std::size_t state_size_ = 1;
  bool extended_;              // true if the columns beyond PlainColumns exist
  bool may_update_separated_;  // kernel::update_if_separated() may replace a step without contact
  bool plain_;                 // springs on a plane without effects: a single pass suffices
  bool placed_ = false;
  std::optional<SkinStepper> skin_;  // with a SkinEffect
  // elements that touch another surface
  std::vector<std::uint32_t> excluded_;
  kernel::Groups candidates_{};  // of approach()
  std::optional<Lost> lost_;
  std::array<double, 12> pose_before_{};  // of the last step on a grid: rotation and position
};

}  // namespace slipbench
