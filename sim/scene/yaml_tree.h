// A YAML document as a tree of plain values that know where they were written.
//
// yaml-cpp's events are taken instead of its nodes: every key keeps its line, anchors, aliases and tags (which could make a small
// file unfold without end) are refused while reading, and a tree is an ordinary value that can be copied, merged and read from many
// threads at once.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/core/parameters.h"

namespace slipbench {

// A longer document is refused.
inline constexpr std::size_t max_yaml_bytes = 1'000'000;

// Where a value was written.
struct Origin {
  std::shared_ptr<const std::string> source;  // file name, or "--set path=value"
  int line = 0;                               // 1 is the first; 0 where the source has no lines
  bool drawn = false;                         // the value was drawn at random by the sweep

  [[nodiscard]] std::string text() const;  // "stage.yaml:12", "stage.yaml:12 (drawn)", "--set motion.speed=8"
};

struct YamlNode {
  enum class Kind { null, scalar, sequence, map };

  Kind kind = Kind::null;
  Origin origin;
  std::string key;                 // where the node is a map's child
  Origin key_origin;               // likewise
  std::string text;                // Kind::scalar
  std::vector<YamlNode> children;  // items of a sequence, or values of a map in file order

  [[nodiscard]] const YamlNode* find(std::string_view name) const;  // the map's child of this key, or null
  [[nodiscard]] YamlNode* find(std::string_view name);
};

// What is written, for messages: "'4 mm'", "a map", "a sequence", "nothing".
std::string described(const YamlNode& node);

// Throws InputError "ORIGIN: message".
[[noreturn]] void fail(const Origin& origin, const std::string& message);

// Reads one document. `source` names it in messages; `has_lines`: whether line numbers mean something there.
// Throws InputError on: invalid YAML or UTF-8, an empty document, more than one document, more than max_yaml_bytes, nesting deeper than 64,
// an anchor, alias, tag or merge key, a duplicate key, a key that is not text.
YamlNode parse_yaml(const std::string& text, const std::string& source, bool has_lines);

// "motion.tilt.0" split at its dots. Throws InputError when a part is empty or there are more than 64.
std::vector<std::string> split_path(const std::string& path, const Origin& origin);

// The node at `path`, or null where there is none.
const YamlNode* node_at(const YamlNode& root, std::span<const std::string> path);

// The place at `path`, made where it does not exist: missing maps and a missing last key are added, a number selects an existing
// item of a sequence. A name in a sequence, such as that of an effect, stands for a map of it alone. New keys get `origin`. Throws InputError where
// the path goes through another scalar or past the end of a sequence.
YamlNode& place_at(YamlNode& root, std::span<const std::string> path, const Origin& origin);

// Puts `value` in `place`, which keeps its key.
void assign(YamlNode& place, const YamlNode& value);

// As assign, but a map is merged into a map, key by key.
void merge(YamlNode& place, const YamlNode& value);

// Values inside a sweep, by their path.

// "sweep.PATH" split into the keys and numbers that lead to what it names in the scene file `root`. A value that an entry of the sweep has is named by the
// entry and what follows: "sweep.motion.0.site.1" of an axis of maps, "sweep.motion.compression.median" of a draw. Anything else is an entry of its own:
// "sweep.motion.speed". Throws InputError for an empty part.
std::vector<std::string> swept_parts(const YamlNode& root, const std::string& path);

// A CSV file that a scene names, as the rows that the scene could have written itself.

// A sequence of rows, each a sequence of the file's cells with the file's line as their origin. With `columns` the first line is a header of their
// names in any order, each perhaps with a unit for its cells, "x [mm]"; a row then has a cell for each column, null where the file has none.
// Empty lines are passed over. Throws InputError at `named`, where the scene names the file, for a file that cannot be read or of more than
// max_yaml_bytes, and with the file's name and line for an unknown or repeated column and a row of another length than the header.
YamlNode read_csv(const std::string& path, const std::vector<TableColumn>& columns, const Origin& named);

}  // namespace slipbench
