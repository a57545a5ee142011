#include "sim/grasp/grasp.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/core/math.h"
#include "sim/core/quantity.h"
#include "sim/core/random.h"
#include "sim/core/readable_quantity.h"

namespace slipbench {
namespace {

void add_scatter(Grasp& grasp, const Parameters& scatter, double period, std::uint64_t seed, std::uint64_t trial) {
  const auto stream = [&](const char* name) { return RandomStream(seed, trial, std::string("scatter.") + name); };
  RandomStream position = stream("position"), centre = stream("centre_of_mass");
  for (int k = 0; k < 3; ++k) {
    grasp.box_position[k] += scatter.vector("position")[static_cast<std::size_t>(k)] * position.normal();
    grasp.centre_of_mass[k] += scatter.number("centre_of_mass") * centre.normal();
  }
  grasp.yaw += scatter.number("yaw") * stream("yaw").normal();
  grasp.pitch += scatter.number("pitch") * stream("pitch").normal();
  grasp.box_size.x() += scatter.number("width") * stream("width").uniform();
  grasp.friction_scale *= math::exp(scatter.number("friction") * stream("friction").normal());
  if (scatter.flag("phase")) grasp.phase += period * stream("phase").uniform();
}

// Draws the drift of the fingers. Without drift it is empty and nothing is drawn.
std::vector<DriftTone> draw_drift(const Parameters& grip, std::uint64_t seed, std::uint64_t trial) {
  constexpr std::size_t tones = 8;  // nearly Gaussian, and smooth
  if (grip.number("drift") == 0.0) return {};
  RandomStream stream(seed, trial, "grip.drift");
  std::vector<DriftTone> drift(tones);
  for (DriftTone& tone : drift) {
    tone.omega = 2.0 * std::numbers::pi * stream.uniform(0.0, grip.number("drift_bandwidth"));
    tone.phase = stream.uniform(0.0, 2.0 * std::numbers::pi);
  }
  return drift;
}

// Counts closer than this are equal: positions are sums of doubles.
constexpr double same_count = 1e-6;

double linear(int value, double least, double most) {
  return least + (most - least) * static_cast<double>(value) / static_cast<double>(max_register);
}

int byte_of(int value, const char* name, bool wrap, double time) {
  if (value >= 0 && value <= max_register) return value;
  if (wrap) return static_cast<int>(static_cast<unsigned char>(value));
  throw SceneValueError(
      "controller", fmt::format("at {2:.6g} s it commanded the {0} {1}; allowed: 0 to {3} (grip.wrap: true takes the low byte)",
                                name, value, time, max_register));
}

constexpr Range byte{0.0, 255.0};

constexpr const char* robotiq =
    "Robotiq's profile k2F85 (robotiq/grippers): bench-measured counts and stroke, ranges of the manual";
constexpr const char* published_loop = "the published loop: read, write 10 ms later, every 20 ms";

Entry grip_entry() {
  return {
      .name = "grip",
      .summary =
          "A gripper modelled on the Robotiq 2F-85: two fingers on springs, one with a sensor's pad, the other with a second pad.",
      .law =
          "opening = (closed_at - position) count + drift g(t)\n"
          "g = 1/2 sum of 8 sin(2 pi f t + p) has variance 1; f (uniform up to drift_bandwidth) and p (uniform) are drawn per trial.\n"
          "Speed and force limit are linear in their registers. The opening changes by trapezoids of speed with `acceleration`.\n"
          "finger along the closing direction: m x'' = k (drive - x) + 2 zeta sqrt(k m) (drive' - x') + force of its pad\n"
          "Sideways, upwards and in rotation the equation is the same, with the position of the hand instead of the drive.\n"
          "The drive is self-locking: no force moves it. A closing drive stops when k (drive - x) reaches the force limit.",
      .source = "manual of the Robotiq 2F-85 and Robotiq's profile k2F85; stiffness and latency of a real one are not published",
      .parameters = {
          choice_spec(
              "protocol", "as_recorded", {"as_printed", "as_recorded"},
              "Protocol that sets the defaults of grip.preset, motion.speed and motion.acceleration, and the length of a trial.",
              "as_recorded: 4 N, 43 mm/s, 400 mm/s2, 5 s, from the gripper's code and the motion capture files; as_printed: 1 N, 5 mm/s, 50 mm/s2, 23 s, from the paper"),
          number_spec(
              "preset", Quantity::force, "4 N", non_negative,
              "Force on the sensor below which a controller tightens before anything has slipped; with protocol as_printed: 1 N.",
              "the published gripper's code; the paper prints 1 N"),
          number_spec("clearance", Quantity::length, "1 mm", positive,
                      "Smallest gap between either pad and the box at the start; the fingers begin at a whole count.", "assumed"),
          number_spec("height", Quantity::length, "70 mm", positive, "Height of the pads' middle over the table at the start.",
                      "assumed"),
          number_spec("yaw", Quantity::angle, "0 deg", {-0.5, 0.5},
                      "Rotation of the hand relative to the box about the vertical.", "assumed"),
          number_spec("pitch", Quantity::angle, "0 deg", {-0.5, 0.5},
                      "Rotation of the hand relative to the box about the pads' width axis.", "assumed"),

          vector_spec(3, "stiffness", Quantity::stiffness, "[8 N/mm, 15 N/mm, 15 N/mm]", positive,
                      "Stiffness of one finger: along its closing direction, sideways, up.",
                      "assumed; along the closing direction the published steps of force allow 3 to 15 N/mm"),
          number_spec("turning_stiffness", Quantity::none, "100", positive,
                      "Stiffness of one finger against pitching and any other turn, N m/rad.",
                      "assumed: fingers below 30 pump the grip force up"),
          number_spec("pivot", Quantity::length, "20 mm", any_value,
                      "Height above the pad of a finger's mass, and of the point about which the finger rotates.", "assumed"),
          number_spec("damping_ratio", Quantity::none, "0.3", {0.0, 10.0}, "Damping ratio of the finger's springs.", "assumed"),
          number_spec("finger_mass", Quantity::mass, "80 g", positive, "Mass of one finger.", "assumed"),
          number_spec("finger_inertia", Quantity::none, "1.2e-4", positive,
                      "Inertia of one finger about its middle, kg m2, the same about all axes.", "assumed: 80 g on 130 mm"),

          number_spec(
              "drift", Quantity::length, "0 mm", {0.0, 0.02},
              "Standard deviation of a slow drift of the opening that the position register does not show; with soft fingers the grip force drifts too.",
              "0: no drift. With 1 N/mm a drift of 0.9 mm changes 4 N by 11 %, as in public recordings of a uSkin on a gripper"),
          number_spec("drift_bandwidth", Quantity::frequency, "0.3 Hz", positive_up_to(10.0), "Highest frequency of the drift.",
                      "assumed: recorded grips change within seconds"),

          choice_spec("second_pad", "silicone", {"same", "silicone"},
                      "Pad of the other finger: flat silicone, or the same elements as the sensor's.", "published: silicone"),
          vector_spec(2, "pad_size", Quantity::length, "[22 mm, 37.5 mm]", positive, "Size of the silicone pad: width, height.",
                      "fingertip of the 2F-85 (mujoco_menagerie)"),
          vector_spec(2, "pad_stiffness", Quantity::stiffness, "[400 N/mm, 200 N/mm]", positive,
                      "Stiffness of the whole silicone pad: normal, tangential.", "assumed"),
          number_spec("pad_damping", Quantity::time, "0.3 ms", non_negative,
                      "Time constant of the dashpot in parallel with each spring of the second pad.", "assumed"),

          number_spec("count", Quantity::length, "0.374 mm", positive,
                      "Change of the opening for one count of the position register.", robotiq),
          integer_spec("open_at", "3", byte, "Count of the open stop.", robotiq),
          integer_spec("closed_at", "230", byte, "Count of the closed stop, at which the pads' origins touch.", robotiq),
          number_spec("slowest", Quantity::speed, "20 mm/s", positive, "Speed of the opening at speed register 0.", robotiq),
          number_spec("fastest", Quantity::speed, "150 mm/s", positive, "Speed of the opening at speed register 255.", robotiq),
          number_spec("acceleration", Quantity::acceleration, "0.5 m/s2", positive, "Acceleration of the opening.", "assumed"),
          number_spec("weakest", Quantity::force, "20 N", positive,
                      "Force of a finger at which the motor stops at force register 0.", robotiq),
          number_spec("strongest", Quantity::force, "235 N", positive,
                      "Force of a finger at which the motor stops at force register 255.", robotiq),
          number_spec("period", Quantity::time, "20 ms", positive, "Time between two reads of the gripper's status.",
                      published_loop),
          number_spec("write_after", Quantity::time, "10 ms", non_negative, "Time from a read to the write that follows it.",
                      published_loop),
          number_spec("latency", Quantity::time, "20 ms", non_negative, "Time from a write until the fingers begin to move.",
                      "assumed; 0 to 60 ms are conceivable"),
          number_spec("phase", Quantity::time, "0 ms", non_negative, "Time of the first read.", "assumed"),
          integer_spec("dead_band", "0", byte, "Largest change of position, in counts, for which a command is ignored.",
                       "assumed: 0; drivers of other makers ignore small changes"),
          flag_spec("wrap", "false", "True: a command beyond a byte wraps to its low byte; false: it is an error.",
                    "set for each scene; the published loop's 8-bit adder wraps"),
      }};
}

Entry box_entry() {
  return {
      .name = "box",
      .summary = "The box that a grasp lifts. It stands on a table; the pads grip two of its sides.",
      .law = "",
      .source = "neither the paper nor its data gives mass and size of the published boxes",
      .parameters = {
          number_spec("mass", Quantity::mass, "200 g", positive, "Mass of the box.",
                      "assumed: 0.2 kg a light box, 0.5 kg a heavy one"),
          vector_spec(3, "size", Quantity::length, "[60 mm, 60 mm, 100 mm]", positive,
                      "Extent along the closing direction, sideways, up.", "assumed"),
          vector_spec(3, "centre_of_mass", Quantity::length, "[0 mm, 0 mm, 0 mm]", any_value,
                      "Centre of mass, from the box's middle.", "assumed"),
          vector_spec(2, "position", Quantity::length, "[0 mm, 0 mm]", any_value,
                      "Position of the box's middle from the middle between the fingers: along the closing direction, sideways.",
                      "assumed"),
          number_spec("weight", Quantity::mass, "0 g", non_negative,
                      "Mass of a weight in the box, in addition to the box's own mass.", "set for each scene"),
          vector_spec(3, "weight_place", Quantity::length, "[0 mm, 0 mm, 0 mm]", any_value,
                      "Position of the weight, a point mass, from the box's middle.", "set for each scene"),
          number_spec("table_friction", Quantity::none, "0.5", {0.0, 100.0}, "Friction coefficient between box and table.",
                      "assumed"),
          number_spec("table_stiffness", Quantity::stiffness, "100 N/mm", positive,
                      "Stiffness of the table under the four corners of the box together.",
                      "assumed: a box of 0.2 kg sinks in by 0.02 mm"),
          table_spec(4, "push", {{"t", Quantity::time}, {"x", Quantity::force}, {"y", Quantity::force}, {"z", Quantity::force}},
                     "External force on the box over time, along the world's axes, linear between the rows.",
                     "set for each scene"),
          vector_spec(3, "push_place", Quantity::length, "[0 mm, 0 mm, 0 mm]", any_value,
                      "Point where the push acts, from the box's middle.", "set for each scene"),
      }};
}

Entry scatter_entry() {
  return {
      .name = "scatter",
      .summary = "Random variation between the trials of a grasp; none without this key.",
      .law = "",
      .source = "assumed: spreads of a hand-placed box",
      .parameters = {
          vector_spec(3, "position", Quantity::length, "[0.5 mm, 1.5 mm, 2 mm]", non_negative,
                      "Standard deviation of the box's position between the fingers: along the closing direction, sideways, up.",
                      "assumed"),
          number_spec("yaw", Quantity::angle, "1 deg", {0.0, 0.2}, "Standard deviation of grip.yaw.", "assumed"),
          number_spec("pitch", Quantity::angle, "1 deg", {0.0, 0.2}, "Standard deviation of grip.pitch.", "assumed"),
          number_spec("centre_of_mass", Quantity::length, "2 mm", non_negative,
                      "Standard deviation of each coordinate of the centre of mass.", "assumed"),
          number_spec(
              "width", Quantity::length, "0.374 mm", non_negative,
              "Largest increase of the box's width, drawn uniformly from 0. The default is one count, so that no grip force is preferred.",
              "assumed"),
          number_spec("friction", Quantity::none, "0.1", {0.0, 2.0}, "Standard deviation of the logarithm of the pads' friction.",
                      "assumed"),
          flag_spec("phase", "true", "True: the loop's phase is drawn uniformly from its period.", "assumed"),
      }};
}

}  // namespace

Grasp draw_grasp(const GraspScene& scene, std::uint64_t seed, std::uint64_t trial) {
  const Parameters &grip = scene.grip, &box = scene.box;
  Grasp grasp;
  grasp.box_size = Eigen::Vector3d::Map(box.vector("size").data());
  grasp.box_position << box.vector("position")[0], box.vector("position")[1], 0.5 * grasp.box_size.z() - grip.number("height");
  grasp.centre_of_mass = Eigen::Vector3d::Map(box.vector("centre_of_mass").data());
  grasp.yaw = grip.number("yaw");
  grasp.pitch = grip.number("pitch");
  grasp.phase = grip.number("phase");
  grasp.drift = draw_drift(grip, seed, trial);
  if (scene.scatter) add_scatter(grasp, *scene.scatter, grip.number("period"), seed, trial);

  grasp.opening = grasp.box_size.x() + 2.0 * (grip.number("clearance") + std::abs(grasp.box_position.x()));
  const double widest = static_cast<double>(grip.integer("closed_at") - grip.integer("open_at")) * grip.number("count");
  if (widest <= 0.0) {
    throw SceneValueError("grip.open_at", fmt::format("{} must be less than grip.closed_at, {}", grip.integer("open_at"),
                                                      grip.integer("closed_at")));
  }
  if (grasp.opening > widest) {
    throw SceneValueError(
        "box.size",
        fmt::format("a box of {} with its clearance does not fit between the fingers; allowed: up to {} including the clearance",
                    readable_quantity(grasp.box_size.x(), Quantity::length), readable_quantity(widest, Quantity::length)));
  }
  const Eigen::Vector3d beyond = grasp.box_position.cwiseAbs() - 0.5 * grasp.box_size;
  if (beyond.y() > 0.0 || beyond.z() > 0.0) {
    throw SceneValueError("box", "the middle of the pads is beside the box; change grip.height or box.position");
  }
  return grasp;
}

PadLayout second_pad(const Parameters& grip, const PadLayout& sensor) {
  constexpr int columns = 4, rows = 6;
  if (grip.choice("second_pad") == "same") return sensor;
  const std::vector<double>&size = grip.vector("pad_size"), &stiffness = grip.vector("pad_stiffness");
  PadLayout layout;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      layout.units.push_back({layout.elements.size(), 1});
      layout.elements.push_back({.tip = {size[0] * ((column + 0.5) / columns - 0.5), size[1] * ((row + 0.5) / rows - 0.5), 0.0},
                                 .k_normal = stiffness[0] / (columns * rows),
                                 .k_tangential = stiffness[1] / (columns * rows)});
    }
  }
  return layout;
}

