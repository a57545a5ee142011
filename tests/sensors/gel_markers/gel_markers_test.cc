// The gel against closed forms, its camera against a pinhole by hand.
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "sim/core/sensor.h"
#include "sim/core/sensor_kind.h"
#include "sim/scene/parser.h"
#include "tests/expect.h"
#include "tools/program/catalogue/program_catalogues.h"
#include "tools/program/run/run_trial.h"

namespace slipbench {

SensorKind gel_markers_sensor();

namespace {

using Values = std::map<std::string, double>;

struct Gel {
  explicit Gel(const Values& values, std::uint64_t trial = 0, const std::string& name = "gel") {
    Parameters parameters = defaults_of(gel_markers_sensor().about.parameters);
    for (const auto& [key, value] : values) parameters.set(key, value);
    sensor = gel_markers_sensor().create(parameters, {}, 7, trial, name);
    markers = sensor->channels()[0].shape[0];
    truth.element_depth.setZero(static_cast<Eigen::Index>(sensor->layout().elements.size()));
    truth.element_shear.setZero(truth.element_depth.size(), 3);
  }
  std::vector<float> frame() {
    const std::span<const float> values = sensor->measure(truth).values;
    return {values.begin(), values.end()};
  }
  std::unique_ptr<Sensor> sensor;
  std::size_t markers;
  ContactFrame truth;
};

// Elements 1 mm apart under markers 0.5 mm apart. 100 px over 10 mm, from 20 mm away: focal length 100 20/10 = 200 px, 10 px a mm at rest.
const Values small{{"columns", 5}, {"rows", 5},    {"marker_columns", 7}, {"marker_rows", 5}, {"marker_pitch", 0.5e-3},
                   {"width", 100}, {"height", 80}, {"field", 10e-3},      {"distance", 20e-3}};
Values with(Values values, const Values& more) {
  for (const auto& [key, value] : more) values[key] = value;
  return values;
}

// Bilinear between elements: a displacement that is linear over the pad is met exactly, at each marker and in the picture of heights.
TEST(GelMarkers, MoveWithTheSkinBetweenElements) {
  Gel gel(with(small, {{"map", 5}}));
  const auto& elements = gel.sensor->layout().elements;
  const auto slope = [](double x, double y) { return 1e-4 + 0.02 * x + 0.01 * y; };
  for (std::size_t e = 0; e < elements.size(); ++e) {
    const auto row = static_cast<Eigen::Index>(e);
    const double s = slope(elements[e].tip.x(), elements[e].tip.y());
    gel.truth.element_shear.row(row) << s, -2.0 * s, 0.0;
    gel.truth.element_depth[row] = 3.0 * s;
  }
  const std::vector<float> values = gel.frame();
  for (std::size_t i = 0; i < gel.markers; ++i) {
    const double x = (static_cast<double>(i % 7) - 3.0) * 0.5e-3, y = (2.0 - static_cast<double>(i / 7)) * 0.5e-3,
                 s = slope(x, y);
    EXPECT_NEAR(values[3 * i], s, 1e-10);
    EXPECT_NEAR(values[3 * i + 1], -2.0 * s, 1e-10);
    EXPECT_NEAR(values[3 * i + 2], 3.0 * s, 1e-10);
    const double px_per_m = 200.0 / (20e-3 - 3.0 * s);  // what is pressed in lies nearer, and looks larger
    EXPECT_NEAR(values[3 * gel.markers + 2 * i], 50.0 + px_per_m * (x + s), 1e-5);
    EXPECT_NEAR(values[3 * gel.markers + 2 * i + 1], 40.0 - px_per_m * (y - 2.0 * s), 1e-5);
    EXPECT_EQ(values[5 * gel.markers + i], 1.0F);
  }
  ASSERT_EQ(gel.sensor->channels()[3].shape, (std::vector<std::size_t>{5, 5}));
  EXPECT_NEAR(values[6 * gel.markers + 4], 3.0 * slope(2e-3, 2e-3), 1e-10);  // the corner at +X and +Y
}

// A dome of 50 mm: tips on a sphere about (0, 0, 50 mm), directions away from it.
TEST(GelMarkers, StandOnADome) {
  const Gel gel(with(small, {{"dome", 50e-3}}));
  const Eigen::Vector3d centre(0.0, 0.0, 50e-3);
  for (const Element& element : gel.sensor->layout().elements) {
    EXPECT_NEAR((element.tip - centre).norm(), 50e-3, 1e-12);
    EXPECT_NEAR((element.axis - (element.tip - centre) / 50e-3).norm(), 0.0, 1e-12);
  }
}

// From rest to 0.1 mm within a frame of 40 ms, exposed for its last 20 ms: on the straight path the mean lies a quarter of the way back.
TEST(GelMarkers, BlurToTheMeanOverTheExposure) {
  Gel gel(with(small, {{"exposure", 20e-3}}));
  gel.frame();
  gel.truth.element_shear.col(0) = 1e-4;
  EXPECT_NEAR(gel.frame()[0], 0.75e-4, 1e-10);
  EXPECT_NEAR(gel.frame()[0], 1e-4, 1e-10);
}

// Noise of 0.2 px over 35 markers and 200 frames: its sd is known to 1/sqrt(2 14,000) = 0.6 %. Of 30 % missed, 7,000 draws: to 0.55 %.
TEST(GelMarkers, AreSeenWithNoiseAndDropOuts) {
  const Values noisy = with(small, {{"noise", 0.2}}), gaps = with(noisy, {{"dropout", 0.3}});
  Gel clean(small), gel(noisy), again(noisy), trial(noisy, 1), other(noisy, 0, "other"), missing(gaps);
  const std::vector<float> rest = clean.frame();
  std::vector<float> shown = rest;
  double square = 0.0, seen = 0.0;
  const std::size_t pixels = 3 * gel.markers, flags = 5 * gel.markers;
  for (int frame = 0; frame < 200; ++frame) {
    const std::vector<float> values = gel.frame(), thinned = missing.frame();
    EXPECT_EQ(values, again.frame());
    EXPECT_NE(values, trial.frame());
    EXPECT_NE(values, other.frame());
    for (std::size_t k = pixels; k < flags; ++k) {
      square += std::pow(static_cast<double>(values[k] - rest[k]), 2);
      const bool sees = thinned[flags + (k - pixels) / 2] == 1.0F;
      if (sees) shown[k] = values[k];
      EXPECT_EQ(thinned[k], shown[k]);  // what is seen has the noise that it has without drop-outs, else what was seen last
    }
    seen += std::accumulate(thinned.begin() + static_cast<std::ptrdiff_t>(flags), thinned.end(), 0.0);
  }
  EXPECT_NEAR(std::sqrt(square / (200.0 * 70.0)), 0.2, 4.0 * 0.006 * 0.2);
  EXPECT_NEAR(seen / (200.0 * 35.0), 0.7, 4.0 * 0.0055);
}

TEST(GelMarkers, RefuseWhatIsNoPad) {
  const auto refusal = [](const Values& more) { return scene_refusal_of([&] { Gel gel(with(small, more)); }); };
  const std::string at = "sensors.gel.type | sensors.gel.type: 'gel_markers' makes no sensor for this scene: '";
  EXPECT_EQ(refusal({{"rows", 4.5}}), at + "rows is 4.500000; allowed: a whole number'");
  EXPECT_THAT(refusal({{"marker_pitch", 1e-3}}), StartsWith(at + "markers reach past the elements"));
  EXPECT_THAT(refusal({{"dome", 2e-3}}), StartsWith(at + "dome is too narrow"));
  EXPECT_THAT(refusal({{"exposure", 50e-3}}), StartsWith(at + "exposure is longer than a frame"));
}

// A sphere of radius R, d deep in a half-space of G and nu = 1/2 (Johnson, Contact Mechanics, 1985, 3.4 and 7.2): a^2 = R d, p = p0 sqrt(1 - r^2/a^2),
// p0 = 8 G a/(pi R). Where all slides along -x, q = mu p; terms of the integral over q, with s = asin(a/r), w = sqrt(1 - a^2/r^2) outside:
//   u_z = [(2a^2 - r^2) s + a r w]/(pi R), inside d - r^2/(2 R)
//   u_x = q0/(8 G a) [3/2 ((2a^2 - r^2) s + a r w) + 1/4 (r^2 s + (2a^2 - r^2) w a/r)(x^2 - y^2)/r^2], u_y with 2 x y for x^2 - y^2 and no first term
// Inside s = pi/2, w = 0, and r^2 s alone of the second bracket. Places are those of the deformed skin: that is where the sphere is met.
TEST(GelMarkers, MoveAsTheHalfSpaceUnderASphere) {
  const TrialRecord record =
      run_trial(
          parse_scene(
              SceneFile::from_text(
                  "slipbench: 1\nduration: 1.6 s\nsurface: {shape: sphere, radius: 40 mm}\nfriction: {static: 0.4, kinetic: 0.4}\n"
                  "motion: {compression: 0.15 mm, gap: 0.1 mm, speed: 0.2 mm/s, acceleration: inf, start: 0.4 s}\n"
                  "sensors:\n  gel: {type: gel_markers, rate: 10 Hz, columns: 20, rows: 20, pitch: 0.45 mm, marker_columns: 11, "
                  "marker_rows: 11, marker_pitch: 0.8 mm}\neffects: [elastic_skin]\n",
                  "sphere.yaml"),
              program_catalogues()),
          0, Recording::full)
          .record;
  const std::vector<float>& u = record.sensors[0].channels[0].values;
  const double R = 40e-3, d = 0.15e-3, a = std::sqrt(R * d), q0_8ga = 0.4 / (std::numbers::pi * R);
  for (const std::size_t frame :
       {std::size_t{3}, std::size_t{15}}) {  // pressed; and 0.22 mm on, where 3/2 mu d = 0.09 mm make all slide
    const double shift = 0.2e-3 * std::max(0.0, record.sensors[0].time[frame] - 0.4);
    for (std::size_t i = 0; i < 121; ++i) {
      const std::span<const float> found = std::span(u).subspan(363 * frame + 3 * i, 3);
      const double x = (static_cast<double>(i % 11) - 5.0) * 0.8e-3 + static_cast<double>(found[0]) + shift;
      const double y = (5.0 - static_cast<double>(i / 11)) * 0.8e-3 + static_cast<double>(found[1]), r = std::hypot(x, y);
      const double s = std::asin(std::min(1.0, a / r)), w = r > a ? std::sqrt(1.0 - a * a / (r * r)) : 0.0;
      const double even = (2.0 * a * a - r * r) * s + a * r * w;
      const double odd = r > 0.0 ? 0.25 * (r * r * s + (r > a ? (2.0 * a * a - r * r) * w * a / r : 0.0)) / (r * r) : 0.0;
      if (frame == 3) {
        EXPECT_NEAR(found[2], even / (std::numbers::pi * R), 0.02 * d) << i;
      }
      const double slides = shift > 0.0 ? q0_8ga : 0.0;
      EXPECT_NEAR(found[0], -slides * (1.5 * even + odd * (x * x - y * y)), 0.02 * 0.09e-3) << i;
      EXPECT_NEAR(found[1], -slides * odd * 2.0 * x * y, 0.02 * 0.09e-3) << i;
    }
  }
}

}  // namespace
}  // namespace slipbench
