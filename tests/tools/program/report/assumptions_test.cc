#include "tools/program/report/report_parts.h"

#include <string>

#include <gtest/gtest.h>

#include "sim/core/error.h"

namespace slipbench::report {
namespace {

const std::string lift_text =
    "slipbench: 1\nsurface: {material: felt}\nbox: {mass: 0.5 kg, size: [50 mm, 60 mm, 90 mm]}\ngrip: {protocol: as_printed}\n"
    "motion: {kind: lift, distance: 80 mm}\n";

Json rows(const std::string& text = lift_text, const Json& overrides = Json::object(), const Json& swept = Json::object()) {
  return grasp_parameters(text, overrides, swept, "lift.h5: attribute scene");
}

Json row(const Json& rows, const std::string& path) {
  for (const Json& candidate : rows) {
    if (candidate.at("path") == path) return candidate;
  }
  return nullptr;
}

void expect_row(const Json& found, const std::string& value, const std::string& by, bool assumed) {
  ASSERT_FALSE(found.is_null());
  EXPECT_EQ(found.at("value"), value) << found;
  EXPECT_EQ(found.at("by"), by) << found;
  EXPECT_EQ(found.at("assumed").get<bool>(), assumed) << found;
}

TEST(GraspParameters, SayWhoSetThemAndWhetherTheyAreAssumed) {
  const Json all = rows();
  expect_row(row(all, "box.mass"), "0.5 kg", "scene", true);
  expect_row(row(all, "box.size"), "[50 mm, 60 mm, 90 mm]", "scene", true);
  expect_row(row(all, "grip.stiffness"), "[8 N/mm, 15 N/mm, 15 N/mm]", "default", true);
  expect_row(row(all, "grip.count"), "0.374 mm", "default", false);
  expect_row(row(all, "grip.preset"), "1 N", "protocol", false);      // as the paper prints it
  expect_row(row(all, "motion.speed"), "5 mm/s", "protocol", false);  // likewise
  expect_row(row(all, "motion.distance"), "80 mm", "scene", false);   // recorded
  expect_row(row(all, "surface.material"), "felt", "scene", true);
}

TEST(GraspParameters, ProtocolIsAsRecordedUnlessSaid) {
  expect_row(row(rows("slipbench: 1\nbox: {mass: 0.2 kg}\nmotion: {kind: lift}\n"), "motion.speed"), "43 mm/s", "protocol",
             false);
}

TEST(GraspParameters, CommandLineCountsAsTheScene) {
  expect_row(row(rows(lift_text, {{"grip.latency", "40 ms"}}), "grip.latency"), "40 ms", "scene", true);
}

// Neither the scene's value nor the protocol's is that of every trial.
TEST(GraspParameters, SweptValuesAreNotShown) {
  const Json all = rows(lift_text, Json::object(), {{"box.size.0", 1}, {"grip.protocol", 1}});
  expect_row(row(all, "box.size"), "", "sweep", true);
  expect_row(row(all, "motion.speed"), "43 mm/s", "default", false);
}

TEST(GraspParameters, ScatterIsThereWhenTheSceneHasIt) {
  EXPECT_TRUE(row(rows(), "scatter.yaw").is_null());
  expect_row(row(rows(lift_text + "scatter: {}\n"), "scatter.yaw"), "1 deg", "default", true);
}

TEST(GraspParameters, AreThoseOfEverythingThatTheSceneNames) {
  const Json all = rows(lift_text +
                        "friction: {static: 0.3}\neffects: [{anisotropic_friction: {ratio: 0.7}}, patchy_friction]\n"
                        "sensors: {left: {type: papillarray}}\ndetector: {type: force_ratio, ratio: 0.2}\n"
                        "controller: {type: step_on_slip}\n");
  expect_row(row(all, "friction.static"), "0.3", "scene", true);
  expect_row(row(all, "effects.0.anisotropic_friction.ratio"), "0.7", "scene", true);
  EXPECT_FALSE(row(all, "effects.1.patchy_friction.sd").is_null());
  expect_row(row(all, "sensors.left.damping"), "1 ms", "default", true);
  EXPECT_FALSE(row(all, "sensors.left.bristles").is_null());
  expect_row(row(all, "detector.ratio"), "0.2", "scene", true);
  expect_row(row(all, "controller.force_per_count"), "1.6 N", "default", true);
}

TEST(GraspParameters, ContactIsThereWithItsFidelity) {
  EXPECT_TRUE(row(rows(), "contact.noslip").is_null());
  const std::string own = lift_text + "fidelity: mujoco_contact\n";
  const Json all = rows(own + "contact: {noslip: 10, solref: [0.001, 1]}\n");
  expect_row(row(all, "contact.noslip"), "10", "scene", false);
  expect_row(row(all, "contact.solref"), "[0.001, 1]", "scene", false);
  expect_row(row(all, "contact.cone"), "pyramidal", "default", false);
  expect_row(row(all, "contact.tip_mass"), "0.1 g", "default", true);
  expect_row(row(rows(own), "contact.noslip"), "0", "default", false);
  expect_row(row(rows(own, {{"contact", "{noslip: 3}"}}), "contact.noslip"), "3", "scene", false);
  expect_row(row(rows(own, Json::object(), {{"contact.noslip", 1}}), "contact.noslip"), "", "sweep", false);
  EXPECT_TRUE(row(rows(own, Json::object(), {{"fidelity", 1}}), "contact.noslip").is_null());
  EXPECT_FALSE(row(rows(lift_text, {{"fidelity", "mujoco_contact"}}), "contact.noslip").is_null());
}

TEST(GraspParameters, RefusesOverridesThatDoNotFit) {
  EXPECT_THROW(rows(lift_text, {{"slipbench.a", "1"}}), InputError);
  EXPECT_THROW(rows(lift_text, {{"box.mass", 1}}), InputError);
}

}  // namespace
}  // namespace slipbench::report
