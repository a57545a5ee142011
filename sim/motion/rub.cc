#include "sim/motion/motion_catalogue.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "sim/core/error.h"
#include "sim/core/math.h"
#include "sim/core/math/rotation.h"
#include "sim/core/readable_quantity.h"
#include "sim/motion/hand_processes.h"
#include "sim/motion/profile.h"
#include "sim/motion/straight_path.h"

namespace slipbench {
namespace rub {
namespace {

constexpr const char* fitted = "assumed: fitted to 111 recordings of a BioTac SP (scenes/biotac_sp/slip.md)";
constexpr const char* outline = "COMSOL model of the BioTac SP by bsadr: half-ellipsoid of 13.85 x 10.1 x 9.85 mm";

// The ranges exceed any real finger and motion: a number outside is a typing error.
Entry rub_entry() {
  return {
      "rub",
      "A finger is pressed on a spot of its round skin; there it slides, turns or rests, in irregular bursts.",
      "skin: the lower half of an ellipsoid in the pad frame\n"
      "The spot (x, arc) has the parametric angle arc/mean(b, c) about X, counted towards +Y. The pad is rolled and pitched,\n"
      "Rz(yaw + turn) Ry Rx, until the spot is the skin's lowest point.\n"
      "p: Gaussian process of mean 0 and variance 1, white noise through two equal low-pass filters of corner frequency f:\n"
      "E p(0) p(s) = (1 + a s) exp(-a s), a = 2 pi f\n"
      "The time of p runs exp(warp p_w) times as fast, p_w: such a process with warp_corner. This makes the motion irregular.\n"
      "depth = deepest tanh(compression effort skin_share exp(gain load_sd p_1)/deepest): the skin stiffens towards the core\n"
      "spot = site + offset + room tanh(gain wander (p_2, p_3)/room), room: from site + offset to the skin's end; the finger rocks without sliding\n"
      "path and rotation: integrals of speed q and rotation q, q = max(0, drive + p_4), after start, approach and wait\n"
      "Until then p_1 to p_3 are scaled by `rest`.\n"
      "The processes are drawn at knots of 10 ms. Between knots p is cubic with continuous rate, and q is linear.",
      "chosen to fit the recordings of yayaneath/BioTacSP-DoS; exact transition of the process",
      {
          vector_spec(3, "half_axes", Quantity::length, "[13.85 mm, 9.85 mm, 10.1 mm]", {1e-3, 0.1},
                      "Half axes a, b, c of the skin's ellipsoid along the pad's X, Y, Z.", outline),
          vector_spec(3, "centre", Quantity::length, "[0 mm, 0 mm, 10.1 mm]", {-0.1, 0.1},
                      "Centre of the ellipsoid in the pad frame.", "that of sensor biotac_sp"),
          vector_spec(2, "site", Quantity::length, "[0 mm, 0 mm]", {-0.1, 0.1},
                      "Spot of the skin that is pressed: X, and the arc around the finger from its lowest line.",
                      "set for each scene"),
          vector_spec(2, "offset", Quantity::length, "[0 mm, 0 mm]", {-0.1, 0.1},
                      "Offset added to the site, to vary it between trials.", "set for each scene"),
          number_spec("compression", Quantity::length, "1.5 mm", positive_up_to(0.1),
                      "How far the skin's lowest point is below the surface.", fitted),
          number_spec("deepest", Quantity::length, "3.5 mm", positive_up_to(0.1), "Largest depth at any load.",
                      "assumed: the core is 2 to 3 mm below the skin (bsadr/biotac), and the skin on it yields"),
          number_spec("effort", Quantity::none, "1", positive_up_to(20.0), "Factor on the compression during this motion.",
                      "set for each scene"),
          number_spec("skin_share", Quantity::none, "1", positive_up_to(1.0),
                      "Share of the compression by which the skin dents; the object dents by the rest. 1: the object is rigid.",
                      "set for each scene"),
          number_spec("speed", Quantity::speed, "0 mm/s", {0.0, 10.0}, "Sliding speed where q is 1.", "8 mm/s fits recordings"),
          number_spec("direction", Quantity::angle, "0 deg", any_value, "Direction in which the pad slides, from its own X axis.",
                      "set for each scene"),
          number_spec("yaw", Quantity::angle, "0 deg", any_value,
                      "Angle by which the pad is turned about the vertical before the motion begins.", "set for each scene"),
          number_spec("rotation", Quantity::angular_speed, "0 deg/s", any_value,
                      "Turning speed about the vertical through the spot where q is 1.", "38.2 deg/s fits recordings"),
          number_spec("drive", Quantity::none, "0.6", {-3.0, 10.0},
                      "Mean of the driving process; a higher mean gives a steadier motion.", fitted),
          vector_spec(2, "wander", Quantity::length, "[0 mm, 0 mm]", {0.0, 0.01},
                      "Standard deviation of the spot along X, and of its arc.", fitted),
          number_spec("load_sd", Quantity::none, "0", {0.0, 2.0}, "Standard deviation of the logarithm of the depth.", fitted),
          number_spec("gain", Quantity::none, "1", {0.0, 20.0}, "Factor on wander and load_sd.", fitted),
          number_spec("corner", Quantity::frequency, "0.4 Hz", {0.01, 20.0}, "Corner frequency f of each low pass.", fitted),
          number_spec("warp", Quantity::none, "1.1", {0.0, 1.5},
                      "Standard deviation of the logarithm of the rate at which the processes' time runs.", fitted),
          number_spec("warp_corner", Quantity::frequency, "0.8 Hz", {0.01, 20.0},
                      "Corner frequency of each low pass of the warping process.", fitted),
          number_spec("gap", Quantity::length, "0.5 mm", {0.0, 0.1}, "Height of the spot above the surface until the start.",
                      "assumed"),
          number_spec("start", Quantity::time, "50 ms", non_negative, "Time at which the finger begins to move down.", "assumed"),
          number_spec("approach", Quantity::time, "0.1 s", positive,
                      "Duration of moving down; after the wait, q rises to its own value in the same time.", "assumed"),
          number_spec("wait", Quantity::time, "0 s", non_negative, "Time that the finger rests on the surface before q rises.",
                      "set for each scene"),
          number_spec("rest", Quantity::none, "1", fraction, "Share of wander and load_sd before q rises; it rises to 1 with q.",
                      "set for each scene"),
      }};
}

class Rub final : public Motion {
 public:
  Rub(const Parameters& p, const MotionKey& key)
      : a_(p.vector("half_axes")[0]),
        b_(p.vector("half_axes")[1]),
        c_(p.vector("half_axes")[2]),
        centre_(p.vector("centre")[0], p.vector("centre")[1], p.vector("centre")[2]),
        site_{p.vector("site")[0] + p.vector("offset")[0], p.vector("site")[1] + p.vector("offset")[1]},
        wander_{p.number("gain") * p.vector("wander")[0], p.number("gain") * p.vector("wander")[1]},
        compression_(p.number("compression") * p.number("effort") * p.number("skin_share")),
        deepest_(p.number("deepest")),
        load_sd_(p.number("gain") * p.number("load_sd")),
        gap_(p.number("gap")),
        start_(p.number("start")),
        approach_(p.number("approach")),
        rotation_(p.number("rotation")),
        yaw_(p.number("yaw")),
        speed_(p.number("speed") *
               Eigen::Vector3d(math::cos(yaw_ + p.number("direction")), math::sin(yaw_ + p.number("direction")), 0.0)),
        processes_({p.number("corner"), p.number("warp_corner"), p.number("warp"), p.number("drive"),
                    start_ + approach_ + p.number("wait"), approach_, p.number("rest")},
                   key, "motion.rub") {
    room_ = {room(site_[0], reach_x * a_, "X"), room(site_[1], reach_arc * radius(), "its arc")};
  }

