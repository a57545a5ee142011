// The scene behind a recorded trial.
#pragma once

#include "sim/scene/catalogues.h"
#include "sim/scene/scene.h"
#include "tools/base/dataset/reader.h"
#include "tools/base/record/trial_record.h"

namespace slipbench {

// The scene that a trial ran: the dataset's, with what was set and what was drawn. Throws InputError where this version cannot read it.
Scene recorded_scene(const DatasetReader& reader, const TrialRecord& record, const Catalogues& catalogues);

}  // namespace slipbench
