#include "sim/testbench/testbench.h"

#include <algorithm>
#include <cmath>

#include <limits>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/effects/catalogue.h"
#include "sim/field/contact_labels.h"
#include "sim/field/field.h"
#include "sim/motion/motion.h"
#include "sim/scene/catalogues.h"
#include "sim/scene/materials.h"
#include "sim/testbench/surfaces.h"

namespace slipbench {
namespace {

// Times that should be whole multiples may miss by this share: they come from decimal text.
constexpr double rounding = 1e-9;

// How many steps within a sampling time are tried before sensors' rates count as having no common step.
constexpr double most_divisors = 100.0;

// The entry called `name` of a catalogue. The parser has let no other names through.
template <class Catalogue>
const auto& kind_named(const Catalogue& catalogue, const std::string& name) {
  return *std::find_if(catalogue.begin(), catalogue.end(), [&](const auto& kind) { return kind.about.name == name; });
}

// n when `longer` is n times `shorter`, else 0.
std::size_t whole_ratio(double longer, double shorter) {
  const double ratio = longer / shorter;
  const double nearest = std::round(ratio);
  return nearest >= 1.0 && std::abs(ratio - nearest) <= rounding * nearest ? static_cast<std::size_t>(nearest) : 0;
}

double reach_of(const PadLayout& layout) {
  double reach = 0.0;
  for (const Element& element : layout.elements) reach = std::max(reach, element.tip.norm());
  return reach;
}

EffectContext context_for(const PadLayout& layout, const Surface& surface, std::uint64_t seed, std::uint64_t trial) {
  EffectContext context;
  context.elements = layout.elements.size();
  context.share.resize(context.elements);
  for (const UnitRange& unit : layout.units) {
    for (std::size_t i = 0; i < unit.count; ++i) context.share[unit.first + i] = 1.0 / static_cast<double>(unit.count);
  }
  for (const Element& element : layout.elements) {
    context.k_normal.push_back(element.k_normal);
    context.k_tangential.push_back(element.k_tangential);
  }
  context.flat_surface = std::holds_alternative<Plane>(surface) || std::holds_alternative<Box>(surface);
  context.seed = seed;
  context.trial = trial;
  return context;
}

// The longest step that every effect resolves.
double longest_step(const FieldEffects& effects, double speed) {
  double longest = std::numeric_limits<double>::infinity();
  for (const auto& effect : effects.surface) longest = std::min(longest, effect->longest_step(speed));
  for (const auto& effect : effects.friction) longest = std::min(longest, effect->longest_step(speed));
  for (const auto& effect : effects.rheology) longest = std::min(longest, effect->longest_step(speed));
  if (effects.cone) longest = std::min(longest, effects.cone->longest_step(speed));
  return longest;
}

// Depth of the deepest tip inside the surface with its texture [m]; 0 when all are outside.
double deepest(const PadLayout& pad, const Surface& shape, const FieldEffects& effects, const Pose& pad_in_surface) {
  double depth = 0.0;
  for (const Element& element : pad.elements) {
    const Eigen::Vector3d tip = pad_in_surface * element.tip;
    const Eigen::Vector3d axis = pad_in_surface.rotation * element.axis;
    const SurfacePoint met =
        std::visit([&](const auto& s) { return s.at(tip.x(), tip.y(), tip.z(), axis.x(), axis.y(), axis.z()); }, shape);
    const double x = tip.x() - met.gap * met.nx, y = tip.y() - met.gap * met.ny;
    double gap = met.gap;
    for (const auto& effect : effects.surface) effect->displace(1, &x, &y, &met.nz, &gap);
    depth = std::max(depth, -gap);
  }
  return depth;
}

// How deep a tip may be in a shape until the far side is nearer than the one by which it came in [m].
struct HalfThickness {
  double operator()(const Plane&) const { return std::numeric_limits<double>::infinity(); }
  double operator()(const Box& box) const { return box.half.minCoeff(); }
  double operator()(const Cylinder& cylinder) const { return std::min(cylinder.radius, cylinder.half_length); }
  double operator()(const Sphere& sphere) const { return sphere.radius; }
};

// An element of a pad deeper than that would come out on the far side without having let go.
void refuse_too_deep(const Field& field, double half_thickness, double time) {
  constexpr double margin = 0.9;  // of the half thickness: a step must not lead over the rest of it
  for (std::size_t i = 0; i < field.size(); ++i) {
    if (field.penetration(i) > margin * half_thickness) {
      throw InputError(
          fmt::format("surface: at {} the pad is {} deep in a shape whose half thickness is {}; allowed: up to {} % of that, "
                      "by a larger shape or less motion.compression",
                      format_quantity(time, Quantity::time), format_quantity(field.penetration(i), Quantity::length),
                      format_quantity(half_thickness, Quantity::length), 100.0 * margin));
    }
  }
}

}  // namespace

struct Testbench::State {
  struct Pad {
    Field field;
    ContactLabels labels;
    std::size_t stride;
  };

