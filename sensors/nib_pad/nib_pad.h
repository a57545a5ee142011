// The capacitive nib pad: 6x6 silicone nibs over electrodes that a multiplexer clusters anew at each reading.
#pragma once

#include <vector>

#include "sensors/electronics/electronics.h"
#include "sim/core/parameters.h"
#include "sim/core/sensor_kind.h"
#include "sim/core/sensor_view.h"

namespace slipbench {

// A nib pad with channels "si" {9,4}, "fl" {2} and "fr" {2}, raw counts of its converter. Pad frame P: +X east, +Y north, +Z into
// the sensor, origin at the tip of a nib of nominal height in the pad's middle. Units are nibs, 6 row + column, rows from north
// to south, columns from west to east; taxels of si likewise, 3 row + column, their electrodes W, N, E, S. fl: the clusters N and
// S; fr: + and -. With `scan: multiplexed` a sample is eight readings (Sensor::scans): fl N, fl S, fr +, fr -, then W, N, E, S of
// one taxel, the next taxel in the next sample; si is complete in the last of every nine samples. What a sample reads is in its
// frame once its last reading is done. Without electronics it still rounds to counts: that is what the device does, parameter
// `bits`. create() throws SceneValueError for a gap of the mask that is none, InputError for unknown or repeated electronics.
SensorKind nib_pad_sensor();

}  // namespace slipbench

namespace slipbench::nib_pad {

// What the catalogue says of the nib pad.

Entry about();
SensorView view();

// How large the disturbances of a nib pad's electronics are.

// Of the values si {9,4}, fl {2}, fr {2}, in counts at 13 bit times `count` above the reading at rest, `rate` [Hz] samples a
// second. Every value is a reading of its own and so a source of its own.
SignalModel signal_model(double rate, double count);

// The parts that its electronics have, with these figures. Rounding to counts is not one of them: it is what the device does,
// parameter `bits`.
std::vector<Entry> electronics_parts();

}  // namespace slipbench::nib_pad
