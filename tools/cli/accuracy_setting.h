// A scene's wish for accuracy, before it runs: for `run`, `sweep` and `check`.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/scene/catalogues.h"
#include "sim/scene/parser.h"

namespace slipbench {

// Where the scene says `accuracy`, appends to `overrides` the setting that meets it (tools/cost/kept_setting.h), so that from
// here on it is a scene like any other and its command says how it was computed. Tells on stderr what it is, unless `quiet`.
// Throws InputError.
void settle_accuracy(const std::string& scene_path, std::vector<Override>& overrides, std::optional<std::uint64_t> seed,
                     const Catalogues& catalogues, bool quiet);

}  // namespace slipbench
