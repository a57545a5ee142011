// A step of a field whose pad is one elastic body (SkinEffect). Three things are needed that a
// field of springs does not need:
// - The contact is evaluated where the loaded skin is: for a touching tip at its anchor, as the
//   last step has left it. So a stuck patch feels no change of gap while the pad moves along, and a
//   tip that begins to slip, or stops, does not jump to another position. For a slipping tip the
//   contact lags by the slip of one step.
// - A gap is measured along the element's axis, gap/cos of the angle between axis and normal, as
//   the skin yields. A force p along the axis is p/cos along the normal.
// - Displacements and forces in the tangent plane are given by the element's x and y, after the
//   shortest rotation of its z onto the normal.
#include <algorithm>

#include "sim/contact/field.h"
#include "sim/contact/vectorise.h"

namespace slipbench {
namespace {

using kernel::Lanes, kernel::lanes, kernel::lanes_at, kernel::put_lanes;

// Columns of Field::skin_. Frames are constant; the rest changes with the step.
enum SkinColumn : std::size_t {
  x_axis = 0,  // of the element's frame, in P
  y_axis = 3,
  z_axis = 6,
  tip_in_frame = 9,  // undeformed, in that frame [m]
  met_x = 12,        // position of the loaded tip, in that frame [m]
  met_y,
  axial_gap,  // [m]
  cosine,     // between z and the normal
  lean_x,
  lean_y,  // components of the normal along x and y
  target_x,
  target_y,  // g of sim/effects/skin/elastic_contact.h [m]
  cap,       // its L [N]
  pressure,  // SkinEffect::Solution, column by column
  sunk,
  shear_x,
  shear_y,
  shift_x,
  shift_y,
  slides,
  skin_columns
};

// An element cannot press on a face at a larger angle than this, nearly 87 deg.
constexpr double steepest_cosine = 0.05;

struct Vectors {
  Lanes x, y, z;
};
struct Ways {
  Lanes x, y;
};

// Columns of elements i to i + lanes, one padded length apart.
struct SkinTable {
  double* first;
  std::size_t padded;
  double* operator[](std::size_t column) const { return first + column * padded; }
  [[nodiscard]] SLIPBENCH_INLINE Lanes at(std::size_t column, std::size_t i) const { return lanes_at((*this)[column] + i); }
  SLIPBENCH_INLINE void put(std::size_t column, std::size_t i, const Lanes& values) const {
    put_lanes((*this)[column] + i, values);
  }
};
SLIPBENCH_INLINE Lanes at(const kernel::Columns& c, kernel::Column column, std::size_t i) { return lanes_at(c[column] + i); }
SLIPBENCH_INLINE Vectors vectors_at(const kernel::Columns& c, kernel::Column x, std::size_t i) {
  return {lanes_at(c[x] + i), lanes_at(c[x + 1] + i), lanes_at(c[x + 2] + i)};
}
SLIPBENCH_INLINE void put(const kernel::Columns& c, kernel::Column x, std::size_t i, const Vectors& v) {
  put_lanes(c[x] + i, v.x);
  put_lanes(c[x + 1] + i, v.y);
  put_lanes(c[x + 2] + i, v.z);
}

SLIPBENCH_INLINE Vectors turned(const kernel::Rotation& r, const Vectors& v) {
  return {r.r00 * v.x + r.r01 * v.y + r.r02 * v.z, r.r10 * v.x + r.r11 * v.y + r.r12 * v.z,
          r.r20 * v.x + r.r21 * v.y + r.r22 * v.z};
}

// Transforms between the elements' frames and the frame in which the pad has `pose`. If all element
// frames are equal, they are combined with the pad's rotation.
struct Frames {
  Frames(const SkinTable& table, bool all_alike, const Pose& pose) : t(table), alike(all_alike) {
    Eigen::Matrix3d own = Eigen::Matrix3d::Identity();
    if (alike) {
      for (const std::size_t k : {0U, 1U, 2U}) {
        own.row(static_cast<Eigen::Index>(k)) << t[x_axis + k][0], t[y_axis + k][0], t[z_axis + k][0];
      }
    }
    const Eigen::Matrix3d out = pose.rotation * own;
    outward = kernel::entries_of(out);
    inward = kernel::entries_of(out.transpose());
    x = pose.position.x();
    y = pose.position.y();
    z = pose.position.z();
  }

