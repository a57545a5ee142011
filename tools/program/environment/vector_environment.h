// Several grasps side by side, stepped by threads.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

#include "tools/program/environment/grasp_environment.h"

namespace slipbench {

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
  // Whether its latest step began an episode.
  [[nodiscard]] bool began(std::size_t i) const { return places_[i].began; }

  // Begins episodes[i] of seeds[i] in each whose `chosen` is not 0. Throws what any of them throws.
  void reset(std::span<const std::uint64_t> seeds, std::span<const std::uint64_t> episodes, std::span<const std::uint8_t> chosen);
  // actions: [size()]
  void step(std::span<const double> actions);

 private:
  struct Place {
    std::unique_ptr<GraspEnvironment> environment;
    std::uint64_t seed = 0, episode = 0;
    bool began = false;
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
