// Reconstructs the scene of a recorded trial.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/scene/catalogues.h"
#include "sim/scene/parser.h"
#include "sim/scene/scene.h"
#include "tools/dataset/header.h"
#include "tools/dataset/reader.h"
#include "tools/dataset/record/json.h"
#include "tools/dataset/record/trial_record.h"

namespace slipbench {

// Parses an attribute of a dataset. Throws InputError, beginning with `subject`, if it is not a
// JSON object.
Json json_object(const std::string& text, const std::string& subject);
// The scene file of `scene` with the overrides of the command line, {path: YAML text}. `place`
// names it in messages. Throws InputError if this version cannot read it.
SceneFile recorded_file(const std::string& scene, const Json& overrides, const std::string& place);
// The scene of a dataset, with its overrides and without its sweep. Throws likewise.
SceneFile recorded_file(const DatasetReader& reader);
// The scene that a trial ran: its dataset's recorded_file() with the trial's draws. Throws
// likewise.
Scene recorded_scene(SceneFile file, const TrialRecord& record, const Catalogues& catalogues);

// The scene's `split`; empty without one.
std::optional<SplitRule> split_rule(const Scene& scene);

// Group of a trial for the split: its material, or the value that the scene's `split` selects. An
// object is identified by the material and shape that the pads touch, at any pose. Throws
// SceneValueError if the scene splits by speed and its motion has none.
std::string split_group(const Scene& scene);

// The swept values (path, YAML text) of a trial except those that change only how, or how long, the
// contact is read or computed: rate and electronics of a sensor, detector without controller, seed,
// time step, fidelity and duration. Empty if the motion or the scatter of the grasp is drawn for
// each trial.
std::string experiment_of(const Scene& scene, const std::vector<std::pair<std::string, std::string>>& swept);

// Keys of a trial's experiment. Trials that share a key are repeats, whose recordings differ in noise
// or in how the contact was read. `truth`: digest of the true forces and states, empty without any.
// If a key is swept that changes the samples of one contact, its digest differs, so experiment_of()
// is a key, too.
std::vector<std::string> experiments_of(const Scene& scene, const std::vector<std::pair<std::string, std::string>>& swept,
                                        const std::string& truth);

}  // namespace slipbench
