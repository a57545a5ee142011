// A step of a field whose pad is one elastic body (SkinEffect). Between the undeformed tips and the forces stand three things that a field of
// springs does not need:
// - The surface is met where the loaded skin is: a tip that touches at its anchor, as the step before has left it. So a stuck patch feels no
//   change of gap while the pad moves along, and a tip that begins to slip or stops meets no other place for it. One that slips is met late by
//   the slip of one step.
// - A gap counts along the element's axis, gap/cos of the angle between axis and normal, as the skin gives. Force p along the axis is p/cos
//   along the normal.
// - Ways and forces in the tangent plane are told by the element's x and y, turned with its z onto the normal the shortest way.
#include <algorithm>
#include <array>
#include <cmath>

#include "sim/field/field.h"
#include "sim/field/kernel.h"

namespace slipbench {
namespace {

// Columns of Field::skin_. Frames are constant; the rest is of the step.
enum SkinColumn : std::size_t {
  x_axis = 0,  // of the element's frame, in P
  y_axis = 3,
  z_axis = 6,
  tip_in_frame = 9,  // undeformed, along these [m]
  axial_gap = 12,    // [m]
  cosine,            // between z and the normal
  lean_x,
  lean_y,  // of the normal along x and y
  target_x,
  target_y,  // g of sim/effects/skin/elastic_contact.h [m]
  cap,       // L of it [N]
  skin_columns
};

// From so steep an angle on, nearly 87 deg, a face is none that this element could press on.
constexpr double steepest_cosine = 0.05;

struct Vector3 {
  double x, y, z;
};

// Pointers to columns that stand one padded length apart.
struct SkinTable {
  double* first;
  std::size_t padded;
  double* operator[](std::size_t column) const { return first + column * padded; }
};

// The rows of a rotation.
struct Rows {
  explicit Rows(const Eigen::Matrix3d& m) {
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) entry[r][c] = m(r, c);
    }
  }
  [[nodiscard]] SLIPBENCH_INLINE Vector3 operator()(double x, double y, double z) const {
    return {entry[0][0] * x + entry[0][1] * y + entry[0][2] * z, entry[1][0] * x + entry[1][1] * y + entry[1][2] * z,
            entry[2][0] * x + entry[2][1] * y + entry[2][2] * z};
  }
  double entry[3][3];
};

SLIPBENCH_INLINE double along(const SkinTable& t, std::size_t axis, std::size_t i, const Vector3& v) {
  return t[axis][i] * v.x + t[axis + 1][i] * v.y + t[axis + 2][i] * v.z;
}
SLIPBENCH_INLINE Vector3 from_frame(const SkinTable& t, std::size_t i, double x, double y, double z) {
  return {t[x_axis][i] * x + t[y_axis][i] * y + t[z_axis][i] * z,
          t[x_axis + 1][i] * x + t[y_axis + 1][i] * y + t[z_axis + 1][i] * z,
          t[x_axis + 2][i] * x + t[y_axis + 2][i] * y + t[z_axis + 2][i] * z};
}
// Of the tangent plane's (x, y), in the surface frame.
SLIPBENCH_INLINE Vector3 in_plane(const SkinTable& t, const Rows& to_surface, std::size_t i, double x, double y) {
  const double rise = t[lean_x][i] * x + t[lean_y][i] * y, share = rise / (1.0 + t[cosine][i]);
  const Vector3 v = from_frame(t, i, x - share * t[lean_x][i], y - share * t[lean_y][i], -rise);
  return to_surface(v.x, v.y, v.z);
}

struct Vector2 {
  double x, y;
};
// From the place (x, y), seen along the axis, to that of the undeformed tip, in the tangent plane.
SLIPBENCH_INLINE Vector2 way_to_root(const SkinTable& t, std::size_t i, double x, double y) {
  const double dx = t[tip_in_frame][i] - x, dy = t[tip_in_frame + 1][i] - y;
  const double rise = (dx * t[lean_x][i] + dy * t[lean_y][i]) / (t[cosine][i] * (1.0 + t[cosine][i]));
  return {dx + rise * t[lean_x][i], dy + rise * t[lean_y][i]};
}

}  // namespace

