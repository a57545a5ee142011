// Oracle 2: a sphere pressed into a flat Winkler field. Pressure p(r) = p_0 (1 - r^2/a^2) and a
// uniform stretch s: elements with k_t s > mu k_n delta(r) slip, so the stuck radius obeys 1 -
// c^2/a^2 = s/s_m, s_m = mu k_n delta_0/k_t. Force per area: inside c:  k_t s;  outside: mu k_n
// delta_0 (1 - r^2/a^2). With x = c^2/a^2 the sum over the disc is
//   T = pi a^2 [k_t s x + mu k_n delta_0 (1 - x)^2/2],  k_t s = mu k_n delta_0 (1 - x),  mu N = pi a^2 mu k_n delta_0/2
//   T/(mu N) = 2 x (1 - x) + (1 - x)^2 = 1 - x^2,  so  c/a = (1 - T/(mu N))^(1/4).

#include <gtest/gtest.h>

#include "tests/oracle/pads.h"

namespace slipbench::oracle::winkler_indenter_test {
namespace {

struct Stuck {
  double ratio;     // c/a from the stuck elements
  double expected;  // from T and N
};

// A grid of n x n elements against a sphere pressed in and moved sideways by `share` of the
// distance to gross slip.
Stuck press_and_shear(int n, double share) {
  const double radius = 20e-3, depth = 0.2e-3, mu = 0.5, k_n = 1000.0, k_t = 600.0;
  const double contact_radius = std::sqrt(2.0 * radius * depth);
  const PadLayout pad = square_grid(n, 2.2 * contact_radius, k_n, k_t);
  Field field(pad, Sphere{radius}, {mu, mu});
  const double way = share * mu * k_n * depth / k_t;
  const int steps = 200;
  for (int i = 0; i <= steps; ++i) {
    Pose pose;
    pose.position = {way * i / steps, 0.0, radius - depth};
    field.step(pose, 1e-3);
  }
  double stuck = 0.0, touching = 0.0, normal = 0.0, tangential = 0.0;
  for (std::size_t i = 0; i < field.size(); ++i) {
    if (field.state(i) == ElementState::detached) continue;
    touching += 1.0;
    stuck += field.state(i) == ElementState::stick ? 1.0 : 0.0;
    normal += field.normal_force(i);
    tangential += field.tangential_force(i).norm();
  }
  return {std::sqrt(stuck / touching), std::pow(1.0 - tangential / (mu * normal), 0.25)};
}

TEST(WinklerIndenter, StuckRadiusConvergesToTheQuarterPower) {
  for (const double share : {0.2, 0.5, 0.8}) {
    // n = 64: 4,096 elements, about 2,660 of them in contact. The boundary of the stuck disc of
    // radius c crosses about 2 pi c/h cells of side h; counting whole cells gives an error of at
    // most half a cell, h/2, in c. With a = n h/2.2 that is (h/2)/a = 1.1/n in c/a.
    for (const int n : {16, 32, 64}) {
      const Stuck stuck = press_and_shear(n, share);
      EXPECT_NEAR(stuck.ratio, stuck.expected, 1.1 / n) << "share " << share << ", n " << n;
    }
  }
}

TEST(WinklerIndenter, ExponentIsNotThatOfAHalfSpace) {
  // At half the distance x = c^2/a^2 = 0.5 and T/(mu N) = 0.75, so c/a = 0.707 here and (1 -
  // 0.75)^(1/3) = 0.630 on a half-space (Cattaneo-Mindlin): 0.077 apart, four times the error of
  // the grid of 64 (1.1/64 = 0.017).
  const Stuck stuck = press_and_shear(64, 0.5);
  EXPECT_NEAR(stuck.ratio, std::sqrt(0.5), 1.1 / 64);
  EXPECT_GT(stuck.ratio - std::cbrt(0.25), 0.05);
}

}  // namespace
}  // namespace slipbench::oracle::winkler_indenter_test
