#include "sim/motion/motion_catalogue.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "sim/core/math.h"
#include "sim/core/math/rotation.h"
#include "sim/core/random.h"
#include "sim/motion/profile.h"
#include "sim/motion/straight_path.h"

namespace slipbench {
namespace {

constexpr const char* by_hand = "assumed: a calibration by hand";

Entry wander_entry() {
  return {
      "wander",
      "A hand presses the pad onto the surface and pushes, tilts and turns it at random: six smooth, band-limited coordinates.",
      "w_i(t) = erf(g_i(t)/sqrt 2),  g_i(t) = 1/2 sum of 8 sin(2 pi f t + p): f uniform up to the bandwidth, p uniform, drawn for\n"
      "each coordinate and trial. g has variance 1 and is nearly normal, so w is spread evenly over -1 to 1.\n"
      "compression = b c C with c = (1 + w_0)/2, C its limit;  each other coordinate = b c w_i times its limit\n"
      "The factor c keeps the pad from slipping: a pad that is pressed less is pushed less.\n"
      "b = 3 s^2 - 2 s^3 rises from 0 to 1 during the approach, s: share of the approach that has passed",
      "assumed: what \"applied randomized forces and moments manually\" (nib pad, IEEE RA-L 2020, section IV-A) may have been",
      {
          number_spec("compression", Quantity::length, "0.5 mm", positive_up_to(0.1), "Largest compression.", by_hand),
          vector_spec(2, "shear", Quantity::length, "[0.4 mm, 0.4 mm]", {0.0, 0.1},
                      "Largest displacement to either side, along X and Y.", by_hand),
          vector_spec(2, "tilt", Quantity::angle, "[2 deg, 2 deg]", {0.0, 0.5}, "Largest tilt, about X and Y.", by_hand),
          number_spec("twist", Quantity::angle, "4 deg", {0.0, 0.5}, "Largest rotation about the pad's normal.", by_hand),
          number_spec("bandwidth", Quantity::frequency, "0.5 Hz", positive_up_to(100.0), "Highest frequency of the sines.",
                      by_hand),
          number_spec("gap", Quantity::length, "0.5 mm", {0.0, 0.1},
                      "Height of the pad's origin above the surface until the start.", "assumed"),
          number_spec("start", Quantity::time, "0.5 s", non_negative,
                      "Time at which the pad begins to move down; readings can be tared before.", "assumed"),
          number_spec("approach", Quantity::time, "0.5 s", positive, "Duration of moving down.", "assumed"),
      }};
}

// A smooth random function of time, uniformly distributed over (-1, 1).
class Wave {
 public:
  struct Point {
    double value, rate;
  };

  Wave(double bandwidth, RandomStream& stream) {
    for (Tone& tone : tones_) {
      tone.omega = 2.0 * std::numbers::pi * stream.uniform(0.0, bandwidth);
      tone.phase = stream.uniform(0.0, 2.0 * std::numbers::pi);
    }
  }

  [[nodiscard]] Point at(double t) const {
    double g = 0.0, rate = 0.0;
    for (const Tone& tone : tones_) {
      const auto [sine, cosine] = math::sincos(tone.omega * t + tone.phase);
      g += amplitude * sine;
      rate += amplitude * tone.omega * cosine;
    }
    return {math::erf(g / std::numbers::sqrt2), slope * math::exp(-0.5 * g * g) * rate};
  }

  [[nodiscard]] double top_rate() const {
    double rate = 0.0;
    for (const Tone& tone : tones_) rate += amplitude * tone.omega;
    return slope * rate;
  }

 private:
  struct Tone {
    double omega, phase;
  };
  static constexpr std::size_t tones = 8;
  static constexpr double amplitude = 0.5;  // of each tone: 8 * 0.5^2/2 = 1
  // of erf(g/sqrt 2) at g = 0
  static constexpr double slope = std::numbers::sqrt2 * std::numbers::inv_sqrtpi;
  std::array<Tone, tones> tones_{};
};

class Wander final : public Motion {
 public:
  Wander(const Parameters& p, const MotionKey& key)
      : start_(p.number("start")),
        approach_(p.number("approach")),
        gap_(p.number("gap")),
        compression_(p.number("compression")),
        bandwidth_(p.number("bandwidth")),
        limits_{p.vector("shear")[0], p.vector("shear")[1], p.vector("tilt")[0], p.vector("tilt")[1], p.number("twist")} {
    RandomStream stream(key.seed, key.trial, "motion.wander");
    for (std::size_t i = 0; i < 1 + limits_.size(); ++i) waves_.emplace_back(bandwidth_, stream);
  }

  [[nodiscard]] BodyState pad_at(double t) const override {
    const ProfilePoint down = descent(t, start_, approach_);
    const Wave::Point press = waves_[0].at(t);
    const Wave::Point share{down.position * 0.5 * (1.0 + press.value),
                            down.velocity * 0.5 * (1.0 + press.value) + down.position * 0.5 * press.rate};
    std::array<Wave::Point, 5> way{};
    for (std::size_t i = 0; i < way.size(); ++i) {
      const Wave::Point wave = waves_[1 + i].at(t);
      way[i] = {limits_[i] * share.value * wave.value, limits_[i] * (share.rate * wave.value + share.value * wave.rate)};
    }
    const auto& [x, y, about_x, about_y, about_z] = way;
    const Eigen::Matrix3d turned = rotation_about(Eigen::Vector3d::UnitZ(), about_z.value);
    const Eigen::Matrix3d pitched = turned * rotation_about(Eigen::Vector3d::UnitY(), about_y.value);
    BodyState pad;
    pad.pose.position = {x.value, y.value, gap_ * (1.0 - down.position) - compression_ * share.value};
    pad.velocity = {x.rate, y.rate, -gap_ * down.velocity - compression_ * share.rate};
    pad.pose.rotation = pitched * rotation_about(Eigen::Vector3d::UnitX(), about_x.value);
    pad.angular_velocity = about_z.rate * Eigen::Vector3d::UnitZ() + about_y.rate * turned.col(1) + about_x.rate * pitched.col(0);
    return pad;
  }

  [[nodiscard]] double top_speed(double reach) const override {
    const double down = 1.5 / approach_, share = down + 0.5 * waves_[0].top_rate();
    double speed = gap_ * down + compression_ * share;
    for (std::size_t i = 0; i < limits_.size(); ++i) {
      speed += (i < 2 ? 1.0 : reach) * limits_[i] * (share + waves_[1 + i].top_rate());
    }
    return speed;
  }

  // A coordinate is a product of two waves of up to `bandwidth` each.
  [[nodiscard]] double longest_step() const override {
    const double share = 1.5 / approach_ + 0.5 * waves_[0].top_rate();
    return std::min(step_per_period(2.0 * bandwidth_), step_per_turn(limits_.back() * (share + waves_.back().top_rate())));
  }

  [[nodiscard]] bool turns() const override { return limits_.back() > 0.0; }

 private:
  double start_, approach_, gap_, compression_, bandwidth_;
  std::array<double, 5> limits_;  // m, m, rad, rad, rad: along X and Y, about X, Y and Z
  std::vector<Wave> waves_;       // of the compression, then of the limits
};

}  // namespace

MotionKind wander_motion() { return motion_kind<Wander>(wander_entry()); }

}  // namespace slipbench
