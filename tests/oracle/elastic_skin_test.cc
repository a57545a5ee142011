// Oracle: an elastic half-space, incompressible, touched by a rigid sphere of radius R
// ([johnson1985], ch. 4 and 7). At the depth d, with E* = 4 G and mu:
// - Hertz: a = sqrt(R d), N = (16/3) G sqrt(R) d^1.5, p = p0 sqrt(1 - r^2/a^2), p0 = 3 N/(2 pi
//   a^2); the second moment of p is (2/5) a^2 N.
// - Cattaneo and Mindlin: all slides from delta_f = 3 mu N (2 - nu)/(16 G a) = 9 mu N/(32 G a)
//   on; before that T = mu N [1 - (1 - delta/delta_f)^1.5], and the stuck disc has the radius c = a
//   sqrt(1 - delta/delta_f).
// - Mindlin and Deresiewicz: unloading from (delta*, T*) follows T* - 2 T((delta* - delta)/2), so a
//   full cycle between -delta* and delta* takes 8 Int_0^delta* T dx - 4 T* delta*, Int_0^x T = mu N
//   [x - (2/5) delta_f (1 - (1 - x/delta_f)^2.5)].
// - Lubkin: twisted until the disc of radius c sticks. With g(t) of q(r) = -d/dr Int_r^a g/sqrt(t^2
//   - r^2) dt the torque is 4 pi Int g t dt, and a surface that turns by beta has g = (4 G beta/pi)
//   t. Outside c the traction is mu p, hence g_s = (2 t/pi) Int_t^a mu p/sqrt(r^2 - t^2) dr; the
//   traction is continuous at c, so beta = (pi/4 G) g_s(c)/c.
//
// The theory assumes slip opposite to the load everywhere, which does not hold for nu = 1/2: as the
// grid is refined T stays .2 % of mu N off.
#include <array>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "sim/effects/skin/elastic_contact.h"
#include "tests/oracle/effect_field.h"
#include "tests/oracle/pads.h"

namespace slipbench::oracle::elastic_skin_test {
namespace {

constexpr double pi = std::numbers::pi;
// Slopes within the contact stay below a/R = 0.06, whose square the theory neglects.
constexpr double radius = 40e-3, depth = 0.15e-3, mu = 0.8;
constexpr std::array moduli{15e3, 150e3, 1.5e6};
constexpr std::array grids{12, 16, 24, 32, 48};

struct Hertz {
  explicit Hertz(double shear_modulus) : g(shear_modulus) {}
  double g;
  double a = std::sqrt(radius * depth);
  double n = 16.0 / 3.0 * g * std::sqrt(radius) * std::pow(depth, 1.5);
  double slides_at = 9.0 * mu * n / (32.0 * g * a);

