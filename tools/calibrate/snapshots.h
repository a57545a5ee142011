// Stiffness, coupling and noise of a sensor from snapshots, force against displacement, without a
// scene or a motion.
#pragma once

#include <string>
#include <vector>

#include "tools/calibrate/recordings.h"
#include "tools/dataset/record/json.h"
#include "tools/page/page.h"

namespace slipbench::calibrate {

// A unit whose tip has moved less than this is idle, unless the caller says otherwise [m].
inline constexpr double default_idle = 20e-6;

// Fits F = K d + F_0 to every unit of a sensor by least squares, over the snapshots in which the
// unit is pressed.
//
// `recordings`: their samples are the snapshots; order and times do not matter. `sensor`: the
// sensor's name in the recordings; empty: the only one with channels `force` [N] and `displacement`
// [m], each [units, 3]. `idle` [m]: a unit that has moved less is idle, one with d_z > `idle` is
// pressed, one with d_z < -`idle` is pulled and not used.
//
// Returns a JSON object, described in README.md. Throws InputError where no such sensor is found,
// where several are found and none is named, and where no unit determines a stiffness.
Json fit_snapshots(const std::vector<RawRecording>& recordings, const std::string& sensor, double idle);

// The result of fit_snapshots() on a terminal: the keys, the units, and the lines to put into a
// scene.
page::TextTable snapshot_key_table(const Json& result);
page::TextTable snapshot_unit_table(const Json& result);
std::string snapshot_text(const Json& result);

}  // namespace slipbench::calibrate
