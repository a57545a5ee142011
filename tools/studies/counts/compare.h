// What grew between two counts of the reference scenes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/studies/counts/results.h"

namespace slipbench::counts {

// Growth of a scene's instructions that is no longer accepted, and shrinkage worth storing.
inline constexpr double allowed_growth = 0.02;

struct FunctionChange {
  std::string name;
  std::uint64_t before = 0;
  std::uint64_t now = 0;
  bool listed = true;  // false: no more than `before` then, since the stored results keep the dearest functions only

  // More instructions now, less where negative; where not listed, at least so many more.
  [[nodiscard]] std::int64_t difference() const { return static_cast<std::int64_t>(now) - static_cast<std::int64_t>(before); }
};

struct SceneChange {
  std::string scene;
  std::uint64_t before = 0;
  std::uint64_t now = 0;
  std::uint64_t steps_before = 0;
  std::uint64_t steps_now = 0;
  std::vector<FunctionChange> functions;  // those that changed, the largest change first

  [[nodiscard]] double growth() const {
    return (static_cast<double>(now) - static_cast<double>(before)) / static_cast<double>(before);
  }
  [[nodiscard]] bool grew() const { return growth() > allowed_growth; }
  [[nodiscard]] bool shrank() const { return growth() < -allowed_growth; }
};

// Throws InputError, which names `path`, the file of `before`, where its build is another or its scenes are not the reference
// scenes.
void check_comparable(const Results& before, const Facts& build, const std::string& path);

// Scene by scene. Both have the same scenes in the same order, `now` with all functions there are and `before` with at least one.
std::vector<SceneChange> compare(const Results& before, const Results& now);

}  // namespace slipbench::counts
