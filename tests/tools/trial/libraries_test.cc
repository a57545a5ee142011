#include "tools/trial/libraries.h"

#include <gtest/gtest.h>

namespace slipbench {
namespace {

Scene scene_of(const char* detector = nullptr) {
  Scene scene;
  scene.sensors.push_back({.name = "pad", .type = "papillarray", .parameters = {}, .electronics = {}});
  if (detector != nullptr) scene.detector = DetectorScene{.type = detector, .sensor = 0, .parameters = {}};
  return scene;
}

TEST(Libraries, AreNamedWhereOthersCompute) {
  EXPECT_EQ(libraries_of(scene_of()), "");
  EXPECT_EQ(libraries_of(scene_of("force_ratio")), "");
  EXPECT_EQ(libraries_of(scene_of("band_energy")), "FFTW");
  EXPECT_EQ(libraries_of(scene_of("network")), "FFTW, network");
  EXPECT_EQ(libraries_of(scene_of("plugin")), "user's library");
  EXPECT_EQ(libraries_of(scene_of("registered_by_a_program")), "user's library");
  Scene articulated = scene_of();
  articulated.fidelity = "mujoco_contact";
  EXPECT_EQ(libraries_of(articulated), "MuJoCo");
  Scene held = scene_of("nib_slip_kind");
  held.bodies.emplace_back();
  held.effects.push_back({"elastic_skin", {}});
  EXPECT_EQ(libraries_of(held), "MuJoCo, FFTW");
}

}  // namespace
}  // namespace slipbench