  [[nodiscard]] SLIPBENCH_INLINE Vectors in(std::size_t i, const Vectors& v) const {
    const Vectors p = turned(inward, v);
    if (alike) return p;
    const auto along = [&](std::size_t axis) { return t.at(axis, i) * p.x + t.at(axis + 1, i) * p.y + t.at(axis + 2, i) * p.z; };
    return {along(x_axis), along(y_axis), along(z_axis)};
  }
  [[nodiscard]] SLIPBENCH_INLINE Vectors place_in(std::size_t i, const Vectors& v) const {
    return in(i, {v.x - x, v.y - y, v.z - z});
  }
  [[nodiscard]] SLIPBENCH_INLINE Vectors out(std::size_t i, const Vectors& v) const {
    if (alike) return turned(outward, v);
    const auto component = [&](std::size_t k) {
      return t.at(x_axis + k, i) * v.x + t.at(y_axis + k, i) * v.y + t.at(z_axis + k, i) * v.z;
    };
    return turned(outward, {component(0), component(1), component(2)});
  }
  // Rotates (x, y) of the tangent plane out of the element's frame.
  [[nodiscard]] SLIPBENCH_INLINE Vectors out(std::size_t i, const Ways& way) const {
    const Lanes lx = t.at(lean_x, i), ly = t.at(lean_y, i), rise = lx * way.x + ly * way.y,
                share = rise / (1.0 + t.at(cosine, i));
    return out(i, Vectors{way.x - share * lx, way.y - share * ly, -rise});
  }

