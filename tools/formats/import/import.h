// Imports recordings of real sensors into a dataset, which has no truth.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "tools/dataset/record/json.h"
#include "tools/dataset/record/trial_record.h"
#include "tools/trial/sweep/warnings.h"

namespace slipbench {

struct ImportFormat;

struct ImportOptions {
  std::vector<std::string> sources;      // files, and folders of which all recordings are imported
  const ImportFormat* format = nullptr;  // entry of the catalogue; null: `map` describes the sources
  std::string output;                    // HDF5 file; empty: the sources are only checked
  std::uint64_t seed = 1;                // of the split
  std::string map = {};                  // description of the sources for Python (slipbench/_import); empty: none
  std::optional<double> rate = {};       // Hz, for resampling (resample.h); empty: samples as recorded
  bool verbose = false;                  // print every warning, not only the first ten
};

struct ImportSummary {
  std::size_t sources = 0;                     // files read
  std::size_t trials = 0;                      // number of recordings
  std::size_t samples = 0;                     // of all recordings
  std::size_t repeated_rows = 0;               // omitted rows that repeat the previous row exactly
  std::map<std::string, std::size_t> objects;  // number of recordings of each; empty: the format names no objects
  std::vector<std::string> files;              // written
  // Names of the channels of the sensors of each type.
  std::map<std::string, std::set<std::string>> channels;
  // For each recording's file: steps that vary by more than 1 % (steps_vary()), a rate that
  // suggests times in another unit, and samples interpolated in gaps or above the recording's rate.
  std::vector<Warning> warnings;
};

// Writes recordings to a dataset in the order of add(), and collects the summary. Without
// options.output it only checks the recordings. An unfinished dataset is removed.
class RecordingWriter {
 public:
  // `split_by`: "object" or "trial", as SplitRule::by. Throws InputError if the output cannot be
  // written.
  RecordingWriter(const ImportOptions& options, const std::string& split_by);
  ~RecordingWriter();
  RecordingWriter(const RecordingWriter&) = delete;
  RecordingWriter& operator=(const RecordingWriter&) = delete;

  // Adds a recording, with number and seed set, resampled if options.rate is set. `path`: the
  // source in messages. `repeated_rows`: number of omitted rows that repeat the row before.
  // `time_units`: unit of the source's times of each sensor [s], 0 for dates; empty: all in
  // seconds. Throws InputError, and Interrupted (InterruptScope).
  void add(TrialRecord record, const std::string& path, std::size_t repeated_rows, const std::vector<double>& time_units = {});
  // Adds a warning about a source.
  void warn(const std::string& path, const std::string& text);
  // Writes and names the dataset. `sources`: number of files read.
  ImportSummary finish(std::size_t sources);

 private:
  struct Target;
  void warn_of_timing(const SensorRecord& sensor, double unit, const std::string& path, const std::string& subject);
  void resample_and_note(TrialRecord& record, const std::string& path);

  ImportOptions options_;
  ImportSummary summary_;
  std::unique_ptr<Target> target_;  // null: check only
};

// Names on the command line, in order: "bts3v2".
std::vector<std::string> import_format_names();
// Entry of the catalogue. Throws InputError with the nearest name.
const ImportFormat& import_format(const std::string& name);
// The entry of ImportOptions: null for `csv`, a table whose columns only a map describes.
const ImportFormat* chosen_import_format(const std::string& name);
// Throws InputError unless exactly one of `format` and `map` is set.
void check_import_options(const ImportOptions& options);
// Name of the format on the command line.
std::string format_name(const ImportFormat& format);
// One line of help per format: name and content.
std::string import_formats_text();

// Passes each recording of the sources, with its file's name, to `take` in order. Throws as
// import_recordings().
void for_each_recording(const std::vector<std::string>& sources, const ImportFormat& format,
                        const std::function<void(TrialRecord record, const std::string& source)>& take);

// Reads the sources of a format one after the other, line by line, and writes each recording as
// soon as it is read. Files of a folder are sorted by name. The same sources and seed give
// identical bytes. Throws InputError, naming file and line, if a source does not match the format,
// and if the output cannot be written; Interrupted on an interrupt (InterruptScope). No partial
// dataset remains.
ImportSummary import_recordings(const ImportOptions& options);

// The result as `slipbench import --json` prints it.
Json import_json(const ImportSummary& summary);

}  // namespace slipbench