  [[nodiscard]] double left(double way) const { return std::max(0.0, 1.0 - way / slides_at); }
  [[nodiscard]] double tangential(double way) const { return mu * n * (1.0 - std::pow(left(way), 1.5)); }
  [[nodiscard]] double stuck_radius(double way) const { return a * std::sqrt(left(way)); }
};

// A pad of n x n elements over 2.4 a, pressed on the sphere.
Field pressed(int n, const Hertz& hertz) {
  Field field = field_with_effect(square_grid(n, 2.4 * hertz.a, 1.0, 1.0), {mu, mu}, "elastic_skin", {{"shear_modulus", hertz.g}},
                                  Sphere{radius});
  return field;
}

Pose over(double x, double angle = 0.0) { return turned(angle, {x, 0.0, radius - depth}); }

struct Sums {
  double normal = 0.0, moment = 0.0, tangential = 0.0, torque = 0.0, stuck = 0.0;
};

Sums sums_of(const Field& field) {
  Sums sums;
  for (std::size_t i = 0; i < field.size(); ++i) {
    const Eigen::Vector3d& tip = field.layout().elements[i].tip;
    const double along = field.normal_force(i) * field.normal(i).z();
    sums.normal += along;
    sums.moment += along * (tip.x() * tip.x() + tip.y() * tip.y());
    const Eigen::Vector3d t = field.tangential_force(i);
    sums.tangential += t.x();
    sums.torque += field.contact_point(i).x() * t.y() - field.contact_point(i).y() * t.x();
    sums.stuck += field.state(i) == ElementState::stick ? 1.0 : 0.0;
  }
  return sums;
}

TEST(ElasticSkin, PressesAsHertzSays) {
  for (const double g : moduli) {
    const Hertz hertz(g);
    double before = 1.0;
    for (const int n : grids) {
      Field field = pressed(n, hertz);
      field.step(over(0.0), 1e-3);
      const Sums sums = sums_of(field);
      const double error = std::abs(sums.normal / hertz.n - 1.0);
      EXPECT_LT(error, 0.01) << n;
      EXPECT_LT(error, before) << "an error that does not fall as the grid is refined, " << n;
      before = error;
      EXPECT_NEAR(std::sqrt(2.5 * sums.moment / sums.normal) / hertz.a, 1.0, 0.01) << n;
    }
  }
}

// Pushed sideways to 1.2 times the distance at which all slides, in steps of a hundredth. T is
// exact within the error of cells of 2.4 a/n; the stuck disc is exact within a cell as long as its
// edge moves by less than that when T is .2 % off: until all but 1 % of the friction is used.
TEST(ElasticSkin, SlipsInwardsAsCattaneoAndMindlinSay) {
  for (const double g : moduli) {
    const Hertz hertz(g);
    for (const int n : grids) {
      Field field = pressed(n, hertz);
      field.step(over(0.0), 1e-3);
      const double cell = 2.4 * hertz.a / n, allowed = n < 16 ? 0.01 : n < 32 ? 0.005 : 0.0025;
      for (int k = 1; k <= 120; ++k) {
        const double way = 0.01 * k * hertz.slides_at;
        field.step(over(way), 1e-3);
        const Sums sums = sums_of(field);
        const double expected = hertz.tangential(way);
        EXPECT_NEAR(sums.tangential / (mu * hertz.n), expected / (mu * hertz.n), allowed) << n << " at " << k << " %";
        if (expected > 0.99 * mu * hertz.n || expected == 0.0) continue;
        EXPECT_NEAR(std::sqrt(sums.stuck * cell * cell / pi), hertz.stuck_radius(way), cell) << n << " at " << k << " %";
      }
      EXPECT_EQ(field.slipping(), field.touching()) << n;
    }
  }
}

TEST(ElasticSkin, LosesInACycleWhatMindlinAndDeresiewiczSay) {
  const Hertz hertz(150e3);
  const double most = 0.8 * hertz.slides_at;
  const double left = std::pow(1.0 - most / hertz.slides_at, 2.5);
  const double under = mu * hertz.n * (most - 0.4 * hertz.slides_at * (1.0 - left));
  const double expected = 8.0 * under - 4.0 * hertz.tangential(most) * most;
  for (const int n : {16, 32}) {
    Field field = pressed(n, hertz);
    field.step(over(0.0), 1e-3);
    constexpr int quarter = 60;
    double work = 0.0, slid = 0.0, way = 0.0, force = 0.0;
    const auto go = [&](int from, int to, bool counts) {
      for (int k = from; k != to; k += to > from ? 1 : -1) {
        const double next = most * (k + (to > from ? 1 : -1)) / quarter;
        field.step(over(next), 1e-3);
        const double now = sums_of(field).tangential;
        if (counts) work += 0.5 * (now + force) * (next - way);
        if (counts) slid += field.spring_sums().slip_loss;
        way = next;
        force = now;
      }
    };
    go(0, quarter, false);
    go(quarter, -quarter, true);
    go(-quarter, quarter, true);
    EXPECT_NEAR(work / expected, 1.0, 0.01) << n;
    EXPECT_NEAR(slid / expected, 1.0, 0.03) << n << ": forces at the end of a step against a trapezoid, one step of 120 a branch";
  }
}

TEST(ElasticSkin, TwistsAsLubkinSays) {
  const Hertz hertz(150e3);
  const double a = hertz.a, p0 = 1.5 * hertz.n / (pi * a * a);
  // Int_t^a mu p/sqrt(r^2 - t^2) dr with r^2 = t^2 + (a^2 - t^2) sin^2 s, which removes both roots.
  const auto inner = [&](double t) {
    constexpr int pieces = 400;
    double sum = 0.0;
    for (int k = 0; k < pieces; ++k) {
      const double s = 0.5 * pi * (k + 0.5) / pieces, room = a * a - t * t;
      sum += room * std::cos(s) * std::cos(s) / std::sqrt(t * t + room * std::sin(s) * std::sin(s));
    }
    return mu * p0 / a * sum * 0.5 * pi / pieces;
  };
  const auto sliding = [&](double t) { return 2.0 * t / pi * inner(t); };
  for (const int n : {16, 32}) {
    Field field = pressed(n, hertz);
    field.step(over(0.0), 1e-3);
    const double full = 3.0 * pi / 16.0 * mu * hertz.n * a;
    double angle = 0.0;
    for (const double share : {0.9, 0.7, 0.5, 0.3}) {  // c/a
      const double c = share * a, beta = pi / (4.0 * hertz.g) * sliding(c) / c;
      double torque = 16.0 / 3.0 * hertz.g * beta * c * c * c;
      constexpr int pieces = 400;
      for (int k = 0; k < pieces; ++k) {
        const double t = c + (a - c) * (k + 0.5) / pieces;
        torque += 4.0 * pi * sliding(t) * t * (a - c) / pieces;
      }
      constexpr int steps = 40;
      for (int k = 1; k <= steps; ++k) field.step(over(0.0, angle + (beta - angle) * k / steps), 1e-3);
      angle = beta;
      // The pad turns by beta, the surface is fixed: the pad's torque on the surface has the same
      // direction.
      EXPECT_NEAR(sums_of(field).torque / full, torque / full, 0.01) << n << " at c = " << share << " a";
      EXPECT_NEAR(std::sqrt(sums_of(field).stuck) * 2.4 / n / std::sqrt(pi), share, 2.4 / n) << n;
    }
    for (int k = 1; k <= 100; ++k) field.step(over(0.0, angle + 2.0 * angle * k / 100), 1e-3);
    EXPECT_NEAR(sums_of(field).torque / full, 1.0, 0.01) << n;
  }
}

// First guesses extrapolate the step before. A small bias would accumulate over thousands of steps.
TEST(ElasticSkin, SinksByWhatItsForcesSayAfterManySmallSteps) {
  constexpr int n = 12, steps = 4000;
  const PadLayout layout = square_grid(n, 2.4 * std::sqrt(radius * depth), 1.0, 1.0);
  const ElasticBody body{150e3, std::numeric_limits<double>::infinity()};
  ElasticContact contact(make_influence(layout, body, 0.0), n * n, 1e-7);
  Eigen::ArrayXd gap(n * n), limit(n * n);
  Eigen::ArrayX2d target(n * n, 2);
  for (int k = 1; k <= steps; ++k) {
    for (Eigen::Index i = 0; i < gap.size(); ++i) {
      gap[i] = layout.elements[static_cast<std::size_t>(i)].tip.squaredNorm() / (2.0 * radius) - depth * k / steps;
    }
    contact.press(gap);
    limit = mu * contact.pressure();
    target.col(0).setConstant(1e-5 * k / steps);
    target.col(1).setConstant(1e-6 * std::sin(0.01 * k));
    contact.shear(target, limit);
  }
  const auto fresh = make_influence(layout, body, 0.0);
  Eigen::ArrayXd sunk(n * n), x(n * n), y(n * n);
  fresh->press(contact.pressure().data(), sunk.data());
  fresh->shear(contact.friction().col(0).data(), contact.friction().col(1).data(), x.data(), y.data());
  constexpr double rounding =
      1e-10;  // of the largest; a random walk of 4000 guesses, each extrapolated from the last, adds 4000^1.5 times 1e-16
  EXPECT_LT((contact.sunk() - sunk).abs().maxCoeff(), rounding * depth);
  EXPECT_LT((contact.shift().col(0) - x).abs().maxCoeff(), rounding * 1e-5);
  EXPECT_LT((contact.shift().col(1) - y).abs().maxCoeff(), rounding * 1e-5);
}

// Without friction all elements slip freely; a kinetic coefficient of 0 applies once the static
// limit is exceeded.
TEST(ElasticSkin, SlipsWithoutFriction) {
  const Hertz hertz(150e3);
  for (const Friction friction : {Friction{0.0, 0.0}, Friction{0.5, 0.0}}) {
    Field field = field_with_effect(square_grid(16, 2.4 * hertz.a, 1.0, 1.0), friction, "elastic_skin",
                                    {{"shear_modulus", hertz.g}}, Sphere{radius});
    field.step(over(0.0), 1e-3);
    double slid = 0.0;
    for (int k = 1; k <= 100; ++k) {
      field.step(over(0.005 * k * hertz.slides_at), 1e-3);
      slid += field.slip_step(16 * 8 + 8).x();
    }
    EXPECT_EQ(field.slipping(), field.touching());
    EXPECT_EQ(sums_of(field).tangential, 0.0);
    EXPECT_GT(slid, 0.2 * hertz.slides_at);
  }
}

// A resting pad is not recomputed: its readers' values must come with its state.
TEST(ElasticSkin, RestsAlikeFromASavedState) {
  const Hertz hertz(150e3);
  Field lasting = pressed(12, hertz), fresh = pressed(12, hertz), used = pressed(12, hertz);
  for (const double x : {0.0, 1e-4}) lasting.step(over(x), 1e-3);
  used.step(over(-5e-4), 1e-3);
  std::vector<double> state(lasting.state_size());
  lasting.save_state(state);
  std::vector<double> depth(144), x(144), y(144), z(144);
  const auto seen = [&](Field& field) {
    for (auto* column : {&depth, &x, &y, &z}) std::fill(column->begin(), column->end(), 0.0);
    field.view_from_pad();
    field.add_elements(field.all(), depth.data(), {x.data(), y.data(), z.data()});
    const Wrench wrench = field.wrench_on_pad();
    std::vector<double> all(depth);
    for (const auto* column : {&x, &y, &z}) all.insert(all.end(), column->begin(), column->end());
    all.insert(all.end(), wrench.force.begin(), wrench.force.end());
    return all;
  };
  fresh.load_state(state);
  used.load_state(state);
  for (Field* field : {&lasting, &fresh, &used}) field->step(over(1e-4), 1e-3);
  const std::vector<double> expected = seen(lasting);
  EXPECT_EQ(seen(fresh), expected);
  EXPECT_EQ(seen(used), expected);
}

// The layer of one wave: u = U(z) sin kx, w = W(z) cos kx with k U + W' = 0, stresses tau and S,
//   U' = tau/G + k W,  W' = -k U,  tau' = k S + 4 G k^2 U,  S' = -k tau;  across: V' = tau/G, tau' = k^2 G V,
// integrated from the fixed back by Runge and Kutta's fourth order.
struct Wave {
  double u, w, tau, s;
};
Wave from_the_back(double thickness, Wave y) {  // G = k = 1
  const auto slope = [](const Wave& v) { return Wave{v.tau + v.w, -v.u, v.s + 4.0 * v.u, -v.tau}; };
  const auto add = [](const Wave& v, double h, const Wave& d) {
    return Wave{v.u + h * d.u, v.w + h * d.w, v.tau + h * d.tau, v.s + h * d.s};
  };
  constexpr int steps = 4000;
  const double h = thickness / steps;
  for (int k = 0; k < steps; ++k) {
    const Wave k1 = slope(y), k2 = slope(add(y, 0.5 * h, k1)), k3 = slope(add(y, 0.5 * h, k2)), k4 = slope(add(y, h, k3));
    for (const auto& [share, d] : {std::pair{1.0, k1}, {2.0, k2}, {2.0, k3}, {1.0, k4}}) y = add(y, share * h / 6.0, d);
  }
  return y;
}

TEST(ElasticLayer, GivesAsItsDifferentialEquationSays) {
  for (const double s : {0.05, 0.3, 1.0, 3.0}) {
    const Wave a = from_the_back(s, {0.0, 0.0, 1.0, 0.0}), b = from_the_back(s, {0.0, 0.0, 0.0, 1.0});
    const double determinant = a.tau * b.s - b.tau * a.s;
    const double pressed_w = (a.tau * b.w - b.tau * a.w) / determinant;  // tau = 0, S = 1 on top
    const double pushed_u = (b.s * a.u - a.s * b.u) / determinant;       // tau = 1, S = 0
    double v = 0.0, tau = 1.0;                                           // across, by the same steps
    constexpr int steps = 4000;
    for (int k = 0; k < steps; ++k) {
      const double h = s / steps;
      const double v1 = tau, t1 = v, v2 = tau + 0.5 * h * t1, t2 = v + 0.5 * h * v1, v3 = tau + 0.5 * h * t2,
                   t3 = v + 0.5 * h * v2;
      const double v4 = tau + h * t3, t4 = v + h * v3;
      v += h / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4);
      tau += h / 6.0 * (t1 + 2.0 * t2 + 2.0 * t3 + t4);
    }
    const LayerCompliance law = layer_compliance(s);
    EXPECT_NEAR(0.5 * law.normal / pressed_w, 1.0, 1e-6) << s;
    EXPECT_NEAR(0.5 * law.along / pushed_u, 1.0, 1e-6) << s;
    EXPECT_NEAR(law.across / (v / tau), 1.0, 1e-6) << s;
  }
  // Thin: k^2 t^3/(3 G) and t/G; thick: 1/(2 G k), 1/(G k).
  const LayerCompliance thin = layer_compliance(0.03), thick = layer_compliance(6.0);
  EXPECT_NEAR(0.5 * thin.normal / (0.03 * 0.03 * 0.03 / 3.0), 1.0, 0.01);
  EXPECT_NEAR(0.5 * thin.along / 0.03, 1.0, 0.01);
  EXPECT_NEAR(thin.across / 0.03, 1.0, 0.01);
  for (const double part : {thick.normal, thick.along, thick.across}) EXPECT_NEAR(part, 1.0, 0.01);
}

// A pad on a thick layer behaves as on a half-space: the back reduces a disc's compliance by 1.17
// a/t ([johnson1985], sec. 5.8), 0.1 % at 1,000 pads. A pad on a thin layer shifts by t/G per unit
// of traction, except strips of the order of t along its edges; extrapolating two layers, one half
// as thick, leaves an error of second order.
TEST(ElasticLayer, IsAHalfSpaceWhereThickAndSpringsWhereThin) {
  const double side = 2.4e-3, g = 150e3;
  const auto stiffness = [&](int n, double thickness) {
    Field field = field_with_effect(square_grid(n, side, 1.0, 1.0), {1e3, 1e3}, "elastic_skin",
                                    {{"shear_modulus", g}, {"thickness", thickness}});
    field.step(turned(0.0, {0.0, 0.0, -1e-6}), 1e-3);
    double normal = 0.0, tangential = 0.0;
    for (std::size_t i = 0; i < field.size(); ++i) normal += field.normal_force(i);
    field.step(turned(0.0, {1e-9, 0.0, -1e-6}), 1e-3);
    for (std::size_t i = 0; i < field.size(); ++i) tangential += field.tangential_force(i).x();
    return std::array{normal / 1e-6, tangential / 1e-9};
  };
  const auto half_space = stiffness(16, std::numeric_limits<double>::infinity()), thick = stiffness(16, 1000.0 * side);
  EXPECT_NEAR(thick[0] / half_space[0], 1.0, 0.01);
  EXPECT_NEAR(thick[1] / half_space[1], 1.0, 0.01);
  const auto over_springs = [&](int n) { return stiffness(n, side / n)[1] / (g * side * n); };
  EXPECT_NEAR(2.0 * over_springs(48) - over_springs(24), 1.0, 0.01);
}

}  // namespace
}  // namespace slipbench::oracle::elastic_skin_test
