// Recordings of real sensors as a dataset: what was read, and no truth.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tools/base/record/trial_record.h"
#include "tools/program/sweep/warnings.h"

namespace slipbench {

struct ImportFormat;

struct ImportOptions {
  std::vector<std::string> sources;      // files, and folders whose recordings are all meant
  const ImportFormat* format = nullptr;  // of the catalogue; null: `map` describes the sources
  std::string output;                    // HDF5 file; empty: the sources are read and checked, and nothing is written
  std::uint64_t seed = 1;                // of the split
  std::string map = {};                  // description of the sources, read by Python (slipbench/_import); empty: none
  std::optional<double> rate = {};  // Hz, at which every recording is resampled (resample.h); empty: samples stay as recorded
};

struct ImportSummary {
  std::size_t sources = 0;                     // files read
  std::size_t trials = 0;                      // recordings
  std::size_t samples = 0;                     // of all recordings
  std::size_t repeated_rows = 0;               // that a source repeats word for word and that were left out
  std::map<std::string, std::size_t> objects;  // recordings of each; empty: the format names none
  std::vector<std::string> files;              // written
  // Of each recording, about its file: steps that vary by more than 1 % (steps_vary()), a rate that looks like times in another unit, and samples that
  // were interpolated in gaps.
  std::vector<Warning> warnings;
};

// Writes recordings into a dataset, in the order in which they are added, and collects what is to be reported of them. Without options.output the
// recordings are only checked. Nothing is left of a dataset that was not finished.
class RecordingWriter {
 public:
  // `split_by`: "object" or "trial", as SplitRule::by. Throws InputError when the output cannot be written.
  RecordingWriter(const ImportOptions& options, const std::string& split_by);
  ~RecordingWriter();
  RecordingWriter(const RecordingWriter&) = delete;
  RecordingWriter& operator=(const RecordingWriter&) = delete;

  // `path`: the source, as messages name it. `repeated_rows`: rows of the source that were left out because they repeat the row before. Sets the
  // record's number and seed, and resamples it where options.rate says so. `time_units`: of the times of each sensor as they
  // were read [s], 0 for dates, or empty where all are seconds. Throws InputError, and Interrupted (InterruptScope).
  void add(TrialRecord record, const std::string& path, std::size_t repeated_rows, const std::vector<double>& time_units = {});
  // A warning about a source.
  void warn(const std::string& path, const std::string& text);
  // `sources`: number of files read. Gives the dataset its name.
  ImportSummary finish(std::size_t sources);

 private:
  struct Target;
  void warn_of_timing(const SensorRecord& sensor, double unit, const std::string& path, const std::string& subject);
  void resample_and_note(TrialRecord& record, const std::string& path);

  ImportOptions options_;
  ImportSummary summary_;
  std::unique_ptr<Target> target_;  // null: nothing is written
};

// Their names on the command line, in order: "bts3v2".
std::vector<std::string> import_format_names();
// The catalogue's entry. Throws InputError with the nearest name.
const ImportFormat& import_format(const std::string& name);
// Its name, as above.
std::string format_name(const ImportFormat& format);
// A line of help a format: its name and what it holds.
std::string import_formats_text();

// Hands over each recording of the sources with its file's name, in order. Throws as import_recordings().
void for_each_recording(const std::vector<std::string>& sources, const ImportFormat& format,
                        const std::function<void(TrialRecord record, const std::string& source)>& take);

// Reads the sources of a format one after the other, line by line, and writes a recording as soon as it is read. A folder's files come in the order
// of their names. The same sources and seed give the same bytes. Throws InputError when a source is not what the format says, naming file
// and line, and when the output cannot be written; then nothing is left behind. Throws Interrupted likewise (InterruptScope).
ImportSummary import_recordings(const ImportOptions& options);

}  // namespace slipbench
