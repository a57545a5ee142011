#include "sim/effects/install.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>

#include "sim/core/error.h"

namespace slipbench {
namespace {

EffectContext context_for(const PadLayout& layout, const Surface& surface, std::uint64_t seed, std::uint64_t trial) {
  EffectContext context;
  context.layout = &layout;
  context.elements = layout.elements.size();
  context.share.resize(context.elements);
  for (const UnitRange& unit : layout.units) {
    for (std::size_t i = 0; i < unit.count; ++i) context.share[unit.first + i] = 1.0 / static_cast<double>(unit.count);
  }
  for (const Element& element : layout.elements) {
    context.k_normal.push_back(element.k_normal);
    context.k_tangential.push_back(element.k_tangential);
  }
  context.plane = std::holds_alternative<Plane>(surface);
  context.dashpots =
      std::ranges::any_of(layout.elements, [](const Element& e) { return e.c_normal > 0.0 || e.c_tangential > 0.0; });
  context.flat_surface = std::holds_alternative<Plane>(surface) || std::holds_alternative<Box>(surface);
  context.seed = seed;
  context.trial = trial;
  return context;
}

// The parts of which a field has at most one; null: it has none.
std::array<const void*, 4> single_parts(const FieldEffects& effects) {
  return {effects.rate.get(), effects.cone.get(), effects.tip.get(), effects.skin.get()};
}
constexpr std::array<const char*, 4> single_names{"rate law", "friction cone", "law of the tips' motion", "elastic skin"};

}  // namespace

const EffectKind& effect_kind(std::string_view name) {
  return *std::ranges::find(effect_catalogue(), name, [](const EffectKind& kind) { return std::string_view(kind.about.name); });
}

FieldEffects install_effects(const std::vector<Named>& effects, const PadLayout& layout, const Surface& surface,
                             std::uint64_t seed, std::uint64_t trial) {
  FieldEffects installed;
  std::string moves_tips, maps_tips, replaces_springs;  // the first effect of each kind
  std::array<std::string, 4> owners;                    // of single_parts()
  const EffectContext context = context_for(layout, surface, seed, trial);
  for (const bool after_tip : {false, true}) {
    for (const Named& effect : effects) {
      const EffectKind& kind = effect_kind(effect.name);
      if (kind.after_tip != after_tip) continue;
      const std::array<const void*, 4> before = single_parts(installed);
      kind.install(effect.parameters, context, installed);
      const std::array<const void*, 4> after = single_parts(installed);
      for (std::size_t k = 0; k < after.size(); ++k) {
        if (after[k] == before[k]) continue;
        if (before[k] != nullptr) {
          throw SceneValueError("effects",
                                owners[k] + " and " + effect.name + " cannot be combined: a pad has only one " + single_names[k]);
        }
        owners[k] = effect.name;
      }
      const auto name_first = [&effect](bool is_installed, std::string& first) {
        if (is_installed && first.empty()) first = effect.name;
      };
      name_first(installed.tip != nullptr, moves_tips);
      name_first(installed.cone || installed.rate || !installed.rheology.empty(), maps_tips);
      name_first(installed.skin != nullptr, replaces_springs);
    }
  }
  if (!moves_tips.empty() && !maps_tips.empty()) {
    throw SceneValueError("effects", moves_tips + " and " + maps_tips + " cannot be combined: " + moves_tips +
                                         " moves the tips by its own spring, dashpot and friction");
  }
  if (installed.skin && (installed.tip || !maps_tips.empty())) {
    throw SceneValueError("effects", replaces_springs + " and " + (installed.tip ? moves_tips : maps_tips) +
                                         " cannot be combined: each of them sets the force of an element");
  }
  return installed;
}

double longest_step(const FieldEffects& effects, double speed) {
  double longest = std::numeric_limits<double>::infinity();
  effects.for_each([&](const Effect& effect) { longest = std::min(longest, effect.longest_step(speed)); });
  return longest;
}

}  // namespace slipbench
