// Where a pad is: its poses and velocities relative to the surfaces that it may touch.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "sim/api/pad_layout.h"
#include "sim/contact/field.h"
#include "sim/contact/surface/surface.h"
#include "sim/core/pose.h"
#include "sim/mujoco/pads/geom_surface.h"
#include "sim/mujoco/pads/pad_config.h"
#include "sim/mujoco/pads/site_watch.h"
#include "sim/mujoco/releases/mujoco_library.h"

namespace slipbench {

using MjMatrix = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;
using MjVector = Eigen::Map<const Eigen::Vector3d>;

// Returns the frame with its origin at `position` [3] m and the axes `rotation` [9], row by row, as
// MuJoCo stores them.
inline Pose pose_at(const double* position, const double* rotation) { return {MjMatrix(rotation), MjVector(position)}; }

// A geom that a pad may touch, and its surface.
struct TouchedGeom {
  int geom;
  int body;
  ShapeValues values;  // of which the surface was made
  Pose surface_in_geom;
  Surface shape;
  SiteWatch watch;
  double reach;           // m, distance between the origins of pad and geom beyond which nothing touches; 0: unknown
  Pose pad_in_surface{};  // of the last locate()
  Twist motion{};         // of the pad in the surface's frame, likewise
};

// Reads a pad's poses and velocities from mjData, and knows how far the pad is from all that it may
// touch. k numbers the touched geoms.
class PadKinematics {
 public:
  // `layout`: of the pad. Throws InputError if a geom cannot be touched or moves with the pad.
  PadKinematics(ModelView model, const PadConfig& config, const PadLayout& layout);

  // Makes the surfaces of geoms whose shape has changed anew. Returns true if one has. Throws
  // InputError if a geom cannot be touched.
  bool update_shapes(ModelView model);

  // Finds the pad in the frame of every touched surface. Returns true if all poses and velocities
  // are those of the last call. `always`: computes them without comparing MuJoCo's values first,
  // which is faster for a pad that moves at every call.
  bool locate(ModelView model, DataView data, bool always);

  // True if the bounding balls of the pad and of each touched geom do not overlap at the present
  // pose, which most pads are. Needs no locate().
  [[nodiscard]] bool is_far(DataView data) const;
  // After locate(): true if the pad can touch nothing at its pose.
  [[nodiscard]] bool is_clear();
  // As is_far() and is_clear(), at all poses of the coming step of `step` [s], as predicted by the
  // implicit solver from the velocity and from the relative acceleration in its memory. A tip's
  // displacement is at most its path.
  [[nodiscard]] bool stays_far(ModelView model, DataView data, std::span<const double> memory, double step) const;
  [[nodiscard]] bool stays_clear(std::span<const double> memory, double step) const;

  // Returns the first mistake in the pose of the pad's site as a sentence, or an empty text. Call
  // it after locate() and a step of the fields (one per touched geom). Mistakes are a pad that
  // exerts no force because it points away, and a pad that exerts a huge force because it starts
  // deep inside. `placed`: a step has been committed since the last reset.
  [[nodiscard]] std::string site_mistake(ModelView model, std::span<const Field> fields, bool placed);

  // Adds `wrench` on the pad, in the frame of surface k, and its reaction on the touched body to
  // qfrc_passive.
  void apply(ModelView model, DataView data, std::size_t k, const Wrench& wrench) const;

  // Stores the poses of the pad and the touched geoms [12 (1 + n)], and returns the pad's pose in
  // surface k at that time.
  void store_poses(DataView data, std::span<double> poses) const;
  [[nodiscard]] Pose stored_pad_in_surface(std::span<const double> poses, std::size_t k) const;

  [[nodiscard]] Pose pad_pose(DataView data) const;                     // in the world
  [[nodiscard]] Pose surface_pose(DataView data, std::size_t k) const;  // likewise
  [[nodiscard]] const std::vector<TouchedGeom>& touched() const { return touched_; }
  [[nodiscard]] int pad_body(ModelView model) const { return model.site_bodyid()[site_]; }

 private:
  [[nodiscard]] TouchedGeom touched_geom(ModelView model, int geom) const;
  [[nodiscard]] bool is_unmoved(ModelView model, DataView data);

  int site_;
  SiteWatch watch_;  // that has seen nothing
  std::vector<TouchedGeom> touched_;
  // MuJoCo's values at the last locate(), and space for those of the next.
  std::vector<double> located_, present_;
  std::optional<bool> clear_;  // is_clear() at the pose of locate(); empty: not computed
};

}  // namespace slipbench
