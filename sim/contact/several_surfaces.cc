#include "sim/contact/several_surfaces.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "sim/core/error.h"

namespace slipbench {
namespace {

constexpr std::size_t none = static_cast<std::size_t>(-1);

// Returns the surface k of `count` with the largest way(k), the distance [m] behind the tip at
// which the element passed its face; none if may_meet(k) is false for every k.
template <class MayMeet, class Way>
std::size_t first_surface(std::size_t count, const MayMeet& may_meet, const Way& way) {
  std::size_t first = none;
  for (std::size_t k = 0; k < count; ++k) {
    if (may_meet(k) && (first == none || way(k) > way(first))) first = k;
  }
  return first;
}

// Returns the surface that element i touches according to state(field), or none.
template <class State>
std::size_t holder_of(std::span<const Field> fields, const State& state) {
  const auto touched = std::ranges::find_if(fields, [&](const Field& field) { return state(field) != ElementState::detached; });
  return touched == fields.end() ? none : static_cast<std::size_t>(touched - fields.begin());
}

// The path of one element back through the union of all surfaces that contain its tip: from each
// surface into those that touch it.
class WayBack {
 public:
  WayBack(std::span<const Field> fields, std::size_t i) : entries_(fields.size()) {
    double way = 0.0;
    for (std::size_t step = 0; step < most_steps; ++step) {
      std::size_t next = none;
      for (std::size_t k = 0; k < fields.size(); ++k) {
        const std::optional<ContactPoints::Entry> entry = fields[k].entry(i, way);
        if (!entry) continue;
        entries_[k] = entry;
        if (next == none || entry->way > entries_[next]->way + same_place) next = k;
      }
      if (next == none) return;
      first_ = next;
      way = entries_[next]->way;
    }
  }

  // The surface whose face the element passed first, or none.
  [[nodiscard]] std::size_t first() const { return first_; }
  [[nodiscard]] const std::optional<ContactPoints::Entry>& entry(std::size_t k) const { return entries_[k]; }