  [[nodiscard]] BodyState pad_at(double t) const override {
    const ProfilePoint down = descent(t, start_, approach_);
    const ProcessPoint load = processes_.at(HandProcesses::load, t), way = processes_.way(t);
    const double asked = compression_ * math::exp(load_sd_ * load.value), share = math::tanh(asked / deepest_);
    const double pressed = deepest_ * share, pressing = (1.0 - share * share) * asked * load_sd_ * load.rate;
    const Spot spot = spot_at(t);

    const Eigen::Matrix3d turned = rotation_about(Eigen::Vector3d::UnitZ(), yaw_ + rotation_ * way.value);
    const Eigen::Matrix3d pitched = turned * rotation_about(Eigen::Vector3d::UnitY(), spot.pitch.value);
    BodyState pad;
    pad.pose.rotation = pitched * rotation_about(Eigen::Vector3d::UnitX(), spot.roll.value);
    pad.angular_velocity =
        rotation_ * way.rate * Eigen::Vector3d::UnitZ() + spot.pitch.rate * turned.col(1) + spot.roll.rate * pitched.col(0);
    Eigen::Vector3d touch = speed_ * way.value, touch_rate = speed_ * way.rate;
    touch.z() = gap_ * (1.0 - down.position) - pressed * down.position;
    touch_rate.z() = -(gap_ + pressed) * down.velocity - pressing * down.position;
    const Eigen::Vector3d arm = pad.pose.rotation * spot.place;
    pad.pose.position = touch - arm;
    pad.velocity = touch_rate - pad.angular_velocity.cross(arm) - pad.pose.rotation * spot.rate;
    return pad;
  }