  std::unique_ptr<Motion> motion;
  Pose world_in_surface;
  double half_thickness = 0.0;  // m, of the surface's shape
  std::vector<Pad> pads;
  std::vector<NamedBody> bodies;
  double dt = 0.0;
  std::size_t ticks = 0;
  std::size_t tick = 0;
};

Testbench::Testbench(const Scene& scene, std::span<const PadLayout* const> pads, std::span<const double> output_rates,
                     std::uint64_t trial)
    : state_(std::make_unique<State>()) {
  if (scene.fidelity != "field") {
    throw SceneValueError("fidelity", fmt::format("'{}' is not available in this version; allowed: field", scene.fidelity));
  }
  State& s = *state_;
  s.motion = kind_named(motion_catalogue(), scene.motion.name).create(scene.motion.parameters);
  const PlacedSurface surface = kind_named(surface_catalogue(), scene.surface.name).create(scene.surface.parameters);
  s.world_in_surface = surface.pose.inverse();
  s.half_thickness = std::visit(HalfThickness{}, surface.shape);

  double longest = std::numeric_limits<double>::infinity();
  std::vector<FieldEffects> effects(pads.size());
  for (std::size_t i = 0; i < pads.size(); ++i) {
    const EffectContext context = context_for(*pads[i], surface.shape, scene.seed, trial);
    for (const Named& effect : scene.effects) {
      kind_named(effect_catalogue(), effect.name).install(effect.parameters, context, effects[i]);
    }
    const double depth = deepest(*pads[i], surface.shape, effects[i], s.world_in_surface * s.motion->pad_at(0.0).pose);
    if (depth > 0.0) {
      throw SceneValueError("motion.gap",
                            fmt::format("the pad begins {} inside the surface; allowed: a gap that is larger by that",
                                        format_quantity(depth, Quantity::length)));
    }
    longest = std::min(longest, longest_step(effects[i], s.motion->top_speed(reach_of(*pads[i]))));
  }

  const double fastest_rate = *std::max_element(output_rates.begin(), output_rates.end());
  if (scene.time_step) {
    s.dt = *scene.time_step;
    if (s.dt > longest) {
      throw SceneValueError("time_step",
                            fmt::format("{} is too long for the scene's effects; allowed are up to {}",
                                        format_quantity(s.dt, Quantity::time), format_quantity(longest, Quantity::time)));
    }
  } else {
    // The longest step that divides every sampling time; where none of a reasonable number does, the check below says which sensor is in the way.
    const double first = std::max(1.0, std::ceil(1.0 / (fastest_rate * longest)));
    const auto step_of = [&](double divisor) { return 1.0 / fastest_rate / divisor; };
    const auto divides_all = [&](double divisor) {
      return std::all_of(output_rates.begin(), output_rates.end(),
                         [&](double rate) { return whole_ratio(1.0 / rate, step_of(divisor)) != 0; });
    };
    double divisor = first;
    while (divisor < first + most_divisors && !divides_all(divisor)) divisor += 1.0;
    s.dt = step_of(divides_all(divisor) ? divisor : first);
  }
  s.ticks = whole_ratio(scene.duration, s.dt);
  if (s.ticks == 0) {
    throw SceneValueError("duration",
                          fmt::format("{} is not a whole number of steps of {}", format_quantity(scene.duration, Quantity::time),
                                      format_quantity(s.dt, Quantity::time)));
  }

  for (std::size_t i = 0; i < pads.size(); ++i) {
    const std::size_t stride = whole_ratio(1.0 / output_rates[i], s.dt);
    if (stride == 0) {
      throw SceneValueError(
          "time_step", fmt::format("{} does not divide the sampling time {} of sensor '{}'; allowed: {} over a whole number",
                                   format_quantity(s.dt, Quantity::time), format_quantity(1.0 / output_rates[i], Quantity::time),
                                   scene.sensors[i].name, format_quantity(1.0 / output_rates[i], Quantity::time)));
    }
    Field field(*pads[i], surface.shape, {scene.friction.static_coefficient, scene.friction.kinetic_coefficient},
                std::move(effects[i]));
    ContactLabels labels(field);
    s.pads.push_back({std::move(field), std::move(labels), stride});
  }
  s.bodies = {{"pad", s.motion->pad_at(0.0)}, {"surface", {surface.pose, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()}}};
}

Testbench::~Testbench() = default;
Testbench::Testbench(Testbench&&) noexcept = default;
Testbench& Testbench::operator=(Testbench&&) noexcept = default;

std::size_t Testbench::ticks() const { return state_->ticks; }
double Testbench::time_step() const { return state_->dt; }
std::size_t Testbench::stride(std::size_t pad) const { return state_->pads[pad].stride; }
const ContactFrame& Testbench::contact(std::size_t pad) const { return state_->pads[pad].labels.frame(); }
const std::vector<NamedBody>& Testbench::bodies() const { return state_->bodies; }
bool Testbench::rotating() const { return state_->motion->turns(); }

void Testbench::step() {
  State& s = *state_;
  const double time = static_cast<double>(s.tick) * s.dt;
  s.bodies.front().state = s.motion->pad_at(time);
  const Pose pad_in_surface = s.world_in_surface * s.bodies.front().state.pose;
  for (State::Pad& pad : s.pads) {
    pad.field.step(pad_in_surface, s.dt);
    if (!pad.field.on_plane()) refuse_too_deep(pad.field, s.half_thickness, time);
    pad.labels.update(pad.field, time, s.dt);
  }
  ++s.tick;
}

void add_sim_catalogues(Catalogues& catalogues) {
  catalogues.materials = material_table();
  for (const SurfaceKind& kind : surface_catalogue()) catalogues.surfaces.push_back(kind.about);
  for (const MotionKind& kind : motion_catalogue()) catalogues.motions.push_back(kind.about);
  for (const EffectKind& kind : effect_catalogue()) catalogues.effects.push_back(kind.about);
}

}  // namespace slipbench
