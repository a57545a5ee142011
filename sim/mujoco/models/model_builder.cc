#include "sim/mujoco/models/model_builder.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <set>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "sim/core/error.h"
#include "sim/core/math/rotation.h"
#include "sim/core/process/check_readable.h"
#include "sim/core/quantity.h"
#include "sim/mujoco/articulated/articulated.h"
#include "sim/mujoco/linear/stability.h"
#include "sim/mujoco/mjcf.h"
#include "sim/mujoco/mujoco_call.h"
#include "sim/mujoco/pads/geom_surface.h"
#include "sim/mujoco/pads/implicit.h"
#include "sim/mujoco/pads/pad_config.h"
#include "sim/mujoco/pads/register_plugin.h"

namespace slipbench {
namespace {

// In the model's folder, as MuJoCo sees it: it includes the model's file.
constexpr const char* wrapper_name = "slipbench-scene-wrapper.xml";
constexpr double earth_gravity = 9.81;  // m/s2

// Time constant of the contacts of the scene's own bodies [s]: 100 times as stiff as MuJoCo's
// default, in which 100 g sinks in by 0.1 mm.
constexpr double contact_time = 2e-3;

struct ToYaml {
  std::string operator()(double value) const { return format_number(value); }
  std::string operator()(std::int64_t value) const { return std::to_string(value); }
  std::string operator()(bool value) const { return value ? "true" : "false"; }
  std::string operator()(const std::string& value) const { return value; }
  std::string operator()(const std::vector<double>& values) const {
    std::string text = "[";
    for (const double value : values) text.append(text.size() > 1 ? ", " : "").append(format_number(value));
    return text + "]";
  }
  template <class Other>
  std::string operator()(const Other&) const {
    throw std::logic_error("no effect has a map or a table among its parameters");
  }
};

std::string yaml_of(const std::vector<Named>& effects) {
  std::string text = "[";
  for (const Named& effect : effects) {
    std::string parameters;
    for (const auto& [name, value] : effect.parameters.values()) {
      parameters.append(parameters.empty() ? "" : ", ").append(name).append(": ").append(std::visit(ToYaml{}, value));
    }
    text += fmt::format("{}{{{}: {{{}}}}}", text.size() > 1 ? ", " : "", effect.name, parameters);
  }
  return text + "]";
}

std::vector<std::string> names_in(const mjSpec* spec, mjtObj type) {
  std::vector<std::string> names;
  for (mjsElement* e = mjs_firstElement(spec, type); e != nullptr; e = mjs_nextElement(spec, e)) {
    const std::string name = mjs_getString(mjs_getName(e));
    if (!name.empty()) names.push_back(name);
  }
  return names;
}

// Returns the element's name; sets it to `otherwise` if it has none.
std::string name_of(mjsElement* element, const std::string& otherwise) {
  const std::string name = mjs_getString(mjs_getName(element));
  if (!name.empty()) return name;
  mjs_setName(element, otherwise.c_str());
  return otherwise;
}

// Returns the scene's key to which a message of MuJoCo refers.
const char* blamed(const Scene& scene) { return scene.model.empty() ? "bodies" : "model"; }

// A scene's model under construction.
class Builder {
 public:
  Builder(const Scene& scene, std::span<const PadLayout* const> pads, std::uint64_t trial, const Hand* hand)
      : scene_(scene), pads_(pads), trial_(trial), hand_(hand) {}

  ModelPointer build(LayoutsInMemory& layouts_in_memory) {
    // The attributes of the plugin depend on geoms that are known only after the model has been
    // read, but must be in the model when it is read. So the model is read twice.
    SpecPointer bare = parse("");
    add_all(bare.get());
    SpecPointer spec = parse(extension(layouts_in_memory));
    add_all(spec.get());
    return compile(spec.get());
  }

