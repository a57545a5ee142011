#include "tools/program/catalogue/detector_catalogue.h"

#include "detectors/flip.h"
#include "detectors/force_ratio.h"
#include "detectors/hd/hd_detector.h"
#include "detectors/network/network_detector.h"
#include "detectors/nib/linear_slip.h"
#include "detectors/nib/slip_kind.h"
#include "detectors/plugin_detector.h"
#include "detectors/shear_rate.h"
#include "detectors/spectral/band_energy.h"
#include "detectors/stuck_fraction.h"
#include "rtl/verilated/rtl_detector.h"
#include "sim/core/detector.h"
#include "sim/core/error.h"
#include "tools/program/catalogue/oracle.h"
#include "tools/program/catalogue/registry.h"

namespace slipbench {
namespace {

// A detector that a scene may name.
struct DetectorKind {
  Entry about;
  std::unique_ptr<Detector> (*create)(const Parameters& parameters, const FrameSource& source);  // none: the oracle
  void (*check_run)(const Parameters& parameters, std::uint64_t trials) = nullptr;  // none: it asks nothing of the run
};

// All detectors, one line each.
const std::vector<DetectorKind>& detector_catalogue() {
  static const std::vector<DetectorKind> kinds{
      {force_ratio_entry(), make_force_ratio},
      {stuck_fraction_entry(), make_stuck_fraction},
      {shear_rate_entry(), make_shear_rate},
      {band_energy_entry(), make_band_energy},
      {gst_hd_entry(), make_gst_hd},
      {gst_hd_rtl_entry(), make_gst_hd_rtl, check_waveform_trial},
      {nib_linear_slip_entry(), make_nib_linear_slip},
      {nib_slip_kind_entry(), make_nib_slip_kind},
      {network_entry(), make_network},
      {plugin_detector_entry(), make_plugin_detector},
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

}  // namespace slipbench
