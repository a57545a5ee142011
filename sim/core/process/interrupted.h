// How long work ends early.
#pragma once

#include <atomic>
#include <stdexcept>
#include <string>

namespace slipbench {

// Thrown by what an interrupt has ended early.
class Interrupted : public std::runtime_error {
 public:
  // `left`: what is left of the work, for the user.
  explicit Interrupted(const std::string& left = "nothing is kept") : std::runtime_error("interrupted; " + left) {}
};

// Throws Interrupted once `interrupt` is true; it may be null.
inline void end_if(const std::atomic<bool>* interrupt) {
  if (interrupt != nullptr && interrupt->load(std::memory_order_relaxed)) throw Interrupted();
}

// While alive, end_if_interrupted() in this thread throws Interrupted once `interrupt` is true; it may be null. Scopes nest.
class InterruptScope {
 public:
  explicit InterruptScope(const std::atomic<bool>* interrupt);
  ~InterruptScope();
  InterruptScope(const InterruptScope&) = delete;
  InterruptScope& operator=(const InterruptScope&) = delete;

 private:
  const std::atomic<bool>* previous_;
};

// For work inside of a library that can take longer than a second. Not below a callback of MuJoCo, which is C.
void end_if_interrupted();

}  // namespace slipbench
