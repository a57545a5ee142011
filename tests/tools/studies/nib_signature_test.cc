// Where the nib pad's signal below 8 Hz comes from, on the bench itself: the patches of friction, not its growth with speed.
#include "tools/studies/nib_reconfigurable/nib_signature.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/scenes.h"
#include "tools/program/run/run_trial.h"

namespace slipbench::reproduce::nib_signature_test {
namespace {

#ifdef SLIPBENCH_WITH_MUJOCO

// The slow release of the scene's own plate, paper pulled by 3 N, under a law of friction_laws().
std::optional<Signature> signature_under(const std::string& law) {
  Scene scene = parsed(shipped("nib_pad/release.yaml", {{"sweep", "{}"}}));
  std::ranges::find(friction_laws(), law, &FrictionLaw::name)->change(scene);
  return signature_of(scene, NibTrace(run_trial(scene, 0, Recording::full).record));
}

TEST(NibSignature, PatchesPutTheEnergyOfSlipBelow8HzAndTheRateLawAloneDoesNot) {
  const std::optional<Signature> patches = signature_under("scene"), smooth = signature_under("no_patches");
  // White noise of 1.2 counts a cluster, 1.7 of their difference, has 8 of its 150 Hz below 8 Hz: 0.053 of the energy, 0.39 counts rms. Patches
  // must make five times of either; without them little more than the noise is left.
  constexpr double noise_share = 8.0 / 150.0;
  const double noise_below = 1.2 * std::sqrt(2.0 * noise_share);
  ASSERT_TRUE(patches.has_value());
  EXPECT_GT(patches->share, 5.0 * noise_share);
  EXPECT_GT(patches->below, 5.0 * noise_below);
  ASSERT_TRUE(smooth.has_value());
  EXPECT_LT(smooth->share, 3.0 * noise_share);
}

#endif

}  // namespace
}  // namespace slipbench::reproduce::nib_signature_test
