// Rounding does not decide whether an element sticks or slips: scenes with one input changed by one
// unit in the last place have the same number of events by unit and kind. An exponential or
// logarithm may differ that much between the libraries of processors, and friction depends on them.
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <tuple>

#include "tests/expect.h"
#include "tests/scenes.h"
#include "tools/trial/run_trial.h"

namespace slipbench {
namespace {

// Number of events of each kind for each unit of each sensor.
using Events = std::map<std::tuple<std::string, std::uint32_t, std::uint8_t>, std::size_t>;

Events events_of(const Scene& scene) {
  Events events;
  for (const SensorRecord& sensor : run_trial(scene, 0, Recording::full).record.sensors) {
    const LabelRecord& labels = sensor.labels;
    for (std::size_t e = 0; e < labels.event_time.size(); ++e)
      ++events[{sensor.name, labels.event_unit[e], labels.event_kind[e]}];
  }
  return events;
}

// Returns copies of the scene with Coulomb's coefficients and each number of the motion and the
// effects one unit in the last place up or down.
std::vector<Scene> disturbed(const Scene& scene) {
  std::vector<Scene> scenes;
  for (const double towards : {0.0, std::numeric_limits<double>::infinity()}) {
    const auto nudge = [towards](double& value) { value = std::nextafter(value, towards); };
    const auto nudge_all = [&](Parameters& parameters) {
      for (const auto& [name, value] : parameters.values()) {
        const double* const number = std::get_if<double>(&value);
        if (number == nullptr || *number == 0.0 || !std::isfinite(*number)) continue;
        double changed = *number;
        nudge(changed);
        parameters.set(name, changed);
      }
    };
    scenes.push_back(scene);
    nudge(scenes.back().friction.static_coefficient);
    nudge(scenes.back().friction.kinetic_coefficient);
    scenes.push_back(scene);
    nudge_all(scenes.back().motion.parameters);
    if (scene.effects.empty()) continue;
    scenes.push_back(scene);
    for (Named& effect : scenes.back().effects) nudge_all(effect.parameters);
  }
  return scenes;
}

void expect_same_events(const Scene& scene, const std::string& what) {
  const Events events = events_of(scene);
  EXPECT_FALSE(events.empty()) << what;
  std::size_t number = 0;
  for (const Scene& other : disturbed(scene)) EXPECT_EQ(events, events_of(other)) << what << ", disturbance " << number++;
}

TEST(Rounding, StageHasTheSameEventsUnderEveryEffect) {
  for (const char* effects :
       {"[]", "[viscous_friction]", "[stribeck]", "[load_dependent_friction]", "[ageing]", "[viscoelastic]", "[texture]",
        "[patchy_friction]", "[patchy_friction, viscous_friction]", "[anisotropic_friction]"}) {
    expect_same_events(stage_scene({{"effects", effects}, {"friction.kinetic", "0.45"}}), effects);
  }
}

TEST(Rounding, TrainingStageHasTheSameEvents) {
  expect_same_events(parsed(shipped("learn/papillarray.yaml", {{"motion.speed", "4 mm/s"}, {"effects", "[viscous_friction]"}})),
                     "learn/papillarray");
}

TEST(Rounding, SlowReleaseHasTheSameEvents) { expect_same_events(parsed(shipped("nib_pad/release.yaml")), "nib_pad/release"); }

}  // namespace
}  // namespace slipbench