// Tips go where the loaded surface is, seen along the axes.
SLIPBENCH_DISPATCHED static void place_loaded(const kernel::Columns& c, const SkinTable& t, const Pose& pose,
                                              const SkinEffect::Solution& s, std::size_t count) {
  const Rows to_pad(pose.rotation.transpose());
  const double px = pose.position.x(), py = pose.position.y(), pz = pose.position.z();
  SLIPBENCH_VECTORISE
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3 stuck = to_pad(c[kernel::anchor_x][i] - px, c[kernel::anchor_y][i] - py, c[kernel::anchor_z][i] - pz);
    const double trailing_x = t[tip_in_frame][i] - s.shift_x[i], trailing_y = t[tip_in_frame + 1][i] - s.shift_y[i];
    const bool touches = c[kernel::mode_before][i] != 0.0;
    const double x = touches ? along(t, x_axis, i, stuck) : trailing_x, y = touches ? along(t, y_axis, i, stuck) : trailing_y;
    const Vector3 tip = from_frame(t, i, x, y, t[tip_in_frame + 2][i]);
    c[kernel::tip_x][i] = tip.x;
    c[kernel::tip_y][i] = tip.y;
    c[kernel::tip_z][i] = tip.z;
  }
}

// Gaps along the axes, of those along the normals, and where the undeformed tips would meet the surface.
// On a plane no height is written: it is 0.
SLIPBENCH_DISPATCHED static void look_along_axes(const kernel::Columns& c, const SkinTable& t, const Pose& pose, bool plane,
                                                 std::size_t count) {
  const Rows to_pad(pose.rotation.transpose()), to_surface(pose.rotation);
  SLIPBENCH_VECTORISE
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3 n = to_pad(c[kernel::normal_x][i], c[kernel::normal_y][i], c[kernel::normal_z][i]);
    const double upright = along(t, z_axis, i, n), met = c[kernel::gap][i];
    const bool faces = upright > steepest_cosine;
    t[cosine][i] = faces ? upright : 1.0;
    t[lean_x][i] = faces ? along(t, x_axis, i, n) : 0.0;
    t[lean_y][i] = faces ? along(t, y_axis, i, n) : 0.0;
    const double gap = faces ? met / upright : std::abs(met) / steepest_cosine;
    t[axial_gap][i] = gap;
    const Vector3 tip{c[kernel::tip_x][i], c[kernel::tip_y][i], c[kernel::tip_z][i]};
    const auto [x, y] = way_to_root(t, i, along(t, x_axis, i, tip), along(t, y_axis, i, tip));
    const Vector3 z = to_surface(t[z_axis][i], t[z_axis + 1][i], t[z_axis + 2][i]), way = in_plane(t, to_surface, i, x, y);
    c[kernel::place_x][i] = c[kernel::contact_x][i] + met * c[kernel::normal_x][i] - gap * z.x;
    c[kernel::place_y][i] = c[kernel::contact_y][i] + met * c[kernel::normal_y][i] - gap * z.y;
    c[kernel::place_z][i] = (plane ? 0.0 : c[kernel::contact_z][i]) + met * c[kernel::normal_z][i] - gap * z.z;
    c[kernel::contact_x][i] = c[kernel::place_x][i] + way.x;
    c[kernel::contact_y][i] = c[kernel::place_y][i] + way.y;
    c[kernel::contact_z][i] = c[kernel::place_z][i] + way.z;
  }
}

// Normal forces along the normals; negative while apart, so that their zero is the instant of touch. The gap is what is left of it once the
// surface has given way, or how far it has.
SLIPBENCH_DISPATCHED static void take_pressure(const kernel::Columns& c, const SkinTable& t, const SkinEffect::Solution& s,
                                               double own_stiffness, std::size_t count) {
  SLIPBENCH_VECTORISE
  for (std::size_t i = 0; i < count; ++i) {
    const bool touches = s.pressure[i] > 0.0;
    const double left = std::max(t[axial_gap][i] + s.sunk[i], 0.0) * t[cosine][i];
    const double pressed = s.pressure[i] / t[cosine][i];
    c[kernel::gap][i] = touches ? -s.sunk[i] * t[cosine][i] : left;
    c[kernel::f_normal][i] = touches ? pressed : -own_stiffness * left;
    c[kernel::depth][i] = s.sunk[i];
    // What is apart shifts across its axis; which way the surface leans below it is nothing to it.
    t[cosine][i] = touches ? t[cosine][i] : 1.0;
    t[lean_x][i] = touches ? t[lean_x][i] : 0.0;
    t[lean_y][i] = touches ? t[lean_y][i] : 0.0;
  }
}

