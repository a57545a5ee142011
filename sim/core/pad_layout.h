// The geometry and stiffness of a sensing pad, as a sensor hands it to the element field.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include <Eigen/Core>

namespace slipbench {

// One friction point of a pad. Vectors are in the pad frame P, whose +Z points from the touched object into the pad: a pad that
// faces down on a horizontal plane has P aligned with the world.
struct Element {
  Eigen::Vector3d tip{0.0, 0.0, 0.0};    // undeformed tip p_PT [m]
  Eigen::Vector3d axis{0.0, 0.0, -1.0};  // unit vector from the pad outwards, towards the object
  double k_normal = 0.0;                 // [N/m]
  double k_tangential = 0.0;             // [N/m]
  double c_normal = 0.0;                 // optional dashpot [N s/m]
  double c_tangential = 0.0;             // optional dashpot [N s/m]
};

// x, y and z of an element that looks along the unit vector `axis`, in P: z is against it, x and y are those of P turned with it the shortest
// way; x stays where there is none.
Eigen::Matrix3d element_frame(const Eigen::Vector3d& axis);

// What a sensor reads as one: a pillar, a nib, a taxel. Its elements are contiguous.
struct UnitRange {
  std::size_t first = 0;
  std::size_t count = 1;
};

// What a sensor reads of its units: nothing, their forces, or displacements too.
enum class UnitTruth : unsigned char { none, force, all };

// The pad: elements grouped into units, in the sensor's own order.
struct PadLayout {
  std::vector<Element> elements;
  std::vector<UnitRange> units;
  // Whether frames also tell what each element does (ContactFrame::element_depth), for a sensor that reads between its units.
  bool element_truth = false;
  UnitTruth unit_truth = UnitTruth::all;
  // How high a unit stands over its base: pressed in farther, the device is no field of springs [m]; infinite: nobody knows.
  double unit_height = std::numeric_limits<double>::infinity();
};

}  // namespace slipbench
