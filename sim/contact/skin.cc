#include "sim/contact/skin.h"

#include <algorithm>
#include <array>
#include <bit>

#include "sim/contact/vectorise.h"

namespace slipbench {
namespace {

using kernel::at, kernel::put, kernel::Lanes, kernel::lanes, kernel::LaneVectors, kernel::select;

// An element cannot press on a face at a larger angle than this, nearly 87 deg.
constexpr double steepest_cosine = 0.05;

// Vectors of SkinColumns::Across.
struct LanePair {
  Lanes x, y;
};
SLIPBENCH_INLINE LanePair at(const SkinColumns::Across& columns, std::size_t i) { return {at(columns.x, i), at(columns.y, i)}; }
SLIPBENCH_INLINE void put(const SkinColumns::Across& columns, std::size_t i, const LanePair& way) {
  put(columns.x, i, way.x);
  put(columns.y, i, way.y);
}

// Transforms between the elements' frames and the frame in which the pad has `pose`. If all element
// frames are equal, they are combined with the pad's rotation.
struct Frames {
  Frames(const SkinColumns& columns, bool all_alike, const Pose& pose) : t(columns), alike(all_alike) {
    Eigen::Matrix3d own = Eigen::Matrix3d::Identity();
    if (alike) own << t.x_axis.at(0), t.y_axis.at(0), t.z_axis.at(0);
    const Eigen::Matrix3d out = pose.rotation * own;
    outward = kernel::entries_of(out);
    inward = kernel::entries_of(out.transpose());
    x = pose.position.x();
    y = pose.position.y();
    z = pose.position.z();
  }

  [[nodiscard]] SLIPBENCH_INLINE LaneVectors in(std::size_t i, const LaneVectors& v) const {
    const LaneVectors p = turned(inward, v);
    if (alike) return p;
    return {dot(at(t.x_axis, i), p), dot(at(t.y_axis, i), p), dot(at(t.z_axis, i), p)};
  }
  [[nodiscard]] SLIPBENCH_INLINE LaneVectors place_in(std::size_t i, const LaneVectors& v) const {
    return in(i, {v.x - x, v.y - y, v.z - z});
  }
  [[nodiscard]] SLIPBENCH_INLINE LaneVectors out(std::size_t i, const LaneVectors& v) const {
    if (alike) return turned(outward, v);
    return turned(outward, v.x * at(t.x_axis, i) + v.y * at(t.y_axis, i) + v.z * at(t.z_axis, i));
  }
  // Rotates (x, y) of the tangent plane out of the element's frame.
  [[nodiscard]] SLIPBENCH_INLINE LaneVectors out(std::size_t i, const LanePair& way) const {
    const LanePair normal = at(t.normal, i);
    const Lanes rise = normal.x * way.x + normal.y * way.y, share = rise / (1.0 + at(t.cosine, i));
    return out(i, LaneVectors{way.x - share * normal.x, way.y - share * normal.y, -rise});
  }

