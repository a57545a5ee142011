#include "sim/motion/motion_catalogue.h"

#include <cmath>
#include <limits>
#include <string>

#include <Eigen/Geometry>

#include "sim/core/math/rotation.h"
#include "sim/motion/profile.h"

namespace slipbench {
namespace {

constexpr const char* simulation = "Dynamically Reconfigurable Tactile Sensor for Robotic Manipulation, IEEE RA-L 2020";

// The ranges exceed any real bench: a number outside is a typing error.
Entry press_entry() {
  return {
      "press",
      "A stage presses the pad onto the surface, holds it and slowly retreats, while forces move what it touches.",
      "height: trapezoids from +gap to -compression and, from `retreat` on, back to +gap; measured at the pad's origin\n"
      "The pad stands at `offset`, turned by Rz(yaw) Ry(tilt y) Rx(tilt x), and never moves sideways.",
      std::string(simulation) + ", section V (slow release); constant accelerations, integrated exactly",
      {
          number_spec("compression", Quantity::length, "0.8 mm", positive_up_to(0.1),
                      "Distance that the stage moves on after the pad's origin touches.", "assumed: 8 N on springs of 10 N/mm"),
          vector_spec(2, "offset", Quantity::length, "[0 mm, 0 mm]", {-1.0, 1.0}, "Position of the pad over the surface.",
                      "assumed: aligned; the paper's rotational slip has 31.75 mm"),
          number_spec("yaw", Quantity::angle, "0 deg", any_value, "Rotation of the pad about the vertical.", "assumed: aligned"),
          vector_spec(2, "tilt", Quantity::angle, "[0 deg, 0 deg]", {-0.5, 0.5}, "Tilt of the pad about its X and Y axis.",
                      "assumed: aligned"),
          number_spec("gap", Quantity::length, "0.5 mm", {0.0, 0.1}, "Height of the pad's origin above the surface at t = 0.",
                      "assumed"),
          number_spec("approach_speed", Quantity::speed, "1 mm/s", positive_up_to(10.0), "Speed of pressing.", "assumed"),
          number_spec("begin", Quantity::time, "0 s", non_negative, "Time at which the pad begins to move down.", "assumed"),
          number_spec("retreat", Quantity::time, "inf", positive_or_infinite,
                      "Time at which the pad begins to retreat; inf: never.", "assumed"),
          number_spec("retreat_speed", Quantity::speed, "0.03 mm/s", positive_up_to(10.0), "Speed of the retreat.",
                      std::string(simulation) + ", section V"),
          number_spec("acceleration", Quantity::acceleration, "50 mm/s2", positive_or_infinite,
                      "Limit for both moves; inf: speeds change at once.", "assumed: as the motion stage"),
      }};
}

class Press final : public Motion {
 public:
  explicit Press(const Parameters& p)
      : height_(p.number("gap")),
        place_(p.vector("offset")[0], p.vector("offset")[1], 0.0),
        turned_(rotation_by_axes({p.vector("tilt")[0], p.vector("tilt")[1], p.number("yaw")})) {
    const double stroke = p.number("gap") + p.number("compression"), retreat = p.number("retreat");
    height_.move(p.number("begin"), -stroke, p.number("approach_speed"), p.number("acceleration"));
    if (!std::isfinite(retreat)) return;
    refuse_early("motion.retreat", retreat, height_.end());
    height_.move(retreat, stroke, p.number("retreat_speed"), p.number("acceleration"));
  }

  [[nodiscard]] BodyState pad_at(double t) const override {
    const ProfilePoint height = height_.at(t);
    BodyState pad;
    pad.pose.rotation = turned_;
    pad.pose.position = place_;
    pad.pose.position.z() = height.position;
    pad.velocity.z() = height.velocity;
    return pad;
  }

  [[nodiscard]] double top_speed(double /*reach*/) const override { return height_.top_speed(); }
  [[nodiscard]] double longest_step() const override { return std::numeric_limits<double>::infinity(); }
  [[nodiscard]] bool turns() const override { return false; }

 private:
  Profile height_;
  Eigen::Vector3d place_;
  Eigen::Matrix3d turned_;
};

}  // namespace

MotionKind press_motion() { return motion_kind<Press>(press_entry()); }

}  // namespace slipbench
