#include "sim/scene/sweep.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <set>
#include <span>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "sim/core/error.h"
#include "sim/core/math.h"

namespace slipbench {
namespace {

constexpr std::size_t max_paths = 1000;
constexpr int max_redraws = 1000;
constexpr double infinity = std::numeric_limits<double>::infinity();

void mark_drawn(YamlNode& node) {
  node.origin.drawn = true;
  node.key_origin.drawn = true;
  for (YamlNode& child : node.children) mark_drawn(child);
}

// Returns the values to choose from, of an axis of the grid or of a draw.
std::vector<YamlNode> values_of(const YamlNode& node, const std::string& where) {
  if (node.kind != YamlNode::Kind::sequence || node.children.empty()) {
    const std::string found = node.kind == YamlNode::Kind::sequence ? "empty" : described(node);
    fail(node.origin, where + " is " + found + "; allowed: a sequence of at least one value");
  }
  return node.children;
}

bool starts_with(std::span<const std::string> path, std::span<const std::string> prefix) {
  return path.size() >= prefix.size() && std::ranges::equal(path.first(prefix.size()), prefix);
}

// Reads the numbers of a draw; all except lognormal's sd share one quantity, given by the units.
class DrawReader {
 public:
  DrawReader(const YamlNode& map, std::string where) : map_(map), where_(std::move(where)) {}

  Draw read(std::vector<YamlNode>& values) {
    const DrawKind& kind = read_kind();
    Draw draw{.kind = kind.kind, .min = -infinity, .max = infinity, .origin = map_.origin};
    draw.origin.drawn = true;
    check_keys(kind);
    if (draw.kind == Draw::Kind::choice) {
      values = values_of(*map_.find("values"), where_ + ".values");
      for (YamlNode& value : values) mark_drawn(value);
      return draw;
    }
    const bool relative_sd = draw.kind == Draw::Kind::lognormal;
    draw.quantity = shared_quantity(relative_sd);
    for (const auto& [key, member] :
         {std::pair{"mean", &Draw::centre}, {"median", &Draw::centre}, {"min", &Draw::min}, {"max", &Draw::max}}) {
      if (const YamlNode* node = map_.find(key)) draw.*member = number(*node, draw.quantity);
    }
    if (const YamlNode* node = map_.find("sd")) draw.sd = number(*node, relative_sd ? Quantity::none : draw.quantity);
    check_values(draw);
    return draw;
  }

 private:
  const DrawKind& read_kind() const {
    const YamlNode* node = map_.find("draw");
    std::vector<std::string_view> names;
    for (const DrawKind& kind : draw_kinds()) names.push_back(kind.name);
    if (node == nullptr) fail(map_.origin, "no key 'draw' in " + where_ + allowed_names("", names));
    if (node->kind != YamlNode::Kind::scalar)
      fail(node->origin, where_ + ".draw is " + described(*node) + allowed_names("", names));
    const auto found = std::ranges::find(draw_kinds(), node->text, &DrawKind::name);
    if (found == draw_kinds().end()) fail(node->origin, "unknown draw " + quote(node->text) + allowed_names(node->text, names));
    return *found;
  }

  void check_keys(const DrawKind& kind) const {
    std::vector<std::string_view> allowed{"draw"};
    allowed.insert(allowed.end(), kind.required.begin(), kind.required.end());
    allowed.insert(allowed.end(), kind.optional.begin(), kind.optional.end());
    std::ranges::sort(allowed);
    for (const YamlNode& child : map_.children) {
      if (std::ranges::find(allowed, child.key) == allowed.end()) {
        fail(child.key_origin, "unknown key " + quote(child.key) + " in " + where_ + allowed_names(child.key, allowed));
      }
    }
    for (const std::string_view key : kind.required) {
      if (map_.find(key) == nullptr) {
        fail(map_.origin, "no key " + quote(key) + " in " + where_ + "; a draw '" + std::string(kind.name) + "' needs this key");
      }
    }
  }

  static const std::string& text_of(const YamlNode& node, const std::string& where) {
    if (node.kind != YamlNode::Kind::scalar) fail(node.origin, where + " is " + described(node) + "; allowed: a number");
    return node.text;
  }