  SkinTable t;
  bool alike;
  kernel::Rotation outward, inward;
  double x, y, z;
};

// Returns the displacement from a position in the element's frame, seen along the axis, to that of
// the undeformed tip, in the tangent plane.
SLIPBENCH_INLINE Ways way_to_root(const SkinTable& t, std::size_t i, const Lanes& x, const Lanes& y) {
  const Lanes dx = t.at(tip_in_frame, i) - x, dy = t.at(tip_in_frame + 1, i) - y;
  const Lanes lx = t.at(lean_x, i), ly = t.at(lean_y, i), upright = t.at(cosine, i);
  const Lanes rise = (dx * lx + dy * ly) / (upright * (1.0 + upright));
  return {dx + rise * lx, dy + rise * ly};
}

}  // namespace

// Moves the tips to the loaded surface, seen along the axes.
SLIPBENCH_DISPATCHED static void place_loaded(const kernel::Columns& c, const Frames& in_pad, const Frames& frames,
                                              std::size_t count) {
  const SkinTable t = frames.t;
  for (std::size_t i = 0; i < count; i += lanes) {
    const Vectors stuck = frames.place_in(i, vectors_at(c, kernel::anchor_x, i));
    const auto touched = at(c, kernel::mode_before, i) != 0.0;
    const Lanes x = touched ? stuck.x : t.at(tip_in_frame, i) - t.at(shift_x, i);
    const Lanes y = touched ? stuck.y : t.at(tip_in_frame + 1, i) - t.at(shift_y, i);
    t.put(met_x, i, x);
    t.put(met_y, i, y);
    put(c, kernel::tip_x, i, in_pad.out(i, Vectors{x, y, t.at(tip_in_frame + 2, i)}));
  }
}

// Converts gaps along the normals to gaps along the axes, and computes the contact points of the
// undeformed tips. On a plane no height is written: it is 0.
SLIPBENCH_DISPATCHED static void look_along_axes(const kernel::Columns& c, const Frames& frames, bool plane, std::size_t count) {
  const SkinTable t = frames.t;
  const Lanes none{}, one = none + 1.0;
  for (std::size_t i = 0; i < count; i += lanes) {
    const Vectors normal = vectors_at(c, kernel::normal_x, i), n = frames.in(i, normal);
    const Lanes met = at(c, kernel::gap, i);
    const auto faces = n.z > steepest_cosine;
    t.put(cosine, i, faces ? n.z : one);
    t.put(lean_x, i, faces ? n.x : none);
    t.put(lean_y, i, faces ? n.y : none);
    const Lanes gap = faces ? met / n.z : (met < 0.0 ? -met : met) / steepest_cosine;
    t.put(axial_gap, i, gap);
    const Vectors z = frames.out(i, Vectors{none, none, one}), contact = vectors_at(c, kernel::contact_x, i);
    const Vectors way = frames.out(i, way_to_root(t, i, t.at(met_x, i), t.at(met_y, i)));
    const Vectors place{contact.x + met * normal.x - gap * z.x, contact.y + met * normal.y - gap * z.y,
                        (plane ? none : contact.z) + met * normal.z - gap * z.z};
    put(c, kernel::place_x, i, place);
    put(c, kernel::contact_x, i, {place.x + way.x, place.y + way.y, place.z + way.z});
  }
}

// Stores normal forces along the normals; negative while separated, so that their zero is the
// instant of touch. The gap becomes the remaining gap after the surface has yielded or, in contact,
// the surface's displacement.
SLIPBENCH_DISPATCHED static void take_pressure(const kernel::Columns& c, SkinTable t, double own_stiffness, std::size_t count) {
  const Lanes none{}, one = none + 1.0;
  for (std::size_t i = 0; i < count; i += lanes) {
    const Lanes p = t.at(pressure, i), w = t.at(sunk, i), upright = t.at(cosine, i), ahead = t.at(axial_gap, i) + w;
    const auto touches = p > 0.0;
    const Lanes left = (ahead > 0.0 ? ahead : none) * upright;
    put_lanes(c[kernel::gap] + i, touches ? -w * upright : left);
    put_lanes(c[kernel::f_normal] + i, touches ? p / upright : -own_stiffness * left);
    put_lanes(c[kernel::depth] + i, w);
    // A separated element shifts across its axis; the slope of the surface below does not matter.
    t.put(cosine, i, touches ? upright : one);
    t.put(lean_x, i, touches ? t.at(lean_x, i) : none);
    t.put(lean_y, i, touches ? t.at(lean_y, i) : none);
  }
}

// Computes the shift that the tips would have if all stuck.
SLIPBENCH_DISPATCHED static void aim(const kernel::Columns& c, const Frames& frames, double placed, std::size_t count) {
  const SkinTable t = frames.t;
  const Lanes none{}, one = none + 1.0;
  for (std::size_t i = 0; i < count; i += lanes) {
    const auto touched = at(c, kernel::mode_before, i) != 0.0;
    const Vectors a = vectors_at(c, kernel::anchor_x, i), b = vectors_at(c, kernel::contact_before_x, i);
    const Vectors anchor = frames.place_in(i, {touched ? a.x : b.x, touched ? a.y : b.y, touched ? a.z : b.z});
    const Ways way = way_to_root(t, i, anchor.x, anchor.y);
    // A new contact has moved with its neighbours so far, and moves with the pad for the rest of
    // the step.
    const Lanes gap = at(c, kernel::gap_before, i), depth = at(c, kernel::gap, i);
    const Lanes rest = depth < 0.0 ? placed * (gap > 0.0 ? depth / (depth - gap) : one) : none;
    t.put(target_x, i, touched ? way.x : t.at(shift_x, i) + rest * way.x);
    t.put(target_y, i, touched ? way.y : t.at(shift_y, i) + rest * way.y);
  }
}

// Stores the tangential solution in the elements' columns.
SLIPBENCH_DISPATCHED static void take_shear(const kernel::Columns& c, const Frames& frames, std::size_t count) {
  const SkinTable t = frames.t;
  const Lanes none{}, one = none + 1.0;
  for (std::size_t i = 0; i < count; i += lanes) {
    const auto touches = t.at(pressure, i) > 0.0, touched = at(c, kernel::mode_before, i) != 0.0;
    const Ways target{t.at(target_x, i), t.at(target_y, i)}, shifted{t.at(shift_x, i), t.at(shift_y, i)},
        shear{t.at(shear_x, i), t.at(shear_y, i)}, ahead{target.x - shifted.x, target.y - shifted.y};
    const Lanes way = kernel::root(ahead.x * ahead.x + ahead.y * ahead.y);
    // Without friction it slips in any direction.
    const auto gives = (t.at(cap, i) == 0.0) | ((ahead.x * shear.x + ahead.y * shear.y > 0.0) & (t.at(slides, i) != 0.0));
    const auto slips = touches & (way > kernel::shortest_slip) & gives, loose = ~(touches & touched);
    Vectors anchor = vectors_at(c, kernel::anchor_x, i);
    if (any(loose)) {
      // Loose elements, and new contacts, are anchored by their root's position and shift.
      const Vectors root = vectors_at(c, kernel::contact_x, i);
      const Vectors behind = frames.out(i, Ways{touches ? target.x : shifted.x, touches ? target.y : shifted.y});
      anchor = {loose ? root.x - behind.x : anchor.x, loose ? root.y - behind.y : anchor.y, loose ? root.z - behind.z : anchor.z};
    }
    Vectors slipped{none, none, none};
    if (any(slips)) {
      slipped = frames.out(i, Ways{slips ? ahead.x : none, slips ? ahead.y : none});
      anchor = {anchor.x + slipped.x, anchor.y + slipped.y, anchor.z + slipped.z};
      put_lanes(c[kernel::path] + i, at(c, kernel::path, i) + (slips ? way : none));
    }
    const Vectors shift = frames.out(i, shifted);
    put(c, kernel::anchor_x, i, anchor);
    put(c, kernel::contact_x, i, {anchor.x + shift.x, anchor.y + shift.y, anchor.z + shift.z});
    put(c, kernel::slip_x, i, slipped);
    put(c, kernel::force_x, i, frames.out(i, shear));
    put_lanes(c[kernel::mode] + i, touches ? (slips ? one + 1.0 : one) : none);
  }
}

void Field::prepare_skin() {
  skin_.assign(skin_columns * padded_ + 12, 0.0);
  const SkinTable t{skin_.data(), padded_};
  const SkinEffect& skin = *effects_.skin;
  for (std::size_t i = 0; i < count_; ++i) {
    Element& element = layout_.elements[i];
    const Eigen::Matrix3d frame = element_frame(element.axis);
    const Eigen::Vector3d tip = frame.transpose() * element.tip;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      t[x_axis + k][i] = frame(row, 0);
      t[y_axis + k][i] = frame(row, 1);
      t[z_axis + k][i] = frame(row, 2);
      t[tip_in_frame + k][i] = tip[row];
    }
    // Stiffness of an element loaded alone, for instants inside a step.
    columns_[k_normal][i] = 1.0 / skin.own_normal();
    columns_[k_tangential][i] = 1.0 / skin.own_tangential();
    columns_[k_normal_spring][i] = element.k_normal = skin.punch_normal()[i];
    columns_[k_tangential_spring][i] = element.k_tangential = skin.punch_tangential()[i];
  }
  std::fill(t[cosine], t[cosine] + padded_, 1.0);
  one_axis_ = std::ranges::all_of(layout_.elements, [&](const Element& e) { return e.axis == layout_.elements.front().axis; });
}

