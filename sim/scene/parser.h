// Reading scene files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sim/scene/catalogues.h"
#include "sim/scene/scene.h"
#include "sim/scene/section_readers.h"
#include "sim/scene/yaml_tree.h"

namespace slipbench {

// "motion.speed=8 mm/s" given on the command line; applied to the file before anything is checked.
struct Override {
  std::string path;              // dotted; a number selects an entry of a sequence: "motion.tilt.0"
  std::string value;             // YAML
  std::string option = "--set";  // by which it was given, for messages
};

// A scene file as read, before its sweep is expanded. Cheap to copy.
class SceneFile {
 public:
  // Reads a file. Throws InputError when it is no file (a pipe, a device), cannot be read or is not YAML
  // (yaml_tree.h says what is refused).
  static SceneFile load(const std::string& path);
  // The same from text; `name` stands in the messages where a path would.
  static SceneFile from_text(std::string text, std::string name);

  // Replaces or adds a value; missing maps on the way are made. Below `sweep` the rest of the path is one key:
  // "sweep.motion.speed=[...]". Throws InputError when the path cannot exist (it goes through a scalar, the index is out of range).
  void apply(const Override& change);

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

// Checks the whole file, its sweep included, and returns the scene of the sweep's first trial under the file's own seed. Throws
// InputError: "stage.yaml:12: unknown key 'sped' in motion; did you mean 'speed'? allowed: acceleration, compression, ...".
Scene parse_scene(const SceneFile& file, const Catalogues& catalogues);

// The trials of a sweep: the grid, times the number of random draws of each cell. Trial i belongs to cell i / draws.
class TrialPlan {
 public:
  // Checks the sweep, and every cell of the grid with its first draw (the cells after the 10,000th when they are asked for).
  // `draws`: repetitions of each grid cell; 0 takes sweep.trials, or 1.
  // `seed`: the dataset's seed, from which random draws come; it replaces the scene's own.
  // `catalogues` must outlive the plan. Throws InputError; more than 1,000,000 trials are refused, and a sweep over names (materials,
  // protocols) whose figures the scene replaces, so that its trials would differ in nothing.
  TrialPlan(const SceneFile& file, const Catalogues& catalogues, std::size_t draws, std::uint64_t seed);

  [[nodiscard]] std::size_t size() const { return count_; }
  // Trials of each grid cell.
  [[nodiscard]] std::size_t draws() const { return draws_; }

  // One trial: the scene with its swept values, and these values in the sweep's order.
  struct Trial {
    Scene scene;
    std::vector<std::pair<std::string, std::string>> drawn;  // path -> JSON, numbers in SI; the same paths in every trial
  };
  // Thread-safe. Throws InputError when drawn values do not make a valid scene.
  [[nodiscard]] Trial trial(std::size_t index) const;

  // The same scene; puts every value that it is read from into `values`. Throws as trial().
  Scene read(std::size_t index, Trace& values) const;

  // Where a value of that trial was written: "stage.yaml:12". The nearest map around it where the scene leaves it at its default.
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
