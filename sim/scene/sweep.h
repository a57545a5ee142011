// The sweep of a scene: which values each trial takes.
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

// A random number as a scene asks for it. With u uniform in [0, 1) and z standard normal:
//   uniform      min + (max - min) u
//   log_uniform  exp of a uniform draw from ln min to ln max
//   normal       mean + sd z, drawn again until it is within [min, max] where these are given
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

// A kind of draw: its name and the numbers that it needs and may have.
struct DrawKind {
  std::string_view name;
  Draw::Kind kind;
  std::vector<std::string_view> required;
  std::vector<std::string_view> optional;
};

const std::vector<DrawKind>& draw_kinds();

// Returns true if a sweep cannot vary this key of a scene.
bool is_fixed(std::string_view key);

// One entry of `sweep`: an axis of the grid, or a draw.
struct SweptPath {
  std::string path;  // empty, as the parts: the axis `scene`, whose maps are merged into the scene itself
  std::vector<std::string> parts;
  Origin origin;
  std::vector<YamlNode> values;  // of the axis, or of a choice
  std::optional<Draw> draw;
  bool typed;  // given on the command line, all of it or a part
};

// Every path that the entry sets: a map on an axis stands for the keys in it.
std::vector<std::string> leaves_of(const SweptPath& swept);

// Most draws of a cell that a scene may ask for, and most cells of the grid.
inline constexpr std::size_t max_cells = 1'000'000;

class Sweep {
 public:
  // `node`: the scene's `sweep`, or null where it has none. `overridden`: paths fixed on the command line, which leave the sweep
  // of the file. What the command line sweeps stays: below such a path it applies to what was given there, and the same path is refused.
  // Throws InputError.
  Sweep(const YamlNode* node, const std::vector<std::vector<std::string>>& overridden);

  [[nodiscard]] std::size_t cells() const { return cells_; }    // of the grid, at least 1
  [[nodiscard]] std::size_t trials() const { return trials_; }  // draws of each cell, as the scene says

  // Every path that some trial sets, in file order: a map on an axis stands for the keys in it.
  [[nodiscard]] const std::vector<std::string>& leaves() const { return leaves_; }

  // What it sets, in file order.
  [[nodiscard]] const std::vector<SweptPath>& paths() const { return paths_; }

  // Puts into the scene what entry `entry` of paths() sets with its value number `value`, and what all others set with their
  // value number `others`, counted round. Drawn numbers are left out. Throws as apply().
  void apply_one(YamlNode& scene, std::size_t entry, std::size_t value, std::size_t others) const;

  // Puts the values of one trial into the scene. The last axis varies fastest. Throws InputError where a path does not fit the
  // scene or a truncated draw finds no value.
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