  ModelPointer build_articulated(const std::function<double(double)>& step_for) {
    SpecPointer spec = parse("");
    add_all(spec.get());
    // Sites and inverse masses are known only after the model has been compiled.
    const ModelPointer bare = compile(spec.get());
    refuse_articulated(bare.get());
    const bool recipe = !scene_.contact;
    std::vector<Pose> sites;
    DataPointer data = start_of(bare.get());
    double longest = recipe ? ArticulatedSettings{}.longest_step : std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < scene_.sensors.size(); ++i) {
      const int site = mj_name2id(bare.get(), mjOBJ_SITE, site_of(scene_.sensors[i]).c_str());
      const mjtNum* turn = bare->site_quat + 4 * site;
      sites.push_back({Eigen::Quaterniond(turn[0], turn[1], turn[2], turn[3]).toRotationMatrix(),
                       Eigen::Map<const Eigen::Vector3d>(bare->site_pos + 3 * site)});
      if (!recipe) continue;
      longest = std::min(longest, longest_articulated_step(*pads_[i], inverse_masses(bare.get(), data.get(), i), {}));
    }
    const PillarSettings settings = pillars_of_scene(scene_, step_for(longest));
    if (recipe) weigh_joints_down(bare.get(), settings.dt);
    data = start_of(bare.get());
    set_pillar_options(spec.get(), settings);
    for (std::size_t i = 0; i < scene_.sensors.size(); ++i) {
      const SensorScene& sensor = scene_.sensors[i];
      PadLayout layout = *pads_[i];
      for (Element& element : layout.elements) {
        element.c_normal += sensor.damping * element.k_normal;
        element.c_tangential += sensor.damping * element.k_tangential;
      }
      mjsBody* carrier = mjs_getParent(mjs_findElement(spec.get(), mjOBJ_SITE, site_of(sensor).c_str()));
      const auto inverse_mass = recipe ? inverse_masses(bare.get(), data.get(), i) : std::vector<InverseMass>{};
      add_articulated_pad(spec.get(), carrier, sites[i], layout, touched_[i],
                          {scene_.friction.static_coefficient, scene_.friction.kinetic_coefficient}, settings, pillars_of(sensor),
                          inverse_mass);
    }
    ModelPointer model = compile(spec.get());
    for (const SensorScene& sensor : scene_.sensors) {
      const int body = mj_name2id(model.get(), mjOBJ_BODY, (pillars_of(sensor) + "/body/0").c_str());
      if (std::abs(model->body_mass[body] - settings.tip_mass) <= 1e-9 * settings.tip_mass) continue;
      throw SceneValueError(
          "model",
          fmt::format(
              "its compiler settings make a pillar's tip weigh {:.6g} kg instead of {:.6g} kg; with fidelity {} leave out boundmass and settotalmass",
              model->body_mass[body], settings.tip_mass, scene_.fidelity));
    }
    return model;
  }

 private:
  using Jacobian = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>;

  static Pose pose_at(const mjtNum* position, const mjtNum* rotation) {
    return {Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rotation),
            Eigen::Map<const Eigen::Vector3d>(position)};
  }

  struct Vfs {
    Vfs() { mj_defaultVFS(&vfs); }
    ~Vfs() { mj_deleteVFS(&vfs); }
    Vfs(const Vfs&) = delete;
    Vfs& operator=(const Vfs&) = delete;
    mjVFS vfs;
  };

  [[nodiscard]] std::string placed(const char* message) const {
    return scene_.model.empty() ? message : placed_message(scene_.model, message);
  }

  ModelPointer compile(mjSpec* spec) {
    ModelPointer model;
    call_mujoco([&] { model.reset(mj_compile(spec, &vfs_.vfs)); });
    if (!model) throw SceneValueError(blamed(scene_), "MuJoCo cannot compile the model: " + placed(mjs_getError(spec)));
    return model;
  }

  // Returns data at the scene's initial pose.
  static DataPointer start_of(const mjModel* model) {
    DataPointer data;
    call_mujoco([&] {
      data.reset(mj_makeData(model));
      mj_forward(model, data.get());
    });
    return data;
  }

  // Gives the joints the inertia m + c dt + k dt^2 that they have in a step of the discrete
  // integrator.
  static void weigh_joints_down(mjModel* model, double dt) {
    for (int dof = 0; dof < model->nv; ++dof) model->dof_armature[dof] += dt * model->dof_damping[dof];
    for (int joint = 0; joint < model->njnt; ++joint) {
      if (model->jnt_type[joint] != mjJNT_SLIDE && model->jnt_type[joint] != mjJNT_HINGE) continue;
      model->dof_armature[model->jnt_dofadr[joint]] += dt * dt * model->jnt_stiffness[joint];
    }
    call_mujoco([model] {
      const DataPointer scratch(mj_makeData(model));
      mj_setConst(model, scratch.get());
    });
  }

