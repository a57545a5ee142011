// Checks files from others, on which the libraries that read them may crash: HDF5 and OpenVINO
// check few of the bytes that they read.
#pragma once

#include <cstdint>
#include <string>

#include "sim/core/error.h"

namespace slipbench {

enum class FileKind {
  dataset_file,    // one HDF5 file: its root's attributes
  dataset_header,  // all files of a dataset: the same, and which trials they hold
  dataset,         // the same, and all trials, with values compared with their digests
  batch,           // one HDF5 file of an unfinished sweep, with its trials
  network,         // ONNX
  model,           // MJCF
};

// The file could not be checked: the program that reads it could not be started, or was ended from
// outside.
class NotChecked : public InputError {
 public:
  using InputError::InputError;
};

// Written by slipbench-reader after its message. A crash leaves none.
enum class ReaderVerdict : char { readable = '+', refused = '-', not_checked = '?' };

// Largest memory of slipbench-reader for a network or a model [bytes], and as text.
inline constexpr std::uint64_t most_reader_memory = 4'000'000'000;
inline constexpr const char* reader_memory_text = "4 GB";

// Runs the program slipbench-reader on the file, so that damage ends that process and not this one.
// Afterwards this process can read the file itself. Returns the reader's output: for a dataset the
// names of its files, each followed by a zero byte. May be called with any threads running. Throws
// InputError "PATH: is damaged: ..." if the reader crashes or takes longer than 8 s of the
// processor plus 2 s per MB; InputError with the reader's message if it refuses the file, also if a
// network or model needs more than `most_reader_memory`; NotChecked; Interrupted (interrupted.h).
std::string check_readable(FileKind kind, const std::string& path);

// The same, but only once per process while the file is unchanged. For networks and models, which
// are loaded for each trial.
void check_readable_once(FileKind kind, const std::string& path);

// The name of a kind on the command line "slipbench-reader KIND PATH".
std::string reader_word(FileKind kind);

}  // namespace slipbench
