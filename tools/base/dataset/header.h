// What a dataset says of itself, and the names of its files.
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

inline constexpr std::uint64_t dataset_schema = 2;         // what is written
inline constexpr std::uint64_t oldest_dataset_schema = 1;  // what is read still

// A part of a sweep that is cut into several: sweep --shard k/n.
struct SweepShard {
  std::size_t number = 1;  // k, from 1 on
  std::size_t count = 1;   // n
  std::size_t trials = 0;  // of the whole sweep

  friend bool operator==(const SweepShard&, const SweepShard&) = default;
};

// " --shard 3/8": the last words of the canonical command of a shard.
std::string shard_words(const SweepShard& shard);

// How a scene wants its trials split.
struct SplitRule {
  std::string by;                // "material", "object", "speed": trials alike in it stay together; "trial": each goes by itself
  std::array<double, 3> shares;  // for training, validation and test, of the groups; 1 in all
  std::string said_by = "as the scene says";  // the last words of Masks::rule
};

// Attributes of the root group.
struct DatasetHeader {
  std::string version;           // of the program
  std::string scene;             // text of the scene file
  std::string overrides = "{}";  // JSON object: path -> YAML text given with --set
  std::uint64_t seed = 0;
  std::string command;                            // canonical: without --jobs and -o, which do not change what is written
  std::optional<SplitRule> split = {};            // of the scene, which says it; not read back
  std::map<std::string, std::string> files = {};  // that the scene names: path -> SHA-256, 64 hexadecimal digits
  std::string truth = {};  // "none: imported from bts3v2": what stands in the truth's place; empty: simulated, with all of it
  std::optional<SweepShard> part = {};  // empty: the whole sweep
};

// That of the undivided sweep which a shard is a part of.
DatasetHeader whole_header(const DatasetHeader& shard);

// The root's attribute `sweep_shard`: "3/8". Its inverse throws InputError, naming the file.
std::string shard_text(const SweepShard& shard);
SweepShard parse_shard(const std::string& file_name, const std::string& text, std::uint64_t trials);

// A trial that could not be simulated.
struct FailedTrial {
  std::size_t trial = 0;
  std::string message;  // why, with the trial's number
  std::string command;  // runs it again, as a shell would be given it
};

// The JSON text of the root's attribute `failed`: [{"trial", "message", "command"}, ...].
std::string failures_json(const std::vector<FailedTrial>& failed);
// The inverse. Throws InputError, naming the file, when `text` is no such list.
std::vector<FailedTrial> parse_failures(const std::string& file_name, const std::string& text);
// The JSON text of the root's attribute `files`, and its inverse, which throws as parse_failures.
std::string files_json(const std::map<std::string, std::string>& files);
std::map<std::string, std::string> parse_files(const std::string& file_name, const std::string& text);
// "3 of 200 trials failed: 17, 44 and 90": of `planned` trials; the first ten numbers. Empty: none failed.
std::string failures_text(const std::vector<FailedTrial>& failed, std::size_t planned);

// Whether two files that say so are files of the same dataset.
inline bool same_dataset(const DatasetHeader& a, const DatasetHeader& b) {
  return a.seed == b.seed && a.command == b.command && a.scene == b.scene;
}

// Describes how two runs differ, as a clause: "seed 7, this run has 8; ...". `other`: name of the second run. Returns an empty text if
// version, seed, scene, overrides, command and files are equal.
std::string header_difference(const DatasetHeader& left, const DatasetHeader& now, const std::string& other = "this run");

// Name of the k-th file of a dataset: OUT.h5, OUT-0001.h5, OUT-0002.h5, ...
std::string shard_path(const std::string& path, std::size_t shard);

struct Masks {
  std::string split_by;  // SplitRule::by; without a rule "material", or "trial" where there is only one material
  std::string rule;      // the same as a sentence
  std::vector<std::size_t> train;
  std::vector<std::size_t> valid;
  std::vector<std::size_t> test;
};

// Splits trials (number, group) so that no group is in two of the parts. Without a rule the groups are materials, or single
// trials where all share one material, and 70 % of them are for training, 15 % for validation and 15 % for the test. A part that
// has a share gets at least one group, the test first, as long as one is left for training. Who goes where is shuffled by
// RandomStream(seed, 0, "mask"). Each part ascends.
Masks split_trials(const std::vector<std::pair<std::size_t, std::string>>& trials, std::uint64_t seed,
                   const std::optional<SplitRule>& rule = {});

}  // namespace slipbench