  // For add_articulated_pad(): returns per element the inverse mass of the pad's body at the tip
  // and of every touched body at its point nearest to the tip. There the tip will touch if it moves
  // along its axis, and no lever is longer than the body.
  [[nodiscard]] std::vector<InverseMass> inverse_masses(const mjModel* model, mjData* data, std::size_t sensor) const {
    struct Touched {
      int body;
      Pose surface;
      Surface shape;
    };
    std::vector<Touched> geoms;
    for (const std::string& name : touched_[sensor]) {
      const int geom = mj_name2id(model, mjOBJ_GEOM, name.c_str());
      GeomSurface surface = surface_of_geom(model, geom);
      geoms.push_back({model->geom_bodyid[geom],
                       pose_at(data->geom_xpos + 3 * geom, data->geom_xmat + 9 * geom) * surface.in_geom,
                       std::move(surface.shape)});
    }
    const int site = mj_name2id(model, mjOBJ_SITE, site_of(scene_.sensors[sensor]).c_str());
    const Pose pad = pose_at(data->site_xpos + 3 * site, data->site_xmat + 9 * site);
    std::vector<InverseMass> result;
    for (const Element& element : pads_[sensor]->elements) {
      const Eigen::Vector3d tip = pad * element.tip, axis = pad.rotation * element.axis;
      struct Nearest {
        double gap;
        Eigen::Vector3d point;
      };
      std::map<int, Nearest> met;  // by body
      for (const Touched& geom : geoms) {
        const Eigen::Vector3d p = geom.surface.inverse() * tip, a = geom.surface.rotation.transpose() * axis;
        const SurfacePoint at =
            std::visit([&](const auto& shape) { return shape.at(p.x(), p.y(), p.z(), a.x(), a.y(), a.z()); }, geom.shape);
        const Eigen::Vector3d point = geom.surface * Eigen::Vector3d(p - at.gap * Eigen::Vector3d(at.nx, at.ny, at.nz));
        const auto [known, added] = met.try_emplace(geom.body, Nearest{at.gap, point});
        if (!added && at.gap < known->second.gap) known->second = {at.gap, point};
      }
      RowMatrix along(static_cast<Eigen::Index>(met.size()), static_cast<Eigen::Index>(model->nv));
      Jacobian of_tip(3, model->nv), of_object(3, model->nv);
      mj_jac(model, data, of_tip.data(), nullptr, tip.data(), model->site_bodyid[site]);
      Eigen::Index row = 0;
      for (const auto& [body, nearest] : met) {
        mj_jac(model, data, of_object.data(), nullptr, nearest.point.data(), body);
        along.row(row++) = axis.transpose() * (of_tip - of_object);
      }
      const Eigen::VectorXd w = delassus(model, data, along).diagonal();
      result.push_back({w.maxCoeff(), w.minCoeff()});
    }
    return result;
  }

  // Refuses settings that MuJoCo would silently ignore or treat differently.
  void refuse_articulated(const mjModel* model) const {
    const auto refuse_flag = [](const std::string& flag, const std::string& setting) {
      throw SceneValueError(
          "model",
          fmt::format("its flag {} is {}, which breaks articulated pads; use the default, or fidelity: field", flag, setting));
    };
    using Flag = std::pair<int, const char*>;
    for (const auto& [bit, flag] : {Flag{mjDSBL_CONSTRAINT, "constraint"}, Flag{mjDSBL_CONTACT, "contact"},
                                    Flag{mjDSBL_SPRING, "spring"}, Flag{mjDSBL_DAMPER, "damper"}}) {
      if ((model->opt.disableflags & bit) != 0) refuse_flag(flag, "disabled");
    }
    for (const auto& [bit, flag] : {Flag{mjENBL_OVERRIDE, "override"}, Flag{mjENBL_SLEEP, "sleep"}}) {
      if ((model->opt.enableflags & bit) != 0) refuse_flag(flag, "enabled");
    }
    for (std::size_t i = 0; i < scene_.sensors.size(); ++i) {
      for (const std::string& name : touched_[i]) {
        const int type = model->geom_type[mj_name2id(model, mjOBJ_GEOM, name.c_str())];
        if (type == mjGEOM_PLANE || (type >= mjGEOM_SPHERE && type <= mjGEOM_BOX)) continue;
        throw SceneValueError(
            "sensors." + scene_.sensors[i].name + ".touches",
            "the geom " + quote(name) +
                " is a mesh, a height field or a distance field, which MuJoCo's own contact treats differently; allowed with fidelity " +
                scene_.fidelity + ": plane, box, sphere, cylinder, capsule, ellipsoid");
      }
    }
  }

