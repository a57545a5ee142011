#include "tools/program/text/warning_text.h"

#include <cstdio>

#include <fmt/format.h>

#include "tools/program/cli/terminal.h"

namespace slipbench {

void print_warnings(const std::vector<Warning>& warnings) {
  const Style style = style_for(stderr);
  for (const Warning& warning : warnings) {
    say(stderr, fmt::format("slipbench: {} {}\n", style.bold("warning:"), warning.text));
  }
}

}  // namespace slipbench
