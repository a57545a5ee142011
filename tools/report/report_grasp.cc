#include "tools/report/report_grasp.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "sim/api/motion.h"
#include "sim/core/error.h"
#include "sim/core/math/rotation.h"
#include "sim/core/pose.h"
#include "sim/grasp/grasp.h"
#include "sim/motion/motion_catalogue.h"
#include "sim/scene/catalogues.h"
#include "sim/scene/materials.h"
#include "sim/scene/parser.h"
#include "sim/scene/scene_values.h"
#include "tools/page/page.h"
#include "tools/registry/program_catalogues.h"
#include "tools/report/report_summary.h"
#include "tools/trial/recorded_scene.h"

namespace slipbench::report {
namespace {

constexpr double frames_per_second = 60.0;  // more are invisible
constexpr std::size_t pose_values = 7;

struct GraspCurve {
  const char* key;
  const char* unit;
  std::vector<std::string> components;
  std::vector<float> values;  // [T, components]
};

const BodyRecord& body_named(const TrialRecord& record, const char* name, const std::string& place) {
  const auto found = std::ranges::find(record.bodies, name, &BodyRecord::name);
  if (found == record.bodies.end()) throw InputError(place + ": a grasp without truth/" + name);
  return *found;
}

Pose pose_at(const BodyRecord& body, std::size_t row) {
  const float* const p = &body.pose[pose_values * row];
  const Eigen::Quaterniond turn(p[3], p[4], p[5], p[6]);
  return {turn.normalized().toRotationMatrix(), {p[0], p[1], p[2]}};
}

// The last row before the arm first moves; the last row if it never moves.
std::size_t lift_row(const BodyRecord& arm, std::size_t rows) {
  for (std::size_t row = 0; row < rows; ++row) {
    const std::span<const float> velocity(&arm.velocity[6 * row], 6);
    if (std::ranges::any_of(velocity, [](float v) { return std::abs(v) > at_rest; })) return row == 0 ? 0 : row - 1;
  }
  return rows - 1;
}

std::vector<GraspCurve> curves_of(const TrialRecord& record, const BodyRecord& arm, const BodyRecord& box, std::size_t lift) {
  constexpr float never = std::numeric_limits<float>::quiet_NaN();
  const std::size_t rows = record.num_samples();
  GraspCurve height{"height", "m", {"box", "arm"}, {}}, slip{"slip", "m", {"slip"}, {}},
      rotation{"rotation", "rad", {"rotation"}, {}};
  const Pose taken = pose_at(arm, lift).inverse() * pose_at(box, lift);
  for (std::size_t row = 0; row < rows; ++row) {
    const Pose held = pose_at(arm, row).inverse() * pose_at(box, row);
    const bool dropped = record.body_time[row] >= record.outcome.grasp->drop_time;  // false for NaN
    const double angle = rotation_vector(held.rotation * taken.rotation.transpose()).norm();
    for (const BodyRecord* body : {&box, &arm}) height.values.push_back(body->pose[pose_values * row + 2] - body->pose[2]);
    slip.values.push_back(dropped ? never : row < lift ? 0.0F : static_cast<float>((held.position - taken.position).norm()));
    rotation.values.push_back(dropped ? never : row < lift ? 0.0F : static_cast<float>(angle));
  }
  std::vector<GraspCurve> curves{std::move(height), std::move(slip), std::move(rotation)};
  if (record.control) {
    const GripRecord& grip = record.control->grip;
    GraspCurve position{"position", "counts", {"commanded", "measured"}, {}};
    for (std::size_t row = 0; row < grip.measured_position.size(); ++row) {
      position.values.push_back(grip.command[3 * row]);
      position.values.push_back(grip.measured_position[row]);
    }
    curves.push_back({"grip_force", "N", {"force"}, grip.grip_force});
    curves.push_back(std::move(position));
  }
  return curves;
}

Json poses_of(const TrialRecord& record) {
  const std::vector<double>& time = record.body_time;
  const std::size_t rows = time.size();
  const double rate = rows < 2 ? 1.0 : static_cast<double>(rows - 1) / (time.back() - time.front());
  const auto stride = static_cast<std::size_t>(std::max(1.0, std::ceil(rate / frames_per_second - 1e-6)));
  Json poses = {{"stride", stride}, {"bodies", Json::array()}};
  for (const BodyRecord& body : record.bodies) {
    std::vector<float> position, turn;
    for (std::size_t row = 0; row < rows; ++row) {
      const auto pose = body.pose.begin() + static_cast<std::ptrdiff_t>(pose_values * row);
      position.insert(position.end(), pose, pose + 3);
      turn.insert(turn.end(), pose + 3, pose + 7);
    }
    poses["bodies"].push_back({{"name", body.name},
                               {"size", body.size.empty() ? Json(nullptr) : Json(body.size)},
                               {"position", page::pack_curves(position, 3, stride)},
                               {"turn", page::pack_curves(turn, 4, stride)}});
  }
  return poses;
}

// Text as in a scene, on one line.
std::string text_of(const YamlNode& node) {
  if (node.kind != YamlNode::Kind::sequence) return node.text;
  std::string text;
  for (const YamlNode& item : node.children) text += (text.empty() ? "" : ", ") + text_of(item);
  return "[" + text + "]";
}

class ParameterRows {
 public:
  ParameterRows(const YamlNode& root, const Json& swept) : root_(root), swept_(swept) {
    const YamlNode* named = at({"grip", "protocol"});
    const std::string name = named == nullptr ? "as_recorded" : named->text;
    const auto found = std::ranges::find(protocol_catalogue(), name, &Protocol::name);
    if (found != protocol_catalogue().end() && !swept.contains("grip.protocol")) protocol_ = &*found;
  }

