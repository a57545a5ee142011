#include "tools/cli/accuracy_setting.h"

#include <cstdio>

#include <fmt/format.h>

#include "tools/cli/terminal.h"
#include "tools/cost/kept_setting.h"

namespace slipbench {

void settle_accuracy(const std::string& scene_path, std::vector<Override>& overrides, std::optional<std::uint64_t> seed,
                     const Catalogues& catalogues, bool quiet) {
  const auto tell = [&](const std::string& text) {
    if (!quiet) say(stderr, fmt::format("slipbench: accuracy: {}\n", text));
  };
  const std::optional<KeptSetting> setting = setting_for(scene_path, overrides, seed, catalogues, [&] {
    tell(fmt::format("looking once for the cheapest setting that meets the wish of {}", scene_path));
  });
  if (!setting) return;
  tell(fmt::format("{}; {}", setting->text, setting->file));
  overrides.insert(overrides.end(), setting->overrides.begin(), setting->overrides.end());
}

}  // namespace slipbench
