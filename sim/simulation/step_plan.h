// How a trial's time is cut into steps and samples.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "sim/scene/scene.h"

namespace slipbench {

struct StepPlan {
  double dt = 0.0;                   // s
  std::size_t ticks = 0;             // duration / dt
  std::vector<std::size_t> strides;  // ticks between two samples, by sensor
};

// The steps that the sensors of a scene from number `first` on have in common, which sample at `output_rates` [Hz]. `time_step: auto` takes the longest step that divides every
// sampling time and is at most `longest` [s]. `limited_by` says what does not bear a longer one: "the scene's effects".
// Throws SceneValueError when the scene's own step is longer than that, is no whole part of the duration or of a sampling time.
StepPlan plan_steps(const Scene& scene, std::span<const double> output_rates, double longest, const std::string& limited_by,
                    std::size_t first = 0);

}  // namespace slipbench