  // `path`: path of the map with the entry's parameters.
  void add(const std::vector<std::string>& path, const Entry& entry) {
    for (const ParameterSpec& spec : entry.parameters) add(path, spec);
  }
  void add(std::vector<std::string> path, const ParameterSpec& spec) {
    path.push_back(spec.name);
    add(fmt::format("{}", fmt::join(path, ".")), at(path), spec.default_text, spec.doc, spec.source);
  }

  // Adds the entry that `path`.type names, unless the type is swept or unknown.
  void add_typed(const std::vector<std::string>& path, const std::vector<Entry>& entries) {
    std::vector<std::string> type = path;
    type.emplace_back("type");
    const YamlNode* node = at(type);
    if (node == nullptr || swept_.contains(fmt::format("{}", fmt::join(type, ".")))) return;
    add_named(path, entries, node->text);
  }

  void add_effects(const std::vector<Entry>& entries) {
    const YamlNode* list = at({"effects"});
    if (list == nullptr) return;
    for (std::size_t i = 0; i < list->children.size(); ++i) {
      const YamlNode& item = list->children[i];
      const std::string& name =
          item.kind == YamlNode::Kind::map && !item.children.empty() ? item.children.front().key : item.text;
      add_named({"effects", std::to_string(i), name}, entries, name);
    }
  }

  void add_friction(const char* key, const char* doc) {
    if (const YamlNode* written = at({"friction", key})) {
      add(std::string("friction.") + key, written, "", doc, "assumed: set by the scene instead of the material");
    }
  }

  void add_material() {
    const YamlNode* material = at({"surface", "material"});
    if (material == nullptr && !swept_.contains("surface.material")) return;
    const std::vector<Material> table = material_table();
    const auto found = material == nullptr ? table.end() : std::ranges::find(table, material->text, &Material::name);
    add("surface.material", material, "", "friction of the pads on the box",
        found == table.end() ? "assumed: see slipbench list materials" : found->source);
  }

  void add_contact() {
    const YamlNode* fidelity = at({"fidelity"});
    if (fidelity != nullptr && fidelity->text == "mujoco_contact" && !swept_.contains("fidelity")) {
      add({contact_entry.name}, contact_entry);
    }
  }

  [[nodiscard]] const YamlNode* at(const std::vector<std::string>& path) const { return node_at(root_, path); }
  [[nodiscard]] Json rows() && { return std::move(rows_); }

 private:
  void add_named(const std::vector<std::string>& path, const std::vector<Entry>& entries, const std::string& name) {
    const auto found = std::ranges::find(entries, name, &Entry::name);
    if (found != entries.end()) add(path, *found);
  }