  Quantity shared_quantity(bool relative_sd) const {
    Quantity quantity = Quantity::none;
    for (const YamlNode& child : map_.children) {
      if (child.key == "draw" || (child.key == "sd" && relative_sd)) continue;
      const std::string where = where_ + "." + child.key;
      try {
        const Quantity found = quantity_of(text_of(child, where));
        if (quantity != Quantity::none && found != Quantity::none && found != quantity) {
          fail(child.origin, where + ": " + quote(child.text) +
                                 " has another unit than the other numbers; allowed: a number in " +
                                 std::string(si_symbol(quantity)));
        }
        if (found != Quantity::none) quantity = found;
      } catch (const std::invalid_argument& error) {
        fail(child.origin, where + ": " + error.what());
      }
    }
    return quantity;
  }

  double number(const YamlNode& node, Quantity quantity) const {
    const std::string where = where_ + "." + node.key;
    try {
      const double value = parse_quantity(text_of(node, where), quantity);
      if (!std::isfinite(value)) throw std::invalid_argument(quote(node.text) + " is infinite; allowed: a finite number");
      return value;
    } catch (const std::invalid_argument& error) {
      fail(node.origin, where + ": " + error.what());
    }
  }

  void refuse(std::string_view key, const std::string& allowed) const {
    const YamlNode& node = *map_.find(key);
    fail(node.origin, where_ + "." + node.key + ": " + quote(node.text) + " is out of range; allowed: " + allowed);
  }

  void check_values(const Draw& draw) const {
    if (draw.sd < 0.0) refuse("sd", ">= 0");
    if (draw.kind == Draw::Kind::lognormal && !(draw.centre > 0.0)) refuse("median", "> 0");
    if (draw.kind == Draw::Kind::log_uniform && !(draw.min > 0.0)) refuse("min", "> 0");
    if (!(draw.min < draw.max)) refuse("max", "more than min");
    if (draw.kind == Draw::Kind::uniform && !std::isfinite(draw.max - draw.min))
      refuse("max", "an interval within a double's range");
  }