  SpecPointer parse(const std::string& extension_text) {
    std::array<char, 1024> error{};
    const auto size = static_cast<int>(error.size());
    SpecPointer spec;
    if (scene_.model.empty() && extension_text.empty()) {
      spec.reset(mj_makeSpec());  // faster: MuJoCo processes its whole schema for each text
    } else if (scene_.model.empty()) {
      const std::string text = fmt::format("<mujoco>{}</mujoco>", extension_text);
      call_mujoco([&] { spec.reset(mj_parseXMLString(text.c_str(), nullptr, error.data(), size)); });
    } else {
      try {
        check_mjcf(scene_.model);
        check_readable_once(FileKind::model, scene_.model);
      } catch (const InputError& error) {
        throw SceneValueError("model", error.what());
      }
      if (!std::ifstream(scene_.model)) throw SceneValueError("model", quote(scene_.model) + " cannot be read");
      const std::filesystem::path file(scene_.model);
      const std::string wrapper = (file.parent_path() / wrapper_name).string();
      const std::string text =
          fmt::format("<mujoco>{}<include file=\"{}\"/></mujoco>", extension_text, escaped(file.filename().string()));
      mj_deleteFileVFS(&vfs_.vfs, wrapper.c_str());
      mj_addBufferVFS(&vfs_.vfs, wrapper.c_str(), text.data(), static_cast<int>(text.size()));
      call_mujoco([&] { spec.reset(mj_parseXML(wrapper.c_str(), &vfs_.vfs, error.data(), size)); });
    }
    if (!spec) throw SceneValueError(blamed(scene_), "MuJoCo cannot read the model: " + placed(error.data()));
    return spec;
  }

  void add_all(mjSpec* spec) {
    while (mjsElement* key = mjs_firstElement(spec, mjOBJ_KEY)) mjs_delete(spec, key);
    if (scene_.gravity || scene_.model.empty()) {
      spec->option.gravity[0] = spec->option.gravity[1] = 0.0;
      spec->option.gravity[2] = -scene_.gravity.value_or(earth_gravity);
      spec->option.disableflags &= ~mjDSBL_GRAVITY;
    }
    spec->option.disableflags |= mjDSBL_AUTORESET;
    if (scene_.model.empty()) {
      spec->option.integrator = mjINT_IMPLICITFAST;
      spec->option.cone = mjCONE_ELLIPTIC;
      spec->option.noslip_iterations = 10;
      if (scene_.implicit_fields()) spec->option.impratio = implicit_impratio;
    }
    // Without sensors MuJoCo would still prepare for them at every step.
    if (mjs_firstElement(spec, mjOBJ_SENSOR) == nullptr) spec->option.disableflags |= mjDSBL_SENSOR;
    for (const BodyScene& body : scene_.bodies) add_body(spec, body);
    if (hand_ != nullptr) {
      add_fingers(mjs_findBody(spec, "world"), *hand_);
    }
    if (hand_ != nullptr && !scene_.contact) {
      mjs_setName(mjs_addSite(mjs_findBody(spec, hand_->box), nullptr)->element, corner_site);
      spec->option.integrator = mjINT_EULER;
      // no joint is damped
      spec->option.disableflags |= mjDSBL_EULERDAMP | mjDSBL_CONSTRAINT | mjDSBL_DAMPER;
    }
    if (!scene_.integrator.empty()) spec->option.integrator = integrator_named(scene_.integrator);
    if (std::ranges::any_of(scene_.sensors, [](const SensorScene& sensor) { return sensor.site.empty(); })) add_stage(spec);
    touched_.assign(scene_.sensors.size(), {});
    unnamed_ = 0;
    excluded_ = exclusions(spec);
    std::vector<SitePair> pairs;
    for (std::size_t i = 0; i < scene_.sensors.size(); ++i) mount(spec, i, pairs);
    if (scene_.implicit_fields()) prepare_implicit(spec, pairs);
  }

