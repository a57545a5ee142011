// Steps the press-and-slide bench without effects, for instruction counts: stage_steps TICKS
#include <iostream>

#include "sim/api/motion.h"
#include "sim/motion/motion_catalogue.h"
#include "sim/stage/stage_simulation.h"
#include "tests/oracle/pads.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: stage_steps TICKS\n";
    return 2;
  }
  slipbench::Scene scene;
  scene.duration = 4.0;
  scene.time_step = 1e-3;
  scene.friction = {0.5, 0.5};
  scene.surface.name = "plane";
  scene.motion = {"stage", slipbench::defaults_of(slipbench::motion_catalogue().front().about.parameters)};
  scene.sensors.emplace_back();
  const slipbench::PadLayout pad = slipbench::oracle::nine_pillars();
  const slipbench::PadLayout* pads[] = {&pad};
  const double rates[] = {1000.0};
  slipbench::StageSimulation bench(scene, pads, rates, 0);
  for (long tick = 0; tick < std::atol(argv[1]); ++tick) bench.step();
  std::cout << bench.contact(0).force.sum() << '\n';
}
