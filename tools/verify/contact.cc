#include "tools/verify/contact.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "sim/contact/contact_points.h"
#include "sim/effects/install.h"
#include "tools/dataset/record/encoder.h"
#include "tools/registry/sensor_catalogue.h"
#include "tools/verify/verification.h"

namespace slipbench::verify {
namespace {

// m: poses are float32, and a pad between two simulation steps is recorded by linear interpolation.
constexpr double slack = 1e-5;
constexpr double of_force = 1e-5;  // of the normal force: float32

struct TouchedBody {
  ContactPoints surface;
  const BodyRecord* motion;
  bool round;  // its faces have other directions from point to point
};

// Surface of a shape of the catalogue of bodies; empty for other shapes.
std::optional<Surface> surface_of(const Named& shape) {
  const Parameters& p = shape.parameters;
  if (shape.name == "box") return Box{0.5 * Eigen::Vector3d::Map(p.vector("size").data())};
  if (shape.name == "sphere") return Sphere{p.number("radius")};
  if (shape.name == "cylinder") return Cylinder{p.number("radius"), 0.5 * p.number("length")};
  if (shape.name == "capsule") return Capsule{p.number("radius"), 0.5 * p.number("length")};
  if (shape.name == "ellipsoid") return Ellipsoid{0.5 * Eigen::Vector3d::Map(p.vector("size").data())};
  if (shape.name == "plane") return Plane{};
  return std::nullopt;
}

Pose pose_in(const BodyRecord& body, std::size_t row) {
  const float* const p = body.pose.data() + 7 * row;
  const Eigen::Quaterniond turn(p[3], p[4], p[5], p[6]);
  return {turn.normalized().toRotationMatrix(), {p[0], p[1], p[2]}};
}

// Reason why the check is not possible; empty if it is.
std::string reason_against(const Scene& scene, const SensorScene& sensor, const SensorRecord& record, const TrialRecord& trial) {
  if (!scene.dynamic()) return "scenes without bodies: the simulation itself stops if a pad passes through the surface";
  if (scene.fidelity != "field") return fmt::format("fidelity {}", scene.fidelity);
  if (!sensor.follows.empty()) return "sensors that follow another pad";
  if (record.time != trial.body_time) return "sensors with other sampling times than the bodies";
  for (const Named& effect : scene.effects) {
    const std::vector<Change>& changes = effect_kind(effect.name).changes;
    if (std::ranges::find(changes, Change::normal_force) != changes.end())
      return fmt::format("the effect {} changes the springs or the surface", effect.name);
  }
  return {};
}

// Bodies that the sensor may touch; empty if the shape of one is unknown.
std::vector<TouchedBody> touched_bodies(const Scene& scene, const SensorScene& sensor, const PadLayout& layout,
                                        const TrialRecord& record) {
  std::vector<TouchedBody> bodies;
  const auto touch = [&](const std::string& name, const std::optional<Surface>& shape) {
    if (!shape) return false;
    const bool round = !std::holds_alternative<Plane>(*shape) && !std::holds_alternative<Box>(*shape);
    bodies.push_back({ContactPoints(layout, *shape), &record.body(name), round});
    return true;
  };
  bool known = true;
  if (scene.grasp) {
    const std::vector<double>& size = record.body("box").size;
    known = size.size() == 3 && touch("box", Box{0.5 * Eigen::Vector3d::Map(size.data())});
  }
  for (const std::string& name : sensor.touches) {
    const auto body = std::ranges::find(scene.bodies, name, &BodyScene::name);
    known = known && body != scene.bodies.end() && touch(name, surface_of(body->shape));
  }
  if (!known) bodies.clear();
  return bodies;
}

// Depth of each element in the touched bodies [m] at a row of the record; 0: outside.
void find_depths(const PadLayout& layout, const std::vector<TouchedBody>& bodies, const BodyRecord& pad, std::size_t row,
                 std::vector<double>& depth) {
  std::ranges::fill(depth, 0.0);
  const Pose pad_pose = pose_in(pad, row);
  for (const TouchedBody& body : bodies) {
    const Pose at = pose_in(*body.motion, row).inverse() * pad_pose;
    for (std::size_t e = 0; e < layout.elements.size(); ++e) {
      const Element& element = layout.elements[e];
      depth[e] = std::max(depth[e], -body.surface.at(at * element.tip, at.rotation * element.axis).gap);
    }
  }
}

// Checks one unit at one row. `depth`: of the elements [m]; `before`: at the previous row.
class UnitCheck {
 public:
  UnitCheck(const PadLayout& layout, const TrialRecord& record, const SensorRecord& sensor, Verification& verification)
      : layout_(layout), record_(record), sensor_(sensor), verification_(verification) {}