  void add_body(mjSpec* spec, const BodyScene& scene) const {
    const Parameters& p = scene.shape.parameters;
    if (mjs_findBody(spec, scene.name.c_str()) != nullptr || mjs_findElement(spec, mjOBJ_GEOM, scene.name.c_str()) != nullptr) {
      throw SceneValueError("bodies." + scene.name, "the model already has a body or geom of this name");
    }
    mjsBody* body = mjs_addBody(mjs_findBody(spec, "world"), nullptr);
    mjs_setName(body->element, scene.name.c_str());
    std::ranges::copy(p.vector("position"), body->pos);
    const std::vector<double>& angles = p.vector("rotation");
    const Eigen::Quaterniond turn(rotation_by_axes({angles[0], angles[1], angles[2]}));
    body->quat[0] = turn.w();
    for (int k = 0; k < 3; ++k) body->quat[1 + k] = turn.vec()[k];

    mjsGeom* geom = mjs_addGeom(body, nullptr);
    mjs_setName(geom->element, scene.name.c_str());
    geom->friction[0] = p.number("friction");
    geom->solref[0] = contact_time;
    if (scene_.contact) {
      std::ranges::copy(scene_.contact->vector("solref"), geom->solref);
      std::ranges::copy(scene_.contact->vector("solimp"), geom->solimp);
    }
    if (scene.shape.name == "plane") {
      geom->type = mjGEOM_PLANE;
      geom->size[2] = 1.0;  // spacing of the drawn grid; the extent of 0 means infinite
      return;
    }
    geom->mass = p.number("mass");
    if (scene.shape.name == "box") put_mass_at(body, p);
    if (scene.shape.name == "box" || scene.shape.name == "ellipsoid") {
      geom->type = scene.shape.name == "box" ? mjGEOM_BOX : mjGEOM_ELLIPSOID;
      for (int k = 0; k < 3; ++k) geom->size[k] = 0.5 * p.vector("size")[static_cast<std::size_t>(k)];
    } else {
      geom->type = scene.shape.name == "sphere"    ? mjGEOM_SPHERE
                   : scene.shape.name == "capsule" ? mjGEOM_CAPSULE
                                                   : mjGEOM_CYLINDER;
      geom->size[0] = p.number("radius");
      if (geom->type != mjGEOM_SPHERE) geom->size[1] = 0.5 * p.number("length");
      if (geom->type == mjGEOM_CYLINDER) hollow_out(body, scene);
    }
    if (p.flag("free")) {
      mjs_addFreeJoint(body);
    } else if (p.vector("velocity") != std::vector<double>(3, 0.0)) {
      throw SceneValueError("bodies." + scene.name + ".velocity", "only a free body (free: true) has a velocity");
    }
  }

  // Replaces the geom's own mass if the box's centre of mass is not its middle, or a weight is in
  // it. About the common centre of two masses m and w, r apart, I = I_m + m w/(m + w) (r^2 1 - r
  // r^T): parallel axes, the weight a point.
  static void put_mass_at(mjsBody* body, const Parameters& box) {
    const auto centre = Eigen::Vector3d::Map(box.vector("centre_of_mass").data());
    const double mass = box.number("mass"), weight = box.number("weight");
    if (centre.isZero(0.0) && weight == 0.0) return;
    const std::vector<double>& size = box.vector("size");
    const Eigen::Vector3d apart = Eigen::Vector3d::Map(box.vector("weight_place").data()) - centre;
    const Eigen::Matrix3d turned =
        mass * weight / (mass + weight) * (apart.squaredNorm() * Eigen::Matrix3d::Identity() - apart * apart.transpose());
    body->explicitinertial = 1;
    body->mass = mass + weight;
    mju_copy3(body->ipos, Eigen::Vector3d(centre + weight / (mass + weight) * apart).eval().data());
    for (int k = 0; k < 3; ++k) {
      const double a = size[static_cast<std::size_t>((k + 1) % 3)], b = size[static_cast<std::size_t>((k + 2) % 3)];
      body->inertia[k] = mass / 12.0 * (a * a + b * b) + turned(k, k);
    }
    const Eigen::Vector3d products(turned(0, 1), turned(0, 2), turned(1, 2));
    if (products.isZero(0.0)) return;
    mju_copy3(body->fullinertia, body->inertia);
    mju_zero3(body->inertia);  // MuJoCo accepts only one of them
    mju_copy3(body->fullinertia + 3, products.data());
  }