  void add(const std::string& path, const YamlNode* written, const std::string& default_text, const std::string& doc,
           const std::string& source) {
    std::string value = default_text;
    const char* by = "default";
    if (protocol_ != nullptr && protocol_->defaults.contains(path)) {
      value = protocol_->defaults.at(path);
      by = "protocol";
    }
    if (written != nullptr) {
      value = text_of(*written);
      by = "scene";
    }
    // A swept vector may be given by element: "box.size.0".
    const bool swept = std::ranges::any_of(swept_.items(), [&](const auto& item) {
      const std::string& name = item.key();
      return name == path || name.starts_with(path + ".");
    });
    if (swept) {
      value.clear();
      by = "sweep";
    }
    rows_.push_back({{"path", path},
                     {"value", value},
                     {"by", by},
                     {"doc", doc},
                     {"source", source},
                     {"assumed", source.find("assumed") != std::string::npos}});
  }

  const YamlNode& root_;
  const Json& swept_;
  const Protocol* protocol_ = nullptr;
  Json rows_ = Json::array();
};

}  // namespace

Json grasp_summary(const GraspOutcome& outcome) {
  return {{"dropped", outcome.dropped},
          {"not_lifted", outcome.not_lifted()},
          {"lift_m", or_null(outcome.lift_height)},
          {"drop_s", or_null(outcome.drop_time)},
          {"slip_m", or_null(outcome.slip_translation)},
          {"rotation_rad", or_null(outcome.slip_rotation)},
          {"max_force_N", or_null(outcome.max_grip_force)},
          {"final_force_N", or_null(outcome.final_grip_force)},
          {"ideal_force_N", or_null(outcome.ideal_grip_force)},
          {"reaction_s", or_null(outcome.reaction_time)}};
}

double lift_time(const TrialRecord& record) {
  const auto arm = std::ranges::find(record.bodies, "arm", &BodyRecord::name);
  return arm == record.bodies.end() ? std::numeric_limits<double>::quiet_NaN()
                                    : record.body_time[lift_row(*arm, record.num_samples())];
}

Json grasp_payload(const TrialRecord& record, std::size_t curve_values, const std::string& place) {
  const BodyRecord& arm = body_named(record, "arm", place);
  const BodyRecord& box = body_named(record, "box", place);
  const std::size_t lift = lift_row(arm, record.num_samples());
  const std::vector<GraspCurve> curves = curves_of(record, arm, box, lift);
  std::size_t total = 0;
  for (const GraspCurve& curve : curves) total += curve.values.size();
  const std::size_t stride = total <= curve_values ? 1 : (total + curve_values - 1) / curve_values;
  Json payload = {{"lift_s", record.body_time[lift]},
                  {"detector", record.control ? record.control->detector : ""},
                  {"controller", record.control ? record.control->controller : ""},
                  {"time", page::pack_times(record.body_time)},
                  {"stride", stride},
                  {"curves", Json::object()},
                  {"poses", poses_of(record)}};
  for (const GraspCurve& curve : curves) {
    payload["curves"][curve.key] = {{"unit", curve.unit},
                                    {"components", curve.components},
                                    {"data", page::pack_curves(curve.values, curve.components.size(), stride)}};
  }
  return payload;
}

Json grasp_parameters(const std::string& scene, const Json& overrides, const Json& swept, const std::string& place) {
  const SceneFile file = recorded_file(scene, overrides, place);
  ParameterRows rows(file.root(), swept);
  for (const Entry& entry : grasp_catalogue()) {
    if (entry.name != "scatter" || rows.at({"scatter"}) != nullptr) rows.add({entry.name}, entry);
  }
  const YamlNode* kind = rows.at({"motion", "kind"});
  const MotionKind* const motion = kind == nullptr ? &default_motion(true) : find_motion(kind->text);
  if (motion != nullptr) rows.add({"motion"}, motion->about);
  rows.add_material();
  rows.add_friction("static", "friction coefficient");
  rows.add_friction("kinetic", "friction coefficient of what slides");
  rows.add_friction("scale", "multiplies both coefficients");
  rows.add_contact();
  const Catalogues catalogues = program_catalogues();
  rows.add_effects(catalogues.effects);
  if (const YamlNode* sensors = rows.at({"sensors"})) {
    for (const YamlNode& sensor : sensors->children) {
      rows.add_typed({"sensors", sensor.key}, catalogues.sensors);
      rows.add({"sensors", sensor.key}, damping_spec);
    }
  }
  rows.add_typed({"detector"}, catalogues.detectors);
  rows.add_typed({"controller"}, catalogues.controllers);
  return std::move(rows).rows();
}

}  // namespace slipbench::report
