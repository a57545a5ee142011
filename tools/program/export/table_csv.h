// One sensor's samples as a table of text.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/base/record/trial_record.h"
#include "tools/program/export/export.h"

namespace slipbench {

struct CsvTable {
  std::string channel;  // the one that has a time of its own, and so a table; empty: all that have the sensor's
  std::string text;
};

// The tables of a sensor, that of its own samples first (README.md says which columns), with the state by `rule`, or by all three. Throws
// InputError when the channels do not fit the names of their values, or a channel with a column of its difference has not two values.
std::vector<CsvTable> table_csv(const SensorRecord& sensor, std::optional<SlipRule> rule = {});

// Whether a file that begins so is one.
bool begins_as_table_csv(std::string_view text);

}  // namespace slipbench
