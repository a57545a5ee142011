#include "tools/trial/judge.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include "sim/core/error.h"
#include "sim/core/quantity.h"

namespace slipbench {
namespace {

// Keeps the earlier of two times, of which the first may be NaN.
void keep_earliest(double& time, double candidate) {
  if (!(time <= candidate)) time = candidate;
}

std::size_t index_of(const std::vector<NamedBody>& bodies, const std::string& name, const char* key) {
  const auto found = std::ranges::find(bodies, name, &NamedBody::name);
  if (found != bodies.end()) return static_cast<std::size_t>(found - bodies.begin());
  std::vector<std::string_view> names;
  for (const NamedBody& body : bodies) names.emplace_back(body.name);
  throw SceneValueError(key, "unknown body " + quote(name) + allowed_names(name, names));
}

}  // namespace

std::optional<HoldBodies> hold_bodies(const Scene& scene, const Simulation& simulation) {
  if (!scene.hold) return std::nullopt;
  // Ticks of the first pad at which bodies are evaluated: one initial tick and a later one.
  const std::size_t ticks = simulation.ticks(0);
  const double latest = ticks < 2 ? 0.0 : static_cast<double>(ticks - 2) * simulation.time_step(0);
  if (ticks < 2 || scene.hold->from > latest) {
    throw SceneValueError("hold.from", format_quantity(scene.hold->from, Quantity::time) +
                                           " leaves fewer than two steps until the end of the trial; allowed: 0 s to " +
                                           format_quantity(latest, Quantity::time));
  }
  return HoldBodies{index_of(simulation.bodies(), scene.hold->body, "hold.body"),
                    index_of(simulation.bodies(), scene.hold->against, "hold.against")};
}

Judge::Judge(const Scene& scene, const Simulation& simulation, const HeldBox* box, TrialResult& result)
    : scene_(scene),
      simulation_(simulation),
      box_(box),
      hold_(hold_bodies(scene, simulation)),
      watches_(box != nullptr || hold_),
      result_(result),
      outcome_(result.record.outcome) {
  for (const SensorRecord& sensor : result.record.sensors) result.units.emplace_back(sensor.labels.units());
  if (box == nullptr) return;
  outcome_.grasp.emplace();
  if (std::isfinite(box->ideal_force())) outcome_.grasp->ideal_grip_force = box->ideal_force();
}

void Judge::note_events(std::size_t pad, const ContactFrame& truth, bool detected) {
  for (const ContactEvent& event : truth.events) {
    UnitOutcome& unit = result_.units[pad][event.unit];
    const bool slip = event.kind == EventKind::slip;
    const bool micro = slip || event.kind == EventKind::micro;
    if (event.kind == EventKind::touch) keep_earliest(unit.touch_time, event.time);
    if (micro) keep_earliest(unit.micro_onset_time, event.time);
    if (slip) keep_earliest(unit.onset_time, event.time);
    // By the rule strict; on a pad of a single unit, as soon as part of it slips
    // (contact_labels.h).
    const bool begins = has_one_unit(pad) ? micro : slip;
    if (!begins || !detected) continue;
    keep_earliest(any_slip_onset_, event.time);
    if (event.time >= judged_from()) keep_earliest(outcome_.judged_slip_time, event.time);
  }
}

// The event after which no touching unit sticks is the last one of the step.
void Judge::note_gross_slip(std::size_t pad, const ContactFrame& truth) {
  if (!follows(pad)) keep_earliest(outcome_.gross_slip_time, truth.events.empty() ? truth.time : truth.events.back().time);
}

void Judge::judge_detection(const Tick& tick, const ContactFrame& truth, PadState seen) {
  // Slip caused by closing fingers is neither a false alarm nor a slip to be detected.
  const bool counts = std::isnan(any_slip_onset_) || truth.time >= judged_from();
  if (slips(seen) && counts && !(outcome_.grasp && outcome_.grasp->dropped)) {
    double& first = std::isnan(outcome_.judged_slip_time) ? outcome_.false_alarm_time : outcome_.detection_time;
    if (std::isnan(first)) first = truth.time;
  }
  if (tick.sample == nullptr) return;
  count(result_.record.control->confusion, truth.state, seen);
}

void Judge::watch(const ContactFrame& truth, const ControlLoop& loop) {
  if (box_ != nullptr) judge_grasp(truth, loop.tightening());
  if (hold_ && !held_from_ && truth.time >= scene_.hold->from) held_from_ = held_at();
}

Eigen::Vector3d Judge::held_at() const {
  const std::vector<NamedBody>& bodies = simulation_.bodies();
  const Pose& against = bodies[hold_->against].state.pose;
  return against.rotation.transpose() * (bodies[hold_->body].state.pose.position - against.position);
}

void Judge::judge_grasp(const ContactFrame& truth, const ControlLoop::Tightening& tightening) {
  const GraspTruth& now = box_->truth();
  GraspOutcome& grasp = *outcome_.grasp;
  if (now.dropped && !grasp.dropped) {
    grasp.dropped = true;
    grasp.drop_time = now.time;
  }
  if (!scene_.guided()) {
    grasp.lifted = now.lifted;
    grasp.lift_height = now.lift_height;
  }
  constexpr double never = std::numeric_limits<double>::quiet_NaN();
  grasp.slip_translation = grasp.held() ? now.slip.norm() : never;
  grasp.slip_rotation = grasp.held() ? now.rotation : never;
  grasp.max_grip_force = std::max(grasp.max_grip_force, now.grip_force);
  grasp.final_grip_force = now.grip_force;
  if (scene_.guided()) judge_turn();
  if (slips(truth.state) && now.time >= judged_from()) keep_earliest(slip_tick_, now.time);
  if (std::isnan(grasp.reaction_time) && !grasp.dropped && tightening.read_time >= slip_tick_) {
    grasp.reaction_time = tightening.start_time - slip_tick_;
  }
}

void Judge::judge_turn() {
  constexpr double upright = 5.0 * std::numbers::pi / 180.0;
  const GraspTruth& now = box_->truth();
  std::optional<TurnOutcome>& turn = outcome_.grasp->turn;
  const bool alone = now.pad_force[0] == 0.0 && now.pad_force[1] == 0.0 && now.table_force > 0.0;
  const double least = turn ? std::min(turn->least_tilt, now.tilt) : now.tilt;
  turn = {.tilt = now.tilt, .least_tilt = least, .standing = alone && now.tilt < upright};
}

void Judge::finish(std::span<const std::unique_ptr<Sensor>> sensors) {
  if (result_.record.control && !result_.record.control->detector.empty()) {
    outcome_.detection_delay = outcome_.detection_time - outcome_.judged_slip_time;
    settle_detection(outcome_, !std::isnan(outcome_.judged_slip_time));
  }
  if (held_from_) {
    const double moved = (held_at() - *held_from_).norm();
    outcome_.hold = {.held = moved <= scene_.hold->within, .from = scene_.hold->from, .moved = moved};
  }
  for (std::size_t pad = 0; pad < sensors.size(); ++pad) {
    const ContactFrame& last = simulation_.contact(pad);
    SensorRecord& sensor = result_.record.sensors[pad];
    if (const std::uint64_t samples = sensors[pad]->saturated(); samples > 0) outcome_.saturated.emplace(sensor.name, samples);
    Eigen::Index column = 0;
    for (UnitOutcome& unit : result_.units[pad]) {
      unit.slip_distance = static_cast<float>(last.slip_distance(column));
      unit.load = static_cast<float>(last.contact_force(2, column)) + 0.0F;  // + 0 removes the sign of a zero
      unit.margin = static_cast<float>(last.margin(column));
      sensor.labels.onset_time.push_back(unit.onset_time);
      sensor.labels.micro_onset_time.push_back(unit.micro_onset_time);
      if (!follows(pad)) {
        // std::fmin ignores NaN.
        outcome_.touch_time = std::fmin(outcome_.touch_time, unit.touch_time);
        outcome_.first_micro_slip_time = std::fmin(outcome_.first_micro_slip_time, unit.micro_onset_time);
        const double onset = has_one_unit(pad) ? unit.micro_onset_time : unit.onset_time;
        outcome_.first_slip_time = std::fmin(outcome_.first_slip_time, onset);
        outcome_.max_slip_distance = std::max(outcome_.max_slip_distance, last.slip_distance(column));
      }
      ++column;
    }
  }
}

}  // namespace slipbench
