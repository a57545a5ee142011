// Computes the outcome of a trial.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "sim/api/contact_frame.h"
#include "sim/api/pad_state.h"
#include "sim/api/sensor.h"
#include "sim/api/simulation.h"
#include "sim/grasp/grasp.h"
#include "sim/scene/scene.h"
#include "tools/dataset/record/trial_record.h"
#include "tools/trial/control_loop.h"
#include "tools/trial/run_trial.h"
#include "tools/trial/sampler.h"

namespace slipbench {

// The bodies of a scene's `hold`, as indices into Simulation::bodies().
struct HoldBodies {
  std::size_t body, against;
};

// Empty if the scene has no `hold`. Throws SceneValueError at hold.body and hold.against for an
// unknown body name, and at hold.from if fewer than two ticks remain from then on.
std::optional<HoldBodies> hold_bodies(const Scene& scene, const Simulation& simulation);

// Computes the outcome of a trial. A sensor that follows another's pad has unit outcomes but does
// not count in the trial's outcome.
class Judge {
 public:
  // Writes outcome, units, state counts, confusion and onset times to `result`, whose record must
  // come from new_record(). `box`: the grasp's; null: the scene is not a grasp. All arguments must
  // outlive the judge.
  Judge(const Scene& scene, const Simulation& simulation, const HeldBox* box, TrialResult& result);

  // Call once per instant, after the loop has acted, with its ticks.
  void observe(std::span<const Tick> ticks, const ControlLoop& loop) {
    for (const Tick& tick : ticks) {
      const ContactFrame& truth = simulation_.contact_part(tick.pad, FramePart::states);
      const bool detected = loop.has_detector() && tick.pad == loop.pad();
      if (watches_ && tick.pad == 0) watch(truth, loop);
      if (!truth.events.empty()) note_events(tick.pad, truth, detected);
      if (truth.state == PadState::gross && !(outcome_.gross_slip_time <= truth.time)) note_gross_slip(tick.pad, truth);
      if (tick.sample != nullptr) count_states(result_.record.sensors[tick.pad].labels, truth);
      if (detected) judge_detection(tick, truth, loop.seen());
    }
  }
  // Call at the trial's end; evaluates the last tick.
  void finish(std::span<const std::unique_ptr<Sensor>> sensors);

 private:
  [[nodiscard]] bool follows(std::size_t pad) const { return !scene_.sensors[pad].follows.empty(); }
  [[nodiscard]] bool has_one_unit(std::size_t pad) const { return result_.units[pad].size() == 1; }
  // s, from which slip counts for the loop.
  [[nodiscard]] double judged_from() const {
    return box_ != nullptr ? box_->lift_start() : -std::numeric_limits<double>::infinity();
  }
  static void count_states(LabelRecord& labels, const ContactFrame& truth) {
    ++labels.state_count[static_cast<std::size_t>(truth.state)];
    ++labels.state_micro_count[static_cast<std::size_t>(truth.state_micro)];
  }
  void note_events(std::size_t pad, const ContactFrame& truth, bool detected);
  void note_gross_slip(std::size_t pad, const ContactFrame& truth);
  void judge_detection(const Tick& tick, const ContactFrame& truth, PadState seen);
  void watch(const ContactFrame& truth, const ControlLoop& loop);
  void judge_grasp(const ContactFrame& truth, const ControlLoop::Tightening& tightening);
  void judge_turn();
  // Position of the body of `hold` in the frame of its holder [m], so that a turning hand does not
  // move it.
  [[nodiscard]] Eigen::Vector3d held_at() const;

  const Scene& scene_;
  const Simulation& simulation_;
  const HeldBox* box_;
  std::optional<HoldBodies> hold_;
  bool watches_;                              // bodies are evaluated at each tick
  std::optional<Eigen::Vector3d> held_from_;  // m, held_at() at the first tick from hold.from on
  TrialResult& result_;
  TrialOutcome& outcome_;
  double slip_tick_ =
      std::numeric_limits<double>::quiet_NaN();  // s, first tick of a grasp's lift with a slipping unit of its pad
  double any_slip_onset_ = std::numeric_limits<
      double>::quiet_NaN();  // s, when a first unit of the detector's pad slips as a whole, also before a lift
};

}  // namespace slipbench
