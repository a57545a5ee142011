// The gel against closed forms, and its camera against a pinhole model.
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "sim/api/sensor.h"
#include "sim/api/sensor_kind.h"
#include "tests/expect.h"
#include "tests/scenes.h"
#include "tools/trial/run_trial.h"

namespace slipbench {

SensorKind gel_markers_sensor();

namespace {

using Values = std::map<std::string, double>;

// 5 x 5 elements 1 mm apart under 7 x 5 markers 0.5 mm apart; 100 px over 10 mm at a distance of 20
// mm: a focal length of 100 20/10 = 200 px.
struct Gel {
  explicit Gel(Values more, std::uint64_t trial = 0, const std::string& name = "gel") {
    Parameters parameters = defaults_of(gel_markers_sensor().about.parameters);
    more.merge(Values{{"columns", 5},
                      {"rows", 5},
                      {"marker_columns", 7},
                      {"marker_rows", 5},
                      {"marker_pitch", 0.5e-3},
                      {"width", 100},
                      {"height", 80},
                      {"field", 10e-3},
                      {"distance", 20e-3}});
    for (const auto& [key, value] : more) parameters.set(key, value);
    sensor = gel_markers_sensor().create(parameters, {}, 7, trial, name);
    truth.element_depth.setZero(static_cast<Eigen::Index>(sensor->layout().elements.size()));
    truth.element_shear.setZero(truth.element_depth.size(), 3);
  }
  std::vector<float> frame() {
    const std::span<const float> values = sensor->measure(truth).values;
    return {values.begin(), values.end()};
  }
  std::unique_ptr<Sensor> sensor;
  ContactFrame truth;
};
constexpr std::size_t pixels = 3 * 35, seen = 5 * 35, heights = 6 * 35;  // where the channels begin

// Bilinear interpolation reproduces a displacement that is linear over the pad exactly, at each
// marker and in the picture of heights.
TEST(GelMarkers, MoveWithTheSkinBetweenElements) {
  Gel gel({{"map", 5}});
  const auto slope = [](double x, double y) { return 1e-4 + 0.02 * x + 0.01 * y; };
  for (Eigen::Index e = 0; e < 25; ++e) {
    const Eigen::Vector3d& tip = gel.sensor->layout().elements[static_cast<std::size_t>(e)].tip;
    gel.truth.element_shear.row(e) << slope(tip.x(), tip.y()), -2.0 * slope(tip.x(), tip.y()), 0.0;
    gel.truth.element_depth[e] = 3.0 * slope(tip.x(), tip.y());
  }
  const std::vector<float> values = gel.frame();
  for (std::size_t i = 0; i < 35; ++i) {
    const double x = (static_cast<double>(i % 7) - 3.0) * 0.5e-3, y = (2.0 - static_cast<double>(i / 7)) * 0.5e-3,
                 s = slope(x, y);
    EXPECT_NEAR(values[3 * i], s, 1e-10);
    EXPECT_NEAR(values[3 * i + 1], -2.0 * s, 1e-10);
    EXPECT_NEAR(values[3 * i + 2], 3.0 * s, 1e-10);
    const double px_per_m = 200.0 / (20e-3 - 3.0 * s);  // markers pressed in are nearer and look larger
    EXPECT_NEAR(values[pixels + 2 * i], 50.0 + px_per_m * (x + s), 1e-5);
    EXPECT_NEAR(values[pixels + 2 * i + 1], 40.0 - px_per_m * (y - 2.0 * s), 1e-5);
    EXPECT_EQ(values[seen + i], 1.0F);
  }
  ASSERT_EQ(gel.sensor->channels()[3].shape, (std::vector<std::size_t>{5, 5}));
  EXPECT_NEAR(values[heights + 4], 3.0 * slope(2e-3, 2e-3), 1e-10);  // the corner at +X and +Y
}

// A dome of 50 mm: tips on a sphere about (0, 0, 50 mm), directions away from its centre.
TEST(GelMarkers, StandOnADome) {
  const Gel gel({{"dome", 50e-3}});
  for (const Element& element : gel.sensor->layout().elements) {
    const Eigen::Vector3d from_centre = element.tip - Eigen::Vector3d(0.0, 0.0, 50e-3);
    EXPECT_NEAR(from_centre.norm(), 50e-3, 1e-12);
    EXPECT_NEAR((element.axis - from_centre / 50e-3).norm(), 0.0, 1e-12);
  }
}

// From rest to 0.1 mm within a frame of 40 ms, exposed for its last 20 ms: on a straight path the
// mean is a quarter of the way back.
TEST(GelMarkers, BlurToTheMeanOverTheExposure) {
  Gel gel({{"exposure", 20e-3}});
  gel.frame();
  gel.truth.element_shear.col(0) = 1e-4;
  EXPECT_NEAR(gel.frame()[0], 0.75e-4, 1e-10);
  EXPECT_NEAR(gel.frame()[0], 1e-4, 1e-10);
}

// Noise of 0.2 px over 35 markers and 200 frames: the standard error of its sd is 1/sqrt(2 14,000)
// = 0.6 %. With 30 % drop-outs, 7,000 draws: 0.55 %.
TEST(GelMarkers, AreSeenWithNoiseAndDropOuts) {
  const Values noisy{{"noise", 0.2}};
  Gel clean({}), gel(noisy), again(noisy), trial(noisy, 1), other(noisy, 0, "other"), missing({{"noise", 0.2}, {"dropout", 0.3}});
  const std::vector<float> rest = clean.frame();
  std::vector<float> shown = rest;
  double square = 0.0, sum = 0.0;
  for (int frame = 0; frame < 200; ++frame) {
    const std::vector<float> values = gel.frame(), thinned = missing.frame();
    EXPECT_EQ(values, again.frame());
    EXPECT_NE(values, trial.frame());
    EXPECT_NE(values, other.frame());
    for (std::size_t k = pixels; k < seen; ++k) {
      square += std::pow(static_cast<double>(values[k] - rest[k]), 2);
      if (thinned[seen + (k - pixels) / 2] == 1.0F) shown[k] = values[k];
      EXPECT_EQ(thinned[k], shown[k]);  // seen markers have the same noise as without drop-outs; others keep their last position
    }
    sum += std::accumulate(thinned.begin() + seen, thinned.end(), 0.0);
  }
  EXPECT_NEAR(std::sqrt(square / (200.0 * 70.0)), 0.2, 4.0 * 0.006 * 0.2);
  EXPECT_NEAR(sum / (200.0 * 35.0), 0.7, 4.0 * 0.0055);
}

TEST(GelMarkers, RefuseWhatIsNoPad) {
  const auto refusal = [](const Values& more) { return scene_refusal_of([&] { Gel gel(more); }); };
  EXPECT_THAT(refusal({{"rows", 4.5}}), mentions({"rows", "4.5", "whole"}));
  EXPECT_THAT(refusal({{"marker_pitch", 1e-3}}), mentions({"markers", "elements"}));
  EXPECT_THAT(refusal({{"dome", 2e-3}}), mentions({"dome", "diagonal"}));
  EXPECT_THAT(refusal({{"exposure", 50e-3}}), mentions({"exposure", "frame"}));
}

// A sphere of radius R, d deep in a half-space of G and nu = 1/2 ([johnson1985], 3.4 and 7.2):
// a^2 = R d, p = p0 sqrt(1 - r^2/a^2), p0 = 8 G a/(pi R). If the whole contact slides along -x,
// q = mu p; with s = asin(a/r), w = sqrt(1 - a^2/r^2) outside, s = pi/2, w = 0 inside:
//   even = (2a^2 - r^2) s + a r w, odd = [r^2 s + (2a^2 - r^2) w a/r]/(4 r^2), u_z = even/(pi R)
//   u_x = -mu/(pi R) [3/2 even + odd (x^2 - y^2)], u_y = -mu/(pi R) odd 2 x y
// Positions are those of the deformed skin, which touches the sphere.
TEST(GelMarkers, MoveAsTheHalfSpaceUnderASphere) {
  const std::string scene =
      "slipbench: 1\nduration: 1.6 s\nsurface: {shape: sphere, radius: 40 mm}\nfriction: {static: 0.4, kinetic: 0.4}\n"
      "motion: {compression: 0.15 mm, gap: 0.1 mm, speed: 0.2 mm/s, acceleration: inf, start: 0.4 s}\neffects: [elastic_skin]\n"
      "sensors:\n  gel: {type: gel_markers, rate: 10 Hz, columns: 20, rows: 20, pitch: 0.45 mm, marker_columns: 11, marker_rows: 11, "
      "marker_pitch: 0.8 mm}\n";
  const SensorRecord gel = run_trial(parsed(scene), 0, Recording::full).record.sensors[0];
  const double R = 40e-3, d = 0.15e-3, a = std::sqrt(R * d), share = 0.4 / (std::numbers::pi * R);
  for (const std::size_t frame :
       {std::size_t{3}, std::size_t{15}}) {  // pressed; and after 0.22 mm, where 3/2 mu d = 0.09 mm make all slide
    const double shift = 0.2e-3 * std::max(0.0, gel.time[frame] - 0.4), slides = shift > 0.0 ? share : 0.0;
    for (std::size_t i = 0; i < 121; ++i) {
      const std::span<const float> u = std::span(gel.channels[0].values).subspan(363 * frame + 3 * i, 3);
      const double x = (static_cast<double>(i % 11) - 5.0) * 0.8e-3 + static_cast<double>(u[0]) + shift;
      const double y = (5.0 - static_cast<double>(i / 11)) * 0.8e-3 + static_cast<double>(u[1]),
                   r = std::max(1e-9, std::hypot(x, y));
      const double s = std::asin(std::min(1.0, a / r)), w = std::sqrt(1.0 - std::min(1.0, a * a / (r * r)));
      const double even = (2.0 * a * a - r * r) * s + a * r * w;
      const double odd = 0.25 * (s + (2.0 * a * a - r * r) * w * a / (r * r * r));
      EXPECT_NEAR(u[0], -slides * (1.5 * even + odd * (x * x - y * y)), 0.02 * 0.09e-3) << i;
      EXPECT_NEAR(u[1], -slides * odd * 2.0 * x * y, 0.02 * 0.09e-3) << i;
      EXPECT_NEAR(u[2], even / (std::numbers::pi * R), 0.02 * d) << i;
    }
  }
}

}  // namespace
}  // namespace slipbench
