// What a format of recordings is, and what the formats share.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "sim/core/pad_state.h"
#include "tools/base/record/json.h"
#include "tools/base/record/trial_record.h"

namespace slipbench {

struct SourceFile {
  std::string path;      // as messages name it
  std::string name;      // below the folder that the user named: "n/case112.csv"
  std::string map = {};  // the column map of the format csv; empty: none
};

// Takes the next recording, and how many rows of its source were left out because they say the one before again, word for word. Number and
// seed are set by whoever takes it.
using AddRecording = std::function<void(TrialRecord record, std::size_t repeated_rows)>;

struct ImportFormat {
  const char* name;      // on the command line: "bts3v2"
  const char* summary;   // for the help
  const char* split_by;  // as SplitRule::by: "object", which recordings of the same TrialRecord::material share, or "trial"
  // How many recordings a file holds, counted without looking into them.
  std::size_t (*count)(const SourceFile& file);
  // Hands over those of a file. Throws InputError "FILE:LINE: what was found; allowed: ...".
  void (*read)(const SourceFile& file, const AddRecording& add);
};

// One file a format.
void read_bts3v2(const SourceFile& file, const AddRecording& add);
void read_biotacsp_dos(const SourceFile& file, const AddRecording& add);
void read_papillarray_csv(const SourceFile& file, const AddRecording& add);
void read_training_csv(const SourceFile& file, const AddRecording& add);
void read_mapped_csv(const SourceFile& file, const AddRecording& add);  // also throws InputError "MAP:LINE: ..."

// ImportFormat::count of a file with a recording in every line below its header, and of one that is a single recording.
std::size_t count_lines(const SourceFile& file);
std::size_t count_one(const SourceFile& file);

// A recording without sensors and without a single truth. `object`: what the split goes by; empty: nothing.
TrialRecord make_recording(const Json& params, const std::string& object);

// A sensor without samples that has the given channels of those which a simulated one of this type has, under the same names.
SensorRecord make_imported_sensor(const std::string& name, const std::string& type, double rate, const std::string& frame,
                                  const std::vector<std::string>& channels);

// Whether a text can name an object or a file in a dataset: not empty, UTF-8, no control characters.
bool is_plain_name(const std::string& text);

// None, some or all of the units that touch slip.
PadState state_of_units(std::size_t touching, std::size_t slipping);

// Samples a second of rising times [s]: one over the median step, rounded to a microsecond. There are two at least.
double rate_of(const std::vector<double>& times);

// What one recording may take in memory [bytes]: a dataset's file holds a recording whole.
inline constexpr std::size_t largest_recording = 1'000'000'000;

}  // namespace slipbench
