#include "tools/registry/program_catalogues.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "detectors/detector_kinds.h"
#include "detectors/flip.h"
#include "detectors/hd/hd_detector.h"
#include "detectors/nib/slip_detectors.h"
#include "rtl/verilated/rtl_engine.h"
#include "sim/api/motion.h"
#include "sim/core/choice.h"
#include "sim/motion/motion_catalogue.h"
#include "tools/registry/registry.h"
#include "tools/registry/sensor_catalogue.h"

namespace slipbench {
namespace {

// Detector that returns the pad's true state by the rule strict, so that a loop shows the errors of
// its controller alone.
class Oracle final : public Detector {
 public:
  Oracle(double latency, const Simulation& simulation, std::size_t pad) : latency_(latency), simulation_(simulation), pad_(pad) {}

  const SlipEstimate& update(const SensorFrame& frame) override {
    const ContactFrame& truth = simulation_.contact_part(pad_, FramePart::states);
    return estimate_ = {frame.time, latency_, truth.state, truth.stuck_fraction};
  }

 private:
  double latency_;
  const Simulation& simulation_;
  std::size_t pad_;
  SlipEstimate estimate_;
};

Entry oracle_entry() {
  return {
      .name = std::string(oracle_type),
      .summary =
          "Oracle, not a detector: returns the true class of the pad, to separate errors of a detector from those of a controller.",
      .law =
          "at each sample of the sensor: the true class by the rule strict (a pillar slips when all of it slips), and the true stuck fraction of the pad's elements\n"
          "A slip that begins and ends between two samples is missed.",
      .source = "the simulation's own contact, which detectors do not see",
      .parameters = {number_spec("latency", Quantity::time, "0 s", non_negative,
                                 "Time from the sample until the class is available.", "set for each scene")}};
}

const std::vector<DetectorKind>& detector_catalogue() {
  static const std::vector<DetectorKind> kinds{
      force_ratio_detector(),        shear_rate_detector(),  marker_deviation_detector(), marker_entropy_detector(),
      band_energy_detector(),        gst_hd_detector(),      gst_hd_rtl_detector(),       nib_linear_slip_detector(),
      nib_slip_kind_detector(),      network_detector(),     plugin_detector(),           deviation_detector(),
      relative_deviation_detector(), shear_ratio_detector(), sum_change_detector(),       {oracle_entry(), nullptr},
  };
  return kinds;
}

Registry<DetectorMaker>& registered_detectors() {
  static Registry<DetectorMaker> registry;
  return registry;
}

// `simulation`: may be null for every type except the oracle.
std::unique_ptr<Detector> make_any(const DetectorScene& scene, const FrameSource& source, const Simulation* simulation) {
  if (const std::optional<DetectorMaker> make = registered_detectors().find(scene.type))
    return with_flips((*make)(scene.parameters, source), scene.parameters.number("flip"), source);
  for (const DetectorKind& kind : detector_catalogue()) {
    if (kind.about.name != scene.type) continue;
    std::unique_ptr<Detector> detector =
        kind.create == nullptr ? std::make_unique<Oracle>(scene.parameters.number("latency"), *simulation, scene.sensor)
                               : kind.create(scene.parameters, source);
    return with_flips(std::move(detector), scene.parameters.number("flip"), source);
  }
  throw InputError("detector: unknown type " + quote(scene.type));
}

struct EngineKind {
  const char* name;
  std::unique_ptr<hd::Engine> (*create)(const hd::Model& model, const hd::Memories& memories);
};

// Uses the core that is fastest to simulate; all unrollings give the same decisions.
std::unique_ptr<hd::Engine> make_rtl(const hd::Model& model, const hd::Memories& memories) {
  return hd::make_rtl_engine(model, memories, {.unrolling = hd::Unrolling::smallest});
}

// All engines.
constexpr EngineKind engine_catalogue[] = {
    {"kernel", hd::make_kernel},
    {"reference", hd::make_reference},
    {"rtl", make_rtl},
};

Registry<ControllerMaker>& registered_controllers() {
  static Registry<ControllerMaker> registry;
  return registry;
}

// Entries of the program's own detectors and controllers, without registered ones.

std::vector<Entry> own_detector_entries() {
  std::vector<Entry> entries;
  for (const DetectorKind& kind : detector_catalogue()) entries.push_back(kind.about);
  return entries;
}

std::vector<Entry> own_controller_entries() {
  std::vector<Entry> entries;
  for (const ControllerKind& kind : controller_catalogue()) entries.push_back(kind.about);
  return entries;
}

using Comparison = ExpectationKind::Comparison;

// Parameters of every kind: its own limit, then the share of the trials that must keep it.
std::vector<ParameterSpec> parameters_of(ParameterSpec limit) {
  return {
      std::move(limit),
      number_spec("pass", Quantity::none, "1", positive_up_to(1.0),
                  "Share of the trials that must meet the expectation: k of n, with k rounded up.", "set for each scene"),
      number_spec(
          "reliability", Quantity::none, "0", {0.0, 0.999999},
          "Rate of meeting the expectation that the run must demonstrate: the interval with expect.confidence must not begin below it. A run with too few trials is an error.",
          "set for each scene")};
}

// `field`: name of the outcome in a dataset.
ExpectationKind number(std::string name, Comparison comparison, Quantity quantity, std::string example, std::string summary,
                       const std::string& field, double (*observed)(const TrialOutcome&)) {
  const bool at_most = comparison == Comparison::at_most;
  return {{{std::move(name), std::move(summary),
            at_most ? "observed <= limit; a trial without an observed value fails"
                    : "observed >= limit; a trial without an observed value meets the expectation",
            "the trial's outcome: " + field,
            parameters_of(number_spec("limit", quantity, std::move(example), non_negative,
                                      at_most ? "Largest allowed value." : "Smallest allowed value.", "set for each scene"))},
           false,
           false},
          comparison,
          observed};
}

ExpectationKind flag(std::string name, std::string summary, const std::string& field, double (*observed)(const TrialOutcome&)) {
  return {{{std::move(name), std::move(summary), "observed = limit", "the trial's outcome: " + field,
            parameters_of(flag_spec("limit", "false", "Expected value.", "set for each scene"))},
           false,
           false},
          Comparison::equal,
          observed};
}

ExpectationKind of_grasp(ExpectationKind kind) {
  kind.about.of_grasp = true;
  return kind;
}

ExpectationKind of_box(ExpectationKind kind) {
  kind.of_box = true;
  return of_grasp(std::move(kind));
}

ExpectationKind of_detector(ExpectationKind kind) {
  kind.about.of_detector = true;
  return kind;
}

ExpectationKind without_value(ExpectationKind kind, const char* text) {
  kind.absent = text;
  return kind;
}

// For expectations of grasps only; the scene reader rejects them in other scenes.
const GraspOutcome& grasp_of(const TrialOutcome& outcome) { return outcome.grasp.value(); }

}  // namespace

Catalogues program_catalogues() {
  Catalogues catalogues = pad_catalogues();
  catalogues.detectors = detector_entries();
  catalogues.controllers = controller_entries();
  catalogues.lift_end = [](const Parameters& motion) { return lift_times(motion).end; };
  for (const ExpectationKind& kind : expectation_catalogue()) catalogues.expectations.push_back(kind.about);
  return catalogues;
}

Catalogues command_line_catalogues() {
  Catalogues catalogues = program_catalogues();
  const auto leave_out = [](std::vector<Entry>& entries, const std::vector<Entry>& registered) {
    std::erase_if(
        entries, [&](const Entry& entry) { return std::ranges::find(registered, entry.name, &Entry::name) != registered.end(); });
  };
  leave_out(catalogues.sensors, registered_sensor_entries());
  leave_out(catalogues.detectors, registered_detectors().entries());
  leave_out(catalogues.controllers, registered_controllers().entries());
  return catalogues;
}

bool ExpectationKind::kept(double observed, double limit) const {
  switch (comparison) {
    case Comparison::at_most: return observed <= limit;  // false for NaN
    case Comparison::at_least: return std::isnan(observed) || observed >= limit;
    case Comparison::equal: return observed == limit;
  }
  throw std::logic_error("no such comparison");
}

double ExpectationKind::badness(double observed) const {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  if (comparison == Comparison::at_least) return std::isnan(observed) ? -infinity : -observed;
  return std::isnan(observed) ? infinity : observed;
}

double ExpectationKind::limit(const Parameters& parameters) const {
  return comparison == Comparison::equal ? static_cast<double>(parameters.flag("limit")) : parameters.number("limit");
}

const std::vector<ExpectationKind>& expectation_catalogue() {
  using enum ExpectationKind::Comparison;
  using enum Quantity;
  static const std::vector<ExpectationKind> kinds{
      number("gross_slip_by", at_most, time, "1 s", "Time by which all touching units must slip.", "gross_slip_time_s",
             [](const TrialOutcome& o) { return o.gross_slip_time; }),
      number("no_slip_before", at_least, time, "1 s", "Time before which no unit may slip as a whole.", "first_slip_time_s",
             [](const TrialOutcome& o) { return o.first_slip_time; }),
      number("max_unit_slip", at_most, length, "1 mm",
             "Largest distance that any unit slips over the surface; with fidelity mujoco_contact the unit's creep counts.",
             "max_slip_distance_m", [](const TrialOutcome& o) { return o.max_slip_distance; }),

      of_detector(flag(
          "false_alarm",
          "True: the detector reports slip before any unit of its sensor slips as a whole; in a grasp also during the lift before its first slip.",
          "false_alarm_time_s", [](const TrialOutcome& o) { return std::isnan(o.false_alarm_time) ? 0.0 : 1.0; })),
      without_value(
          of_detector(number(
              "max_detection_delay", at_most, time, "50 ms",
              "Time from the first slip of a whole unit until the detector first reports slip. A trial without slip fails, and so does one with an alarm before the slip.",
              "detection_delay_s", [](const TrialOutcome& o) { return o.detection_delay; })),
          "no delay"),

      without_value(
          of_box(flag("dropped", "True: the box falls after it was lifted. A box that is not lifted always fails.", "dropped",
                      [](const TrialOutcome& o) {
                        return grasp_of(o).not_lifted() ? std::numeric_limits<double>::quiet_NaN()
                               : grasp_of(o).dropped    ? 1.0
                                                        : 0.0;
                      })),
          "box not lifted"),
      without_value(of_box(flag("lifted", "True: the box leaves the table in the lift.", "lifted",
                                [](const TrialOutcome& o) {
                                  const std::optional<bool>& lifted = grasp_of(o).lifted;
                                  return !lifted ? std::numeric_limits<double>::quiet_NaN() : *lifted ? 1.0 : 0.0;
                                })),
                    "no lift"),
      without_value(
          of_box(number(
              "max_slip", at_most, length, "3 mm",
              "Slip displacement of the box's middle in the hand, from the start of the lift to the end of the trial. A box that is dropped or not lifted fails.",
              "slip_translation_m", [](const TrialOutcome& o) { return grasp_of(o).slip_translation; })),
          "box dropped or not lifted"),
      without_value(
          of_box(number(
              "max_rotation", at_most, angle, "5 deg",
              "Slip rotation of the box in the hand, from the start of the lift to the end of the trial. A box that is dropped or not lifted fails.",
              "slip_rotation_rad", [](const TrialOutcome& o) { return grasp_of(o).slip_rotation; })),
          "box dropped or not lifted"),
      of_grasp(number(
          "max_grip_force", at_most, force, "12 N",
          "Peak grip force at any step, which the object must withstand. The grip force is the mean of both pads' normal forces.",
          "max_grip_force_N", [](const TrialOutcome& o) { return grasp_of(o).max_grip_force; })),
      of_grasp(number("max_final_grip_force", at_most, force, "8 N", "Grip force at the end of the trial.", "final_grip_force_N",
                      [](const TrialOutcome& o) { return grasp_of(o).final_grip_force; })),
      without_value(
          of_grasp(number("max_force_ratio", at_most, none, "2.5",
                          "Peak grip force divided by the ideal grip force, the least that holds the box.",
                          "max_grip_force_N / ideal_grip_force_N",
                          [](const TrialOutcome& o) { return grasp_of(o).max_grip_force / grasp_of(o).ideal_grip_force; })),
          "no ideal force"),
      without_value(
          of_grasp(number(
              "max_reaction_time", at_most, time, "150 ms",
              "Time from the first true slip of a unit in the lift until the fingers close for it. A trial without slip fails, and so does a trial with an alarm before the slip or with a controller that ignores slip.",
              "reaction_time_s", [](const TrialOutcome& o) { return grasp_of(o).reaction_time; })),
          "no reaction"),
  };
  return kinds;
}

std::vector<Entry> detector_entries() {
  std::vector<Entry> entries = own_detector_entries();
  for (const Entry& entry : registered_detectors().entries()) entries.push_back(entry);
  for (Entry& entry : entries) entry.parameters.push_back(flip_spec());
  return entries;
}

const DetectorKind* detector_kind(const std::string& type) {
  const auto found = std::ranges::find(detector_catalogue(), type,
                                       [](const DetectorKind& kind) -> const std::string& { return kind.about.name; });
  return found == detector_catalogue().end() ? nullptr : &*found;
}

FrameSpacing frame_spacing(const std::string& type) {
  const DetectorKind* const kind = detector_kind(type);
  return kind == nullptr ? FrameSpacing::even : kind->spacing;
}

void register_detector(const Entry& about, DetectorMaker make) {
  registered_detectors().put("detector", about, std::move(make), own_detector_entries());
}

std::unique_ptr<Detector> make_detector(const DetectorScene& scene, const FrameSource& source, const Simulation& simulation) {
  return make_any(scene, source, &simulation);
}

std::unique_ptr<Detector> make_detector(const DetectorScene& scene, const FrameSource& source) {
  if (scene.type == oracle_type) {
    throw InputError("detector " + quote(scene.type) + " is the oracle, which needs a simulation and cannot read a recording");
  }
  return make_any(scene, source, nullptr);
}

void check_run(const DetectorScene& scene, std::uint64_t trials) {
  const DetectorKind* const kind = detector_kind(scene.type);
  if (kind != nullptr && kind->check_run != nullptr) kind->check_run(scene.parameters, trials);
}

std::vector<std::string> hd_engine_names() { return choice_names(engine_catalogue); }

std::unique_ptr<hd::Engine> make_hd_engine(std::string_view name, const hd::Model& model, const hd::Memories& memories) {
  for (const EngineKind& kind : engine_catalogue) {
    if (kind.name == name) return kind.create(model, memories);
  }
  throw InputError("unknown engine " + quote(name) + allowed_names(name, hd_engine_names()));
}

const std::vector<ControllerKind>& controller_catalogue() {
  using namespace controllers;
  static const std::vector<ControllerKind> kinds{
      constant_force(), force_ratio(), hold_preset(), plugin(), reorient(), step_on_slip(), timed_grip(),
  };
  return kinds;
}

std::vector<Entry> controller_entries() {
  std::vector<Entry> entries = own_controller_entries();
  for (const Entry& entry : registered_controllers().entries()) entries.push_back(entry);
  return entries;
}

void register_controller(const Entry& about, ControllerMaker make) {
  registered_controllers().put("controller", about, std::move(make), own_controller_entries());
}

const ControllerKind* controller_kind(const std::string& type) {
  const auto found = std::ranges::find(controller_catalogue(), type,
                                       [](const ControllerKind& kind) -> const std::string& { return kind.about.name; });
  return found == controller_catalogue().end() ? nullptr : &*found;
}

std::set<std::string> users_types() {
  std::set<std::string> names;
  for (const Entry& sensor : pad_catalogues().sensors) {
    if (sensor_kind(sensor.name).users_code) names.insert(sensor.name);
  }
  for (const Entry& detector : detector_entries()) {
    const DetectorKind* const kind = detector_kind(detector.name);
    if (kind == nullptr || kind->users_code) names.insert(detector.name);
  }
  for (const Entry& controller : controller_entries()) {
    const ControllerKind* const kind = controller_kind(controller.name);
    if (kind == nullptr || kind->users_code) names.insert(controller.name);
  }
  return names;
}

Answers answers_of(const Named& controller) {
  const ControllerKind* const kind = controller_kind(controller.name);
  return kind == nullptr ? Answers::by_own_rule : kind->answers;
}

std::unique_ptr<Controller> make_controller(const Named& controller, const GripSource& source) {
  for (const ControllerKind& kind : controller_catalogue()) {
    if (kind.about.name == controller.name) return kind.create(controller.parameters, source);
  }
  if (const std::optional<ControllerMaker> make = registered_controllers().find(controller.name))
    return (*make)(controller.parameters, source);
  const std::vector<std::string> names = choice_names(controller_entries());
  throw InputError("controller: unknown type " + quote(controller.name) + allowed_names(controller.name, names));
}

}  // namespace slipbench
