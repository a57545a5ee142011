// Scenes for tests: shipped ones and texts.
#pragma once

#include <string>
#include <vector>

#include "sim/scene/parser.h"
#include "tools/registry/program_catalogues.h"

namespace slipbench {

// Returns the program's catalogues.
inline const Catalogues& catalogues() {
  static const Catalogues all = program_catalogues();
  return all;
}

// Loads the file scenes/`path` with changed values.
inline SceneFile shipped(const std::string& path, const std::vector<Override>& changes = {}) {
  SceneFile file = SceneFile::load(std::string(SLIPBENCH_SOURCE_DIR) + "/scenes/" + path);
  for (const Override& change : changes) file.apply(change);
  return file;
}

inline Scene parsed(const SceneFile& file) { return parse_scene(file, catalogues()); }
inline Scene parsed(const std::string& text) { return parsed(SceneFile::from_text(text, "scene.yaml")); }

// The published press-and-slide: 4 mm/s from 2 s on, an ideal sensor, mu = 0.5.
inline Scene stage_scene(const std::vector<Override>& changes) { return parsed(shipped("papillarray/stage.yaml", changes)); }

}  // namespace slipbench
