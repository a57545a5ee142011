// What each thread has for itself, kept until the thread ends.
#pragma once

#include <memory>
#include <new>

#include <pthread.h>

namespace slipbench {

// A key of POSIX and no thread_local object: to note the destructor of one takes memory, and glibc ends the program where there is none. Keys are not given
// back: make these static.
template <class Value>
class OfThread {
 public:
  OfThread() {
    if (::pthread_key_create(&key_, [](void* value) { delete static_cast<Value*>(value); }) != 0) throw std::bad_alloc();
  }

  // This thread's own, made when it first asks. Throws std::bad_alloc.
  Value& get() {
    if (void* const there = ::pthread_getspecific(key_)) return *static_cast<Value*>(there);
    auto made = std::make_unique<Value>();
    if (::pthread_setspecific(key_, made.get()) != 0) throw std::bad_alloc();
    return *made.release();
  }

 private:
  pthread_key_t key_{};
};

}  // namespace slipbench