void Field::approach_on_skin() {
  candidates_ = all();
  at_rest_ = skin_rests();
  if (at_rest_) return step_resting_skin();
  const SkinTable t{skin_.data(), padded_};
  const SkinEffect::Solution s = effects_.skin->solution();
  std::copy_n(s.shift_x, count_, t[shift_x]);
  std::copy_n(s.shift_y, count_, t[shift_y]);
  const Frames in_pad(t, one_axis_, {}), frames(t, one_axis_, pose_);
  place_loaded(columns_, in_pad, frames, count_);
  contacts_.find(columns_, pose_, all());
  for (const auto& effect : effects_.surface) {
    effect->displace(count_, columns_[contact_x], columns_[contact_y], columns_[normal_z], columns_[gap]);
  }
}

void Field::step_on_skin(const Twist* motion) {
  if (at_rest_) return;
  open_excluded();
  SkinEffect& skin = *effects_.skin;
  const SkinTable t{skin_.data(), padded_};
  const SkinEffect::Solution s = skin.solution();
  const auto take = [&](SkinColumn column, const double* from) { std::copy_n(from, count_, t[column]); };
  const Frames frames(t, one_axis_, pose_);
  look_along_axes(columns_, frames, on_plane(), count_);
  skin.press(t[axial_gap]);
  take(pressure, s.pressure);
  take(sunk, s.sunk);
  take_pressure(columns_, t, 1.0 / skin.own_normal(), count_);
  if (!effects_.friction.empty()) rate_friction(step_, motion);
  aim(columns_, frames, placed_ ? 1.0 : 0.0, count_);
  shear_skin();
  take(shift_x, s.shift_x);
  take(shift_y, s.shift_y);
  take(shear_x, s.shear_x);
  take(shear_y, s.shear_y);
  take(slides, s.slides);
  take_shear(columns_, frames, count_);
}