  SkinColumns t;
  bool alike;
  kernel::Rotation outward, inward;
  double x, y, z;
};

// Returns the displacement from a position in the element's frame, seen along the axis, to that of
// the undeformed tip, in the tangent plane.
SLIPBENCH_INLINE LanePair shift_to_root(const SkinColumns& t, std::size_t i, const Lanes& x, const Lanes& y) {
  const Lanes dx = at(t.tip.x, i) - x, dy = at(t.tip.y, i) - y, upright = at(t.cosine, i);
  const LanePair normal = at(t.normal, i);
  const Lanes rise = (dx * normal.x + dy * normal.y) / (upright * (1.0 + upright));
  return {dx + rise * normal.x, dy + rise * normal.y};
}

}  // namespace

// Moves the tips to the loaded surface, seen along the axes.
SLIPBENCH_DISPATCHED static void place_loaded(const kernel::Columns& c, const Frames& in_pad, const Frames& frames,
                                              std::size_t count) {
  const SkinColumns& t = frames.t;
  for (std::size_t i = 0; i < count; i += lanes) {
    const LaneVectors stuck = frames.place_in(i, at(c.anchor, i));
    const auto touched = at(c.before.mode, i) != 0.0;
    const Lanes x = touched ? stuck.x : at(t.tip.x, i) - at(t.shift.x, i);
    const Lanes y = touched ? stuck.y : at(t.tip.y, i) - at(t.shift.y, i);
    put(t.loaded_tip, i, LanePair{x, y});
    put(c.tip, i, in_pad.out(i, LaneVectors{x, y, at(t.tip.z, i)}));
  }
}

// Converts gaps along the normals to gaps along the axes, and computes the contact points of the
// undeformed tips. On a plane no height is written: it is 0.
SLIPBENCH_DISPATCHED static void look_along_axes(const kernel::Columns& c, const Frames& frames, bool plane, std::size_t count) {
  const SkinColumns& t = frames.t;
  const Lanes none{}, one = none + 1.0;
  for (std::size_t i = 0; i < count; i += lanes) {
    const LaneVectors normal = at(c.normal, i), n = frames.in(i, normal);
    const Lanes met = at(c.gap, i);
    const auto faces = n.z > steepest_cosine;
    put(t.cosine, i, faces ? n.z : one);
    put(t.normal.x, i, faces ? n.x : none);
    put(t.normal.y, i, faces ? n.y : none);
    const Lanes gap = faces ? met / n.z : (met < 0.0 ? -met : met) / steepest_cosine;
    put(t.axial_gap, i, gap);
    const LaneVectors z = frames.out(i, LaneVectors{none, none, one}), contact = at(c.contact, i);
    const LaneVectors way = frames.out(i, shift_to_root(t, i, at(t.loaded_tip.x, i), at(t.loaded_tip.y, i)));
    const LaneVectors place{contact.x + met * normal.x - gap * z.x, contact.y + met * normal.y - gap * z.y,
                            (plane ? none : contact.z) + met * normal.z - gap * z.z};
    put(c.place, i, place);
    put(c.contact, i, place + way);
  }
}

// Stores normal forces along the normals; negative while separated, so that their zero is the
// instant of touch. The gap becomes the remaining gap after the surface has yielded or, in contact,
// the surface's displacement.
SLIPBENCH_DISPATCHED static void take_pressure(const kernel::Columns& c, const SkinColumns& t, double own_stiffness,
                                               std::size_t count) {
  const Lanes none{}, one = none + 1.0;
  for (std::size_t i = 0; i < count; i += lanes) {
    const Lanes p = at(t.pressure, i), w = at(t.sunk, i), upright = at(t.cosine, i), ahead = at(t.axial_gap, i) + w;
    const auto touches = p > 0.0;
    const Lanes left = (ahead > 0.0 ? ahead : none) * upright;
    put(c.gap, i, touches ? -w * upright : left);
    put(c.f_normal, i, touches ? p / upright : -own_stiffness * left);
    put(c.depth, i, w);
    // A separated element shifts across its axis; the slope of the surface below does not matter.
    put(t.cosine, i, touches ? upright : one);
    put(t.normal.x, i, touches ? at(t.normal.x, i) : none);
    put(t.normal.y, i, touches ? at(t.normal.y, i) : none);
  }
}

// Computes the shift that the tips would have if all stuck.
SLIPBENCH_DISPATCHED static void aim(const kernel::Columns& c, const Frames& frames, double placed, std::size_t count) {
  const SkinColumns& t = frames.t;
  const Lanes none{}, one = none + 1.0;
  for (std::size_t i = 0; i < count; i += lanes) {
    const auto touched = at(c.before.mode, i) != 0.0;
    const LaneVectors a = at(c.anchor, i), b = at(c.before.contact, i);
    const LaneVectors anchor = frames.place_in(i, select(touched, a, b));
    const LanePair way = shift_to_root(t, i, anchor.x, anchor.y);
    // A new contact has moved with its neighbours so far, and moves with the pad for the rest of
    // the step.
    const Lanes gap = at(c.before.gap, i), depth = at(c.gap, i);
    const Lanes rest = depth < 0.0 ? placed * (gap > 0.0 ? depth / (depth - gap) : one) : none;
    put(t.target.x, i, touched ? way.x : at(t.shift.x, i) + rest * way.x);
    put(t.target.y, i, touched ? way.y : at(t.shift.y, i) + rest * way.y);
  }
}

// Stores the tangential solution in the elements' columns.
SLIPBENCH_DISPATCHED static void take_shear(const kernel::Columns& c, const Frames& frames, std::size_t count) {
  const SkinColumns& t = frames.t;
  const Lanes none{}, one = none + 1.0;
  for (std::size_t i = 0; i < count; i += lanes) {
    const auto touches = at(t.pressure, i) > 0.0, touched = at(c.before.mode, i) != 0.0;
    const LanePair target = at(t.target, i), shifted = at(t.shift, i), shear = at(t.shear, i),
                   ahead{target.x - shifted.x, target.y - shifted.y};
    const Lanes way = kernel::root(ahead.x * ahead.x + ahead.y * ahead.y);
    // Without friction it slips in any direction.
    const auto gives = (at(t.cap, i) == 0.0) | ((ahead.x * shear.x + ahead.y * shear.y > 0.0) & (at(t.slides, i) != 0.0));
    const auto slips = touches & (way > kernel::shortest_slip) & gives, loose = ~(touches & touched);
    LaneVectors anchor = at(c.anchor, i);
    if (any(loose)) {
      // Loose elements, and new contacts, are anchored by their root's position and shift.
      const LaneVectors root = at(c.contact, i);
      const LaneVectors behind = frames.out(i, LanePair{touches ? target.x : shifted.x, touches ? target.y : shifted.y});
      anchor = select(loose, root - behind, anchor);
    }
    LaneVectors slipped{none, none, none};
    if (any(slips)) {
      slipped = frames.out(i, LanePair{slips ? ahead.x : none, slips ? ahead.y : none});
      anchor = anchor + slipped;
      put(c.path, i, at(c.path, i) + (slips ? way : none));
    }
    const LaneVectors shift = frames.out(i, shifted);
    put(c.anchor, i, anchor);
    put(c.contact, i, anchor + shift);
    put(c.slip, i, slipped);
    put(c.force, i, frames.out(i, shear));
    put(c.mode, i, touches ? (slips ? one + 1.0 : one) : none);
  }
}

SkinStepper::SkinStepper(SkinEffect& effect, PadLayout& layout, const kernel::Columns& columns)
    : effect_(&effect), count_(layout.elements.size()) {
  constexpr std::size_t all = sizeof(SkinColumns) / sizeof(double*);
  const std::size_t padded = (count_ + lanes - 1) / lanes * lanes;
  values_.assign(all * padded + pose_size, 0.0);
  std::array<double*, all> each;
  for (std::size_t k = 0; k < all; ++k) each[k] = values_.data() + k * padded;
  own_ = std::bit_cast<SkinColumns>(each);
  for (std::size_t i = 0; i < count_; ++i) {
    Element& element = layout.elements[i];
    const Eigen::Matrix3d frame = element_frame(element.axis);
    own_.x_axis.set(i, frame.col(0));
    own_.y_axis.set(i, frame.col(1));
    own_.z_axis.set(i, frame.col(2));
    own_.tip.set(i, frame.transpose() * element.tip);
    // Stiffness of an element loaded alone, for instants inside a step.
    columns.k_normal[i] = 1.0 / effect.own_normal();
    columns.k_tangential[i] = 1.0 / effect.own_tangential();
    columns.spring.k_normal[i] = element.k_normal = effect.punch_normal()[i];
    columns.spring.k_tangential[i] = element.k_tangential = effect.punch_tangential()[i];
  }
  std::fill_n(own_.cosine, padded, 1.0);
  one_axis_ = std::ranges::all_of(layout.elements, [&](const Element& e) { return e.axis == layout.elements.front().axis; });
}

bool SkinStepper::rests(const Pose& pose, bool may_rest) {
  const std::span<double> before = this->pose();
  const Eigen::Map<Eigen::Matrix3d> rotation(before.data());
  const Eigen::Map<Eigen::Vector3d> position(before.data() + 9);
  rests_ = may_rest && rotation == pose.rotation && position == pose.position;
  std::copy_n(pose.position.data(), 3, std::copy_n(pose.rotation.data(), 9, before.begin()));
  return rests_;
}

void SkinStepper::keep_state(const kernel::Columns& c) const {
  const auto keep = [this](double* now, const double* before) { std::copy_n(before, count_, now); };
  for (const std::size_t k : {0U, 1U, 2U}) {
    keep(c.contact.components()[k], c.before.contact.components()[k]);
    keep(c.force.components()[k], c.before.force.components()[k]);
    std::fill_n(c.slip.components()[k], count_, 0.0);
  }
  keep(c.f_normal, c.before.f_normal);
  keep(c.gap, c.before.gap);
  keep(c.limit, c.before.limit);
  for (std::size_t i = 0; i < count_; ++i) c.mode[i] = std::min(c.before.mode[i], 1.0);
}

void SkinStepper::place_tips(const kernel::Columns& columns, const Pose& pose) {
  const SkinEffect::Solution s = effect_->solution();
  std::copy_n(s.shift_x, count_, own_.shift.x);
  std::copy_n(s.shift_y, count_, own_.shift.y);
  const Frames in_pad(own_, one_axis_, {}), frames(own_, one_axis_, pose);
  place_loaded(columns, in_pad, frames, count_);
}

void SkinStepper::press(const kernel::Columns& columns, const Pose& pose, bool plane) {
  look_along_axes(columns, Frames(own_, one_axis_, pose), plane, count_);
  effect_->press(own_.axial_gap);
  const SkinEffect::Solution s = effect_->solution();
  std::copy_n(s.pressure, count_, own_.pressure);
  std::copy_n(s.sunk, count_, own_.sunk);
  take_pressure(columns, own_, 1.0 / effect_->own_normal(), count_);
}

void SkinStepper::shear(const kernel::Columns& columns, const Pose& pose, bool placed) {
  const Frames frames(own_, one_axis_, pose);
  aim(columns, frames, placed ? 1.0 : 0.0, count_);
  shear_until_none_begins(columns);
  const SkinEffect::Solution s = effect_->solution();
  std::copy_n(s.shift_x, count_, own_.shift.x);
  std::copy_n(s.shift_y, count_, own_.shift.y);
  std::copy_n(s.shear_x, count_, own_.shear.x);
  std::copy_n(s.shear_y, count_, own_.shear.y);
  std::copy_n(s.slides, count_, own_.slides);
  take_shear(columns, frames, count_);
}

// An element that begins to slip carries mu_k f_n, and the load that it drops goes to its
// neighbours. Repeats until no element begins to slip.
void SkinStepper::shear_until_none_begins(const kernel::Columns& c) {
  const double *const f_normal = c.f_normal, *const mu_kinetic = c.mu_kinetic;
  double* const cap = own_.cap;
  const auto pressed = [f_normal](std::size_t i) { return std::max(0.0, f_normal[i]); };
  for (std::size_t i = 0; i < count_; ++i) {
    c.limit[i] = c.mu_static[i] * pressed(i);
    cap[i] = c.before.mode[i] == 2.0 ? mu_kinetic[i] * pressed(i) : c.limit[i];
  }
  for (bool begins = true; begins;) {
    effect_->shear(own_.target.x, own_.target.y, cap);
    const double* const slid = effect_->solution().slides;
    begins = false;
    for (std::size_t i = 0; i < count_; ++i) {
      const double kinetic = mu_kinetic[i] * pressed(i);
      if (slid[i] == 0.0 || !(cap[i] > kinetic)) continue;
      cap[i] = kinetic;
      begins = true;
    }
  }
}

}  // namespace slipbench
