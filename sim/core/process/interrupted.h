// Interruption of long work.
#pragma once

#include <atomic>
#include <stdexcept>
#include <string>

namespace slipbench {

// Thrown by work that an interrupt ended early.
class Interrupted : public std::runtime_error {
 public:
  // `left`: the remaining work, for the user.
  explicit Interrupted(const std::string& left = "nothing is kept") : std::runtime_error("interrupted; " + left) {}
};

// Throws Interrupted once `interrupt` is true; it may be null.
inline void end_if(const std::atomic<bool>* interrupt) {
  if (interrupt != nullptr && interrupt->load(std::memory_order_relaxed)) throw Interrupted();
}

// While alive, makes end_if_interrupted() in this thread throw Interrupted once `interrupt` is
// true. `interrupt` may be null. Scopes nest.
class InterruptScope {
 public:
  explicit InterruptScope(const std::atomic<bool>* interrupt);
  ~InterruptScope();
  InterruptScope(const InterruptScope&) = delete;
  InterruptScope& operator=(const InterruptScope&) = delete;

 private:
  const std::atomic<bool>* previous_;
};

// Throws if the innermost InterruptScope is interrupted. For work inside a library that can take
// longer than a second. Must not be called below a callback of MuJoCo, which is C.
void end_if_interrupted();

}  // namespace slipbench
