// Contactile's PapillArray: nine silicone pillars of three heights, whose tips report a force and a
// displacement in three axes.
#pragma once

#include <cstddef>
#include <vector>

#include "sensors/electronics/electronics.h"
#include "sim/api/sensor_kind.h"

namespace slipbench {

// A PapillArray with channels "force" {9,3} [N] and "displacement" {9,3} [m], pillars P0 to P8,
// axes x, y, z of the pad frame P (+X up, +Y right, +Z into the sensor, connector at the bottom,
// origin at the undeformed tip of the centre pillar). With the parameter range_flag also
// "out_of_range" {9}: 1 for a pillar with a reading beyond the part valid_range, else 0. create()
// throws InputError for a rate that the device does not have, for unknown or repeated electronics,
// and for range_flag without the part valid_range.
SensorKind papillarray_sensor();

}  // namespace slipbench

namespace slipbench::papillarray {

// Magnitudes of the disturbances by the electronics of a PapillArray.

inline constexpr std::size_t pillars = 9;
inline constexpr std::size_t axes = 3;
inline constexpr std::size_t channel_size = pillars * axes;

// Stiffness of one pillar [N/m].
struct PillarStiffness {
  double normal;
  double tangential;
};
inline constexpr PillarStiffness gripper_stiffness{7.1e3, 3.9e3};
inline constexpr PillarStiffness hexapod_stiffness{1.2e3, 0.65e3};

// The channel whose readings the coupling changes.
enum class CouplingCarrier { force, displacement, both };

// Largest coefficients of the coupling between the axes of a pillar [N of force over N], and what
// carries it.
struct CouplingFigures {
  double shear_to_normal = 0.0;  // FX, FY to FZ
  double normal_to_shear = 0.0;  // FZ to FX, FY
  double shear_to_shear = 0.0;   // FX to FY, FY to FX
  CouplingCarrier carrier = CouplingCarrier::force;

  [[nodiscard]] bool any() const { return shear_to_normal > 0.0 || normal_to_shear > 0.0 || shear_to_shear > 0.0; }
};

// Returns the coefficients of the part `coupling` in `electronics`; zeros without this part.
CouplingFigures coupling_figures(const std::vector<Named>& electronics);

// Returns the measured figures for the values force {9,3} [N], displacement {9,3} [m] at `rate`
// [Hz]. The force and the displacement of an axis share a source. The force figures were measured
// at the stiffness of the profile `gripper` and are proportional to the stiffness.
SignalModel signal_model(const PillarStiffness& stiffness, double rate, const CouplingFigures& coupling);

// Parts of the electronics, with the figures that were measured on a PapillArray.
std::vector<Entry> electronics_parts();

}  // namespace slipbench::papillarray
