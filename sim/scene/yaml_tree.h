// A YAML document as a tree of plain values with their origins.
//
// The tree is built from yaml-cpp's events instead of its nodes. So every key keeps its
// line; anchors, aliases and tags (which could make a small file expand without end) are refused
// while reading; and a tree is an ordinary value that can be copied, merged and read from many
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

// Longer documents are refused.
inline constexpr std::size_t max_yaml_bytes = 1'000'000;

// The place where a value was written.
struct Origin {
  std::shared_ptr<const std::string> source;  // file name, or "--set path=value"
  int line = 0;                               // first line: 1; 0 if the source has no lines
  bool drawn = false;                         // drawn at random by the sweep
  bool typed = false;                         // given by an option, whose paths start from the current folder
  bool callers_own = false;                   // given by the caller, who may name any file

  // "stage.yaml:12", "stage.yaml:12 (drawn)", "--set motion.speed=8"
  [[nodiscard]] std::string text() const;
};

struct YamlNode {
  enum class Kind { null, scalar, sequence, map };

  Kind kind = Kind::null;
  Origin origin;
  std::string key;                 // of a map's child
  Origin key_origin;               // of a map's child
  std::string text;                // Kind::scalar
  std::vector<YamlNode> children;  // items of a sequence, or values of a map in file order

  // the map's child with this key, or null
  [[nodiscard]] const YamlNode* find(std::string_view name) const;
  [[nodiscard]] YamlNode* find(std::string_view name);
};

// Describes the node's content for messages: "'4 mm'", "a map", "a sequence", "nothing".
std::string described(const YamlNode& node);

// Throws InputError "ORIGIN: message".
[[noreturn]] void fail(const Origin& origin, const std::string& message);

// Reads one document. `source`: its name in messages; `has_lines`: true if its line numbers are
// meaningful. Throws InputError on invalid YAML or UTF-8, an empty document, more than one
// document, more than max_yaml_bytes, nesting deeper than 64, an anchor, alias, tag or merge key, a
// duplicate key, a key that is not text.
YamlNode parse_yaml(const std::string& text, const std::string& source, bool has_lines);

// Splits "motion.tilt.0" at its dots. Throws InputError if a part is empty or there are more than
// 64.
std::vector<std::string> split_path(const std::string& path, const Origin& origin);

// Returns the node at `path`, or null.
const YamlNode* node_at(const YamlNode& root, std::span<const std::string> path);

// Returns the node at `path` and creates it if needed: missing maps and a missing last key are
// added, a number selects an existing item of a sequence. A name in a sequence, such as that of an
// effect, becomes a map with this name as its only key. New keys get `origin`. Throws InputError if
// the path goes through another scalar or past the end of a sequence.
YamlNode& place_at(YamlNode& root, std::span<const std::string> path, const Origin& origin);

// Removes the key at `path`, which a map contains. Throws InputError at `origin` if the path does
// not exist, with the nearest key of the map, and for an item of a sequence, whose removal would
// renumber the items after it.
void remove_at(YamlNode& root, std::span<const std::string> path, const Origin& origin);

// Puts `value` in `place`, which keeps its key.
void assign(YamlNode& place, const YamlNode& value);

// Like assign(), but a map is merged into a map, key by key.
void merge(YamlNode& place, const YamlNode& value);

// Values inside a sweep, by their path.

// Splits "sweep.PATH" into the keys and numbers that lead to its value in the scene file `root`. A
// value inside an entry of the sweep is named by the entry and the rest of the path:
// "sweep.motion.0.site.1" for an axis of maps, "sweep.motion.compression.median" for a draw. Any
// other path is a separate entry: "sweep.motion.speed". Throws InputError for an empty part.
std::vector<std::string> swept_parts(const YamlNode& root, const std::string& path);

// A CSV file named by a scene, as the rows that the scene could contain itself.

// Returns a sequence of rows, each a sequence of the file's cells with the file's line as their
// origin. With `columns` the first line is a header with their names in any order, each optionally
// with a unit for its cells, "x [mm]"; a row then has a cell for each column, null for columns
// missing in the file. Empty lines are skipped. Throws InputError at `named`, where the scene names
// the file, if the file cannot be read or has more than max_yaml_bytes; and with the file's name
// and line for an unknown or repeated column and a row of another length than the header.
YamlNode read_csv(const std::string& path, const std::vector<TableColumn>& columns, const Origin& named);

}  // namespace slipbench
