#include "tools/run/run_trial.h"

#include <memory>
#include <vector>

#include "sim/testbench/testbench.h"
#include "tools/run/recorder.h"
#include "tools/run/sensors.h"

namespace slipbench {

namespace {

using Sensors = std::vector<std::unique_ptr<Sensor>>;

Sensors make_sensors(const Scene& scene, std::uint64_t trial) {
  Sensors sensors;
  for (const SensorScene& description : scene.sensors) sensors.push_back(make_sensor(description, scene.seed, trial));
  return sensors;
}

Testbench make_bench(const Scene& scene, const Sensors& sensors, std::uint64_t trial) {
  std::vector<const PadLayout*> pads;
  std::vector<double> rates;
  for (const auto& sensor : sensors) {
    pads.push_back(&sensor->layout());
    rates.push_back(sensor->rate());
  }
  return {scene, pads, rates, trial};
}

}  // namespace

double check_trial(const Scene& scene, std::uint64_t trial) {
  const Sensors sensors = make_sensors(scene, trial);
  return record_bytes(sensors, make_bench(scene, sensors, trial));
}

TrialResult run_trial(const Scene& scene, std::uint64_t trial, Recording recording, double max_bytes) {
  const Sensors sensors = make_sensors(scene, trial);
  Testbench bench = make_bench(scene, sensors, trial);
  TrialRecorder recorder(scene, sensors, bench, trial, recording, max_bytes);
  for (std::size_t tick = 0; tick < bench.ticks(); ++tick) {
    bench.step();
    for (std::size_t pad = 0; pad < sensors.size(); ++pad) {
      const ContactFrame& truth = bench.contact(pad);
      recorder.observe(pad, truth);
      if (tick % bench.stride(pad) == 0) recorder.sample(pad, truth, sensors[pad]->measure(truth));
    }
    recorder.bodies(tick, bench.contact(0).time, bench.bodies());
  }
  return recorder.finish();
}

}  // namespace slipbench
