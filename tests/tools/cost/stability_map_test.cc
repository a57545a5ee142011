#include "tools/cost/stability_map.h"

#include <cmath>
#include <set>

#include "tests/expect.h"

namespace slipbench::cost {
namespace {

// Measured once for all tests of this file.
const StabilityMap& map() {
  static const StabilityMap measured = measure_stability({.every = 7});
  return measured;
}

// The limit: within 20 % of the measured value, and never above it. Both are known better: 1 % is
// subtracted from the prediction, the measurement is at most 0.5 % too large (step_probe.h), and
// turning loads contribute 0.3 %.
TEST(StabilityMap, PredictsTheMeasuredLimitAndNeverExceedsIt) {
  ASSERT_GE(map().combinations.size(), 50U);
  for (const StabilityCombination& c : map().combinations) {
    const std::string which = c.set_up + ", " + c.integrator + ", " + std::to_string(c.mass) + " kg, x" +
                              std::to_string(c.stiffness_scale) + ", " + std::to_string(c.damping) + " s";
    EXPECT_LE(c.predicted, c.measured) << which;
    EXPECT_GE(c.predicted, 0.8 * c.measured) << which;
    EXPECT_LT(c.allowed, 0.8 * c.predicted) << which;
  }
  EXPECT_EQ(map().above(), 0U);
  EXPECT_GT(map().worst_ratio(), 0.98);
}

// As documented in the header: the tested part has every set-up, integrator and range of the whole
// map.
TEST(StabilityMap, SpansMassStiffnessDampingAndIntegrator) {
  std::set<std::string> set_ups, integrators;
  std::set<double> masses, scales, dampings;
  for (const StabilityCombination& c : map().combinations) {
    set_ups.insert(c.set_up);
    integrators.insert(c.integrator);
    masses.insert(c.mass);
    scales.insert(c.stiffness_scale);
    dampings.insert(c.damping);
    EXPECT_DOUBLE_EQ(c.k_normal, 7100.0 * c.stiffness_scale);
  }
  EXPECT_EQ(set_ups.size(), 4U);
  EXPECT_THAT(integrators, ElementsAre("Euler", "RK4", "discrete", "implicit", "implicitfast"));
  EXPECT_THAT(masses, ElementsAre(0.005, 0.05, 0.5, 5.0));
  EXPECT_THAT(scales, ElementsAre(0.1, 1.0, 10.0, 100.0));
  EXPECT_THAT(dampings, ElementsAre(0.0, 1e-4, 1e-3));
}

// One undamped box between two pads: the fastest mode is along the normals, with only 18 k_n
// against the box's mass, and the limit is 2/omega, RK4's sqrt(8)/omega.
TEST(StabilityMap, MeasuredLimitIsTheClosedForm) {
  int found = 0;
  for (const StabilityCombination& c : map().combinations) {
    if (c.set_up != "two pads hold a box" || c.damping != 0.0) continue;
    ++found;
    const double omega = std::sqrt(18.0 * c.k_normal / c.mass), limit = (c.integrator == "RK4" ? std::sqrt(8.0) : 2.0) / omega;
    EXPECT_NEAR(c.omega, omega, 1e-3 * omega);
    EXPECT_NEAR(c.measured, limit, 2e-3 * limit);
    EXPECT_NEAR(c.allowed, 0.75 / omega, 1e-3 / omega);
  }
  EXPECT_GE(found, 4);
}

TEST(StabilityMap, TellsItselfAsJsonAndAsText) {
  StabilityMap two;
  two.combinations.push_back({"two pads hold a box", "Euler", 0.005, 1.0, 7100.0, 1e-3, 5000.0, 1.5e-4, 4e-5, 2e-4});
  two.combinations.push_back({"one pad under a box", "RK4", 5.0, 10.0, 71000.0, 0.0, 500.0, 6e-3, 1.5e-3, 5e-3});
  const Json json = stability_json(two);
  EXPECT_EQ(json["slipbench_stability"], 1);
  EXPECT_DOUBLE_EQ(json["worst_ratio"].get<double>(), 0.75);
  EXPECT_EQ(json["above"], 1);
  EXPECT_EQ(json["combinations"][0].dump(),
            R"({"case":"two pads hold a box","integrator":"Euler","mass_kg":0.005,"stiffness_scale":1.0,"k_normal":7100.0,)"
            R"("damping_s":0.001,"omega":5000.0,"predicted_s":0.00015,"allowed_s":4e-05,"measured_s":0.0002,"ratio":)" +
                Json(1.5e-4 / 2e-4).dump() + "}");
  EXPECT_GE(json["text"].size(), 4U);
  EXPECT_THAT(json["remarks"][1].get<std::string>(), HasSubstr("Ratio farthest from 1: two pads hold a box, Euler, 0.005 kg"));
  const std::string text = stability_text(two);
  EXPECT_THAT(text, HasSubstr("two pads hold a box"));
  EXPECT_THAT(
      text,
      HasSubstr(
          "2 combinations: the predicted longest stable step is at least 0.7500 of the measured one, and longer than it in 1 cases."));
}

}  // namespace
}  // namespace slipbench::cost
