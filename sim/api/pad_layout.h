// The geometry and stiffness of a sensing pad, as a sensor describes it to the element field.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include <Eigen/Core>

namespace slipbench {

// One friction point of a pad. Vectors are in the pad frame P, whose +Z points from the touched
// object into the pad: a pad that faces down on a horizontal plane has P aligned with the world.
struct Element {
  Eigen::Vector3d tip{0.0, 0.0, 0.0};    // undeformed tip p_PT [m]
  Eigen::Vector3d axis{0.0, 0.0, -1.0};  // unit vector from the pad outwards, towards the object
  double k_normal = 0.0;                 // [N/m]
  double k_tangential = 0.0;             // [N/m]
  double c_normal = 0.0;                 // optional dashpot [N s/m]
  double c_tangential = 0.0;             // optional dashpot [N s/m]
};

// Returns the axes x, y, z, as columns in P, of an element that points along the unit vector
// `axis`: z = -axis, and x, y are those of P after the shortest rotation from P's Z to z. Half a
// turn has no shortest rotation; it keeps x.
Eigen::Matrix3d element_frame(const Eigen::Vector3d& axis);

// The elements that a sensor reads as one: a pillar, a nib, a taxel. They are contiguous.
struct UnitRange {
  std::size_t first = 0;
  std::size_t count = 1;
};

// The values that a sensor reads per unit: none, forces, or forces and displacements.
enum class UnitTruth : unsigned char { none, force, all };

// The pad: elements grouped into units, in the sensor's own order.
struct PadLayout {
  std::vector<Element> elements;
  std::vector<UnitRange> units;
  // True if frames also hold each element's state (ContactFrame::element_depth), for a sensor that
  // reads between its units.
  bool element_truth = false;
  UnitTruth unit_truth = UnitTruth::all;
  // Height of a unit above its base [m]. A unit pressed in further does not behave as springs.
  // Infinite: unknown.
  double unit_height = std::numeric_limits<double>::infinity();
};

}  // namespace slipbench
