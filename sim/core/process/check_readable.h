// Files of others, on which the libraries that read them may crash: HDF5 and OpenVINO check few of the bytes that they read.
#pragma once

#include <string>

#include "sim/core/error.h"

namespace slipbench {

enum class FileKind {
  dataset_file,    // one HDF5 file: what its root says of it
  dataset_header,  // all files of a dataset: the same, and which trials they hold
  dataset,         // the same, and all trials, whose values are compared with their digests
  batch,           // one HDF5 file of an unfinished sweep, with its trials
  network,         // ONNX
  model,           // MJCF
};

// Nothing is known of the file: the program that reads it could not be started, or was ended from outside.
class NotChecked : public InputError {
 public:
  using InputError::InputError;
};

// What slipbench-reader writes behind its message. A crash leaves none.
enum class ReaderVerdict : char { readable = '+', refused = '-', not_checked = '?' };

// Has the program slipbench-reader read the file through, so that damage ends that process and not this one. Afterwards this process can read the
// file itself. Returns what the reader prints: for a dataset the names of its files, each with a zero byte behind it. Works whatever threads there are.
// Throws InputError "PATH: is damaged: ..." where the reader crashes or takes longer than 8 s of the
// processor and 2 s for each MB; InputError with the reader's message where it refuses the file; NotChecked; Interrupted (interrupted.h).
std::string check_readable(FileKind kind, const std::string& path);

// The same, once a process for as long as the file stays the same. For networks and models, which are loaded for each trial.
void check_readable_once(FileKind kind, const std::string& path);

// slipbench-reader KIND PATH: names of the kinds as it takes them.
std::string reader_word(FileKind kind);

}  // namespace slipbench
