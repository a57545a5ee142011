// The capacitive nib pad: 6x6 silicone nibs over electrodes that a multiplexer groups anew for each
// reading.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "sensors/electronics/electronics.h"
#include "sim/api/sensor_kind.h"
#include "sim/core/parameters.h"

namespace slipbench {

// A nib pad with channels "si" {9,4}, "fl" {2} and "fr" {2}, raw counts of its converter. Pad frame
// P: +X east, +Y north, +Z into the sensor, origin at the tip of a nib of nominal height in the
// pad's middle. Units are nibs, 6 row + column, rows from north to south, columns from west to
// east. Taxels of si are numbered likewise, 3 row + column, with electrodes W, N, E, S. fl:
// clusters N and S; fr: + and -.
//
// With `scan: multiplexed` a sample is eight readings (Sensor::scans): fl N, fl S, fr +, fr -, then
// W, N, E, S of one taxel; the next sample reads the next taxel, so si is complete in the last of
// every nine samples. A frame shows its sample's readings once the last one is done. Values are
// rounded to counts even without electronics, because the device does so (parameter `bits`).
//
// create() throws SceneValueError for an invalid mask_gap, InputError for unknown or repeated
// electronics.
SensorKind nib_pad_sensor();

}  // namespace slipbench

namespace slipbench::nib_pad {

// Which electrodes a reading connects, and how a nib changes their capacitance.

inline constexpr double pitch = 3.8e-3;  // m, from nib to nib
inline constexpr std::size_t rows = 6;   // of nibs, and number of columns
inline constexpr std::size_t nibs = rows * rows;
inline constexpr std::size_t taxels = 9;  // of 2x2 nibs
inline constexpr std::size_t sides = 4;   // electrodes of a taxel

// The values of a sample, in the order of its channels: si {9,4}, fl {2}, fr {2}.
inline constexpr std::size_t si_size = taxels * sides;
inline constexpr std::size_t fl_first = si_size;
inline constexpr std::size_t fr_first = fl_first + 2;
inline constexpr std::size_t value_count = fr_first + 2;

// Side of a nib on which an electrode lies, in the device's order: -x, +y, +x, -y of the pad frame.
enum class Side : std::size_t { west, north, east, south };

struct Electrode {
  std::size_t nib;
  Side side;
};

// Nib 6 row + column, taxel 3 row + column: rows from north to south, columns from west to east.
std::size_t taxel_of(std::size_t nib);

// Returns the electrodes that value v of a sample connects. si: v = 4 taxel + side, the electrodes
// on one side of a taxel's four nibs. fl: the electrodes on the north side of all taxels, then
// those on the south side. fr: the tangential electrodes of the eight outer taxels, one on an edge,
// two on a corner; first those towards which nibs lean when dragged counter-clockwise about +z,
// then the opposite ones.
std::vector<Electrode> electrodes_of(std::size_t v);

// The electrode of a nib against the grounded fabric above it:
//   C   = C0 g0/(g0 - u - r a),   a = (t_e - t_w, t_n - t_s of the side) the fabric's tilt towards the electrode
//   u   = min(f_n/k_post, g0 - gf)          the post alone compresses the gap
//   t   = q/L, no longer than (g0 - u - gf)/R
// f_n: normal force [N]; q: deflection of the tip [m] in the pad's plane; L: distance from the
// hinge in the gap to the tip; R: radius of the fabric that tilts with the nib; gf: gap left where
// the fabric lies on the mask. The mask limits both motions: the fabric's rim ends the tilt, and
// fabric lying flat ends the compression, whatever the nib above does. The gap therefore never
// reaches zero, and capacitance is never clipped. Plate capacitor without fringes. `rest`: C0, at
// f_n = 0, q = 0.
struct NibCapacitor {
  double rest;           // pF, C0
  double gap;            // m, g0
  double mask_gap;       // m, gf
  double post;           // N/m, k_post
  double lever;          // m, L
  double fabric_radius;  // m, R
  double place;          // m, r, from the nib's axis to the electrode's middle
  bool linear;           // uses the tangent of 1/gap at zero load, C0 (1 + (u + r a)/g0)

  // Returns C - C0 [pF] of the electrode on `side`.
  [[nodiscard]] double change(double force, double qx, double qy, Side side) const {
    const double room = gap - mask_gap;
    const double u = std::min(force / post, room);
    const double along = side == Side::east ? qx : side == Side::west ? -qx : side == Side::north ? qy : -qy;
    const double landed = (room - u) / fabric_radius * lever;  // m, deflection at which the rim touches the mask
    const double length2 = qx * qx + qy * qy;
    const double share = length2 > landed * landed ? landed / std::sqrt(length2) : 1.0;
    const double closed = u + place * share * along / lever;
    return linear ? rest * closed / gap : rest * closed / (gap - closed);
  }
};

// The nib pad's catalogue entry and view.

Entry about();
SensorView view();

// Disturbances of a nib pad's electronics.

// Returns the disturbances of the values si {9,4}, fl {2}, fr {2}, in counts at 13 bit times
// `count`, relative to the reading without load. `rate`: samples per second [Hz]. Each value is a
// separate reading and so has its own source.
SignalModel signal_model(double rate, double count);

// Parts of the electronics, with these figures. Rounding to counts is not a part: the device always
// rounds (parameter `bits`).
std::vector<Entry> electronics_parts();

}  // namespace slipbench::nib_pad