  void check(std::size_t unit, std::size_t row, const std::vector<double>& depth, const std::vector<double>& before) {
    const LabelRecord& labels = sensor_.labels;
    const std::size_t units = labels.units(), i = row * units + unit;
    const std::size_t first = layout_.units[unit].first, end = first + layout_.units[unit].count;
    verification_.count(Check::contact, 1);
    double most = 0.0, deepest = 0.0;
    double relieved = 0.0;  // N, by which the springs give way since the previous row
    for (std::size_t e = first; e < end; ++e) {
      most += layout_.elements[e].k_normal * (depth[e] + slack);
      relieved += layout_.elements[e].k_normal * (std::max(0.0, before[e] - depth[e]) + 2.0 * slack);
      deepest = std::max(deepest, depth[e]);
    }
    const double normal = labels.force[3 * i + 2];
    if (normal > most * (1.0 + of_force)) {
      fail(unit, row, "force",
           fmt::format("presses with {:.6g} N at a depth of {:.4g} mm, where its springs give at most {:.6g} N", normal,
                       1e3 * deepest, most));
    }
    if (row == 0 || labels.unit_state[i] != 0 || labels.unit_state[i - units] == 0) return;
    // An element that an edge has swept into a body presses with a part of its depth alone
    // (sim/contact/field.h), and comes free when it has moved by that part.
    if (labels.force[3 * (i - units) + 2] <= relieved) return;
    for (std::size_t e = first; e < end; ++e) {
      if (depth[e] < 2.0 * slack || depth[e] < 0.5 * before[e]) continue;
      fail(unit, row, "unit_state",
           fmt::format("is detached, but element {} is still {:.4g} mm deep in the touched body", e, 1e3 * depth[e]));
      return;
    }
  }

 private:
  void fail(std::size_t unit, std::size_t row, const char* array, const std::string& what) {
    verification_.fail(Check::contact, {record_.trial, fmt::format("{}/{}", label_group(sensor_.name), array), row},
                       fmt::format("unit {}: {}", unit, what));
  }

  const PadLayout& layout_;
  const TrialRecord& record_;
  const SensorRecord& sensor_;
  Verification& verification_;
};

}  // namespace

void check_contact(const Scene& scene, std::size_t index, const TrialRecord& record, const SensorRecord& sensor,
                   Verification& verification) {
  const SensorScene& described = scene.sensors.at(index);
  if (const std::string why = reason_against(scene, described, sensor, record); !why.empty()) {
    verification.leave_out(Check::contact, why);
    return;
  }
  const PadLayout layout = make_sensor(described, scene.seed, record.trial)->layout();
  const auto is_sum = [](const UnitRange& unit) { return unit.count > 1; };
  const auto is_turned = [&](const Element& element) { return element.axis != layout.elements.front().axis; };
  const std::vector<TouchedBody> bodies = touched_bodies(scene, described, layout, record);
  if (bodies.empty()) {
    verification.leave_out(Check::contact, "geoms of a model file");
    return;
  }
  const bool turns = std::ranges::any_of(layout.elements, is_turned) || std::ranges::any_of(bodies, &TouchedBody::round);
  if (turns && std::ranges::any_of(layout.units, is_sum)) {
    verification.leave_out(Check::contact, "elements of one unit touch faces with different directions");
    return;
  }

  const BodyRecord& pad = record.body(sensor.name);
  UnitCheck checks(layout, record, sensor, verification);
  std::vector<double> before(layout.elements.size(), 0.0), depth(layout.elements.size(), 0.0);
  for (std::size_t row = 0; row < sensor.time.size(); ++row) {
    depth.swap(before);
    find_depths(layout, bodies, pad, row, depth);
    for (std::size_t unit = 0; unit < sensor.labels.units(); ++unit) checks.check(unit, row, depth, before);
  }
}

}  // namespace slipbench::verify
