// A source's lines, one at a time, and errors that name them.
#pragma once

#include <cstddef>
#include <fstream>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/base/record/json.h"
#include "tools/base/record/trial_record.h"

namespace slipbench {

// What a format of recordings is, and what the formats share.

struct SourceFile {
  std::string path;  // as messages name it
  std::string name;  // below the folder that the user named, or below the one that holds all of several sources: "n/case112.csv"
};

// Takes the next recording, and how many rows of its source were left out because they say the one before again, word for word. Number and
// seed are set by whoever takes it.
using AddRecording = std::function<void(TrialRecord record, std::size_t repeated_rows)>;

struct ImportFormat {
  const char* name;      // on the command line: "bts3v2"
  const char* summary;   // for the help
  const char* split_by;  // as SplitRule::by: "object", which recordings of the same TrialRecord::material share, or "trial"
  // Hands over those of a file. Throws InputError "FILE:LINE: what was found; allowed: ...".
  void (*read)(const SourceFile& file, const AddRecording& add);
};

// One file a format.
void read_bts3v2(const SourceFile& file, const AddRecording& add);
void read_biotacsp_dos(const SourceFile& file, const AddRecording& add);
void read_papillarray_csv(const SourceFile& file, const AddRecording& add);
void read_training_csv(const SourceFile& file, const AddRecording& add);

// The files that are meant by files and folders, in the order of their names in each folder. `endings`: of the files that are meant in a folder, ".csv".
// `bags`: a folder with a file metadata.yaml is one source, a bag of ROS 2. Throws InputError for a source that does not exist or is named twice, and
// for a folder without such files.
std::vector<SourceFile> list_sources(const std::vector<std::string>& sources, const std::vector<std::string>& endings, bool bags);

// A recording without sensors and without a single truth. `object`: what the split goes by; empty: nothing.
TrialRecord make_recording(const Json& params, const std::string& object);

// A sensor without samples that has the given channels of those which a simulated one of this type has, under the same names.
SensorRecord make_imported_sensor(const std::string& name, const std::string& type, double rate, const std::string& frame,
                                  const std::vector<std::string>& channels);

// True if a simulated sensor of this type has a channel of this name with one value a sample and no axis, such as pdc of a BioTac SP.
bool is_scalar_channel(const std::string& type, const std::string& channel);

// Whether a text can name an object or a file in a dataset: not empty, UTF-8, no control characters.
bool is_plain_name(const std::string& text);

// What one recording may take in memory [bytes]: a dataset's file holds a recording whole.
inline constexpr std::size_t largest_recording = 1'000'000'000;

class SourceTable {
 public:
  static constexpr std::size_t longest_line = 65'536;  // bytes

  // Throws InputError where the file is no regular one or cannot be opened.
  explicit SourceTable(const SourceFile& file);

  // Goes to the next line and cuts it at its commas; false at the end. A line may end with a carriage return, the first may begin with the
  // mark of UTF-8, and a last one that is empty is none. Throws InputError for one that is too long.
  bool next();
  // Number of the current line, from 1. Its text, and its cells without blanks around them, valid until next().
  [[nodiscard]] std::size_t line() const { return line_; }
  [[nodiscard]] std::string_view text() const { return text_; }
  [[nodiscard]] std::span<const std::string_view> cells() const { return cells_; }

  // Throws InputError "FILE:LINE: what".
  [[noreturn]] void fail(const std::string& what) const;

  // Reads a header. Throws InputError unless it has these names and no more.
  void expect_header(std::span<const std::string> names);
  // Throws InputError unless the line has so many cells.
  void expect_cells(std::size_t count) const;
  // A cell as a finite number within [least, most]; `name` says what it is.
  [[nodiscard]] double number(std::size_t cell, std::string_view name, double least, double most) const;
  // The same, any that a float32 holds.
  [[nodiscard]] float value(std::size_t cell, std::string_view name) const;
  // A cell that is one of these whole numbers.
  [[nodiscard]] int one_of(std::size_t cell, std::string_view name, std::span<const int> allowed) const;
  [[nodiscard]] bool flag(std::size_t cell, std::string_view name) const;
  // Throws InputError where a recording with so many rows of so many bytes is too large.
  void expect_room(std::size_t rows, std::size_t row_bytes) const;

 private:
  bool at_end();  // whether no byte is left
  [[noreturn]] void refuse(std::size_t cell, std::string_view name, const std::string& allowed) const;

  std::string path_;
  std::ifstream stream_;
  std::vector<char> buffer_;
  std::string_view text_;
  std::vector<std::string_view> cells_;
  std::size_t line_ = 0;
};

// The least difference that two numbers written like this one can have: 0.001 of "1.250", 1 of "7", 100 of "1.2e3".
double resolution_of(std::string_view number);

// Sets rate and timing of a sensor by its stamps, whose least difference is `resolution` [s]. Fails where there are fewer than two.
void set_timing(const SourceTable& table, double resolution, SensorRecord& sensor);

}  // namespace slipbench
