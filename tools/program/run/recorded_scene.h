// The scene behind a recorded trial.
#pragma once

#include <optional>
#include <string>

#include "sim/scene/catalogues.h"
#include "sim/scene/parser.h"
#include "sim/scene/scene.h"
#include "tools/base/dataset/header.h"
#include "tools/base/dataset/reader.h"
#include "tools/base/record/json.h"
#include "tools/base/record/trial_record.h"

namespace slipbench {

// An attribute of a dataset. Throws InputError that begins with `subject` where it is none.
Json json_object(const std::string& text, const std::string& subject);
// The text of a scene with what the command line set, {path: YAML text}. `place` names it in messages. Throws InputError where this version cannot read
// it.
SceneFile recorded_file(const std::string& scene, const Json& overrides, const std::string& place);
// The scene of a dataset, with what was set and without its sweep. Throws the same.
SceneFile recorded_file(const DatasetReader& reader);
// The scene that a trial ran: its dataset's recorded_file(), with what was drawn. Throws the same.
Scene recorded_scene(SceneFile file, const TrialRecord& record, const Catalogues& catalogues);

// The scene's `split`; empty where it has none.
std::optional<SplitRule> split_rule(const Scene& scene);

// What the trial has in common with those that must be in the same part: its material, or what else the scene's `split` says. An
// object is what the pads touch, its material and shape, wherever it stands. Throws SceneValueError where the scene splits by
// speed and its motion has none.
std::string split_group(const Scene& scene);

}  // namespace slipbench
