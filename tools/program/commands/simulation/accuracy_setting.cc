#include "tools/program/commands/simulation/accuracy_setting.h"

#include <optional>

#include <fmt/format.h>

#include "tools/program/cost/kept_setting.h"

namespace slipbench {

void settle_accuracy(SweepOptions& sweep, const Catalogues& catalogues, const Command& command) {
  const std::optional<KeptSetting> setting = setting_for(sweep, catalogues, [&] {
    command.tell(fmt::format("accuracy: looking once for the cheapest setting that meets the wish of {}", sweep.scene_path));
  });
  if (!setting) return;
  command.tell(fmt::format("accuracy: {}; {}", setting->text, setting->file));
  sweep.overrides.insert(sweep.overrides.end(), setting->overrides.begin(), setting->overrides.end());
}

}  // namespace slipbench
