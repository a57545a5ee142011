// Electrode positions and readings of a BioTac SP (24 electrodes) and of its predecessor (19).
// Electrode E1 has index 0.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "sim/api/contact_frame.h"
#include "sim/api/pad_layout.h"

namespace slipbench::biotac_sp {

inline constexpr std::size_t electrodes = 24;     // of an SP
inline constexpr std::size_t electrodes_19 = 19;  // of its predecessor

// Half axes of the skins, as written in a scene.
inline constexpr const char* own_radii = "[13.85 mm, 10.1 mm, 9.85 mm]";
inline constexpr const char* own_radii_19 = "[16 mm, 7 mm, 7 mm]";

// Middle of each electrode of an SP on the rigid core [m], in the device's own axes: x along the
// finger, y away from the object, z across.
const std::array<Eigen::Vector3d, electrodes>& electrode_places();
// The same for the predecessor. Its x is counted from 7 mm behind the maker's origin, where half an
// ellipsoid comes nearest to its skin.
const std::array<Eigen::Vector3d, electrodes_19>& electrode_places_19();

// Reading of each electrode of an untouched SP [counts].
const std::array<double, electrodes>& rest_readings();

// Standard deviation of each electrode's noise, relative to the mean of all (SP).
const std::array<double, electrodes>& relative_noise();

// Transforms a position from the device's own axes into the pad frame P, whose origin is the skin's
// outermost point and whose +Z goes into the finger. `bulge`: how far the skin reaches outwards,
// along -y, from the device's origin [m].
inline Eigen::Vector3d in_pad_frame(const Eigen::Vector3d& place, double bulge) {
  return {place.x(), -place.z(), place.y() + bulge};
}

// The skin of a BioTac: half an ellipsoid of compliant friction points over the core with the
// electrodes.
struct Skin {
  PadLayout layout;                    // in P; unit e: the elements nearest to electrode e
  std::vector<double> area;            // m2, of each element
  std::vector<Eigen::Vector3d> above;  // m, in P: the point of the skin above each electrode
};

struct SkinFigures {
  std::size_t elements;
  Eigen::Vector3d radii;  // m, of the ellipsoid, along the device's x, y and z
  double k_normal;        // N/m, of all elements together
  double shear;           // k_tangential over k_normal
};

// Fibonacci points of the lower half sphere, t_k = (k + 1/2)/n - 1 along its axis, stretched to the
// ellipsoid
//   (x/a)^2 + (y/b)^2 + (z/c)^2 = 1,  y < 0.
// Stretching enlarges an area at the point u of the unit sphere by a b c |(u_x/a, u_y/b, u_z/c)|.
// This factor is the element's weight, so that sums over elements are integrals over the skin for
// any n. Stiffness is proportional to the area (elastic foundation). `sensor`: path in the scene,
// "sensors.finger". `places`: of the electrodes. Throws SceneValueError at the radii if an
// electrode has no element: the skin's shape does not fit the electrodes, or the mesh is too
// coarse.
Skin make_skin(const SkinFigures& figures, const std::string& sensor,
               std::span<const Eigen::Vector3d> places = electrode_places());

// Counts of an electrode from the dents of the skin.

// Effective dent of the skin over each electrode, w [m]:
//   w_e = sum_i d_i (G_ei + S q_i . grad G_ei) - B sum_i d_i A_i / sum_i A_i
//   G_ei = A_i ((1 - a) g(r_ei)/g_max + a h(r_ei)/h_max),  g = exp(-r^2/(2 l^2)),  h = exp(-r/L)
// d_i: depth of element i in the object; q_i: drag of its tip along the surface; A_i: its
// area; r_ei: distance from the skin over electrode e. g_max: largest over e of sum_i A_i g(r_ei),
// h_max likewise, so that no electrode feels more than a dent of the whole skin. S: `stretch`.
// grad: along the skin, as a dragged dent moves towards or away from the electrode. B: `swell`, as
// the fluid displaced by a dent lifts the skin elsewhere.
struct Kernel {
  double near;       // m, l
  double far;        // m, L
  double far_share;  // a
  double swell;      // B
  double stretch;    // S
};

class Dents {
 public:
  // `sensor`: path in the scene, "sensors.finger". Throws SceneValueError at near or far if it is
  // so short that an electrode does not feel its nearest element.
  Dents(const Skin& skin, const Kernel& kernel, const std::string& sensor);

  // Returns w_e [m] of electrode e. `truth` needs element_depth and element_shear. `touching`: the
  // elements with depth > 0; the cost is proportional to their number.
  [[nodiscard]] double dent(std::size_t e, const ContactFrame& truth, std::span<const Eigen::Index> touching) const {
    const auto column = static_cast<Eigen::Index>(e);
    const Eigen::Index n = depth_.rows();
    const double* const felt = depth_.col(column).data();
    const double* const drag = drag_.size() > 0 ? drag_.col(column).data() : nullptr;
    const double* const q = truth.element_shear.data();
    double w = 0.0;
    for (const Eigen::Index i : touching) {
      double share = felt[i];
      if (drag != nullptr) share += q[i] * drag[i] + q[n + i] * drag[n + i] + q[2 * n + i] * drag[2 * n + i];
      w += share * truth.element_depth[i];
    }
    return w;
  }

 private:
  Eigen::MatrixXd depth_;  // [N,electrodes] 1
  Eigen::MatrixXd drag_;   // [3N,electrodes] 1/m, empty if drag has no effect
};

// Voltage divider that measures an electrode: Z = (4095/E - 1) 10 kOhm, E in counts (SP manual,
// section 5).
inline constexpr double load_resistor = 10.0;  // kOhm
inline constexpr double last_code = 4095.0;    // of 12 bit
inline double counts_of(double impedance) { return last_code / (1.0 + impedance / load_resistor); }
inline double impedance_of(double counts) { return (last_code / counts - 1.0) * load_resistor; }

}  // namespace slipbench::biotac_sp
