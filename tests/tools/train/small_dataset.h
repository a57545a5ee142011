// A dataset made in a tenth of a second.
#pragma once

#include <fstream>
#include <string>

#include "tests/tools/dataset/record/test_records.h"
#include "tools/registry/program_catalogues.h"
#include "tools/trial/sweep/run_sweep.h"

namespace slipbench::testing {

// 24 trials of 0.4 s: pressed 0.6 mm until 0.2 s, then slid at two speeds, with twelve draws of
// direction and friction each.
inline constexpr const char* small_scene = R"(slipbench: 1
description: short slides
duration: 0.4 s
time_step: 1 ms
seed: 5
surface: {material: acrylic}
friction: {static: 0.5, kinetic: 0.5}
motion: {kind: stage, gap: 0 mm, compression: 0.6 mm, approach_speed: 10 mm/s, start: 0.2 s, speed: 8 mm/s, acceleration: 1 m/s2}
sensors:
  pad: {type: papillarray, rate: 1 kHz, electronics: typical, bristles: 3, profile: hexapod}
sweep:
  motion.speed: [4 mm/s, 16 mm/s]
  motion.direction: {draw: uniform, min: 0 deg, max: 360 deg}
  friction.scale: {draw: lognormal, median: 1, sd: 0.1}
  trials: 12
)";

struct SmallDatasetTest : FolderTest {
  // Writes the dataset, with some of the scene's values replaced.
  std::string dataset(const std::vector<Override>& overrides = {}, const std::string& name = "data.h5") {
    std::ofstream(path("scene.yaml")) << small_scene;
    SweepOptions options;
    options.scene_path = path("scene.yaml");
    options.overrides = overrides;
    options.jobs = 1;
    options.output = path(name);
    run_sweep(options, program_catalogues());
    return options.output;
  }
};

}  // namespace slipbench::testing