PadLayout box_corners(const Parameters& box, const Eigen::Vector3d& box_size) {
  constexpr double standing = 4.0;  // corners
  PadLayout layout;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d side((corner & 1) != 0 ? 1.0 : -1.0, (corner & 2) != 0 ? 1.0 : -1.0, (corner & 4) != 0 ? 1.0 : -1.0);
    Element element{.tip = 0.5 * side.cwiseProduct(box_size), .axis = side.normalized()};
    element.k_normal = element.k_tangential = box.number("table_stiffness") / standing;
    layout.units.push_back({layout.elements.size(), 1});
    layout.elements.push_back(element);
  }
  return layout;
}

double ideal_grip_force(const Scene& scene, double friction_scale, double gravity) {
  const double mu = scene.friction.static_coefficient * friction_scale;
  const double mass = scene.grasp->box.number("mass") + scene.grasp->box.number("weight");
  return mu > 0.0 ? 0.5 * mass * gravity / mu : std::numeric_limits<double>::infinity();
}

const std::vector<Entry>& grasp_catalogue() {
  static const std::vector<Entry> entries{box_entry(), grip_entry(), scatter_entry()};
  return entries;
}

const std::vector<Protocol>& protocol_catalogue() {
  static const std::vector<Protocol> protocols{
      {"as_printed",
       {{"duration", "23 s"}, {"grip.preset", "1 N"}, {"motion.speed", "5 mm/s"}, {"motion.acceleration", "50 mm/s2"}}},
      {"as_recorded",
       {{"duration", "5 s"}, {"grip.preset", "4 N"}, {"motion.speed", "43 mm/s"}, {"motion.acceleration", "400 mm/s2"}}},
  };
  return protocols;
}

