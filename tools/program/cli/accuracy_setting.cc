#include "tools/program/cli/accuracy_setting.h"

#include <cstdio>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "tools/program/cli/terminal.h"
#include "tools/program/cost/kept_setting.h"

namespace slipbench {

void settle_accuracy(SweepOptions& sweep, const Catalogues& catalogues, bool quiet) {
  const auto tell = [&](const std::string& text) {
    if (!quiet) say(stderr, fmt::format("slipbench: accuracy: {}\n", text));
  };
  const std::optional<KeptSetting> setting = setting_for(sweep, catalogues, [&] {
    tell(fmt::format("looking once for the cheapest setting that meets the wish of {}", sweep.scene_path));
  });
  if (!setting) return;
  tell(fmt::format("{}; {}", setting->text, setting->file));
  sweep.overrides.insert(sweep.overrides.end(), setting->overrides.begin(), setting->overrides.end());
}

}  // namespace slipbench
