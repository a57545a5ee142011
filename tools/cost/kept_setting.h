// The setting that a scene's wish for accuracy takes, kept beside the scene so that it is looked for once.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "sim/scene/catalogues.h"
#include "sim/scene/parser.h"

namespace slipbench {

struct KeptSetting {
  std::vector<Override> overrides;  // to be given after the scene's own: the wish goes, what meets it comes
  std::string file;                 // where it stands with its evidence: SCENE.accuracy.json
  std::string text;                 // one line for a person
};

// The setting of a scene that wishes for one; empty where it does not. It is taken from the file beside the scene where that
// holds one for just this scene (its text, the overrides, the seed, the bytes of its model and the program's version), else
// looked for (find_setting) and put there; entries for another text of the scene go. `on_search` is called before it is looked
// for, which takes a while; may be empty. `seed`: the dataset's; empty: the scene's.
// Throws InputError as find_setting(), for a file that is damaged, and where it cannot be written; then what was found is lost.
std::optional<KeptSetting> setting_for(const std::string& scene_path, const std::vector<Override>& overrides,
                                       std::optional<std::uint64_t> seed, const Catalogues& catalogues,
                                       const std::function<void()>& on_search = {});

}  // namespace slipbench