  const YamlNode& map_;
  std::string where_;
};

double sample_once(const Draw& draw, RandomStream& random) {
  switch (draw.kind) {
    case Draw::Kind::uniform: return random.uniform(draw.min, draw.max);
    case Draw::Kind::log_uniform: return math::exp(random.uniform(math::log(draw.min), math::log(draw.max)));
    case Draw::Kind::normal: return random.normal(draw.centre, draw.sd);
    case Draw::Kind::lognormal: return draw.centre * math::exp(draw.sd * random.normal());
    case Draw::Kind::choice: break;
  }
  throw std::logic_error("a choice is not a number");
}

// Returns the value as a scene would write it, with the SI unit, so that a draw of the wrong
// dimension is refused when it is read.
YamlNode sample(const Draw& draw, RandomStream& random) {
  for (int i = 0; i < max_redraws; ++i) {
    const double value = sample_once(draw, random);
    // Rounding of exp may also leave the interval of log_uniform by one unit in the last place.
    if (value < draw.min || value > draw.max) continue;
    YamlNode node;
    node.kind = YamlNode::Kind::scalar;
    node.origin = draw.origin;
    node.text = format_number(value);
    if (draw.quantity != Quantity::none) node.text.append(" ").append(si_symbol(draw.quantity));
    return node;
  }
  fail(draw.origin, "no draw within [" + format_quantity(draw.min, draw.quantity) + ", " +
                        format_quantity(draw.max, draw.quantity) + "] in " + std::to_string(max_redraws) +
                        " tries; choose bounds nearer to the mean");
}

std::string named(const SweptPath& swept) { return "sweep." + (swept.parts.empty() ? "scene" : swept.path); }

[[noreturn]] void refuse_inside(const SweptPath& swept) {
  fail(swept.origin, named(swept) + " conflicts with a --set of a part of it; use --set " +
                         (swept.parts.empty() ? "for the whole value" : swept.path + "=... for the whole value"));
}

// Both values are from the command line, so neither takes precedence.
[[noreturn]] void refuse_both(const SweptPath& swept) {
  fail(swept.origin, named(swept) + " sweeps a key that --set fixes; remove one of the two");
}

// Removes the key at `path` from a map of an axis; returns true if it existed.
bool erase_inside(YamlNode& value, std::span<const std::string> path, const SweptPath& swept) {
  if (value.kind != YamlNode::Kind::map) refuse_inside(swept);
  if (path.size() == 1)
    return std::erase_if(value.children, [&](const YamlNode& child) { return child.key == path.front(); }) > 0;
  YamlNode* child = value.find(path.front());
  return child != nullptr && erase_inside(*child, path.subspan(1), swept);
}

bool is_typed(const YamlNode& node) { return node.origin.typed || std::ranges::any_of(node.children, is_typed); }

void collect(const YamlNode& value, const std::string& path, std::vector<std::string>& leaves) {
  if (value.kind != YamlNode::Kind::map) {
    leaves.push_back(path);
    return;
  }
  for (const YamlNode& child : value.children) collect(child, path.empty() ? child.key : path + "." + child.key, leaves);
}

[[noreturn]] void refuse_fixed(const YamlNode& node) { fail(node.key_origin, quote(node.key) + " cannot be swept"); }

}  // namespace

const std::vector<DrawKind>& draw_kinds() {
  static const std::vector<DrawKind> kinds{
      {"choice", Draw::Kind::choice, {"values"}, {}},
      {"log_uniform", Draw::Kind::log_uniform, {"min", "max"}, {}},
      {"lognormal", Draw::Kind::lognormal, {"median", "sd"}, {"min", "max"}},
      {"normal", Draw::Kind::normal, {"mean", "sd"}, {"min", "max"}},
      {"uniform", Draw::Kind::uniform, {"min", "max"}, {}},
  };
  return kinds;
}

bool is_fixed(std::string_view key) {
  constexpr std::array<std::string_view, 5> fixed{"expect", "seed", "slipbench", "split", "sweep"};
  return std::ranges::find(fixed, key) != fixed.end();
}

std::vector<std::string> leaves_of(const SweptPath& swept) {
  std::vector<std::string> found;
  if (swept.values.empty()) found.push_back(swept.path);
  for (const YamlNode& value : swept.values) collect(value, swept.path, found);
  return found;
}

Sweep::Sweep(const YamlNode* node, const std::vector<std::vector<std::string>>& overridden) {
  if (node == nullptr) return;
  if (node->kind != YamlNode::Kind::map) {
    fail(node->origin, "sweep is " + described(*node) + "; allowed: a map of paths, such as 'motion.speed: [1 mm/s, 4 mm/s]'");
  }
  if (node->children.size() > max_paths) {
    fail(node->origin,
         "sweep has " + std::to_string(node->children.size()) + " entries; allowed: at most " + std::to_string(max_paths));
  }
  for (const YamlNode& child : node->children) {
    if (child.key == "trials") {
      read_trials(child);
    } else if (child.key == "scene") {
      read_scenes(child);
    } else {
      read_path(child);
    }
  }
  drop_overridden(overridden);
  collect_leaves();
  for (const SweptPath& swept : paths_) {
    if (swept.draw) continue;
    if (swept.values.size() > max_cells / cells_) {
      fail(swept.origin, "the sweep has more than 1,000,000 grid cells, the most that is allowed");
    }
    cells_ *= swept.values.size();
  }
}

void Sweep::read_trials(const YamlNode& node) {
  const std::string& text = node.text;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), trials_);
  if (node.kind != YamlNode::Kind::scalar || error != std::errc{} || end != text.data() + text.size() || trials_ == 0 ||
      trials_ > max_cells) {
    fail(node.origin, "sweep.trials is " + described(node) + "; allowed: 1 to 1000000");
  }
}

// Maps that are merged into the scene itself: values of several sections that belong together.
void Sweep::read_scenes(const YamlNode& node) {
  SweptPath swept{
      .path = "", .parts = {}, .origin = node.key_origin, .values = {}, .draw = std::nullopt, .typed = is_typed(node)};
  if (node.kind == YamlNode::Kind::sequence) swept.values = values_of(node, "sweep.scene");
  if (node.kind == YamlNode::Kind::map) {
    swept.draw = DrawReader(node, "sweep.scene").read(swept.values);
    swept.origin.drawn = true;
  }
  for (const YamlNode& value : swept.values) {
    if (value.kind != YamlNode::Kind::map)
      fail(value.origin, "sweep.scene has " + described(value) + "; expected maps of the scene's keys");
    for (const YamlNode& child : value.children) {
      if (is_fixed(child.key)) refuse_fixed(child);
    }
  }
  if (swept.values.empty())
    fail(node.origin, "sweep.scene is " + described(node) +
                          "; expected a sequence of maps of the scene's keys, or {draw: choice, values: ...} with such maps");
  paths_.push_back(std::move(swept));
}