 private:
  static constexpr std::size_t most_steps = 64;  // surfaces one behind the other
  std::vector<std::optional<ContactPoints::Entry>> entries_;
  std::size_t first_ = none;
};

// Returns the surface that element i meets after approach() of all fields, and makes it meet the
// union's face there; none: it meets nothing.
std::size_t owner_of(std::span<Field> fields, std::size_t i, std::size_t holder) {
  const auto meets = [i](const Field& field) { return field.is_inside(i); };
  const auto met = std::ranges::count_if(fields, meets);
  if (holder != none && met == 1 && fields[holder].keeps_face(i)) return holder;
  // The grid of a mesh may miss an element that is inside the mesh near an edge. A first touch
  // there is accepted only within the length of the column, because the elements of a pad that
  // points the wrong way are inside as well, but deeper.
  const double column = fields.front().column_length();
  if (met == 0 && holder == none) {
    const auto in_grid = [i](const Field& field) { return field.on_grid() && field.has_tip_inside(i); };
    if (column == 0.0 || std::ranges::none_of(fields, in_grid)) {
      if (!fields.front().has_bumps()) return none;
      return first_surface(
          fields.size(), [&](std::size_t k) { return fields[k].faces_surface(i); },
          [&](std::size_t k) { return fields[k].way_inside(i); });
    }
  }
  const WayBack back(fields, i);
  std::size_t owner = back.first();
  if (owner == none || (column > 0.0 && back.entry(owner)->way > column)) {
    // A round body, or none: use each surface by itself.
    if (holder != none && (met == 0 || fields[holder].is_inside(i))) return holder;
    return first_surface(
        fields.size(), [&](std::size_t k) { return fields[k].is_inside(i); },
        [&](std::size_t k) { return fields[k].way_inside(i); });
  }
  if (holder != none && holder != owner && back.entry(holder)) {
    // The element changes to a face that now lies before its own.
    fields[holder].meet_face(i, *back.entry(holder));
    const double ahead = back.entry(owner)->way - back.entry(holder)->way;
    if (!(ahead > same_place && ahead <= fields[holder].travel(i) + 2.0 * same_place)) return holder;
  }
  fields[owner].meet_face(i, *back.entry(owner));
  return owner;
}

// An element meets the nearest face of a mesh. Where meshes adjoin this may be the inner face between
// them, which no element can touch. `owner`: the surface that element i meets,
// or none.
void refuse_seam_of_meshes(std::span<const Field> fields, std::span<const Pose> pads, std::size_t i, std::size_t owner) {
  constexpr double rounded = 1e-4;  // m, of faces that are not exactly level
  constexpr double leaning = -0.7;  // cosine between axis and normal of a face that leans by 45 deg
  for (std::size_t k = 0; k < fields.size(); ++k) {
    const Field& field = fields[k];
    if (!field.on_grid() || (owner != none && owner != k) || !field.has_tip_inside(i)) continue;
    const Eigen::Vector3d axis = pads[k].rotation * field.layout().elements[i].axis, contact = field.contact_point(i);
    if (field.normal(i).dot(axis) < leaning) continue;
    for (std::size_t j = 0; j < fields.size(); ++j) {
      // The element with its tip at that point.
      Pose there = pads[j] * pads[k].inverse();
      there = {pads[j].rotation, there * contact - pads[j].rotation * field.layout().elements[i].tip};
      if (j == k || std::abs(fields[j].meet(i, there).gap) > rounded) continue;
      throw InputError(
          "a pad touches the seam of two geoms, at least one of them a mesh, of which an element meets the nearest face; element " +
          std::to_string(i) +
          " would press on the wall between the geoms: join the meshes, let them overlap by 2 mm, or use boxes");
    }
  }
}

// Call after approach() of all fields.
void share_elements(std::span<Field> fields, std::span<const Pose> pads) {
  std::vector<std::vector<std::uint32_t>> excluded(fields.size());
  for (std::size_t i = 0; i < fields.front().size(); ++i) {
    const std::size_t holder = holder_of(fields, [i](const Field& field) { return field.state_before(i); });
    const std::size_t owner = owner_of(fields, i, holder);
    if (std::ranges::any_of(fields, &Field::on_grid)) refuse_seam_of_meshes(fields, pads, i, owner);
    if (owner == none) continue;
    if (holder != none && holder != owner) fields[holder].hand_over(i, fields[owner], pads[owner] * pads[holder].inverse());
    for (std::size_t k = 0; k < fields.size(); ++k) {
      if (k != owner) excluded[k].push_back(static_cast<std::uint32_t>(i));
    }
  }
  for (std::size_t k = 0; k < fields.size(); ++k) fields[k].exclude(excluded[k]);
}

// A load that is counted twice would be a wrong result without a message.
void refuse_two_contacts(std::span<const Field> fields) {
  if (fields.front().has_skin()) {
    // Each field would solve for a skin that only its own surface presses.
    if (std::ranges::count_if(fields, [](const Field& field) { return field.touching() > 0; }) > 1) {
      throw InputError("effects: the pad touches two surfaces at once, but its elastic skin is solved for one surface only");
    }
    return;
  }
  for (std::size_t i = 0; i < fields.front().size(); ++i) {
    const auto touches = [i](const Field& field) { return field.state(i) != ElementState::detached; };
    if (std::ranges::count_if(fields, touches) > 1) {
      throw std::logic_error("field: element " + std::to_string(i) + " touches two surfaces");
    }
  }
}

}  // namespace

void step_on_surfaces(std::span<Field> fields, std::span<const Pose> pads, double dt, std::span<const Twist> motions) {
  const auto motion_on = [&](std::size_t k) { return motions.empty() ? nullptr : &motions[k]; };
  if (fields.size() == 1) return fields.front().step(pads.front(), dt, motion_on(0));
  for (std::size_t k = 0; k < fields.size(); ++k) fields[k].approach(pads[k], dt);
  const bool shared = std::ranges::any_of(fields, &Field::is_near);
  if (shared) {
    share_elements(fields, pads);
  } else {
    for (Field& field : fields) field.exclude({});
  }
  for (std::size_t k = 0; k < fields.size(); ++k) fields[k].finish(motion_on(k));
  if (shared) refuse_two_contacts(fields);
}

void exclude_all_but_first(std::span<Field> fields, std::span<const Pose> pads) {
  std::vector<std::vector<std::uint32_t>> excluded(fields.size());
  std::vector<SurfacePoint> met(fields.size());
  std::vector<double> along(fields.size());
  for (std::size_t i = 0; fields.size() > 1 && i < fields.front().size(); ++i) {
    for (std::size_t k = 0; k < fields.size(); ++k) {
      met[k] = fields[k].meet(i, pads[k]);
      along[k] = Eigen::Vector3d(met[k].nx, met[k].ny, met[k].nz).dot(pads[k].rotation * fields[k].layout().elements[i].axis);
    }
    const std::size_t holder = holder_of(fields, [i](const Field& field) { return field.state(i); });
    const bool held = holder != none && met[holder].gap < 0.0;
    const std::size_t owner = held ? holder
                                   : first_surface(
                                         fields.size(), [&](std::size_t k) { return along[k] < 0.0; },
                                         [&](std::size_t k) { return met[k].gap / along[k]; });
    for (std::size_t k = 0; owner != none && k < fields.size(); ++k) {
      if (k != owner) excluded[k].push_back(static_cast<std::uint32_t>(i));
    }
  }
  for (std::size_t k = 0; k < fields.size(); ++k) fields[k].exclude(excluded[k]);
}

}  // namespace slipbench
