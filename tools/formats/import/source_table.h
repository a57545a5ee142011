// Reads a source line by line, with errors that name the line.
#pragma once

#include <cstddef>
#include <fstream>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/dataset/record/json.h"
#include "tools/dataset/record/trial_record.h"

namespace slipbench {

// Formats of recordings, and their common functions.

struct SourceFile {
  std::string path;  // as in messages
  std::string name;  // relative to the folder that the user named, or to the common parent of several sources: "n/case112.csv"
};

// Receives the next recording, and the number of its source's omitted rows that repeat the previous
// row exactly. The receiver sets number and seed.
using AddRecording = std::function<void(TrialRecord record, std::size_t repeated_rows)>;

struct ImportFormat {
  const char* name;      // on the command line: "bts3v2"
  const char* summary;   // for the help
  const char* split_by;  // as SplitRule::by: "object" (TrialRecord::material, shared by recordings) or "trial"
  // Passes the recordings of a file to `add`. Throws InputError "FILE:LINE: what was
  // found; allowed: ...".
  void (*read)(const SourceFile& file, const AddRecording& add);
};

// Each is defined in the file of its format.
void read_bts3v2(const SourceFile& file, const AddRecording& add);
void read_biotacsp_dos(const SourceFile& file, const AddRecording& add);
void read_papillarray_csv(const SourceFile& file, const AddRecording& add);
void read_training_csv(const SourceFile& file, const AddRecording& add);

// Lists the files of `sources`, which are files and folders, sorted by name within each folder.
// `endings`: file endings that are read in a folder, ".csv". `bags`: a folder with a file
// metadata.yaml is one source, a ROS 2 bag. Throws InputError for a source that does not exist or
// is named twice, for a folder without such files, and for a link in a folder or bag to a file
// outside of the folders of `sources` and of the current folder.
std::vector<SourceFile> list_sources(const std::vector<std::string>& sources, const std::vector<std::string>& endings, bool bags);

// A recording without sensors and without any truth. `object`: group for the split; empty: none.
TrialRecord make_recording(const Json& params, const std::string& object);

// A sensor without samples that has the given channels of a simulated sensor of this type, under
// the same names.
SensorRecord make_imported_sensor(const std::string& name, const std::string& type, double rate, const std::string& frame,
                                  const std::vector<std::string>& channels);

// True if a simulated sensor of this type has a channel of this name with one value per sample and
// no axis, such as pdc of a BioTac SP.
bool is_scalar_channel(const std::string& type, const std::string& channel);

// True if a text is a valid name of an object or file in a dataset: not empty, UTF-8, no control
// characters.
bool is_plain_name(const std::string& text);

// Maximum memory of one recording [bytes]: a dataset's file holds a recording whole.
inline constexpr std::size_t largest_recording = 1'000'000'000;

class SourceTable {
 public:
  static constexpr std::size_t longest_line = 65'536;  // bytes

  // Throws InputError if the file is not a regular file or cannot be opened.
  explicit SourceTable(const SourceFile& file);

  // Reads the next line and splits it at commas; returns false at the end. A line may end with a
  // carriage return, the first may begin with a UTF-8 byte order mark, and an empty last line is
  // ignored. Throws InputError for a line that is too long.
  bool next();
  // Number of the current line, from 1; its text; and its cells without surrounding blanks. Both
  // views are valid until next().
  [[nodiscard]] std::size_t line() const { return line_; }
  [[nodiscard]] std::string_view text() const { return text_; }
  [[nodiscard]] std::span<const std::string_view> cells() const { return cells_; }

  // Throws InputError "FILE:LINE: what".
  [[noreturn]] void fail(const std::string& what) const;

  // Reads a header. Throws InputError unless it has exactly these names.
  void expect_header(std::span<const std::string> names);
  // Throws InputError unless the line has exactly `count` cells.
  void expect_cells(std::size_t count) const;
  // A cell as a finite number within [least, most]; `name` is used in errors.
  [[nodiscard]] double number(std::size_t cell, std::string_view name, double least, double most) const;
  // As number(), within the range of a float32.
  [[nodiscard]] float value(std::size_t cell, std::string_view name) const;
  // A cell that must be one of these whole numbers.
  [[nodiscard]] int one_of(std::size_t cell, std::string_view name, std::span<const int> allowed) const;
  [[nodiscard]] bool flag(std::size_t cell, std::string_view name) const;
  // Throws InputError if a recording of `rows` rows with `row_bytes` bytes each is too large.
  void expect_room(std::size_t rows, std::size_t row_bytes) const;

 private:
  bool at_end();  // true if no byte is left
  [[noreturn]] void refuse(std::size_t cell, std::string_view name, const std::string& allowed) const;

  std::string path_;
  std::ifstream stream_;
  std::vector<char> buffer_;
  std::string_view text_;
  std::vector<std::string_view> cells_;
  std::size_t line_ = 0;
};

// Resolution of a number as written: 0.001 for "1.250", 1 for "7", 100 for "1.2e3".
double resolution_of(std::string_view number);

// Sets rate and timing of a sensor from its stamps, whose resolution is `resolution` [s]. Throws
// InputError for fewer than two stamps.
void set_timing(const SourceTable& table, double resolution, SensorRecord& sensor);

}  // namespace slipbench
