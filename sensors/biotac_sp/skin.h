// The skin of a BioTac SP: half an ellipsoid of compliant friction points over the core with the electrodes.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "sensors/biotac_sp/electrodes.h"
#include "sim/core/pad_layout.h"

namespace slipbench::biotac_sp {

struct Skin {
  PadLayout layout;                               // in P; unit e: what is nearer to electrode e than to any other
  std::vector<double> area;                       // m2, of each element
  std::array<Eigen::Vector3d, electrodes> above;  // m, in P: the skin's point over each electrode
};

struct SkinFigures {
  std::size_t elements;
  Eigen::Vector3d radii;  // m, of the ellipsoid, along the device's x, y and z
  double k_normal;        // N/m, of all elements together
  double shear;           // k_tangential over k_normal
};

// Fibonacci points of the lower half sphere, t_k = (k + 1/2)/n - 1 along its axis, stretched to the ellipsoid
//   (x/a)^2 + (y/b)^2 + (z/c)^2 = 1,  y < 0.
// Where the point u of the unit sphere comes to lie, an area of it is larger by a b c |(u_x/a, u_y/b, u_z/c)|: that is the element's weight,
// so that sums over elements are integrals over the skin whatever n. Stiffness goes with the area (an elastic foundation).
// `sensor`: its place in the scene, "sensors.finger". Throws SceneValueError of its radii where an electrode would have no element: the skin is
// another shape than the electrodes', or the mesh too coarse for it.
Skin make_skin(const SkinFigures& figures, const std::string& sensor);

}  // namespace slipbench::biotac_sp