Gripper::Gripper(const Parameters& grip, double opening, double phase, std::vector<DriftTone> drift)
    : count_(grip.number("count")),
      closed_at_(static_cast<double>(grip.integer("closed_at"))),
      open_at_(static_cast<double>(grip.integer("open_at"))),
      slowest_(grip.number("slowest") / count_),
      fastest_(grip.number("fastest") / count_),
      acceleration_(grip.number("acceleration") / count_),
      weakest_(grip.number("weakest")),
      strongest_(grip.number("strongest")),
      period_(grip.number("period")),
      write_after_(grip.number("write_after")),
      latency_(grip.number("latency")),
      phase_(phase),
      dead_band_(static_cast<double>(grip.integer("dead_band"))),
      wrap_(grip.flag("wrap")),
      drift_amplitude_(drift.empty() ? 0.0 : grip.number("drift") * std::sqrt(2.0 / static_cast<double>(drift.size()))),
      drift_(std::move(drift)),
      position_(std::clamp(std::floor(closed_at_ - (opening - wander(0.0)) / count_ + same_count), open_at_, closed_at_)),
      target_(position_.at(0.0).position),
      force_limit_(weakest_) {
  if (const double start = closed_at_ - (opening - wander(0.0)) / count_; !drift_.empty() && start < open_at_ - 1.0) {
    throw SceneValueError("grip.drift",
                          fmt::format("{} opens the fingers by {} beyond their stop at the start; use a smaller drift",
                                      format_quantity(grip.number("drift"), Quantity::length),
                                      readable_quantity((open_at_ - start) * count_, Quantity::length)));
  }
  if (write_after_ >= period_) {
    throw SceneValueError(
        "grip.write_after",
        format_quantity(write_after_, Quantity::time) +
            " is too late: the write after a read must come before the next read; allowed: less than the period, " +
            format_quantity(period_, Quantity::time));
  }
}