  [[nodiscard]] double top_speed(double reach) const override {
    const double rate = processes_.top_rate(), q = processes_.top_way_rate();
    const double vertical = (gap_ + deepest_) * 1.5 / approach_ + most_pressing * deepest_ * load_sd_ * rate;
    // (1 - tanh^2 y) y is at most 0.4477, where 2 y tanh y = 1.
    //
    // With x = a sin h and g the arc's angle: tan(pitch) = tan(h)/(a m), 1/m from the lesser to the
    // greater of b and c, and tan(roll) = -(c/b) tan(g). An angle whose tangent is f times
    // another's changes at most max(f, 1/f) times as fast. m itself changes by at most half of f^2
    // - 1 of it per radian, f = max(b, c)/min(b, c), and pitch by half of that.
    const double most = std::max(b_, c_), least = std::min(b_, c_), f = most / least;
    const double cosine =
        std::sqrt(1.0 - math::pow((std::abs(site_[0]) + std::min(HandProcesses::limit * wander_[0], room_[0])) / a_, 2));
    const double h_rate = wander_[0] * rate / (a_ * cosine), g_rate = wander_[1] * rate / radius();
    const double pitching = std::max({a_ / least, most / a_, 1.0}) * h_rate + 0.25 * (f * f - 1.0) * g_rate;
    const double turning = std::abs(rotation_) * q + pitching + f * g_rate;
    const double skin = std::max(a_, most) * h_rate + most * g_rate, arm = centre_.norm() + std::max(a_, most);
    return speed_.norm() * q + vertical + skin + (arm + reach) * turning;
  }

  // Between two knots the sliding speed is linear. Rocking moves the tips in straight lines.
  [[nodiscard]] double longest_step() const override {
    return std::min(HandProcesses::knot, step_per_turn(std::abs(rotation_) * processes_.top_way_rate()));
  }

  [[nodiscard]] bool turns() const override { return rotation_ != 0.0; }

 private:
  // Limits of the skin that can be pressed: share of the half length, and angle [rad].
  static constexpr double reach_x = 0.95, reach_arc = 1.4;
  static constexpr double most_pressing = 0.448;

  struct Spot {
    Eigen::Vector3d place, rate;  // m, m/s, in the pad frame
    ProcessPoint roll, pitch;     // rad, rad/s
  };

  [[nodiscard]] double radius() const { return 0.5 * (b_ + c_); }

  // Returns the space between a site and the end of the skin. Throws if no space is left.
  static double room(double site, double end, const char* what) {
    if (std::abs(site) < end) return end - std::abs(site);
    throw SceneValueError(
        "motion.site",
        fmt::format("the site plus the offset is {} along {}; allowed: less than {} on this skin",
                    readable_quantity(std::abs(site), Quantity::length), what, readable_quantity(end, Quantity::length)));
  }

  // Returns a coordinate of the spot.
  [[nodiscard]] ProcessPoint wandered(std::size_t k, const ProcessPoint& process) const {
    const double bounded = math::tanh(wander_[k] * process.value / room_[k]);
    return {site_[k] + room_[k] * bounded, (1.0 - bounded * bounded) * wander_[k] * process.rate};
  }

  // The spot is centre + (x, k b sin g, -k c cos g) with k = sqrt(1 - (x/a)^2); the outward normal
  // there is along (x/a^2, k sin(g)/b, -k cos(g)/c). Rx rotates away its Y component, then Ry its X
  // component.
  [[nodiscard]] Spot spot_at(double t) const {
    const ProcessPoint along = wandered(0, processes_.at(HandProcesses::along, t)),
                       around = wandered(1, processes_.at(HandProcesses::around, t));
    const double x = along.value, dx = along.rate, g = around.value / radius(), dg = around.rate / radius();
    const double k = std::sqrt(1.0 - x * x / (a_ * a_)), dk = -x * dx / (a_ * a_ * k);
    const auto [sine, cosine] = math::sincos(g);
    Spot spot;
    spot.place = centre_ + Eigen::Vector3d(x, k * b_ * sine, -k * c_ * cosine);
    spot.rate = {dx, b_ * (dk * sine + k * cosine * dg), -c_ * (dk * cosine - k * sine * dg)};
    const double nx = x / (a_ * a_), ny = k * sine / b_, nz = -k * cosine / c_;
    const double dny = (dk * sine + k * cosine * dg) / b_, dnz = -(dk * cosine - k * sine * dg) / c_;
    const double m = math::hypot(ny, nz), dm = (ny * dny + nz * dnz) / m;
    spot.roll = {math::atan(ny / nz), (dny * nz - ny * dnz) / (m * m)};
    spot.pitch = {math::atan2(nx, m), (dx / (a_ * a_) * m - nx * dm) / (nx * nx + m * m)};
    return spot;
  }

  double a_, b_, c_;
  Eigen::Vector3d centre_;
  std::array<double, 2> site_, wander_, room_;
  double compression_, deepest_, load_sd_, gap_, start_, approach_, rotation_, yaw_;
  Eigen::Vector3d speed_;
  HandProcesses processes_;
};

}  // namespace
}  // namespace rub

MotionKind rub_motion() { return motion_kind<rub::Rub>(rub::rub_entry()); }

}  // namespace slipbench
