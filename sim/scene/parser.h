// Reading scene files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sim/scene/catalogues.h"
#include "sim/scene/entry_reader.h"
#include "sim/scene/scene.h"
#include "sim/scene/yaml_tree.h"

namespace slipbench {

// An override from the command line such as "motion.speed=8 mm/s"; applied to the file before any
// check. Relative paths of files in it start from the current folder, not from the scene's.
struct Override {
  std::string path;              // dotted; a number selects an item of a sequence: "motion.tilt.0"
  std::string value;             // YAML; null removes the key
  std::string option = "--set";  // the option that gave it, for messages
  // A value that the scene's own sweep gave, whose paths start from the scene's folder.
  bool of_sweep = false;
  bool callers_own = true;  // false: read from a dataset, which may be of others
};

// A scene file as read, before its sweep is expanded. Cheap to copy.
class SceneFile {
 public:
  // Reads a file. Throws InputError if it is not a regular file (a pipe, a device), cannot be read
  // or is not valid YAML (see yaml_tree.h).
  static SceneFile load(const std::string& path);
  // The same from text; messages show `name` instead of a path. `callers_own`: the caller wrote the
  // text, which may then name any file.
  static SceneFile from_text(std::string text, std::string name, bool callers_own = false);

  // Effect of an override that removes a key which neither the scene nor its sweep sets.
  enum class MissingKey { refused, ignored };

  // Replaces or adds a value and makes missing maps on the way; null removes the key from the scene
  // and from its sweep. Below `sweep` the rest of the path is one key: "sweep.motion.speed=[...]".
  // Throws InputError if the path is impossible (through a scalar, or an index out of range).
  void apply(const Override& change, MissingKey missing = MissingKey::refused);

  [[nodiscard]] const std::string& text() const { return text_; }  // as read, without overrides
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const YamlNode& root() const { return *root_; }  // with overrides

 private:
  friend class TrialPlan;
  friend Scene parse_scene(const SceneFile& file, const Catalogues& catalogues);
  std::string text_;
  std::string name_;
  std::shared_ptr<const YamlNode> root_;
  std::vector<std::vector<std::string>> overridden_;  // paths, split
};

// Checks the whole file, its sweep included, and returns the scene of the sweep's first trial under
// the file's own seed. Throws InputError: "stage.yaml:12: unknown key 'sped' in motion; did you
// mean 'speed'? allowed: acceleration, compression, ...".
Scene parse_scene(const SceneFile& file, const Catalogues& catalogues);

// The trials of a sweep: the grid, times the number of random draws per cell. Trial i belongs to
// cell i / draws.
class TrialPlan {
 public:
  // Checks the sweep, and every cell of the grid with its first draw (cells after the 10,000th only
  // when they are used). `draws`: repetitions of each grid cell; 0 takes sweep.trials, or 1.
  // `seed`: the dataset's seed for random draws; it replaces the scene's own. `catalogues` must
  // outlive the plan. Throws InputError, also for more than 1,000,000 trials, and for a sweep over
  // names (materials, protocols) whose figures the scene replaces, so that its trials would not
  // differ.
  TrialPlan(const SceneFile& file, const Catalogues& catalogues, std::size_t draws, std::uint64_t seed);

  [[nodiscard]] std::size_t size() const { return count_; }
  // Trials of each grid cell.
  [[nodiscard]] std::size_t draws() const { return draws_; }

  // One trial: the scene with its swept values, and these values in the sweep's order.
  struct Trial {
    Scene scene;
    // path -> JSON, numbers in SI; the same paths in every trial
    std::vector<std::pair<std::string, std::string>> drawn;
  };
  // Thread-safe. Throws InputError if drawn values do not make a valid scene.
  [[nodiscard]] Trial trial(std::size_t index) const;

  // The same scene; adds every value that it was read from to `values`. Throws like trial().
  Scene read(std::size_t index, Trace& values) const;

  // Returns the origin of a value of that trial: "stage.yaml:12". For a default it is that of the
  // nearest enclosing map. An entry of a list has its number or its name: "effects.texture.edge".
  [[nodiscard]] std::string where(std::size_t index, const std::string& path) const;

 private:
  struct Plan;

  Scene scene_of(std::size_t index, YamlNode& root, Trace* trace) const;

  std::shared_ptr<const Plan> plan_;
  const Catalogues* catalogues_;
  std::size_t draws_ = 1;
  std::uint64_t seed_;
  std::size_t count_ = 0;
};

}  // namespace slipbench