GripperStatus Gripper::read() {
  const double time = next_read();
  ++reads_;
  return {time, position(time), position_.at(time).velocity != 0.0, stopped_};
}

GripCommand Gripper::write(const GripCommand& command) {
  const double time = next_write();
  ++writes_;
  const GripCommand sent{byte_of(command.position, "position", wrap_, time), byte_of(command.speed, "speed", wrap_, time),
                         byte_of(command.force, "force", wrap_, time)};
  pending_.push_back({time + latency_, sent});
  return sent;
}

void Gripper::obey(const Pending& pending) {
  const double speed = linear(pending.command.speed, slowest_, fastest_);
  const double target = std::clamp(static_cast<double>(pending.command.position), open_at_, closed_at_);
  const double force_limit = linear(pending.command.force, weakest_, strongest_);
  const bool stronger = force_limit > force_limit_;
  force_limit_ = force_limit;
  // A repeated target changes nothing: the motion continues, rests, or stays stopped unless a
  // larger force is now allowed.
  if (target == target_ && speed == speed_ && !(stopped_ && stronger)) return;
  if (dead_band_ > 0.0 && std::abs(target - position_.at(pending.time).position) <= dead_band_ + same_count) return;
  target_ = target;
  speed_ = speed;
  stopped_ = false;
  position_.move_to(pending.time, target, speed, acceleration_);
}

void Gripper::update(double time, double force) {
  for (; !pending_.empty() && pending_.front().time <= time + rounding; pending_.pop_front()) obey(pending_.front());
  if (force < force_limit_ || !(position_.at(time).velocity > 0.0)) return;
  position_.change_velocity(time, 0.0, std::numeric_limits<double>::infinity());
  stopped_ = true;
}

int Gripper::position(double time) const { return static_cast<int>(std::lround(position_.at(time).position)); }

double Gripper::wander(double time) const {
  double sum = 0.0;
  for (const DriftTone& tone : drift_) sum += drift_amplitude_ * math::sin(tone.omega * time + tone.phase);
  return sum;
}

double Gripper::opening(double time) const { return (closed_at_ - position_.at(time).position) * count_ + wander(time); }

double Gripper::opening_speed(double time) const {
  double rate = 0.0;
  for (const DriftTone& tone : drift_) rate += drift_amplitude_ * tone.omega * math::cos(tone.omega * time + tone.phase);
  return rate - position_.at(time).velocity * count_;
}

}  // namespace slipbench
