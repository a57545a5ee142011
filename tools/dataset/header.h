// Header of a dataset, and the names of its files.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace slipbench {

inline constexpr std::uint64_t dataset_schema = 2;         // written
inline constexpr std::uint64_t oldest_dataset_schema = 1;  // still readable

// One part of a sweep that is divided into n: sweep --shard k/n.
struct SweepShard {
  std::size_t number = 1;  // k, from 1
  std::size_t count = 1;   // n
  std::size_t trials = 0;  // of the whole sweep

  friend bool operator==(const SweepShard&, const SweepShard&) = default;
};

// " --shard 3/8": the last words of the canonical command of a shard.
std::string shard_words(const SweepShard& shard);

// The split that a scene asks for.
struct SplitRule {
  std::string by;                // "material", "object", "speed": trials with equal value stay together; "trial": each experiment
  std::array<double, 3> shares;  // of the groups, for training, validation and test; sum 1
  std::string said_by = "as the scene says";  // end of the sentence Masks::rule
};

// Attributes of the root group.
struct DatasetHeader {
  std::string version;           // of the program
  std::string scene;             // text of the scene file
  std::string overrides = "{}";  // JSON object: path -> YAML text given with --set
  std::uint64_t seed = 0;
  std::string command;                            // canonical: without --jobs and -o, which do not affect the output
  std::optional<SplitRule> split = {};            // from the scene; not read back
  std::map<std::string, std::string> files = {};  // files that the scene names: path -> SHA-256, 64 hexadecimal digits
  std::string truth = {};                         // "none: imported from bts3v2"; empty: simulated, with the complete truth
  std::optional<SweepShard> part = {};            // empty: the whole sweep
};

// Header of the undivided sweep to which a shard belongs.
DatasetHeader whole_header(const DatasetHeader& shard);

// The root's attribute `sweep_shard`: "3/8". parse_shard() is its inverse; it throws InputError,
// naming the file.
std::string shard_text(const SweepShard& shard);
SweepShard parse_shard(const std::string& file_name, const std::string& text, std::uint64_t trials);

// A trial that could not be simulated.
struct FailedTrial {
  std::size_t trial = 0;
  std::string message;  // the reason, with the trial's number
  std::string command;  // shell command that runs it again
};

// The JSON text of the root's attribute `failed`: [{"trial", "message", "command"}, ...].
std::string failures_json(const std::vector<FailedTrial>& failed);
// Inverse of failures_json(). Throws InputError, naming the file, if `text` is not such a list.
std::vector<FailedTrial> parse_failures(const std::string& file_name, const std::string& text);
// JSON text of the root's attribute `files`. parse_files() is its inverse; it throws InputError
// likewise.
std::string files_json(const std::map<std::string, std::string>& files);
std::map<std::string, std::string> parse_files(const std::string& file_name, const std::string& text);
// "3 of 200 trials failed: 17, 44 and 90", out of `planned` trials; lists the first ten numbers.
// Empty if none failed.
std::string failures_text(const std::vector<FailedTrial>& failed, std::size_t planned);

// True if two files belong to the same dataset by their headers.
inline bool same_dataset(const DatasetHeader& a, const DatasetHeader& b) {
  return a.seed == b.seed && a.command == b.command && a.scene == b.scene;
}

// Describes how two runs differ, as a clause: "seed 7, this run has 8; ...". `other`: name of the
// second run. Empty if version, seed, scene, overrides, command and files are equal.
std::string header_difference(const DatasetHeader& left, const DatasetHeader& now, const std::string& other = "this run");

// Name of the k-th file of a dataset: OUT.h5, OUT-0001.h5, OUT-0002.h5, ...
std::string shard_path(const std::string& path, std::size_t shard);

struct Masks {
  std::string split_by;  // SplitRule::by; without a rule "material", or "trial" if there is only one material
  std::string rule;      // `split_by` as a sentence
  std::vector<std::size_t> train;
  std::vector<std::size_t> valid;
  std::vector<std::size_t> test;
  std::size_t groups = 0;  // that were divided
};

// Group of a trial in split_trials(): `name`, such as its material, and keys of its experiment. Trials
// that share a key are repeats of one experiment; empty keys are left out.
std::string split_group_text(const std::string& name, const std::vector<std::string>& keys);

// Splits trials (number, split_group_text()) so that no group is in two parts. Without a rule the
// groups are materials, or experiments if all share one material, and 70 % of them are for
// training, 15 % for validation and 15 % for the test. A split by trial also groups by experiment,
// so that repeats with another noise stay together. A part with a share above 0 gets at least one
// group, the test first, as long as one stays for training. RandomStream(seed, 0, "mask") shuffles
// the groups, listed in the order of their first trials if they are experiments, else by name. Each
// part is in ascending order.
Masks split_trials(const std::vector<std::pair<std::size_t, std::string>>& trials, std::uint64_t seed,
                   const std::optional<SplitRule>& rule = {});

}  // namespace slipbench