// True if the pad has not moved and nothing else could change; stores the pose.
bool Field::skin_rests() {
  const std::span<double> before = skin_pose();
  const Eigen::Map<Eigen::Matrix3d> rotation(before.data());
  const Eigen::Map<Eigen::Vector3d> position(before.data() + 9);
  const bool rests = placed_ && rotation == pose_.rotation && position == pose_.position && effects_.friction.empty();
  std::copy_n(pose_.position.data(), 3, std::copy_n(pose_.rotation.data(), 9, before.begin()));
  return rests;
}

// A pad that has not moved since the last step keeps its state, and slipping elements stick.
void Field::step_resting_skin() {
  const auto keep = [this](Column now, Column before) { std::copy_n(columns_[before], count_, columns_[now]); };
  for (const std::size_t k : {0U, 1U, 2U}) {
    keep(static_cast<Column>(contact_x + k), static_cast<Column>(contact_before_x + k));
    keep(static_cast<Column>(force_x + k), static_cast<Column>(force_before_x + k));
    std::fill_n(columns_[slip_x + k], count_, 0.0);
  }
  keep(f_normal, f_normal_before);
  keep(gap, gap_before);
  keep(limit, limit_before);
  for (std::size_t i = 0; i < count_; ++i) columns_[mode][i] = std::min(columns_[mode_before][i], 1.0);
}

// An element that begins to slip carries mu_k f_n, and the load that it drops goes to its
// neighbours. Repeats until no element begins to slip.
void Field::shear_skin() {
  const SkinTable t{skin_.data(), padded_};
  SkinEffect& skin = *effects_.skin;
  for (std::size_t i = 0; i < count_; ++i) {
    const double pressed = normal_force(i);
    columns_[limit][i] = columns_[mu_static][i] * pressed;
    t[cap][i] = columns_[mode_before][i] == 2.0 ? columns_[mu_kinetic][i] * pressed : columns_[limit][i];
  }
  for (bool begins = true; begins;) {
    skin.shear(t[target_x], t[target_y], t[cap]);
    const double* const slid = skin.solution().slides;
    begins = false;
    for (std::size_t i = 0; i < count_; ++i) {
      const double kinetic = columns_[mu_kinetic][i] * normal_force(i);
      if (slid[i] == 0.0 || !(t[cap][i] > kinetic)) continue;
      t[cap][i] = kinetic;
      begins = true;
    }
  }
}

void FieldResults::add_sunk(double* depth_of) const {
  for (std::size_t i = 0; i < count_; ++i) {
    if (state(i) == ElementState::detached) depth_of[i] += columns_[depth][i];
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
