// Datasets in the file formats that others read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/base/dataset/reader.h"
#include "tools/base/files/output_file.h"
#include "tools/program/samples/samples.h"

namespace slipbench {

enum class ExportFormat {
  csv,             // a table a trial and sensor, with a header
  npz,             // a numpy archive a trial
  robomimic,       // one HDF5 file of demonstrations
  lerobot,         // a LeRobotDataset a rate; Python writes it
  parquet,         // a table of columns a sensor; Python writes it
  mcap,            // messages with their times, a file a trial; Python writes it
  rosbag2,         // ROS 2 bags, a folder a trial; Python writes it
  vendor_csv,      // PapillArray: the log of the vendor's visualisation software
  slip_csv,        // BioTac SP: the public slip recordings, one file a trial
  grasp_csv,       // BioTac SP: the public grasps with three fingers, one file
  training_csv,    // PapillArray: the 73 columns of the published training code
  myrmex_csv,      // Myrmex: counts alone, an image a line, as the public tools read them
  myrmex_rotated,  // npz, with the images of every Myrmex as its paper augments them
};

struct ExportOptions {
  ExportFormat format = ExportFormat::vendor_csv;
  std::optional<SlipRule>
      slip_rule;  // empty: strict in the PapillArray's formats, the state by every rule in those of any sensor
  std::optional<double>
      label_speed;  // m/s, only with paper and has_slipped of the PapillArray's formats; empty: default_label_speed
  std::vector<std::string> sensors;  // empty: all; of training_csv the only PapillArray. grasp_csv has all
  std::optional<std::size_t> trial;  // empty: all
  std::optional<double> rate = {};   // Hz, of the rows; empty: the slowest sensor's in robomimic, else each one's own
  std::string split = {};            // "train", "valid" or "test": its trials alone; empty: all
  bool recorded = false;             // --labels recorded: the labels of recordings, which are all that they have
  bool points = false;               // of lerobot: position and force of each unit as one feature
  std::string licence = {};          // of the data, for the dataset card: "cc-by-4.0"; empty: the card states none
  bool compress = false;             // files of text by gzip, with .gz behind the name; the arrays of robomimic by HDF5's deflate
};

// The formats' names on the command line: "vendor-csv". The parser throws InputError with the nearest name.
ExportFormat parse_export_format(const std::string& name);
std::vector<std::string> export_format_names();

// Told of how many trials of all are written, and of their bytes so far.
using ExportProgress = std::function<void(std::size_t done, std::size_t total, std::uintmax_t bytes)>;

// Writes the trials of a dataset to `out_dir`, which is made if it is missing (its parent is not), and returns the files written.
// Each file appears under its name only when it is whole. Throws InputError when the options contradict each other, the dataset
// is damaged or does not fit the format, a trial has no recording, or a file cannot be written; files that were finished before stay, and
// a folder in which none was is not left behind. `progress` is destroyed before an error is thrown.
// lerobot, parquet, mcap and rosbag2 are not written here, but by start_python_export().
std::vector<std::string> export_dataset(const std::string& dataset_path, const std::string& out_dir, const ExportOptions& options,
                                        ExportProgress progress = {});

// Returns true if tools/python/slipbench/_export writes this format. It writes the dataset card of every format.
bool is_python_format(ExportFormat format);

// To be called before export_dataset(), which may take long. Returns why README.md and croissant.json cannot be written
// beside its files: the program has no Python. Empty: they can. Throws InputError where the options contradict each other,
// where they have a licence and there is no Python to state it, and where a file of another kind has one of these names.
std::string check_card(const std::string& out_dir, const ExportOptions& options);

// Becomes the Python that writes README.md and croissant.json beside the `files` that export_dataset() has returned, and
// tells of all of them as start_python_export() does. Throws InputError when it cannot start.
[[noreturn]] void start_card(const std::string& dataset_path, const std::string& out_dir, const ExportOptions& options,
                             const std::vector<std::string>& files, bool json);

// Becomes the Python that writes the trials of a dataset to `out_dir`. `json`: one JSON object on stdout. The dataset and
// the options are checked before. Throws InputError as export_dataset does, and where there is no such Python: build/venv's
// of a build, or the one whose package `slipbench` runs the program, which names itself in SLIPBENCH_PYTHON.
[[noreturn]] void start_python_export(const std::string& dataset_path, const std::string& out_dir, const ExportOptions& options,
                                      bool json);

// The folder that an export writes into.
// Made when the first file is ready to be written, and removed again where none could be.
class OutputFolder {
 public:
  // `inputs`: files that are never replaced. `compress`: files are written by gzip, with .gz behind their names. Touches nothing.
  OutputFolder(std::string path, std::vector<std::string> inputs, bool compress = false)
      : path_(std::move(path)), inputs_(std::move(inputs)), compress_(compress) {}
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  // Writes PATH/NAME, where NAME may begin with one folder more, and returns that path. Throws InputError when it cannot be
  // written or something stands there that is not of this kind.
  std::string write(const std::string& name, const TextKind& kind, const std::string& bytes);
  // Makes the folder, and returns PATH/NAME for a file that someone else will write. Throws InputError for a name with control
  // characters and for one that leads out of the folder.
  std::string prepare(const std::string& name);
  // Removes the card of an export before, whose digests would be wrong once its files are replaced. write() does so itself.
  void remove_card() const;

  [[nodiscard]] const std::vector<std::string>& inputs() const { return inputs_; }

 private:
  void make(const std::string& folder);

  std::string path_;
  std::vector<std::string> inputs_;
  bool compress_;
  std::vector<std::string> made_;
};

// Text files in the container of gzip.
// As `gzip` writes it, without a name or a time: the same text gives the same bytes.
std::string gzip(std::string_view text);

// The text of a file of gzip that begins so, up to 64 kB of it; empty: it is none.
std::string beginning_of_gzip(std::string_view bytes);

}  // namespace slipbench
