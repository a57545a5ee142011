// A scene's wish for accuracy, before it runs: for `run`, `sweep` and `check`.
#pragma once

#include "sim/scene/catalogues.h"
#include "tools/program/cli/command.h"
#include "tools/program/sweep/run_sweep.h"

namespace slipbench {

// Where the scene says `accuracy`, appends to `sweep.overrides` the setting that meets it in the trials that `sweep` asks for
// (tools/program/cost/kept_setting.h), so that from here on it is a scene like any other and its command says how it was computed.
// `command` tells what it is. Throws InputError.
void settle_accuracy(SweepOptions& sweep, const Catalogues& catalogues, const Command& command);

}  // namespace slipbench
