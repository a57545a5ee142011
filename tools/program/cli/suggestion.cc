#include "tools/program/cli/suggestion.h"

#include <fmt/format.h>

#include "sim/core/error.h"

namespace slipbench {

std::string suggestion(const std::string& word, const std::vector<std::string>& candidates) {
  const std::string nearest = nearest_name(word, candidates);
  return nearest.empty() ? ";" : fmt::format("; did you mean '{}'?", nearest);
}

}  // namespace slipbench
