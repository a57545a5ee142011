#include "tools/program/catalogue/detector_catalogue.h"

#include <optional>
#include <utility>

#include "detectors/detector_kinds.h"
#include "detectors/flip.h"
#include "detectors/hd/hd_detector.h"
#include "detectors/nib/slip_detectors.h"
#include "rtl/verilated/rtl_engine.h"
#include "sim/core/error.h"
#include "tools/program/catalogue/registry.h"

namespace slipbench {
namespace {

const std::vector<DetectorKind>& detector_catalogue() {
  static const std::vector<DetectorKind> kinds{
      force_ratio_detector(),     stuck_fraction_detector(), shear_rate_detector(), marker_deviation_detector(),
      marker_entropy_detector(),  band_energy_detector(),    gst_hd_detector(),     gst_hd_rtl_detector(),
      nib_linear_slip_detector(), nib_slip_kind_detector(),  network_detector(),    plugin_detector(),
      {oracle_entry(), nullptr},
  };
  return kinds;
}

Registry<DetectorMaker>& registered_detectors() {
  static Registry<DetectorMaker> registry;
  return registry;
}

// `simulation`: null where there is none, of all but the oracle.
std::unique_ptr<Detector> make_any(const DetectorScene& scene, const FrameSource& source, const Simulation* simulation) {
  if (const std::optional<DetectorMaker> make = registered_detectors().find(scene.type))
    return with_flips((*make)(scene.parameters, source), scene.parameters.number("flip"), source);
  for (const DetectorKind& kind : detector_catalogue()) {
    if (kind.about.name != scene.type) continue;
    std::unique_ptr<Detector> detector =
        kind.create == nullptr ? make_oracle(scene.parameters, *simulation, scene.sensor) : kind.create(scene.parameters, source);
    return with_flips(std::move(detector), scene.parameters.number("flip"), source);
  }
  throw InputError("detector: unknown type " + quote(scene.type));
}

class Oracle final : public Detector {
 public:
  Oracle(double latency, const Simulation& simulation, std::size_t pad) : latency_(latency), simulation_(simulation), pad_(pad) {}

  const SlipEstimate& update(const SensorFrame& frame) override {
    const ContactFrame& truth = simulation_.contact(pad_);
    return estimate_ = {frame.time, latency_, truth.state, truth.stuck_fraction};
  }

 private:
  double latency_;
  const Simulation& simulation_;
  std::size_t pad_;
  SlipEstimate estimate_;
};

struct EngineKind {
  const char* name;
  std::unique_ptr<hd::Engine> (*create)(const hd::Model& model, const hd::Memories& memories);
};

// The core that is fastest to simulate; all unrollings decide alike.
std::unique_ptr<hd::Engine> make_rtl(const hd::Model& model, const hd::Memories& memories) {
  return hd::make_rtl_engine(model, memories, {.unrolling = hd::Unrolling::smallest});
}

// All engines, one line each.
constexpr EngineKind engine_catalogue[] = {
    {"kernel", hd::make_kernel},
    {"reference", hd::make_reference},
    {"rtl", make_rtl},
};

Registry<ControllerMaker>& registered_controllers() {
  static Registry<ControllerMaker> registry;
  return registry;
}

std::vector<Entry> own_entries() {
  std::vector<Entry> entries;
  for (const ControllerKind& kind : controller_catalogue()) entries.push_back(kind.about);
  return entries;
}

}  // namespace

std::vector<Entry> detector_entries() {
  std::vector<Entry> entries;
  for (const DetectorKind& kind : detector_catalogue()) entries.push_back(kind.about);
  for (const Entry& entry : registered_detectors().entries()) entries.push_back(entry);
  for (Entry& entry : entries) entry.parameters.push_back(flip_spec());
  return entries;
}

void register_detector(const Entry& about, DetectorMaker make) {
  std::vector<Entry> taken;
  for (const DetectorKind& kind : detector_catalogue()) taken.push_back(kind.about);
  registered_detectors().put("detector", about, std::move(make), taken);
}

std::unique_ptr<Detector> make_detector(const DetectorScene& scene, const FrameSource& source, const Simulation& simulation) {
  return make_any(scene, source, &simulation);
}

std::unique_ptr<Detector> make_detector(const DetectorScene& scene, const FrameSource& source) {
  if (scene.type == oracle_type) {
    throw InputError("detector " + quote(scene.type) + " is the oracle, which reads the simulation and no recording");
  }
  return make_any(scene, source, nullptr);
}

void check_run(const DetectorScene& scene, std::uint64_t trials) {
  for (const DetectorKind& kind : detector_catalogue()) {
    if (kind.about.name == scene.type && kind.check_run != nullptr) kind.check_run(scene.parameters, trials);
  }
}

Entry oracle_entry() {
  return {
      .name = std::string(oracle_type),
      .summary = "ORACLE, no detector: the true class of the pad, to tell a detector's faults from a controller's.",
      .law =
          "at each sample of the sensor: the true class by the rule strict (a pillar slips when all of it slips), and the true stuck fraction of the pad's elements",
      .source = "the simulation's own contact, which no detector sees",
      .parameters = {
          number_spec("latency", Quantity::time, "0 s", non_negative, "Time from the sample until the class is there.", "free")}};
}

std::unique_ptr<Detector> make_oracle(const Parameters& parameters, const Simulation& simulation, std::size_t pad) {
  return std::make_unique<Oracle>(parameters.number("latency"), simulation, pad);
}

std::vector<std::string> hd_engine_names() {
  std::vector<std::string> names;
  for (const EngineKind& kind : engine_catalogue) names.emplace_back(kind.name);
  return names;
}

std::unique_ptr<hd::Engine> make_hd_engine(std::string_view name, const hd::Model& model, const hd::Memories& memories) {
  for (const EngineKind& kind : engine_catalogue) {
    if (kind.name == name) return kind.create(model, memories);
  }
  throw InputError("unknown engine " + quote(name) + allowed_names(name, hd_engine_names()));
}

const std::vector<ControllerKind>& controller_catalogue() {
  using namespace controllers;
  static const std::vector<ControllerKind> kinds{
      constant_force(), force_pid(), force_ratio(), hold_preset(), plugin(), reorient(), step_on_slip(), stuck_fraction(),
  };
  return kinds;
}

std::vector<Entry> controller_entries() {
  std::vector<Entry> entries = own_entries();
  for (const Entry& entry : registered_controllers().entries()) entries.push_back(entry);
  return entries;
}

void register_controller(const Entry& about, ControllerMaker make) {
  registered_controllers().put("controller", about, std::move(make), own_entries());
}

std::unique_ptr<Controller> make_controller(const Named& controller, const GripSource& source) {
  for (const ControllerKind& kind : controller_catalogue()) {
    if (kind.about.name == controller.name) return kind.create(controller.parameters, source);
  }
  if (const std::optional<ControllerMaker> make = registered_controllers().find(controller.name))
    return (*make)(controller.parameters, source);
  std::vector<std::string> names;
  for (const Entry& entry : controller_entries()) names.push_back(entry.name);
  throw InputError("controller: unknown type " + quote(controller.name) + allowed_names(controller.name, names));
}

}  // namespace slipbench