// The shift that the tips would have if all stuck to where they were.
SLIPBENCH_DISPATCHED static void aim(const kernel::Columns& c, const SkinTable& t, const Pose& pose,
                                     const SkinEffect::Solution& s, double placed, std::size_t count) {
  const Rows to_pad(pose.rotation.transpose());
  const double px = pose.position.x(), py = pose.position.y(), pz = pose.position.z();
  SLIPBENCH_VECTORISE
  for (std::size_t i = 0; i < count; ++i) {
    const bool touched = c[kernel::mode_before][i] != 0.0;
    const double ax = c[kernel::anchor_x][i], ay = c[kernel::anchor_y][i], az = c[kernel::anchor_z][i];
    const double bx = c[kernel::contact_before_x][i], by = c[kernel::contact_before_y][i], bz = c[kernel::contact_before_z][i];
    const Vector3 was = to_pad((touched ? ax : bx) - px, (touched ? ay : by) - py, (touched ? az : bz) - pz);
    const auto [way_x, way_y] = way_to_root(t, i, along(t, x_axis, i, was), along(t, y_axis, i, was));
    // What touches anew has followed its neighbours, and goes with the pad for the rest of the step.
    const double gap = c[kernel::gap_before][i], depth = c[kernel::gap][i];
    const double rest = depth < 0.0 ? placed * (gap > 0.0 ? depth / (depth - gap) : 1.0) : 0.0;
    t[target_x][i] = touched ? way_x : s.shift_x[i] + rest * way_x;
    t[target_y][i] = touched ? way_y : s.shift_y[i] + rest * way_y;
  }
}

// What the solution makes of the elements.
SLIPBENCH_DISPATCHED static void take_shear(const kernel::Columns& c, const SkinTable& t, const Pose& pose,
                                            const SkinEffect::Solution& s, std::size_t count) {
  const Rows to_surface(pose.rotation);
  SLIPBENCH_VECTORISE
  for (std::size_t i = 0; i < count; ++i) {
    const double touches = s.pressure[i] > 0.0 ? 1.0 : 0.0, touched = c[kernel::mode_before][i] != 0.0 ? 1.0 : 0.0;
    const double ahead_x = t[target_x][i] - s.shift_x[i], ahead_y = t[target_y][i] - s.shift_y[i];
    const double way = std::sqrt(ahead_x * ahead_x + ahead_y * ahead_y);
    const double moves = way > kernel::shortest_slip ? 1.0 : 0.0;
    // Where there is no friction it slips whichever way it is taken.
    const double free = t[cap][i] == 0.0 ? 1.0 : 0.0;
    const double along_force = ahead_x * s.shear_x[i] + ahead_y * s.shear_y[i] > 0.0 ? s.slides[i] : 0.0;
    const double slip = touches * moves * std::max(free, along_force), stays = touches * touched;
    const Vector3 shift = in_plane(t, to_surface, i, s.shift_x[i], s.shift_y[i]);
    const Vector3 slipped = in_plane(t, to_surface, i, slip * ahead_x, slip * ahead_y);
    const Vector3 force = in_plane(t, to_surface, i, s.shear_x[i], s.shear_y[i]);
    // What is loose, or has touched in this step, is where its root's place and its shift say.
    const double behind_x = touches != 0.0 ? t[target_x][i] : s.shift_x[i],
                 behind_y = touches != 0.0 ? t[target_y][i] : s.shift_y[i];
    const Vector3 behind = in_plane(t, to_surface, i, behind_x, behind_y);
    const double loose_x = c[kernel::contact_x][i] - behind.x, loose_y = c[kernel::contact_y][i] - behind.y,
                 loose_z = c[kernel::contact_z][i] - behind.z;
    const double stuck_x = c[kernel::anchor_x][i], stuck_y = c[kernel::anchor_y][i], stuck_z = c[kernel::anchor_z][i];
    const double anchor_x = (stays != 0.0 ? stuck_x : loose_x) + slipped.x,
                 anchor_y = (stays != 0.0 ? stuck_y : loose_y) + slipped.y,
                 anchor_z = (stays != 0.0 ? stuck_z : loose_z) + slipped.z;
    c[kernel::anchor_x][i] = anchor_x;
    c[kernel::anchor_y][i] = anchor_y;
    c[kernel::anchor_z][i] = anchor_z;
    c[kernel::contact_x][i] = anchor_x + shift.x;
    c[kernel::contact_y][i] = anchor_y + shift.y;
    c[kernel::contact_z][i] = anchor_z + shift.z;
    c[kernel::slip_x][i] = slipped.x;
    c[kernel::slip_y][i] = slipped.y;
    c[kernel::slip_z][i] = slipped.z;
    c[kernel::force_x][i] = force.x;
    c[kernel::force_y][i] = force.y;
    c[kernel::force_z][i] = force.z;
    c[kernel::path][i] += slip * way;
    c[kernel::mode][i] = touches * (1.0 + slip);
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
    // One that is loaded alone, for instants inside a step.
    columns_[k_normal][i] = 1.0 / skin.own_normal();
    columns_[k_tangential][i] = 1.0 / skin.own_tangential();
    columns_[k_normal_spring][i] = element.k_normal = skin.punch_normal()[i];
    columns_[k_tangential_spring][i] = element.k_tangential = skin.punch_tangential()[i];
  }
  std::fill(t[cosine], t[cosine] + padded_, 1.0);
}

