// What became of a trial: its outcome figures, from the truth and from what the loop did.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "sim/core/contact_frame.h"
#include "sim/core/sensor.h"
#include "sim/grasp/grasp.h"
#include "sim/scene/scene.h"
#include "sim/simulation/simulation.h"
#include "tools/program/run/control_loop.h"
#include "tools/program/run/run_trial.h"

namespace slipbench {

// The bodies of a scene's `hold`, as indices into Simulation::bodies().
struct HoldBodies {
  std::size_t body, against;
};

// Empty where the scene has no `hold`. Throws SceneValueError at hold.body and hold.against for a name that no body has, which a dataset
// would record, and at hold.from where fewer than two ticks are left from then on.
std::optional<HoldBodies> hold_bodies(const Scene& scene, const Simulation& simulation);

// A sensor that follows another one's pad has figures of its units, and none in the outcome.
class Judge {
 public:
  // Figures go into `result`: outcome, units, state counts, confusion and onset times; its record must be that of new_record().
  // `box`: the grasp's; null: the scene is none. All must outlive the judge.
  Judge(const Scene& scene, const Simulation& simulation, const HeldBox* box, TrialResult& result);

  // Once every instant, after the loop has acted: the ticks at it.
  void observe(std::span<const Tick> ticks, const ControlLoop& loop) {
    for (const Tick& tick : ticks) {
      const ContactFrame& truth = simulation_.contact(tick.pad);
      const bool detected = loop.has_detector() && tick.pad == loop.pad();
      if (watches_ && tick.pad == 0) watch(truth, loop);
      if (!truth.events.empty()) note_events(tick.pad, truth, detected);
      if (truth.state == PadState::gross && !(outcome_.gross_slip_time <= truth.time)) note_gross_slip(tick.pad, truth);
      if (tick.sample != nullptr) count_states(result_.record.sensors[tick.pad].labels, truth);
      if (detected) judge_detection(tick, truth, loop.seen());
    }
  }
  // At the trial's end: what only the last tick tells.
  void finish(std::span<const std::unique_ptr<Sensor>> sensors);

 private:
  [[nodiscard]] bool follows(std::size_t pad) const { return !scene_.sensors[pad].follows.empty(); }
  [[nodiscard]] bool has_one_unit(std::size_t pad) const { return result_.units[pad].size() == 1; }
  // s, from when on slip is what the loop is judged by.
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
  // The origin of the body of `hold` in the frame of what holds it [m]: a hand that turns with what it holds does not move it.
  [[nodiscard]] Eigen::Vector3d held_at() const;

  const Scene& scene_;
  const Simulation& simulation_;
  const HeldBox* box_;
  std::optional<HoldBodies> hold_;
  bool watches_;                              // whether bodies are looked at in each tick
  std::optional<Eigen::Vector3d> held_from_;  // m, held_at() at the first tick of which `hold` asks
  TrialResult& result_;
  TrialOutcome& outcome_;
  double slip_tick_ =
      std::numeric_limits<double>::quiet_NaN();  // s, first tick of a grasp's lift at which a unit of its pad slips
  double any_slip_onset_ = std::numeric_limits<
      double>::quiet_NaN();  // s, when a first unit of the detector's pad slips as a whole, also before a lift
};

}  // namespace slipbench
