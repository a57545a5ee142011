#include "sim/simulation/stage_setup.h"

#include <algorithm>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/core/quantity.h"

namespace slipbench {
namespace {

// The entry called `name` of a catalogue. The parser has let no other names through.
template <class Catalogue>
const auto& kind_named(const Catalogue& catalogue, const std::string& name) {
  return *std::find_if(catalogue.begin(), catalogue.end(), [&](const auto& kind) { return kind.about.name == name; });
}

}  // namespace

std::unique_ptr<Motion> make_motion(const Scene& scene, std::uint64_t trial) {
  return kind_named(motion_catalogue(), scene.motion.name).create(scene.motion.parameters, {scene.seed, trial});
}

void refuse_motors(const Motion& motion) {
  if (!motion.motors()) return;
  throw SceneValueError("motion.vibration", "shakes pads of fidelity field on the stage alone; allowed here: 0");
}

StageSetup set_up_stage(const Scene& scene, std::uint64_t trial) {
  return {make_motion(scene, trial), kind_named(surface_catalogue(), scene.surface.name).create(scene.surface.parameters)};
}

void refuse_inside(const PadLayout& pad, const PlacedSurface& surface, const FieldEffects& effects, const Pose& pose) {
  const Pose pad_in_surface = surface.pose.inverse() * pose;
  double depth = 0.0;
  for (const Element& element : pad.elements) {
    const Eigen::Vector3d tip = pad_in_surface * element.tip;
    const Eigen::Vector3d axis = pad_in_surface.rotation * element.axis;
    const SurfacePoint met =
        std::visit([&](const auto& s) { return s.at(tip.x(), tip.y(), tip.z(), axis.x(), axis.y(), axis.z()); }, surface.shape);
    const double x = tip.x() - met.gap * met.nx, y = tip.y() - met.gap * met.ny;
    double gap = met.gap;
    for (const auto& effect : effects.surface) effect->displace(1, &x, &y, &met.nz, &gap);
    depth = std::max(depth, -gap);
  }
  if (depth > 0.0) {
    throw SceneValueError("motion.gap", fmt::format("the pad begins {} inside the surface; allowed: a gap that is larger by that",
                                                    format_quantity(depth, Quantity::length)));
  }
}

double reach_of(const PadLayout& layout) {
  double reach = 0.0;
  for (const Element& element : layout.elements) reach = std::max(reach, element.tip.norm());
  return reach;
}

}  // namespace slipbench
