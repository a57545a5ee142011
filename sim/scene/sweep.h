// The sweep of a scene: the values of each trial.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/core/quantity.h"
#include "sim/core/random.h"
#include "sim/scene/yaml_tree.h"

namespace slipbench {

// A random number as requested by a scene. With u uniform in [0, 1) and z standard normal:
//   uniform      min + (max - min) u
//   log_uniform  exp of a uniform draw from ln min to ln max
//   normal       mean + sd z, redrawn until it is within [min, max] if these are given
//   lognormal    median exp(sd z), likewise
//   choice       one of `values`, all equally likely
struct Draw {
  enum class Kind { uniform, log_uniform, normal, lognormal, choice };
  Kind kind = Kind::uniform;
  double centre = 0.0;  // mean or median, SI
  double sd = 0.0;
  double min;  // SI
  double max;
  Quantity quantity = Quantity::none;
  Origin origin;
};

// A kind of draw: its name, and its required and optional numbers.
struct DrawKind {
  std::string_view name;
  Draw::Kind kind;
  std::vector<std::string_view> required;
  std::vector<std::string_view> optional;
};

const std::vector<DrawKind>& draw_kinds();

// True if a sweep cannot vary this key of a scene.
bool is_fixed(std::string_view key);

// One entry of `sweep`: an axis of the grid, or a draw.
struct SweptPath {
  // Empty, as are the parts: the axis `scene`, whose maps are merged into the scene itself.
  std::string path;
  std::vector<std::string> parts;
  Origin origin;
  std::vector<YamlNode> values;  // of the axis, or of a choice
  std::optional<Draw> draw;
  bool typed;  // given on the command line, in whole or in part
};

// Returns every path that the entry sets: a map on an axis stands for the keys in it.
std::vector<std::string> leaves_of(const SweptPath& swept);

// Largest number of draws per cell, and of cells of the grid.
inline constexpr std::size_t max_cells = 1'000'000;

class Sweep {
 public:
  // `node`: the scene's `sweep`, or null. `overridden`: paths fixed on the command line, which are
  // removed from the file's sweep. A sweep given on the command line stays: a fixed path below it
  // changes its values, and the same path is refused. Throws InputError.
  Sweep(const YamlNode* node, const std::vector<std::vector<std::string>>& overridden);

  [[nodiscard]] std::size_t cells() const { return cells_; }  // of the grid, at least 1
  // draws per cell, as given by the scene
  [[nodiscard]] std::size_t trials() const { return trials_; }

  // Every path that some trial sets, in file order: a map on an axis stands for the keys in it.
  [[nodiscard]] const std::vector<std::string>& leaves() const { return leaves_; }

  // True if some trial sets a value at `path` or below it.
  [[nodiscard]] bool sets(const std::string& path) const;

  // The entries, in file order.
  [[nodiscard]] const std::vector<SweptPath>& paths() const { return paths_; }

  // Sets value number `value` of entry number `entry` of paths() in the scene, and value number
  // `others` (modulo their number) of all other entries. Omits drawn numbers. Throws like apply().
  void apply_one(YamlNode& scene, std::size_t entry, std::size_t value, std::size_t others) const;

  // Sets the values of one trial in the scene. The last axis varies fastest. Throws InputError if a
  // path does not fit the scene or a truncated draw finds no value.
  void apply(YamlNode& scene, std::size_t cell, std::uint64_t seed, std::size_t trial) const;

 private:
  void read_trials(const YamlNode& node);
  void read_scenes(const YamlNode& node);
  void read_path(const YamlNode& node);
  void drop_overridden(const std::vector<std::vector<std::string>>& overridden);
  void collect_leaves();

  std::vector<SweptPath> paths_;
  std::vector<std::string> leaves_;
  std::size_t cells_ = 1;
  std::size_t trials_ = 1;
};

}  // namespace slipbench
