// Mistakes in a user's model that would go unnoticed: the simulation would run, and be wrong.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "sim/core/pad_layout.h"
#include "sim/core/pose.h"
#include "sim/field/surface/surface.h"
#include "sim/mujoco/pads/pad_config.h"

namespace slipbench {

// Contacts of MuJoCo's own that are possible between a geom that moves with the pad (that of the site's body and of bodies welded to it; of what is
// fixed to the world only the site's own body) and a touched one, as a sentence with what to write; empty: none is.
[[nodiscard]] std::string possible_contact(const mjModel* model, const PadConfig& config);

// Watches one pad on one surface until it has touched rightly: an element that is inside and looks out exerts no force.
class SiteWatch {
 public:
  // At least the tip farthest from the pad's origin is looked at, and 16 at most.
  explicit SiteWatch(const PadLayout& layout);

  // Whether a tip is inside the surface by more than 10 um and looks out of it. `touching`: elements of the pad that touch.
  [[nodiscard]] bool looks_out(const Surface& shape, const Pose& pad_in_surface, std::size_t touching);
  // How far the pad is from the surface at least [m], whichever way it is turned about its origin; negative: it may touch.
  [[nodiscard]] double clearance(const Surface& shape, const Pose& pad_in_surface) const;
  [[nodiscard]] double radius() const { return radius_; }  // m, of the pad about its origin
  // How far a pad may be pressed in where a simulation begins [m]: a unit's height, or the pad's radius where nobody knows it; infinite for a
  // single element.
  [[nodiscard]] double deepest_start() const { return deepest_start_; }

 private:
  std::vector<Element> looked_at_;
  double radius_ = 0.0;  // m, of the pad about its origin
  double deepest_start_;
  bool sure_ = false;  // it has touched
  Eigen::Vector3d clear_at_{0.0, 0.0, 0.0};
  double clear_ = -1.0;  // m, how far from there the pad meets nothing
};

}  // namespace slipbench
