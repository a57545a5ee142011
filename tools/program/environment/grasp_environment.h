// A grasp whose commands come from outside: a policy in the controller's place.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "controllers/grip.h"
#include "sim/scene/catalogues.h"
#include "sim/scene/parser.h"
#include "sim/simulation/simulation.h"
#include "tools/program/run/trial_run.h"
#include "tools/program/sweep/warnings.h"

namespace slipbench {

// What an action in [-1, 1] stands for, in a straight line.
enum class ActionKind {
  force,  // 0 to GraspEnvironment::strongest, a target of the measured grip force, followed as the controllers do (ForceFollower)
  position,  // 0 to max_register, the position register
};

// What a step of a policy led to.
struct EnvironmentStep {
  double reward = 0.0;
  bool dropped = false;        // the box was; this ends the episode
  bool left_behind = false;    // the arm has risen, and the box was not lifted; so does this
  bool ended = false;          // the scene's duration is over; so does this
  double time = 0.0;           // s, of the read, or of the end
  double grip_force = 0.0;     // N, true
  double ideal_force = 0.0;    // N, the least that could hold the box; infinite without friction
  double slip_distance = 0.0;  // m, the largest of any unit of the first sensor's pad
  bool lifting = false;        // the lift has begun

  [[nodiscard]] bool failed() const { return dropped || left_behind; }
};

// Reward of a step: -(F/F_ideal) dt/T - 0.1/mm ds - 10 where the box was dropped in it, or the lift ended without the box. F: true grip force at its end, F_ideal: the least that
// could hold the box, dt: its length, T: the scene's duration, ds: growth of slip_distance since the lift began. So an episode that holds the box
// at the ideal force without slip is worth -1 at least, and one that leaves the box on the table no more than one that drops it.
// The scene's duration limits the episode. It may end before the lift does, which other trials may not: then the last tick stands for the lift's end.
class GraspEnvironment {
 public:
  static constexpr double strongest = 20.0;      // N, of ActionKind::force
  static constexpr double drop_penalty = 10.0;   // 1
  static constexpr double slip_penalty = 100.0;  // 1/m

  // Throws InputError for a scene that cannot be used or is no grasp, whose arm waits for commands, and, for ActionKind::force, whose first
  // sensor tells no force.
  GraspEnvironment(const SceneFile& file, ActionKind action);

  // Names of what an observation holds: each channel value of every sensor ("pad.P0_FX"), as it was last sampled, then gripper.position [counts],
  // gripper.moving, gripper.stopped, and, where the scene has a detector, slip.state (PadState).
  [[nodiscard]] const std::vector<std::string>& observation_names() const { return names_; }
  // Unit of each value of an observation: "N", "m", "counts"; "1" for flags and codes.
  [[nodiscard]] const std::vector<std::string>& observation_units() const { return units_; }

  // Begins episode number `episode` of the scene with that seed, and runs it to its first read of the gripper. Each episode of a seed is another
  // draw; cells of the scene's grid follow each other.
  void reset(std::uint64_t seed, std::uint64_t episode);
  // Commands, and runs on to the next read. Throws InputError for an action that is not within [-1, 1], std::logic_error without reset() or after
  // the end.
  const EnvironmentStep& step(double action);
  // Of the read at which the next action is asked for; after the end the last one. [observation_names().size()]
  [[nodiscard]] std::span<const float> observation() const { return observation_; }
  [[nodiscard]] const EnvironmentStep& latest() const { return latest_; }
  // Once the episode is over: a demo's attribute `outcome`. Empty before.
  [[nodiscard]] const std::string& outcome() const { return outcome_; }
  [[nodiscard]] bool over() const { return latest_.failed() || latest_.ended; }
  // Where the grasp's bodies are, in the world (GraspSimulation::bodies()). Throws std::logic_error after a reset() that failed.
  [[nodiscard]] const std::vector<NamedBody>& bodies() const;
  // Throws InputError for an action that is not within [-1, 1].
  static void check_action(double action);
  // JSON of what was drawn for the episode.
  [[nodiscard]] const std::string& params() const { return params_; }
  // What `slipbench sweep` would warn of before it runs the scene.
  [[nodiscard]] std::vector<Warning> warnings() const;
  // Runs the episode's trial with the scene's own controller: "slipbench run ...". `scene`: the scene's path and overrides, as a shell takes them.
  [[nodiscard]] std::string episode_command(const std::string& scene) const;

 private:
  class Observer;

  void run_to_read();
  void look();
  GripCommand command_for(double action);

  std::unique_ptr<const Catalogues> catalogues_;
  SceneFile file_;
  ActionKind action_;
  std::optional<TrialPlan> plan_;
  std::uint64_t seed_ = 0, trial_ = 0;
  std::vector<std::string> names_, units_;
  std::vector<float> observation_;
  std::unique_ptr<TrialRun> run_;
  std::optional<controllers::GripForce> force_;
  std::optional<controllers::ForceFollower> follower_;
  GripCommand registers_;
  EnvironmentStep latest_;
  std::string outcome_, params_;
};

// Several grasps side by side, stepped by threads.
// Autoreset by Gymnasium's mode NEXT_STEP: the step after an episode's end ignores its action, begins the next episode of that environment's
// seed, and is worth 0. What it gives does not depend on the number of threads. One thread at a time may use it.
class VectorEnvironment {
 public:
  // `count` environments, `threads` of the caller's and its own. Throws as GraspEnvironment.
  VectorEnvironment(const SceneFile& file, ActionKind action, std::size_t count, std::size_t threads);
  ~VectorEnvironment();
  VectorEnvironment(const VectorEnvironment&) = delete;
  VectorEnvironment& operator=(const VectorEnvironment&) = delete;

  [[nodiscard]] std::size_t size() const { return places_.size(); }
  [[nodiscard]] GraspEnvironment& environment(std::size_t i) { return *places_[i].environment; }
  // Number of its episode.
  [[nodiscard]] std::uint64_t episode(std::size_t i) const { return places_[i].episode; }

  // Begins episodes[i] of seeds[i] in each. Throws what any of them throws.
  void reset(std::span<const std::uint64_t> seeds, std::span<const std::uint64_t> episodes);
  // actions: [size()]
  void step(std::span<const double> actions);

 private:
  struct Place {
    std::unique_ptr<GraspEnvironment> environment;
    std::uint64_t seed = 0, episode = 0;
  };

  // Does `work` for each place, on all threads. Throws the first thing, by place, that went wrong.
  void for_each(const std::function<void(Place&, std::size_t)>& work);
  void take_places();
  void wait_for_work();

  std::vector<Place> places_;
  std::vector<std::exception_ptr> errors_;
  std::mutex mutex_;
  std::condition_variable changed_;
  const std::function<void(Place&, std::size_t)>* work_ = nullptr;
  std::uint64_t round_ = 0;  // of work
  std::size_t next_ = 0;     // place that nobody has taken
  std::size_t busy_ = 0;     // threads that have one
  bool stopped_ = false;
  std::vector<std::jthread> threads_;  // beside the caller's; last: they use all of the above
};

}  // namespace slipbench
