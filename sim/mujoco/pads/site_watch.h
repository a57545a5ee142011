// Checks of a pad's site: a contact of MuJoCo's own that would count twice, and a pad that points
// the wrong way.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "sim/api/pad_layout.h"
#include "sim/contact/surface/surface.h"
#include "sim/core/pose.h"
#include "sim/mujoco/pads/pad_config.h"
#include "sim/mujoco/releases/mujoco_library.h"

namespace slipbench {

// Returns a sentence that names the contacts that MuJoCo itself may find between a geom that moves
// with the pad and a touched geom, with the remedy; empty if MuJoCo can find no such contact. Geoms
// of the site's body and of bodies welded to it move with the pad; if the site's body is fixed to
// the world, only its own geoms are meant.
[[nodiscard]] std::string possible_contact(ModelView model, const PadConfig& config);

// Checks one pad on one surface until it has touched correctly: an element that is inside and
// points outwards exerts no force.
class SiteWatch {
 public:
  // Uses at least the tip farthest from the pad's origin, and at most 16 tips.
  explicit SiteWatch(const PadLayout& layout);

  // True if a tip is inside the surface by more than 10 um and points outwards. `touching`: number
  // of the pad's touching elements.
  [[nodiscard]] bool points_outwards(const Surface& shape, const Pose& pad_in_surface, std::size_t touching);
  // Returns a lower bound of the pad's distance from the surface [m] at any rotation about its
  // origin; negative: it may touch.
  [[nodiscard]] double clearance(const Surface& shape, const Pose& pad_in_surface) const;
  [[nodiscard]] double radius() const { return radius_; }  // m, of the pad about its origin
  // Largest valid depth of a pad at the start of a simulation [m]: a unit's height, or the pad's
  // radius if that is unknown; infinite for a single element.
  [[nodiscard]] double deepest_start() const { return deepest_start_; }

 private:
  std::vector<Element> tips_;
  double radius_ = 0.0;  // m, of the pad about its origin
  double deepest_start_;
  bool sure_ = false;  // it has touched
  Eigen::Vector3d clear_at_{0.0, 0.0, 0.0};
  double clear_ = -1.0;  // m, distance from clear_at_ within which the pad touches nothing
};

}  // namespace slipbench
