#include "tools/program/catalogue/program_catalogues.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "tools/program/catalogue/detector_catalogue.h"
#include "tools/program/catalogue/sensor_catalogue.h"

namespace slipbench {

Catalogues program_catalogues() {
  Catalogues catalogues = pad_catalogues();
  catalogues.detectors = detector_entries();
  catalogues.controllers = controller_entries();
  catalogues.expectations = expectation_entries();
  return catalogues;
}

namespace {

using Comparison = ExpectationKind::Comparison;

// Every kind's parameters: its own limit, then how many of the trials must keep it.
std::vector<ParameterSpec> parameters_of(ParameterSpec limit) {
  return {
      std::move(limit),
      number_spec("pass", Quantity::none, "1", positive_up_to(1.0),
                  "Share of the trials that must keep the expectation: k of n, k rounded up.", "free"),
      number_spec(
          "reliability", Quantity::none, "0", {0.0, 0.999999},
          "Rate of keeping the expectation that the run must demonstrate: the interval of expect.confidence must not begin below it. A run with too few trials is refused.",
          "free")};
}

// `field`: of the outcome in a dataset.
ExpectationKind number(std::string name, Comparison comparison, Quantity quantity, std::string example, std::string summary,
                       const std::string& field, double (*observed)(const TrialOutcome&)) {
  const bool at_most = comparison == Comparison::at_most;
  return {{{std::move(name), std::move(summary),
            at_most ? "observed <= limit; a trial without an observed value fails"
                    : "observed >= limit; a trial without an observed value keeps the expectation",
            "the trial's outcome: " + field,
            parameters_of(number_spec("limit", quantity, std::move(example), non_negative,
                                      at_most ? "Largest value that is good." : "Smallest value that is good.", "free"))},
           false,
           false},
          comparison,
          observed};
}

ExpectationKind flag(std::string name, std::string summary, const std::string& field, double (*observed)(const TrialOutcome&)) {
  return {{{std::move(name), std::move(summary), "observed = limit", "the trial's outcome: " + field,
            parameters_of(flag_spec("limit", "false", "Value that must come out.", "free"))},
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

// For expectations of a grasp alone, which the scene reader sees to.
const GraspOutcome& grasp_of(const TrialOutcome& outcome) { return outcome.grasp.value(); }

}  // namespace

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
      number("gross_slip_by", at_most, time, "1 s", "All touching units slip by this time of the trial.", "gross_slip_time_s",
             [](const TrialOutcome& o) { return o.gross_slip_time; }),
      number("no_slip_before", at_least, time, "1 s", "No unit slips as a whole before this time of the trial.",
             "first_slip_time_s", [](const TrialOutcome& o) { return o.first_slip_time; }),
      number("max_unit_slip", at_most, length, "1 mm",
             "Largest distance that any unit slips over the surface; with fidelity mujoco_contact the unit's creep counts.",
             "max_slip_distance_m", [](const TrialOutcome& o) { return o.max_slip_distance; }),

      of_detector(flag(
          "false_alarm",
          "Whether the detector says slip before any unit of its sensor slips as a whole; in a grasp also in the lift before its own first slip.",
          "false_alarm_time_s", [](const TrialOutcome& o) { return std::isnan(o.false_alarm_time) ? 0.0 : 1.0; })),
      of_detector(number(
          "max_detection_delay", at_most, time, "50 ms",
          "Time from the first slip of a whole unit until the detector first reports slip. A trial without slip fails, and so does one with an alarm before the slip.",
          "detection_delay_s", [](const TrialOutcome& o) { return o.detection_delay; })),

      of_box(flag("dropped", "Whether the box falls.", "dropped",
                  [](const TrialOutcome& o) { return grasp_of(o).dropped ? 1.0 : 0.0; })),
      of_box(number(
          "max_slip", at_most, length, "3 mm",
          "Slip displacement of the box's middle in the hand, from the lift's beginning to the trial's end. A dropped box fails.",
          "slip_translation_m", [](const TrialOutcome& o) { return grasp_of(o).slip_translation; })),
      of_box(number("max_rotation", at_most, angle, "5 deg",
                    "Slip rotation of the box in the hand, from the lift's beginning to the trial's end. A dropped box fails.",
                    "slip_rotation_rad", [](const TrialOutcome& o) { return grasp_of(o).slip_rotation; })),
      of_grasp(number(
          "max_grip_force", at_most, force, "12 N",
          "Peak grip force at any tick, which the object must stand. The grip force is the mean of both pads' normal forces.",
          "max_grip_force_N", [](const TrialOutcome& o) { return grasp_of(o).max_grip_force; })),
      of_grasp(number("max_final_grip_force", at_most, force, "8 N", "Grip force at the trial's end.", "final_grip_force_N",
                      [](const TrialOutcome& o) { return grasp_of(o).final_grip_force; })),
      of_grasp(number("max_force_ratio", at_most, none, "2.5",
                      "Peak grip force over the ideal grip force, the least that could hold the box.",
                      "max_grip_force_N / ideal_grip_force_N",
                      [](const TrialOutcome& o) { return grasp_of(o).max_grip_force / grasp_of(o).ideal_grip_force; })),
      of_grasp(number(
          "max_reaction_time", at_most, time, "150 ms",
          "Time from the first true slip of a unit in the lift until the fingers close. A trial without slip fails: it shows no reaction. Nor does one whose detector alarmed before the slip.",
          "reaction_time_s", [](const TrialOutcome& o) { return grasp_of(o).reaction_time; })),
  };
  return kinds;
}

std::vector<ExpectationEntry> expectation_entries() {
  std::vector<ExpectationEntry> entries;
  for (const ExpectationKind& kind : expectation_catalogue()) entries.push_back(kind.about);
  return entries;
}

}  // namespace slipbench
