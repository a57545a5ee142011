#include "sim/scene/parser.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "sim/core/counted.h"
#include "sim/core/error.h"
#include "sim/core/process/regular_file.h"
#include "sim/scene/scene_reader.h"
#include "sim/scene/sweep.h"

namespace slipbench {
namespace {

constexpr std::size_t max_trials = 1'000'000;
constexpr std::size_t max_checked_cells = 10'000;

// Converts a swept value that is neither one number nor one name, such as a sequence of effects.
nlohmann::json json_of(const YamlNode& node) {
  switch (node.kind) {
    case YamlNode::Kind::null: return nullptr;
    case YamlNode::Kind::scalar: return node.text;
    case YamlNode::Kind::sequence: {
      nlohmann::json items = nlohmann::json::array();
      for (const YamlNode& child : node.children) items.push_back(json_of(child));
      return items;
    }
    case YamlNode::Kind::map: {
      nlohmann::json items = nlohmann::json::object();
      for (const YamlNode& child : node.children) items[child.key] = json_of(child);
      return items;
    }
  }
  throw std::logic_error("no such kind of node");
}

void mark_callers_own(YamlNode& node) {
  node.origin.callers_own = true;
  node.key_origin.callers_own = true;
  for (YamlNode& child : node.children) mark_callers_own(child);
}

void mark_typed(YamlNode& node) {
  node.origin.typed = true;
  node.key_origin.typed = true;
  for (YamlNode& child : node.children) mark_typed(child);
}

// A name in a scene that stands for figures, and the keys that together may replace all of them.
struct NamedFigures {
  std::string path;
  std::vector<std::string> replaced_by;
};

std::vector<NamedFigures> named_figures(const Catalogues& catalogues) {
  std::vector<NamedFigures> names{{"surface.material", {"friction.static", "friction.kinetic"}}, {"grip.protocol", {}}};
  for (const Protocol& protocol : catalogues.protocols) {
    for (const auto& [path, value] : protocol.defaults) names.back().replaced_by.push_back(path);
  }
  return names;
}

// Returns the entry of a list of entries such as `effects`, "texture" or {texture: ...}, or null.
const YamlNode* entry_named(const YamlNode& list, const std::string& name) {
  for (const YamlNode& item : list.children) {
    if (item.kind == YamlNode::Kind::scalar && item.text == name) return &item;
    if (const YamlNode* values = item.find(name)) return values;
  }
  return nullptr;
}

// Returns "friction.static (stage.yaml:7), friction.kinetic (stage.yaml:7)": the replacing keys
// that the scene has.
std::string replacements_in(const YamlNode& root, const NamedFigures& name) {
  std::string text;
  for (const std::string& path : name.replaced_by) {
    const YamlNode* node = node_at(root, split_path(path, {}));
    if (node != nullptr) text += (text.empty() ? "" : ", ") + path + " (" + node->origin.text() + ")";
  }
  return text;
}

// Refuses entry number `entry` of the sweep if all its values make the same scene: trials would
// differ only in the name.
void refuse_idle(const YamlNode& scene, const Sweep& sweep, std::size_t entry, const NamedFigures& name,
                 const Catalogues& catalogues) {
  std::size_t contexts = 1;
  for (const SweptPath& other : sweep.paths()) contexts = std::max(contexts, other.values.size());
  const SweptPath& swept = sweep.paths()[entry];
  for (std::size_t others = 0; others < contexts; ++others) {
    std::optional<Trace> first;
    for (std::size_t value = 0; value < swept.values.size(); ++value) {
      YamlNode root = scene;
      sweep.apply_one(root, entry, value, others);
      Trace read;
      try {
        read_scene(root, catalogues, &read);
      } catch (const InputError&) {
        return;  // not a valid scene without its draws
      }
      read.erase(name.path);
      if (first && read != *first) return;
      first = std::move(read);
    }
  }
  YamlNode root = scene;
  sweep.apply_one(root, entry, 0, 0);
  const std::string replacements = replacements_in(root, name);
  if (replacements.empty()) return;  // the values themselves are equal
  fail(swept.origin, "sweep." + swept.path + " has no effect: the friction of " + quote(name.path) + " is replaced by " +
                         replacements + "; sweep those instead, or leave them out");
}

void refuse_idle(const YamlNode& scene, const Sweep& sweep, const Catalogues& catalogues) {
  for (const SweptPath& swept : sweep.paths()) {
    const std::vector<std::string> leaves = leaves_of(swept);
    const bool of_words = std::ranges::all_of(leaves, [](const std::string& leaf) { return leaf == "description"; });
    if (swept.values.size() > 1 && of_words && !leaves.empty())
      fail(swept.origin, "a sweep of 'description' alone has no effect; sweep other keys too");
  }
  for (const NamedFigures& name : named_figures(catalogues)) {
    for (std::size_t entry = 0; entry < sweep.paths().size(); ++entry) {
      const SweptPath& swept = sweep.paths()[entry];
      if (swept.values.size() < 2) continue;
      const std::vector<std::string> leaves = leaves_of(swept);
      const bool of_names = std::ranges::all_of(leaves, [&](const std::string& leaf) { return leaf == name.path; });
      if (of_names) refuse_idle(scene, sweep, entry, name, catalogues);
    }
  }
}

}  // namespace

// A checked file, ready to be expanded; shared by the copies of a plan.
struct TrialPlan::Plan {
  YamlNode scene;  // without its sweep
  Sweep sweep;
  std::vector<std::vector<std::string>> leaves;  // the sweep's, split
};

SceneFile SceneFile::load(const std::string& path) {
  check_regular_file(path);
  std::ifstream stream(path, std::ios::binary);
  // One byte more than allowed: enough to detect a file that is too long.
  std::string text(max_yaml_bytes + 1, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!stream.is_open() || stream.bad()) throw InputError(path + ": cannot be read: " + std::strerror(errno));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  return from_text(std::move(text), path);
}

SceneFile SceneFile::from_text(std::string text, std::string name, bool callers_own) {
  SceneFile file;
  YamlNode root = parse_yaml(text, name, true);
  if (callers_own) mark_callers_own(root);
  file.root_ = std::make_shared<const YamlNode>(std::move(root));
  file.text_ = std::move(text);
  file.name_ = std::move(name);
  return file;
}

void SceneFile::apply(const Override& change, MissingKey missing) {
  constexpr std::size_t longest = 200;  // in messages
  const std::string given = change.path + "=" + change.value;
  const std::string source = change.option + " " + given.substr(0, longest) + (given.size() > longest ? "..." : "");
  YamlNode value = parse_yaml(change.value, source, false);
  if (!change.of_sweep) mark_typed(value);
  if (!change.of_sweep && change.callers_own) mark_callers_own(value);
  std::vector<std::string> parts = split_path(change.path, value.origin);
  const bool sweeps = parts.front() == "sweep";
  if (sweeps && parts.size() > 1) parts = swept_parts(*root_, change.path);
  YamlNode root = *root_;
  if (value.kind != YamlNode::Kind::null) {
    assign(place_at(root, parts, value.origin), value);
  } else if (node_at(root, parts) != nullptr ||
             (missing == MissingKey::refused && (sweeps || !Sweep(root.find("sweep"), {}).sets(change.path)))) {
    remove_at(root, parts, value.origin);
  }
  root_ = std::make_shared<const YamlNode>(std::move(root));
  if (!sweeps) overridden_.push_back(std::move(parts));
}

Scene parse_scene(const SceneFile& file, const Catalogues& catalogues) {
  return TrialPlan(file, catalogues, 0, read_seed(*file.root_)).trial(0).scene;
}

TrialPlan::TrialPlan(const SceneFile& file, const Catalogues& catalogues, std::size_t draws, std::uint64_t seed)
    : catalogues_(&catalogues), seed_(seed) {
  auto plan = std::make_shared<Plan>(Plan{*file.root_, Sweep(file.root_->find("sweep"), file.overridden_), {}});
  std::erase_if(plan->scene.children, [](const YamlNode& child) { return child.key == "sweep"; });
  for (const std::string& leaf : plan->sweep.leaves()) plan->leaves.push_back(split_path(leaf, {}));
  plan_ = std::move(plan);
  draws_ = draws == 0 ? plan_->sweep.trials() : draws;
  if (draws_ > max_trials / plan_->sweep.cells()) {
    throw InputError(file.name_ + ": " + counted(plan_->sweep.cells(), "grid cell") + " of " + counted(draws_, "trial") +
                     " each; allowed: at most 1,000,000 trials");
  }
  count_ = plan_->sweep.cells() * draws_;
  for (std::size_t cell = 0; cell < std::min(plan_->sweep.cells(), max_checked_cells); ++cell) {
    YamlNode root = plan_->scene;
    scene_of(cell * draws_, root, nullptr);
  }
  refuse_idle(plan_->scene, plan_->sweep, catalogues);
}

Scene TrialPlan::read(std::size_t index, Trace& values) const {
  YamlNode root = plan_->scene;
  return scene_of(index, root, &values);
}

Scene TrialPlan::scene_of(std::size_t index, YamlNode& root, Trace* trace) const {
  plan_->sweep.apply(root, index / draws_, seed_, index);
  Scene scene = read_scene(root, *catalogues_, trace);
  scene.seed = seed_;
  return scene;
}

std::string TrialPlan::where(std::size_t index, const std::string& path) const {
  YamlNode root = plan_->scene;
  plan_->sweep.apply(root, index / draws_, seed_, index);
  const YamlNode* node = &root;
  for (const std::string& part : split_path(path, {})) {
    const YamlNode* next = node_at(*node, {&part, 1});
    if (next == nullptr && node->kind == YamlNode::Kind::sequence) next = entry_named(*node, part);
    if (next == nullptr) break;
    node = next;
  }
  return node->origin.text();
}

TrialPlan::Trial TrialPlan::trial(std::size_t index) const {
  if (index >= count_) throw std::out_of_range("trial " + std::to_string(index) + " of " + std::to_string(count_));
  Trial trial;
  Trace trace;
  YamlNode root = plan_->scene;
  trial.scene = scene_of(index, root, plan_->leaves.empty() ? nullptr : &trace);
  for (std::size_t i = 0; i < plan_->leaves.size(); ++i) {
    const std::string& path = plan_->sweep.leaves()[i];
    const auto read = trace.find(path);
    const YamlNode* node = read == trace.end() ? node_at(root, plan_->leaves[i]) : nullptr;
    trial.drawn.emplace_back(path, read != trace.end() ? read->second.json : node != nullptr ? json_of(*node).dump() : "null");
  }
  return trial;
}

}  // namespace slipbench
