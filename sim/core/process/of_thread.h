// What each thread has for itself, kept until the thread ends.
#pragma once

#include <memory>

namespace slipbench {

// A key of POSIX and no thread_local object: to note the destructor of one takes memory, and glibc ends the program where there is none. Keys are not given
// back.
class ThreadKey {
 public:
  // `end` is called with the value of each thread that ends. Throws std::bad_alloc where no key is left.
  explicit ThreadKey(void (*end)(void* value));
  [[nodiscard]] void* get() const;  // null: this thread has none yet
  void set(void* value) const;      // throws std::bad_alloc

 private:
  unsigned key_ = 0;
};

// Make these static.
template <class Value>
class OfThread {
 public:
  // This thread's own, made when it first asks. Throws std::bad_alloc.
  Value& get() {
    if (void* const there = key_.get()) return *static_cast<Value*>(there);
    auto made = std::make_unique<Value>();
    key_.set(made.get());
    return *made.release();
  }

 private:
  ThreadKey key_{[](void* value) { delete static_cast<Value*>(value); }};
};

}  // namespace slipbench
