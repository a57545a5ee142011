// Times one reading of the nib pad (2,400 per second). Run with --benchmark_repetitions=9 and read
// the medians.
#include <benchmark/benchmark.h>

#include "tests/sensors/nib_pad/rig.h"

namespace slipbench::nib_pad_test {
namespace {

void reading(benchmark::State& state, const std::string& scan, bool typical) {
  Parameters parameters = defaults_of(nib_pad_sensor().about.parameters);
  parameters.set("scan", scan);
  std::vector<Named> parts;
  for (const Entry& entry : nib_pad_sensor().electronics) {
    if (typical) parts.push_back({entry.name, defaults_of(entry.parameters)});
  }
  const auto sensor = nib_pad_sensor().create(parameters, parts, 1, 0, "pad");
  const ContactFrame truth = contact(0.3, 0.2e-3, -0.1e-3);
  for (auto _ : state) benchmark::DoNotOptimize(sensor->measure(truth).values.data());
}

BENCHMARK_CAPTURE(reading, multiplexed_ideal, "multiplexed", false);
BENCHMARK_CAPTURE(reading, multiplexed_typical, "multiplexed", true);
BENCHMARK_CAPTURE(reading, simultaneous_typical, "simultaneous", true);

}  // namespace
}  // namespace slipbench::nib_pad_test

BENCHMARK_MAIN();
