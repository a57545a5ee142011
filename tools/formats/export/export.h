// Exports datasets to common file formats.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/dataset/reader.h"
#include "tools/dataset/record/json.h"
#include "tools/files/output_file.h"
#include "tools/learning_data/label_rules.h"
#include "tools/learning_data/samples.h"

namespace slipbench {

enum class ExportFormat {
  csv,             // one table with header per trial and sensor
  npz,             // one numpy archive per trial
  robomimic,       // one HDF5 file of demonstrations
  lerobot,         // one LeRobotDataset per rate; written by Python
  parquet,         // one table of columns per sensor; written by Python
  mcap,            // time-stamped messages, one file per trial; written by Python
  rosbag2,         // ROS 2 bags, one folder per trial; written by Python
  vendor_csv,      // PapillArray: log of the vendor's visualisation software
  slip_csv,        // BioTac SP: the public slip recordings, one file per trial
  grasp_csv,       // BioTac SP: the public grasps with three fingers, one file
  training_csv,    // PapillArray: the 73 columns of the published training code
  myrmex_csv,      // Myrmex: counts alone, one image per line, as the public tools read them
  myrmex_rotated,  // npz with every Myrmex's images augmented as in its paper
};

struct ExportOptions {
  ExportFormat format = ExportFormat::vendor_csv;
  std::optional<LabelRule> slip_rule;  // empty: strict in the PapillArray's formats, every rule in the general formats
  std::optional<double>
      label_speed;  // m/s, only with paper and has_slipped of the PapillArray's formats; empty: default_label_speed
  std::vector<std::string> sensors;  // empty: all; the only PapillArray for training_csv. grasp_csv has all
  std::optional<std::size_t> trial;  // empty: all
  std::optional<double> rate = {};   // Hz, of the rows; empty: the slowest sensor's in robomimic, else each sensor's own
  std::string split = {};            // "train", "valid" or "test": only its trials; empty: all
  bool recorded = false;             // --labels recorded: the labels of recordings, which have no others
  bool points = false;               // lerobot: position and force of each unit as one feature
  std::string licence = {};          // of the data, for the dataset card: "cc-by-4.0"; empty: not stated
  bool compress = false;             // text files by gzip, with the suffix .gz; the arrays of robomimic by HDF5's deflate
};

// Names of the formats on the command line: "vendor-csv". The parser throws InputError with the
// nearest name.
ExportFormat parse_export_format(const std::string& name);
std::string export_format_name(ExportFormat format);
std::vector<std::string> export_format_names();

// Sets the rule of `--labels`: a slip rule, or "recorded". Throws InputError with the nearest name.
void set_label_rule(ExportOptions& options, const std::string& name);

// Throws InputError if the options contradict each other.
void check_export_options(const ExportOptions& options);

// Called with the number of written trials, of all trials, and of bytes so far.
using ExportProgress = std::function<void(std::size_t done, std::size_t total, std::uintmax_t bytes)>;

// Writes the trials of a dataset to `out_dir`, which is created if missing (its parent is not), and
// returns the written files. Each file appears under its name only when it is complete. Throws
// InputError if the options contradict each other, the dataset is damaged or does not fit the
// format, a trial has no recording, or a file cannot be written; Interrupted on an interrupt
// (InterruptScope), after a trial. Files finished before are kept, and a folder without any is
// removed. `progress` is destroyed before an error is thrown. lerobot, parquet, mcap and rosbag2 are
// written by Python instead (export_request()).
std::vector<std::string> export_dataset(const std::string& dataset_path, const std::string& out_dir, const ExportOptions& options,
                                        ExportProgress progress = {});

// True if python/slipbench/_export writes this format. It also writes the dataset card of
// every format.
bool is_python_format(ExportFormat format);

// Call before export_dataset(), which may take long. Throws InputError if a file that is not a card
// has the name of one, so that Python would not replace it.
void check_card_target(const std::string& out_dir);

// Returns the request to python/slipbench/_export (request.py) to write the trials of a dataset to
// `out_dir` or, if export_dataset() has written `files`, to write their card. Checks the dataset and
// the options; throws InputError as export_dataset().
Json export_request(const std::string& dataset_path, const std::string& out_dir, const ExportOptions& options,
                    const std::vector<std::string>& files);

// The output folder of an export.
// Created when the first file is ready to be written, and removed if none was.
class OutputFolder {
 public:
  // `inputs`: files that are never replaced. `compress`: writes files by gzip, with the suffix .gz.
  // Does not touch the file system.
  OutputFolder(std::string path, std::vector<std::string> inputs, bool compress = false)
      : path_(std::move(path)), inputs_(std::move(inputs)), compress_(compress) {}
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  // Writes PATH/NAME, where NAME may begin with one subfolder, and returns that path. Throws
  // InputError if it cannot be written or a file of another kind exists there.
  std::string write(const std::string& name, const TextKind& kind, const std::string& bytes);
  // Creates the folder, and returns PATH/NAME for a file that other code will write. Throws
  // InputError for a name with control characters and for one that leaves the folder.
  std::string prepare(const std::string& name);
  // Removes the card of an earlier export, whose digests become wrong once its files are replaced.
  // write() calls it.
  void remove_card() const;

  [[nodiscard]] const std::vector<std::string>& inputs() const { return inputs_; }

 private:
  void make(const std::string& folder);

  std::string path_;
  std::vector<std::string> inputs_;
  bool compress_;
  std::vector<std::string> made_;
};

// Text files compressed by gzip.
// As `gzip` writes it, without name and time: equal text gives identical bytes.
std::string gzip(std::string_view text);

// The beginning of a gzip file's text, up to 64 kB; empty if it is not a gzip file.
std::string beginning_of_gzip(std::string_view bytes);

}  // namespace slipbench
