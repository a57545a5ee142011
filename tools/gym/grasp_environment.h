// A grasp commanded from outside: a policy takes the controller's place.
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
#include "sim/api/simulation.h"
#include "sim/scene/catalogues.h"
#include "sim/scene/parser.h"
#include "tools/trial/sweep/warnings.h"
#include "tools/trial/trial_run.h"

namespace slipbench {

// Quantity to which an action in [-1, 1] maps linearly.
enum class ActionKind {
  force,  // 0 to GraspEnvironment::strongest: target of the measured grip force, followed as the controllers do (ForceFollower)
  position,  // 0 to max_register, the position register
};

// Result of a step of a policy.
struct EnvironmentStep {
  double reward = 0.0;
  bool dropped = false;        // the box was dropped, which ends the episode
  bool left_behind = false;    // the arm rose without the box, which ends the episode
  bool ended = false;          // the scene's duration is over, which ends the episode
  double time = 0.0;           // s, of the read, or of the episode's end
  double grip_force = 0.0;     // N, true
  double ideal_force = 0.0;    // N, least force that can hold the box; infinite without friction
  double slip_distance = 0.0;  // m, the largest of any unit of the first sensor's pad
  bool lifting = false;        // the lift has begun

  [[nodiscard]] bool failed() const { return dropped || left_behind; }
};

// Reward of a step: -(F/F_ideal) dt/T - 0.1/mm ds - 10 if the box was dropped in it, or the lift
// ended without the box. F: true grip force at its end, F_ideal: least force that can hold the box,
// dt: its length, T: the scene's duration, ds: growth of slip_distance since the lift began. So an
// episode that holds the box at the ideal force without slip is worth at least -1, and one that
// leaves the box on the table no more than one that drops it.
// The scene's duration limits the episode. Unlike other trials it may end before the lift does:
// then the last tick counts as the lift's end.
class GraspEnvironment {
 public:
  static constexpr double strongest = 20.0;      // N, of ActionKind::force
  static constexpr double drop_penalty = 10.0;   // 1
  static constexpr double slip_penalty = 100.0;  // 1/m

  // Throws InputError for an invalid scene, for a scene that is not a grasp or whose arm waits for
  // commands, and, for ActionKind::force, if the first sensor does not measure force.
  GraspEnvironment(const SceneFile& file, ActionKind action);

  // Names of the observation's values: each channel value of every sensor ("pad.P0_FX") at its last
  // sample, then gripper.position [counts], gripper.moving, gripper.stopped, and, if the scene has
  // a detector, slip.state (PadState).
  [[nodiscard]] const std::vector<std::string>& observation_names() const { return names_; }
  // Unit of each value: "N", "m", "counts"; "1" for flags and codes.
  [[nodiscard]] const std::vector<std::string>& observation_units() const { return units_; }

  // Starts episode number `episode` of the scene with that seed, and runs it to the first read of
  // the gripper. Each episode of a seed is another draw; episodes cycle through the cells of the
  // scene's grid from a cell of the seed (trial_of_episode()).
  void reset(std::uint64_t seed, std::uint64_t episode);
  // Sends the command and runs to the next read. Throws InputError for an action outside [-1, 1],
  // std::logic_error before reset() or after the end.
  const EnvironmentStep& step(double action);
  // Observation at the read that asks for the next action; after the end, the last one.
  // [observation_names().size()]
  [[nodiscard]] std::span<const float> observation() const { return observation_; }
  [[nodiscard]] const EnvironmentStep& latest() const { return latest_; }
  // After the episode: the attribute `outcome` of a demo. Empty before.
  [[nodiscard]] const std::string& outcome() const { return outcome_; }
  [[nodiscard]] bool over() const { return latest_.failed() || latest_.ended; }
  // Poses of the grasp's bodies in the world (GraspSimulation::bodies()). Throws std::logic_error
  // after a failed reset().
  [[nodiscard]] const std::vector<NamedBody>& bodies() const;
  // Throws InputError for an action outside [-1, 1].
  static void check_action(double action);
  // JSON of the episode's draws.
  [[nodiscard]] const std::string& params() const { return params_; }
  // Warnings that `slipbench sweep` would give before it runs the scene.
  [[nodiscard]] std::vector<Warning> warnings() const;
  // Command that runs the episode's trial with the scene's own controller: "slipbench run ...".
  // `scene`: the scene's path and overrides, quoted for a shell.
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

// Several grasps, stepped in parallel by threads. Autoreset by Gymnasium's mode NEXT_STEP: the step
// after an episode's end ignores its action, starts the next episode of that environment's seed,
// and has reward 0. The results do not depend on the number of threads. Use from one thread at a
// time.
class VectorEnvironment {
 public:
  // `count` environments; `threads` includes the caller's thread. Throws as GraspEnvironment.
  VectorEnvironment(const SceneFile& file, ActionKind action, std::size_t count, std::size_t threads);
  ~VectorEnvironment();
  VectorEnvironment(const VectorEnvironment&) = delete;
  VectorEnvironment& operator=(const VectorEnvironment&) = delete;

  [[nodiscard]] std::size_t size() const { return places_.size(); }
  [[nodiscard]] GraspEnvironment& environment(std::size_t i) { return *places_[i].environment; }
  // Number of the environment's episode.
  [[nodiscard]] std::uint64_t episode(std::size_t i) const { return places_[i].episode; }

  // Starts episode episodes[i] with seeds[i] in environment i. Rethrows the environments'
  // exceptions.
  void reset(std::span<const std::uint64_t> seeds, std::span<const std::uint64_t> episodes);
  // actions: [size()]
  void step(std::span<const double> actions);

 private:
  struct Place {
    std::unique_ptr<GraspEnvironment> environment;
    std::uint64_t seed = 0, episode = 0;
  };

  // Runs `work` for each place, on all threads. Rethrows the exception of the first place that
  // failed.
  void for_each(const std::function<void(Place&, std::size_t)>& work);
  void take_places();
  void wait_for_work();

  std::vector<Place> places_;
  std::vector<std::exception_ptr> errors_;
  std::mutex mutex_;
  std::condition_variable changed_;
  const std::function<void(Place&, std::size_t)>* work_ = nullptr;
  std::uint64_t round_ = 0;  // of work
  std::size_t next_ = 0;     // next place to take
  std::size_t busy_ = 0;     // threads that are working on a place
  bool stopped_ = false;
  std::vector<std::jthread> threads_;  // besides the caller's; last: they use all members above
};

}  // namespace slipbench
