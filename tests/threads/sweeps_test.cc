// Sweeps by four threads without reports of the thread sanitizer: with halt_on_error=1 a race ends
// the test.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/tools/dataset/record/test_records.h"
#include "tools/registry/program_catalogues.h"
#include "tools/trial/sweep/run_sweep.h"

namespace slipbench::testing {
namespace {

// Scenes that use every sensor, both fidelities, spectra, a detector and controllers in several
// threads at once, as short as possible.
struct Sweep {
  std::string scene;
  std::vector<Override> overrides;
};
void PrintTo(const Sweep& sweep, std::ostream* out) { *out << sweep.scene; }

class Threads : public FolderTest, public ::testing::WithParamInterface<Sweep> {};

TEST_P(Threads, SweepWithoutARace) {
  constexpr std::size_t trials = 6;  // so that a thread begins a second trial while others are in their first
  SweepOptions options;
  options.scene_path = SLIPBENCH_SOURCE_DIR "/scenes/" + GetParam().scene;
  options.overrides = GetParam().overrides;
  options.limit = trials;
  options.jobs = 4;
  options.output = path("out.h5");
  EXPECT_EQ(run_sweep(options, program_catalogues()).trials.size(), trials);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Threads,
                         ::testing::Values(Sweep{"papillarray/hexapod.yaml", {{"duration", "0.3 s"}}},
                                           Sweep{"papillarray/stage.yaml", {{"duration", "0.3 s"}, {"fidelity", "articulated"}}},
                                           Sweep{"piezo_skin/slide.yaml", {{"duration", "1 s"}}},
                                           Sweep{"biotac_sp/slip.yaml", {{"duration", "0.5 s"}}},
                                           Sweep{"nib_pad/linear.yaml", {{"duration", "1 s"}}},
                                           Sweep{"nib_pad/reorient.yaml", {{"duration", "2 s"}}},
                                           Sweep{"myrmex/slip.yaml", {{"duration", "1 s"}}},
                                           Sweep{"grasp/lift.yaml", {{"duration", "2 s"}, {"motion.distance", "10 mm"}}}));

}  // namespace
}  // namespace slipbench::testing
