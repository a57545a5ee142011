// The setting that a scene's wish for accuracy takes, kept beside the scene so that it is looked for once.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "sim/scene/catalogues.h"
#include "sim/scene/parser.h"
#include "tools/program/sweep/run_sweep.h"

namespace slipbench {

struct KeptSetting {
  std::vector<Override> overrides;  // to be given after the scene's own: the wish goes, what meets it comes
  std::string file;                 // where it stands with its evidence: SCENE.accuracy.json
  std::string text;                 // one line for a person
};

// The setting of a scene that wishes for one; empty where it does not, which costs no more than reading its YAML. It is taken
// from the file beside the scene where that holds one for just this scene (its text, the overrides, the seed, the bytes of its
// model and the program's version) and these trials (as many, of as many draws a cell). Else it is looked for (find_setting) and
// put there, and entries for another text of the scene go. `on_search` is called before it is looked for, which takes long, and
// may be empty.
// Of `sweep` what decides the trials counts: one trial alone (`only`) has the setting of those that it is one of.
// Throws InputError as plan_trials() and find_setting(), for a file that is damaged, and, before anything is looked for, where it
// cannot be written.
std::optional<KeptSetting> setting_for(const SweepOptions& sweep, const Catalogues& catalogues,
                                       const std::function<void()>& on_search = {});

}  // namespace slipbench
