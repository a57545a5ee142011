// The scene file with what was fitted in it.
#pragma once

#include <string>
#include <vector>

#include "sim/scene/parser.h"
#include "tools/base/page/json.h"
#include "tools/program/calibrate/fit_key.h"

namespace slipbench::calibrate {

// YAML: at its head what was fitted and how well it is known, then `file` with the values of `result` (calibrate.h) in it. A key of every
// recording is drawn by the sweep, with the centre and scatter that were found.
std::string fitted_scene(const SceneFile& file, const std::vector<FitKey>& keys, const Json& result);

}  // namespace slipbench::calibrate
