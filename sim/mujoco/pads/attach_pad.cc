#include "sim/mujoco/pads/attach_pad.h"

#include <algorithm>
#include <array>
#include <set>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <mujoco/mujoco.h>

#include "sim/core/error.h"
#include "sim/mujoco/mjcf.h"
#include "sim/mujoco/mujoco_call.h"
#include "sim/mujoco/pads/implicit.h"
#include "sim/mujoco/pads/register_plugin.h"

namespace slipbench {
namespace {

std::vector<mjsElement*> elements_of(const mjSpec* spec, mjtObj type) {
  std::vector<mjsElement*> all;
  for (mjsElement* one = mjs_firstElement(spec, type); one != nullptr; one = mjs_nextElement(spec, one)) all.push_back(one);
  return all;
}

std::vector<mjsBody*> bodies_of(const mjSpec* spec) {
  std::vector<mjsBody*> all;
  for (mjsElement* element : elements_of(spec, mjOBJ_BODY)) all.push_back(mjs_asBody(element));
  return all;
}

std::string name_of(mjsElement* element) { return mjs_getString(mjs_getName(element)); }

// Returns the body's name and sets one if it has none, since excludes and tendons refer to names.
std::string named(mjSpec* spec, mjsBody* body) {
  if (name_of(body->element).empty()) {
    int number = 1;
    while (mjs_findBody(spec, fmt::format("slipbench_body_{}", number).c_str()) != nullptr) ++number;
    mjs_setName(body->element, fmt::format("slipbench_body_{}", number).c_str());
  }
  return name_of(body->element);
}

bool is_world(mjsBody* body) { return name_of(body->element) == "world"; }

bool has(mjsBody* body, mjtObj type) { return mjs_firstChild(body, type, 0) != nullptr; }

// Returns the bodies that move rigidly with this one; for a body fixed to the world only itself.
std::vector<mjsBody*> moving_with(const mjSpec* spec, mjsBody* body) {
  const auto top = [](mjsBody* b) {
    while (!is_world(b) && !has(b, mjOBJ_JOINT) && !b->mocap) b = mjs_getParent(b->element);
    return b;
  };
  mjsBody* const carrier = top(body);
  if (is_world(carrier)) return {body};
  std::vector<mjsBody*> all = bodies_of(spec);
  std::erase_if(all, [&](mjsBody* b) { return is_world(b) || top(b) != carrier; });
  return all;
}

// Returns the first moving ancestor of this body, where its kinematic tree begins; for a body fixed
// to the world itself.
mjsBody* beginning_of_tree(mjsBody* body) {
  mjsBody* first = body;
  for (mjsBody* b = body; !is_world(b); b = mjs_getParent(b->element)) {
    if (has(b, mjOBJ_JOINT)) first = b;
  }
  return first;
}

bool stands_below(mjsBody* body, mjsBody* root) {
  while (body != root && !is_world(body)) body = mjs_getParent(body->element);
  return body == root;
}

// Finds the element for a name as the plugin does: first with the prefix and suffix of the pad's
// instance.
mjsElement* look_up(const mjSpec* spec, const std::string& instance, const std::string& own, mjtObj type,
                    const std::string& name) {
  const auto find = [&](const std::string& whole) { return mjs_findElement(spec, type, whole.c_str()); };
  for (std::size_t at = instance.find(own); at != std::string::npos; at = instance.find(own, at + 1)) {
    if (mjsElement* found = find(instance.substr(0, at) + name + instance.substr(at + own.size()))) return found;
  }
  return find(name);
}

// Returns the bodies of the geoms that the words of `touch` name (pad_config.h), each once.
std::vector<mjsBody*> touched_bodies(const mjSpec* spec, const std::string& instance, const AttachedPad& pad, mjsBody* carrier) {
  std::vector<mjsBody*> bodies;
  const auto take = [&](mjsBody* body) {
    if (has(body, mjOBJ_GEOM) && std::ranges::find(bodies, body) == bodies.end()) bodies.push_back(body);
  };
  for (const std::string& word : pad.touch) {
    const std::size_t colon = std::min(word.find(':'), word.size());
    const std::string kind = word.substr(0, colon), rest = word.substr(std::min(colon + 1, word.size()));
    if (mjsElement* geom = look_up(spec, instance, pad.name, mjOBJ_GEOM, word)) {
      take(mjs_getParent(geom));
    } else if (kind == "body" || kind == "subtree") {
      mjsElement* const found = look_up(spec, instance, pad.name, mjOBJ_BODY, rest);
      if (found == nullptr) continue;
      mjsBody* const root = mjs_asBody(found);
      for (mjsBody* body : bodies_of(spec)) {
        if (kind == "body" ? body == root : stands_below(body, root)) take(body);
      }
    } else if (kind == "group") {
      const std::vector<mjsBody*> with_pad = moving_with(spec, carrier);
      for (mjsElement* geom : elements_of(spec, mjOBJ_GEOM)) {
        mjsBody* const body = mjs_getParent(geom);
        if (std::to_string(mjs_asGeom(geom)->group) == rest && std::ranges::find(with_pad, body) == with_pad.end()) take(body);
      }
    }
  }
  return bodies;
}

using Pair = std::pair<std::string, std::string>;

Pair pair_of(const std::string& a, const std::string& b) { return std::minmax(a, b); }

void exclude(mjSpec* spec, const std::string& pad_body, const std::string& body, std::set<Pair>& known) {
  // An exclude of the world would let bodies fall through its other geoms, the floor. The plugin
  // refuses a contact that is then possible.
  if (pad_body == body || pad_body == "world" || body == "world" || !known.insert(pair_of(pad_body, body)).second) return;
  mjsExclude* added = mjs_addExclude(spec);
  mjs_setString(added->bodyname1, pad_body.c_str());
  mjs_setString(added->bodyname2, body.c_str());
}

// Adds a plugin instance and the sensor that reads it. By XML, since MuJoCo's setter of attributes
// takes a map of the C++ library with which MuJoCo itself was built. Attached with a part of the
// name as prefix, because MuJoCo warns of an empty one.
void add_instance(mjSpec* spec, const std::string& own, const std::vector<std::pair<std::string, std::string>>& attributes) {
  const std::string prefix = own.substr(0, own.size() - 1), rest = escaped(own.substr(own.size() - 1));
  std::string configs;
  for (const auto& [key, value] : attributes) configs += config_element(key, value);
  const std::string xml = fmt::format(
      "<mujoco><extension><plugin plugin=\"{0}\"><instance name=\"{1}\">{2}</instance></plugin></extension><sensor><plugin name=\"{1}\" instance=\"{1}\"/></sensor></mujoco>",
      field_plugin_name, rest, configs);
  std::array<char, 500> error{};
  const SpecPointer child(mj_parseXMLString(xml.c_str(), nullptr, error.data(), static_cast<int>(error.size())));
  if (!child) throw InputError(error.data());
  const mjsFrame* const nothing = mjs_addFrame(mjs_findBody(child.get(), "world"), nullptr);
  if (mjs_attach(mjs_findBody(spec, "world")->element, nothing->element, prefix.c_str(), "") == nullptr)
    throw InputError(mjs_getError(spec));
}

}  // namespace

AttachedPad attach_pad(mjSpec* spec, const std::string& site, const std::vector<std::string>& touch, const PadOptions& options) {
  if (mjs_findElement(spec, mjOBJ_SITE, site.c_str()) == nullptr) {
    std::vector<std::string> names;
    for (mjsElement* one : elements_of(spec, mjOBJ_SITE)) names.push_back(name_of(one));
    std::erase(names, "");
    throw InputError(fmt::format("no site {} in the spec; allowed: {}", quote(site), fmt::join(names, ", ")));
  }
  AttachedPad pad{options.name.empty() ? site : options.name, site, touch, options.solver == "implicit"};
  for (mjsElement* one : elements_of(spec, mjOBJ_PLUGIN)) {
    if (mjs_getString(mjs_asPlugin(one)->name) == pad.name) {
      throw InputError(fmt::format("the spec already has a plugin {}; choose another name", quote(pad.name)));
    }
  }
  if (mjs_findElement(spec, mjOBJ_SENSOR, pad.name.c_str()) != nullptr) {
    throw InputError(fmt::format("the spec already has a sensor {}; choose another name", quote(pad.name)));
  }
  if (options.check != "error" && options.check != "warn") {
    throw InputError(fmt::format("check={}; allowed: error, warn", quote(options.check)));
  }
  if (mjp_getPlugin(field_plugin_name, nullptr) == nullptr) {
    throw InputError(fmt::format(
        "MuJoCo does not know the plugin {}; call mj_loadPluginLibrary() first, with the path that `slipbench plugin-path` prints",
        field_plugin_name));
  }

  std::vector<std::pair<std::string, std::string>> attributes{{"pad", site},
                                                              {"touch", fmt::format("{}", fmt::join(touch, " "))},
                                                              {"name", pad.name},
                                                              {"solver", options.solver},
                                                              {"truth", options.truth ? "true" : "false"},
                                                              {"seed", std::to_string(options.seed)},
                                                              {"trial", std::to_string(options.trial)},
                                                              {"check", options.check},
                                                              {"unloaded", options.unloaded}};
  if (options.pad.starts_with('[')) {
    attributes.emplace_back("elements", options.pad);
  } else {
    attributes.emplace_back("sensor", options.pad.starts_with('{') ? options.pad : "{type: " + options.pad + "}");
  }
  if (!options.friction.empty()) {
    attributes.emplace_back("friction",
                            options.friction.starts_with('{') ? options.friction : "{static: " + options.friction + "}");
  }
  if (!options.material.empty()) attributes.emplace_back("material", options.material);
  if (!options.effects.empty()) attributes.emplace_back("effects", options.effects);
  if (options.damping) attributes.emplace_back("damping", fmt::format("{}", *options.damping));
  add_instance(spec, pad.name, attributes);
  complete_pad(spec, pad);
  return pad;
}

void complete_pad(mjSpec* spec, const AttachedPad& pad) {
  std::set<Pair> known;
  for (mjsElement* one : elements_of(spec, mjOBJ_EXCLUDE)) {
    const mjsExclude* const declared = mjs_asExclude(one);
    known.insert(pair_of(mjs_getString(declared->bodyname1), mjs_getString(declared->bodyname2)));
  }
  std::vector<SitePair> tendons;
  for (mjsElement* one : elements_of(spec, mjOBJ_PLUGIN)) {
    const mjsPlugin* const plugin = mjs_asPlugin(one);
    const std::string instance = mjs_getString(plugin->name);
    if (mjs_getString(plugin->plugin_name) != std::string_view(field_plugin_name)) continue;
    if (!instance.starts_with(pad.name) && !instance.ends_with(pad.name)) continue;
    mjsElement* const site = look_up(spec, instance, pad.name, mjOBJ_SITE, pad.site);
    if (site == nullptr) continue;
    for (mjsBody* body : touched_bodies(spec, instance, pad, mjs_getParent(site))) {
      for (mjsBody* carrier : moving_with(spec, mjs_getParent(site)))
        exclude(spec, named(spec, carrier), named(spec, body), known);
      const std::string there =
          fmt::format("slipbench_{}_{}", named(spec, beginning_of_tree(mjs_getParent(site))), named(spec, body));
      if (!pad.implicit || mjs_findElement(spec, mjOBJ_SITE, there.c_str()) != nullptr) continue;
      mjsSite* const added = mjs_addSite(body, nullptr);
      mjs_setName(added->element, there.c_str());
      added->rgba[3] = 0.0F;
      tendons.push_back({name_of(site), there});
    }
  }
  if (!pad.implicit) return;
  prepare_implicit(spec, tendons);
  spec->option.iterations = std::max(spec->option.iterations, implicit_iterations);
  spec->option.impratio = std::max(spec->option.impratio, implicit_impratio);
  spec->option.cone = mjCONE_ELLIPTIC;
}

void prepare_implicit(mjSpec* spec, std::span<const SitePair> pairs) {
  for (const SitePair& pair : pairs) {
    for (const std::string& site : {pair.pad_site, pair.object_site}) {
      if (mjs_findElement(spec, mjOBJ_SITE, site.c_str()) == nullptr) {
        throw std::invalid_argument("implicit fields: the model has no site '" + site + "'");
      }
    }
  }
  spec->option.integrator = mjINT_DISCRETE;
  spec->option.noslip_iterations = 0;
  if (spec->option.solver == mjSOL_PGS) spec->option.solver = mjSOL_NEWTON;
  for (const SitePair& pair : pairs) {
    mjsTendon* tendon = mjs_addTendon(spec, nullptr);
    tendon->damping[0] = 1e-9;  // N s/m: negligible damping, but not zero
    tendon->rgba[3] = 0.0F;
    mjs_wrapSite(tendon, pair.pad_site.c_str());
    mjs_wrapSite(tendon, pair.object_site.c_str());
  }
}

}  // namespace slipbench
