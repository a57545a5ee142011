// Whether a trial stayed within what a double, and the float of a dataset, can hold.
#pragma once

#include <string>
#include <vector>

#include "sim/core/contact_frame.h"
#include "sim/core/sensor.h"
#include "sim/simulation/simulation.h"
#include "tools/base/record/trial_record.h"

namespace slipbench {

// Each throws InputError that names what is not finite and when. A margin must be finite while its unit touches; directions and
// centres of slip may be undefined at any time.

// Every column of a whole record: the earliest row that is not finite.
void check_finite(const TrialRecord& record);
// One tick of the pad of the sensor called `sensor`.
void check_finite(const std::string& sensor, const ContactFrame& truth);
// One sample of it.
void check_finite(const std::string& sensor, const std::vector<Channel>& channels, const SensorFrame& frame);
// The bodies at `time` [s].
void check_finite(double time, const std::vector<NamedBody>& bodies);

}  // namespace slipbench
