// The BioTac SP fingertip and its predecessor: 24 or 19 electrodes on a rigid core, under a conducting fluid and a curved elastomer skin.
#pragma once

#include <vector>

#include "sim/core/parameters.h"
#include "sim/core/sensor_kind.h"

namespace slipbench {

// A biotac_sp with channels "electrodes" {24}, "pdc" {} and "pac" {P}, P = 2 cycle_rate/rate, raw counts. Pad frame P: origin at
// the skin's outermost point, +X along the finger to its tip as the device's x, +Z into the finger (the device's y), so +Y is the
// device's -z. Unit e is the part of the skin nearest to electrode E(e+1). A sample is cycle_rate/rate cycles, Sensor::scans(),
// each of which is two readings of pac and, with `scan: device`, of the two slots whose turn it is: 24 electrodes, pdc, and three
// that are not modelled; electrodes and pdc hold what was read last, before their first turn what the first reading's contact
// gives with the noise of that round. With `scan: ideal` all electrodes and pdc are read in the last cycle of a sample. Without
// electronics it still rounds to counts. create() throws SceneValueError where cycle_rate is no whole multiple of the rate and
// where radii, near or far leave an electrode without skin, InputError for unknown or repeated electronics.
SensorKind biotac_sp_sensor();

// The predecessor, biotac_19: the same with "electrodes" {19} and a round of 22 slots, of which two are not modelled.
SensorKind biotac_19_sensor();

}  // namespace slipbench

namespace slipbench::biotac_sp {

// Catalogue entries of the BioTac SP and of its predecessor with 19 electrodes.

Entry about();
Entry about_19();
// The parts of its electronics. `gain` and `offset` are those of the electrodes' sensitivity and of their impedance at rest.
std::vector<Entry> electronics_parts();
std::vector<Entry> electronics_parts_19();

}  // namespace slipbench::biotac_sp