void Sweep::read_path(const YamlNode& node) {
  SweptPath swept{.path = node.key,
                  .parts = split_path(node.key, node.key_origin),
                  .origin = node.key_origin,
                  .values = {},
                  .draw = std::nullopt,
                  .typed = is_typed(node)};
  if (is_fixed(swept.parts.front())) refuse_fixed(node);
  const std::string where = "sweep." + node.key;
  if (node.kind == YamlNode::Kind::sequence) {
    swept.values = values_of(node, where);
  } else if (node.kind == YamlNode::Kind::map) {
    swept.draw = DrawReader(node, where).read(swept.values);
    swept.origin.drawn = true;
  } else {
    fail(node.origin, where + " is " + described(node) + "; allowed: a sequence of values, or {draw: ...}");
  }
  paths_.push_back(std::move(swept));
}

void Sweep::drop_overridden(const std::vector<std::vector<std::string>>& overridden) {
  for (const std::vector<std::string>& fixed : overridden) {
    std::erase_if(paths_, [&](const SweptPath& swept) { return starts_with(swept.parts, fixed) && !swept.typed; });
    for (SweptPath& swept : paths_) {
      if (!starts_with(fixed, swept.parts)) continue;
      if (fixed == swept.parts) refuse_both(swept);
      // A key inside an axis of maps is fixed: remove it from every map.
      const auto inside = std::span(fixed).subspan(swept.parts.size());
      for (YamlNode& value : swept.values) {
        if (erase_inside(value, inside, swept) && swept.typed) refuse_both(swept);
      }
      if (swept.values.empty()) refuse_inside(swept);
    }
  }
}

bool Sweep::sets(const std::string& path) const {
  return std::ranges::any_of(leaves_, [&](const std::string& leaf) { return leaf == path || leaf.starts_with(path + '.'); });
}

void Sweep::collect_leaves() {
  // Two entries that set the same value would hide each other. Sorted by its parts, a path directly
  // precedes those below it.
  struct Leaf {
    std::vector<std::string> parts;
    const SweptPath* owner;
  };
  std::vector<Leaf> sorted;
  std::set<std::string> seen;
  for (const SweptPath& swept : paths_) {
    for (const std::string& leaf : leaves_of(swept)) {
      sorted.push_back({split_path(leaf, swept.origin), &swept});
      if (seen.insert(leaf).second) leaves_.push_back(leaf);
    }
  }
  std::ranges::stable_sort(sorted, {}, &Leaf::parts);
  const Leaf* above = nullptr;
  for (const Leaf& leaf : sorted) {
    if (above == nullptr || !starts_with(leaf.parts, above->parts)) {
      above = &leaf;
    } else if (above->owner != leaf.owner) {
      const auto [first, second] = std::minmax(above->owner, leaf.owner);
      fail(second->origin, named(*second) + " sets a value that " + named(*first) + " sets too; set each value once");
    }
  }
}

void Sweep::apply_one(YamlNode& scene, std::size_t entry, std::size_t value, std::size_t others) const {
  for (std::size_t i = 0; i < paths_.size(); ++i) {
    const SweptPath& swept = paths_[i];
    if (swept.values.empty()) continue;
    merge(place_at(scene, swept.parts, swept.origin), swept.values[(i == entry ? value : others) % swept.values.size()]);
  }
}

void Sweep::apply(YamlNode& scene, std::size_t cell, std::uint64_t seed, std::size_t trial) const {
  std::size_t stride = cells_;
  for (const SweptPath& swept : paths_) {
    YamlNode& place = place_at(scene, swept.parts, swept.origin);
    if (!swept.draw) {
      stride /= swept.values.size();
      merge(place, swept.values[cell / stride % swept.values.size()]);
      continue;
    }
    RandomStream random(seed, trial, "sweep." + swept.path);
    merge(place, swept.values.empty() ? sample(*swept.draw, random) : swept.values[random.integer(swept.values.size())]);
  }
}

}  // namespace slipbench