void Field::step_on_skin(double dt, const Twist* motion) {
  step_ = dt;
  if (skin_rests()) return rest_on_skin();
  SkinEffect& skin = *effects_.skin;
  const SkinTable t{skin_.data(), padded_};
  const SkinEffect::Solution s = skin.solution();
  place_loaded(columns_, t, pose_, s, count_);
  contacts_.find(columns_, pose_, all());
  for (const auto& effect : effects_.surface) {
    effect->displace(count_, columns_[contact_x], columns_[contact_y], columns_[normal_z], columns_[gap]);
  }
  look_along_axes(columns_, t, pose_, on_plane(), count_);
  skin.press(t[axial_gap]);
  take_pressure(columns_, t, s, 1.0 / skin.own_normal(), count_);
  if (!effects_.friction.empty()) rate_friction(dt, motion);
  aim(columns_, t, pose_, s, placed_ ? 1.0 : 0.0, count_);
  shear_skin();
  take_shear(columns_, t, pose_, s, count_);
}

// Whether the pad is where it was, and nothing else could change; remembers where it is.
bool Field::skin_rests() {
  const std::span<double> before = skin_pose();
  const Eigen::Map<Eigen::Matrix3d> rotation(before.data());
  const Eigen::Map<Eigen::Vector3d> position(before.data() + 9);
  const bool rests = placed_ && rotation == pose_.rotation && position == pose_.position && effects_.friction.empty();
  std::copy_n(pose_.position.data(), 3, std::copy_n(pose_.rotation.data(), 9, before.begin()));
  return rests;
}

// A pad that has not moved since the step before is as it was, and what slipped sticks.
void Field::rest_on_skin() {
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

// An element that has begun to slip holds mu_k f_n, and what it lets go of loads its neighbours: until none begins.
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
    const double* const slides = skin.solution().slides;
    begins = false;
    for (std::size_t i = 0; i < count_; ++i) {
      const double kinetic = columns_[mu_kinetic][i] * normal_force(i);
      if (slides[i] == 0.0 || !(t[cap][i] > kinetic)) continue;
      t[cap][i] = kinetic;
      begins = true;
    }
  }
}

void Field::add_sunk(double* depth_of) const {
  for (std::size_t i = 0; i < count_; ++i) {
    if (state(i) == ElementState::detached) depth_of[i] += columns_[depth][i];
  }
}

// p'C p/2 + q'C q/2: forces times the ways that the surface has given.
kernel::SpringSums Field::skin_sums() const {
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
