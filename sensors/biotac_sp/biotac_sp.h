// BioTac SP fingertip and its predecessor: 24 or 19 electrodes on a rigid core, under a conducting
// fluid and a curved elastomer skin.
#pragma once

#include <vector>

#include "sim/api/sensor_kind.h"
#include "sim/core/parameters.h"

namespace slipbench {

// A biotac_sp with channels "electrodes" {24}, "pdc" {} and "pac" {P}, P = 2 cycle_rate/rate, in
// raw counts. Pad frame P: origin at the skin's outermost point, +X along the finger to its tip
// (the device's x), +Z into the finger (the device's y), so +Y is the device's -z. Unit e is the
// part of the skin nearest to electrode E(e+1).
//
// One sample is cycle_rate/rate cycles (Sensor::scans()). With `scan: device` each cycle reads pac
// twice and the next two slots of the round: 24 electrodes, pdc and three slots that are not
// modelled. Electrodes and pdc hold their last reading; before their first slot they hold values
// computed from the contact of the first reading, with the noise of that round. With `scan: ideal`
// all electrodes and pdc are read in the last cycle of a sample. Values are rounded to counts even
// without electronics.
//
// create() throws SceneValueError if cycle_rate is not a multiple of the rate, or if radii, near or
// far leave an electrode without skin; InputError for unknown or repeated electronics.
SensorKind biotac_sp_sensor();

// The predecessor, biotac_19: the same with "electrodes" {19} and a round of 22 slots, two of which
// are not modelled.
SensorKind biotac_19_sensor();

}  // namespace slipbench

namespace slipbench::biotac_sp {

// Catalogue entries of the BioTac SP and of its predecessor with 19 electrodes.

Entry about();
Entry about_19();
// Parts of the electronics. `gain` varies the electrodes' sensitivity, `offset` their impedance at
// rest.
std::vector<Entry> electronics_parts();
std::vector<Entry> electronics_parts_19();

}  // namespace slipbench::biotac_sp