  // Replaces the geom's own mass if the cylinder is hollow or its centre of mass is not its middle:
  // I_z = m/2 (R^2 + r^2), I_x = I_y = m/12 (3 R^2 + 3 r^2 + L^2).
  static void hollow_out(mjsBody* body, const BodyScene& scene) {
    const Parameters& cylinder = scene.shape.parameters;
    const auto centre = Eigen::Vector3d::Map(cylinder.vector("centre_of_mass").data());
    const double mass = cylinder.number("mass"), radius = cylinder.number("radius"), bore = cylinder.number("bore");
    if (centre.isZero(0.0) && bore == 0.0) return;
    if (!(bore < radius)) {
      throw SceneValueError("bodies." + scene.name + ".bore", format_quantity(bore, Quantity::length) +
                                                                  " leaves no wall; allowed: less than the radius, " +
                                                                  format_quantity(radius, Quantity::length));
    }
    const double squares = radius * radius + bore * bore, length = cylinder.number("length");
    body->explicitinertial = 1;
    body->mass = mass;
    mju_copy3(body->ipos, centre.data());
    body->inertia[0] = body->inertia[1] = mass / 12.0 * (3.0 * squares + length * length);
    body->inertia[2] = 0.5 * mass * squares;
  }

  static void add_stage(mjSpec* spec) {
    mjsBody* stage = mjs_addBody(mjs_findBody(spec, "world"), nullptr);
    mjs_setName(stage->element, stage_name);
    mjs_addFreeJoint(stage);
    stage->explicitinertial = 1;
    stage->mass = stage->inertia[0] = stage->inertia[1] = stage->inertia[2] = stage_mass;
    stage->gravcomp = 1.0;
    mjs_setName(mjs_addSite(stage, nullptr)->element, stage_name);
  }

  // Finds the pad's site and the geoms that it touches, and excludes contacts between their bodies.
  void mount(mjSpec* spec, std::size_t i, std::vector<SitePair>& pairs) {
    const SensorScene& sensor = scene_.sensors[i];
    const std::string path = "sensors." + sensor.name;
    mjsElement* site = mjs_findElement(spec, mjOBJ_SITE, site_of(sensor).c_str());
    if (site == nullptr) {
      throw SceneValueError(
          path + ".site", "the model has no site " + quote(sensor.site) + allowed_names(sensor.site, names_in(spec, mjOBJ_SITE)));
    }
    mjsBody* pad_body = mjs_getParent(site);
    std::set<mjsBody*> objects;
    for (std::size_t k = 0; k < sensor.touches.size(); ++k)
      touch(spec, i, sensor.touches[k], fmt::format("{}.touches.{}", path, k), objects);
    if (objects.contains(pad_body)) {
      throw SceneValueError(path + ".touches", "the pad is mounted on the body that it touches; name another body");
    }
    const std::string pad_name = name_of(pad_body->element, "slipbench/pad of " + sensor.name);
    for (mjsBody* object : in_order(spec, objects)) {
      const std::string object_name = name_of(object->element, fmt::format("slipbench/touched {}", ++unnamed_));
      exclude(spec, pad_name, object_name);
      if (!scene_.implicit_fields()) continue;
      const std::string object_site = "slipbench/" + object_name;
      if (mjs_findElement(spec, mjOBJ_SITE, object_site.c_str()) == nullptr) {
        mjs_setName(mjs_addSite(object, nullptr)->element, object_site.c_str());
      }
      pairs.push_back({site_of(sensor), object_site});
    }
  }

  // Returns the bodies in the order of the model, because the order of a set of pointers differs
  // from run to run.
  static std::vector<mjsBody*> in_order(const mjSpec* spec, const std::set<mjsBody*>& bodies) {
    std::vector<mjsBody*> result;
    for (mjsElement* e = mjs_firstElement(spec, mjOBJ_BODY); e != nullptr; e = mjs_nextElement(spec, e)) {
      if (mjsBody* body = mjs_asBody(e); bodies.contains(body)) result.push_back(body);
    }
    return result;
  }

