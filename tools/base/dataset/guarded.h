// Reading files that may be damaged.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace slipbench {

// What reading may take.
struct ReadingLimits {
  std::uint64_t cpu = 0;     // s, of the processor
  std::uint64_t wait = 0;    // s, in all
  std::uint64_t memory = 0;  // bytes, of the address space beyond that of the program
};

// 8 s of the processor and 2 s for each MB of the dataset's files, all shards counted; 120 s and 20 s in all; 8 GB, which two
// copies of the largest record take (run_trial.h), and 16 times the files.
ReadingLimits reading_limits(const std::string& path);

// Runs `action` in a child process and hands back what it returns. HDF5 checks few of the bytes that it reads, so that a damaged
// file can end the process that reads it, or keep it for ever; here that ends the child, and is an InputError "SUBJECT: is
// damaged: ..." or "SUBJECT: cannot be read: ..." with the limit that was reached. A program under a sanitizer has no limit of
// memory. An InputError in the child is thrown again as one, any other exception as std::runtime_error. Call it before any thread
// is made.
std::string guarded(const std::string& subject, const ReadingLimits& limits, const std::function<std::string()>& action);
// With reading_limits(subject): the path of a dataset.
std::string guarded(const std::string& subject, const std::function<std::string()>& action);

}  // namespace slipbench
