// The rubbing finger: the requested spot touches, rates match the poses, and the processes have the
// law's moments.
#include "sim/api/motion.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "sim/motion/motion_catalogue.h"
#include "tests/expect.h"

namespace slipbench::rub_test {
namespace {

using Changes = std::vector<std::pair<std::string, Parameters::Value>>;
using Lengths = std::vector<double>;

constexpr double pole = 2.0 * std::numbers::pi * 0.4;  // 1/s, of the default corner

std::unique_ptr<Motion> rub(const MotionKey& key, const Changes& changes = {}) {
  Parameters parameters = defaults_of(rub_motion().about.parameters);
  for (const auto& [name, value] : changes) parameters.set(name, value);
  return rub_motion().create(parameters, key);
}

// Depth for a compression of 1.5 mm and a maximum depth of 3.5 mm.
const double pressed = 3.5e-3 * std::tanh(1.5 / 3.5);

// The load's process p from the depth: atanh(depth/deepest) deepest/compression = exp(0.2 p).
double load_of(double depth) { return std::log(std::atanh(depth / 3.5e-3) * 3.5 / 1.5) / 0.2; }

// Its rate over the pole, for a finger pressed at its lowest line: dp/d(depth) = 1/(0.2 deepest (1
// - u^2) atanh u), u = depth/deepest.
double load_rate(const BodyState& pad) {
  const double u = -pad.pose.position.z() / 3.5e-3;
  return -pad.velocity.z() / (0.2 * 3.5e-3 * (1.0 - u * u) * std::atanh(u)) / pole;
}

const Changes restless{{"site", Lengths{-6e-3, 4e-3}},
                       {"wander", Lengths{1.5e-3, 1.2e-3}},
                       {"load_sd", 0.2},
                       {"speed", 8e-3},
                       {"direction", 0.7},
                       {"rotation", -0.6}};

// The lowest point of the ellipsoid {centre + D v : |v| = 1}, D = diag(a, b, c), along the world's
// Z in the pad frame. With r the third row of the rotation, v = -D r/|D r|.
Eigen::Vector3d lowest(const BodyState& pad, const Eigen::Vector3d& half, const Eigen::Vector3d& centre) {
  const Eigen::Vector3d seen = half.cwiseProduct(pad.pose.rotation.row(2).transpose());
  return centre - half.cwiseProduct(seen) / seen.norm();
}

// The spot is (x, k b sin g, -k c cos g) with g = arc/mean(b, c), k = sqrt(1 - (x/a)^2), up to
// rounding.
TEST(Rub, TheSpotAskedForIsTheLowestPoint) {
  const Eigen::Vector3d half(13.85e-3, 9.85e-3, 10.1e-3), centre(1e-3, -0.5e-3, 2e-3);
  for (const double x : {-9e-3, 0.0, 6.2e-3}) {
    for (const double arc : {-6.6e-3, 0.0, 3e-3, 9e-3}) {
      const auto motion = rub({1, 0}, {{"site", Lengths{x - 1e-3, arc + 2e-3}},
                                       {"offset", Lengths{1e-3, -2e-3}},
                                       {"centre", Lengths{1e-3, -0.5e-3, 2e-3}},
                                       {"speed", 8e-3},
                                       {"compression", 2e-3},
                                       {"effort", 1.5},
                                       {"skin_share", 0.5}});
      const double g = arc / 9.975e-3, k = std::sqrt(1.0 - x * x / (half.x() * half.x()));
      const Eigen::Vector3d spot = centre + Eigen::Vector3d(x, k * half.y() * std::sin(g), -k * half.z() * std::cos(g));
      const BodyState pad = motion->pad_at(1.0);
      EXPECT_NEAR((lowest(pad, half, centre) - spot).norm(), 0.0, 1e-15);
      const Eigen::Vector3d touch = pad.pose * spot;
      EXPECT_NEAR(touch.z(), -pressed, 1e-15);  // 2 mm * 1.5 * 0.5 of compression
      EXPECT_NEAR(touch.y(), 0.0, 1e-15);       // slides along X, rocks in place
    }
  }
}

TEST(Rub, StandsOverTheSurfaceUntilItsStartAndThenComesDown) {
  const auto motion = rub({7, 1}, {{"gap", 0.3e-3}, {"start", 0.4}, {"approach", 0.2}, {"speed", 8e-3}});
  for (const double t : {0.0, 0.2, 0.4}) {
    EXPECT_NEAR(motion->pad_at(t).pose.position.z(), 0.3e-3, 1e-15);
    EXPECT_EQ(motion->pad_at(t).velocity.norm(), 0.0);
  }
  EXPECT_NEAR(motion->pad_at(0.6).pose.position.z(), -pressed, 1e-15);
  EXPECT_EQ(motion->pad_at(0.6).pose.position.x(), 0.0);  // slides only after contact
}

// Rates by central differences inside the cubics, h = 1 us. The third derivative of a cubic that
// moves by mm within some ms, at the fastest warp, is below 1e5 m/s^3, and h^2/6 times that is 2e-8
// m/s; for angles, over a centimetre, a hundred times as much. Rounding: 1e-2 m * 1e-16/h = 1e-12.
TEST(Rub, VelocityIsTheRateOfItsPose) {
  const auto motion = rub({11, 2}, restless);
  const double h = 1e-6;
  double fastest = 0.0;
  for (double t = 0.054; t < 12.0; t += 0.03) {
    const BodyState before = motion->pad_at(t - h), now = motion->pad_at(t), after = motion->pad_at(t + h);
    EXPECT_NEAR((now.velocity - (after.pose.position - before.pose.position) / (2.0 * h)).norm(), 0.0, 1e-7);
    const Eigen::Matrix3d spin = (after.pose.rotation - before.pose.rotation) / (2.0 * h) * now.pose.rotation.transpose();
    EXPECT_NEAR((now.angular_velocity - Eigen::Vector3d(spin(2, 1), spin(0, 2), spin(1, 0))).norm(), 0.0, 1e-5);
    const Eigen::Vector3d tip = now.pose.rotation * Eigen::Vector3d(0.0, 0.0, 0.0);
    fastest = std::max(fastest, (now.velocity + now.angular_velocity.cross(tip)).norm());
  }
  EXPECT_GT(fastest, 8e-3);
  EXPECT_LE(fastest, motion->top_speed(10.1e-3));
}

TEST(Rub, LongestStepIsAKnotOrATurn) {
  EXPECT_EQ(rub({11, 2})->longest_step(), 0.01);
  // q is at most drive + 4 = 4.6: 3 deg at 4.6 x 360 deg/s.
  EXPECT_NEAR(rub({11, 2}, {{"rotation", 2.0 * std::numbers::pi}})->longest_step(), 1.0 / 120.0 / 4.6, 1e-12);
}

// Poses and rates are smooth at the knots: 2 ns apart, both sides differ by at most rate and
// curvature times 2 ns.
TEST(Rub, IsSmoothOverItsKnots) {
  const auto motion = rub({5, 3}, restless);
  for (int k = 20; k < 400; ++k) {
    const BodyState before = motion->pad_at(0.01 * k - 1e-9), after = motion->pad_at(0.01 * k + 1e-9);
    EXPECT_NEAR((after.pose.position - before.pose.position).norm(), 0.0, 2e-9);  // up to 1 m/s
    EXPECT_NEAR((after.velocity - before.velocity).norm(), 0.0, 2e-7);            // up to 100 m/s^2
  }
}

// The load is a stationary process. Over 200 trials x 10 instants 3 s apart, after which all but (1
// + 7.5) exp(-7.5) is forgotten, a product of two values of variance 1 and covariance r has the
// standard error sqrt((1 + r^2)/2000) <= 0.0316; five are allowed. The rate has the variance pole^2
// with the standard error pole^2 sqrt(2/2000).
TEST(Rub, LoadIsNoiseBehindTwoEqualLowPasses) {
  const std::vector<double> lags{0.0, 0.1, 0.4, 1.0};
  std::vector<double> products(lags.size(), 0.0);
  double rates = 0.0;
  int draws = 0;
  for (std::uint64_t trial = 0; trial < 200; ++trial) {
    const auto motion = rub({3, trial}, {{"load_sd", 0.2}, {"warp", 0.0}});
    const auto process = [&](double t) { return load_of(-motion->pad_at(t).pose.position.z()); };
    for (int k = 1; k <= 10; ++k, ++draws) {
      const double first = process(3.0 * k);
      rates += std::pow(load_rate(motion->pad_at(3.0 * k)), 2);
      for (std::size_t i = 0; i < lags.size(); ++i) products[i] += first * process(3.0 * k + lags[i]);
    }
  }
  for (std::size_t i = 0; i < lags.size(); ++i) {
    const double s = pole * lags[i];
    EXPECT_NEAR(products[i] / draws, (1.0 + s) * std::exp(-s), 5.0 * 0.0316) << "lag " << lags[i];
  }
  EXPECT_NEAR(rates / draws, 1.0, 5.0 * 0.0316);
}

// A rate is pole exp(warp g) u: its mean square is pole^2 exp(2 warp^2), with a relative standard
// error of sqrt((3 exp(4 warp^2) - 1)/2000) = 0.06 at warp = 0.5.
TEST(Rub, WarpMakesFitsAndStarts) {
  double rates = 0.0;
  int draws = 0;
  for (std::uint64_t trial = 0; trial < 200; ++trial) {
    const auto motion = rub({4, trial}, {{"load_sd", 0.2}, {"warp", 0.5}});
    for (int k = 1; k <= 10; ++k, ++draws) {
      rates += std::pow(load_rate(motion->pad_at(3.0 * k)), 2);
    }
  }
  EXPECT_NEAR(rates / draws / std::exp(0.5), 1.0, 5.0 * 0.06);
}

// q = max(0, m + z) with m = 0.6: E q = m F(m) + f(m) = 0.7687 and E q^2 = (1 + m^2) F(m) + m f(m)
// = 1.1869, with F and f of the standard normal; it rests for F(-m) = 0.2743 of the time. 2,000
// values at knots: standard errors sqrt(1.1869 - 0.7687^2)/44.7 = 0.0173 and 0.01.
TEST(Rub, SlidesByFitsAndStarts) {
  double way = 0.0, rests = 0.0;
  int draws = 0;
  for (std::uint64_t trial = 0; trial < 200; ++trial) {
    const auto motion = rub({6, trial}, {{"speed", 8e-3}, {"warp", 0.0}, {"direction", std::numbers::pi / 2.0}});
    for (int k = 1; k <= 10; ++k, ++draws) {
      const Eigen::Vector3d velocity = motion->pad_at(3.0 * k).velocity;
      EXPECT_NEAR(velocity.x(), 0.0, 1e-15);
      way += velocity.y() / 8e-3;
      rests += velocity.y() == 0.0 ? 1.0 : 0.0;
    }
  }
  EXPECT_NEAR(way / draws, 0.7687, 5.0 * 0.0173);
  EXPECT_NEAR(rests / draws, 0.2743, 5.0 * 0.01);
}

// One process drives both, so the angle is the distance times rotation/speed, about the spot. Start
// 50 ms, approach 100 ms, wait 300 ms: at rest until 450 ms. Until then the logarithm of the depth
// is a fifth of its value without `rest`; from 550 ms on both are equal.
TEST(Rub, WaitsAndRocksLessUntilItMoves) {
  const Changes all{{"load_sd", 0.2}, {"speed", 8e-3}};
  Changes resting = all;
  resting.insert(resting.end(), {{"wait", 0.3}, {"rest", 0.2}});
  const auto plain = rub({7, 0}, all), waits = rub({7, 0}, resting);
  for (double t = 0.15; t < 0.45; t += 0.01) {
    EXPECT_EQ(waits->pad_at(t).pose.position.x(), waits->pad_at(0.0).pose.position.x());
    EXPECT_NEAR(load_of(-waits->pad_at(t).pose.position.z()), 0.2 * load_of(-plain->pad_at(t).pose.position.z()), 1e-9);
  }
  for (double t = 0.56; t < 2.0; t += 0.1)
    EXPECT_NEAR(waits->pad_at(t).pose.position.z(), plain->pad_at(t).pose.position.z(), 1e-15);
  EXPECT_GT(waits->pad_at(2.0).pose.position.x() - waits->pad_at(0.0).pose.position.x(), 1e-3);
}

TEST(Rub, TurnsAboutTheSpotAsItWouldSlide) {
  const auto turning = rub({8, 0}, {{"rotation", -0.5}}), sliding = rub({8, 0}, {{"speed", 1e-3}});
  EXPECT_TRUE(turning->turns());
  EXPECT_FALSE(sliding->turns());
  for (const double t : {0.3, 1.0, 2.5}) {
    const BodyState pad = turning->pad_at(t);
    const double angle = std::atan2(pad.pose.rotation(1, 0), pad.pose.rotation(0, 0));
    EXPECT_NEAR(angle, -0.5 * sliding->pad_at(t).pose.position.x() / 1e-3, 1e-13);
    EXPECT_NEAR(pad.pose.position.head<2>().norm(), 0.0, 1e-17);
  }
}

// Turned by 90 degrees and commanded along its own -Y, it moves along the world's X: R^T (1, 0, 0)
// = (0, -1, 0).
TEST(Rub, DirectionIsThePadsOwn) {
  const double quarter = 0.5 * std::numbers::pi;
  const auto motion = rub({1, 0}, {{"yaw", quarter}, {"direction", -quarter}, {"speed", 8e-3}});
  const BodyState pad = motion->pad_at(1.0);
  EXPECT_NEAR((pad.pose.rotation.transpose() * Eigen::Vector3d::UnitX() + Eigen::Vector3d::UnitY()).norm(), 0.0, 1e-15);
  EXPECT_GT(pad.pose.position.x(), 0.0);
  EXPECT_NEAR(pad.pose.position.y(), 0.0, 1e-17);
}

TEST(Rub, IsTheSameInAnyOrderAndAnotherOneInEveryTrial) {
  const auto forth = rub({1, 0}, restless), back = rub({1, 0}, restless);
  std::vector<Eigen::Vector3d> places;
  for (int k = 0; k <= 20; ++k) places.push_back(forth->pad_at(0.137 * k).pose.position);
  for (int k = 20; k >= 0; --k) EXPECT_EQ(back->pad_at(0.137 * k).pose.position, places[static_cast<std::size_t>(k)]);
  EXPECT_NE(rub({1, 1}, restless)->pad_at(1.0).pose.position, forth->pad_at(1.0).pose.position);
  EXPECT_NE(rub({2, 0}, restless)->pad_at(1.0).pose.position, forth->pad_at(1.0).pose.position);
}

TEST(Rub, StaysOnTheSkinHoweverMuchItWanders) {
  const auto motion =
      rub({2, 0}, {{"site", Lengths{-9e-3, 5e-3}}, {"wander", Lengths{9e-3, 9e-3}}, {"centre", Lengths{0.0, 0.0, 0.0}}});
  const Eigen::Vector3d half(13.85e-3, 9.85e-3, 10.1e-3);
  double least = 0.0;
  for (double t = 0.0; t < 60.0; t += 0.05) {
    const double x = lowest(motion->pad_at(t), half, Eigen::Vector3d::Zero()).x();
    EXPECT_GE(x, -0.95 * 13.85e-3);
    least = std::min(least, x);
  }
  EXPECT_LT(least, -12e-3);  // it moves: two thirds of a standard deviation lead to 9 mm + 4.16 mm tanh(6/4.16) = 12.7 mm
}

TEST(Rub, RefusesASiteBesideTheSkin) {
  const auto message = [](const Changes& changes) { return refusal_of<SceneValueError>([&] { rub({1, 0}, changes); }); };
  EXPECT_THAT(message({{"site", Lengths{-9e-3, 0.0}}, {"offset", Lengths{-5e-3, 0.0}}}),
              AllOf(mentions({"X"}), HasSubstr(" 13.16")));
  EXPECT_THAT(message({{"site", Lengths{0.0, 14.5e-3}}}), mentions({"arc"}));
  EXPECT_EQ(message({{"site", Lengths{13.1e-3, 13.9e-3}}}), "accepted");  // up to 0.95 * 13.85 mm and 1.4 * 9.975 mm
}

}  // namespace
}  // namespace slipbench::rub_test