  void touch(mjSpec* spec, std::size_t sensor, const std::string& name, const std::string& path, std::set<mjsBody*>& objects) {
    std::vector<mjsElement*> geoms;
    if (mjsElement* geom = mjs_findElement(spec, mjOBJ_GEOM, name.c_str())) {
      geoms.push_back(geom);
    } else if (mjsBody* body = mjs_findBody(spec, name.c_str())) {
      for (mjsElement* e = mjs_firstChild(body, mjOBJ_GEOM, 0); e != nullptr; e = mjs_nextChild(body, e, 0)) geoms.push_back(e);
      if (geoms.empty()) throw SceneValueError(path, "the body " + quote(name) + " has no geom, so a pad cannot touch it");
    } else {
      std::vector<std::string> known = names_in(spec, mjOBJ_GEOM);
      for (const std::string& body_name : names_in(spec, mjOBJ_BODY)) {
        if (std::ranges::find(known, body_name) == known.end() && body_name != stage_name) known.push_back(body_name);
      }
      throw SceneValueError(path, "no geom or body " + quote(name) + allowed_names(name, known));
    }
    for (mjsElement* geom : geoms) {
      const std::string geom_name = name_of(geom, fmt::format("{}/geom{}", name, touched_[sensor].size()));
      if (geom_name.find_first_of(" \t\n") != std::string::npos) {
        throw SceneValueError(path, "the geom " + quote(geom_name) + " has a space in its name; rename it");
      }
      if (std::ranges::find(touched_[sensor], geom_name) != touched_[sensor].end()) {
        throw SceneValueError(path, "the geom " + quote(geom_name) + " is listed twice");
      }
      touched_[sensor].push_back(geom_name);
      objects.insert(mjs_getParent(geom));
    }
  }

  static std::set<std::pair<std::string, std::string>> exclusions(const mjSpec* spec) {
    std::set<std::pair<std::string, std::string>> pairs;
    for (mjsElement* e = mjs_firstElement(spec, mjOBJ_EXCLUDE); e != nullptr; e = mjs_nextElement(spec, e)) {
      const mjsExclude* exclude = mjs_asExclude(e);
      pairs.insert(std::minmax<std::string>(mjs_getString(exclude->bodyname1), mjs_getString(exclude->bodyname2)));
    }
    return pairs;
  }

  void exclude(mjSpec* spec, const std::string& a, const std::string& b) {
    if (!excluded_.insert(std::minmax(a, b)).second) return;
    mjsExclude* exclude = mjs_addExclude(spec);
    mjs_setString(exclude->bodyname1, a.c_str());
    mjs_setString(exclude->bodyname2, b.c_str());
  }

  // Returns the plugin's instances, in the form in which a user would write them.
  [[nodiscard]] std::string extension(LayoutsInMemory& layouts_in_memory) const {
    std::string text = fmt::format("<extension><plugin plugin=\"{}\">", bench_plugin_name);
    for (std::size_t i = 0; i < scene_.sensors.size(); ++i) {
      const SensorScene& sensor = scene_.sensors[i];
      const FrictionScene& friction = sensor.friction.value_or(scene_.friction);
      std::string geoms;
      for (const std::string& geom : touched_[i]) geoms += (geoms.empty() ? "" : " ") + geom;
      text += fmt::format("<instance name=\"{}\">", sensor.name);
      text += config_element("pad", site_of(sensor)) + config_element("touch", geoms) +
              config_element("elements", layouts_in_memory.add(*pads_[i])) +
              config_element("friction", fmt::format("{{static: {}, kinetic: {}}}", format_number(friction.static_coefficient),
                                                     format_number(friction.kinetic_coefficient))) +
              config_element("effects", sensor.friction ? "[]" : yaml_of(scene_.effects)) +
              config_element("seed", std::to_string(scene_.seed)) + config_element("trial", std::to_string(trial_)) +
              config_element("damping", format_number(sensor.damping)) +
              config_element("solver", scene_.implicit_fields() ? "implicit" : "explicit") + config_element("check", "off");
      text += "</instance>";
    }
    return text + "</plugin></extension>";
  }

  const Scene& scene_;
  std::span<const PadLayout* const> pads_;
  std::uint64_t trial_;
  const Hand* hand_;
  Vfs vfs_;
  std::vector<std::vector<std::string>> touched_;  // names of geoms, by sensor
  std::set<std::pair<std::string, std::string>> excluded_;
  int unnamed_ = 0;
};

}  // namespace

ModelPointer build_model(const Scene& scene, std::span<const PadLayout* const> pads, std::uint64_t trial, const Hand* hand,
                         LayoutsInMemory& layouts_in_memory) {
  return Builder(scene, pads, trial, hand).build(layouts_in_memory);
}

ModelPointer build_articulated_model(const Scene& scene, std::span<const PadLayout* const> pads,
                                     const std::function<double(double)>& step_for, const Hand* hand) {
  return Builder(scene, pads, 0, hand).build_articulated(step_for);
}

std::string site_of(const SensorScene& sensor) { return sensor.site.empty() ? stage_name : sensor.site; }
std::string pillars_of(const SensorScene& sensor) { return "slipbench/" + sensor.name; }

}  // namespace slipbench
