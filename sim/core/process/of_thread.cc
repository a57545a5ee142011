#include "sim/core/process/of_thread.h"

#include <new>

#include <pthread.h>

namespace slipbench {

ThreadKey::ThreadKey(void (*end)(void* value)) {
  if (::pthread_key_create(&key_, end) != 0) throw std::bad_alloc();
}

void* ThreadKey::get() const { return ::pthread_getspecific(key_); }

void ThreadKey::set(void* value) const {
  if (::pthread_setspecific(key_, value) != 0) throw std::bad_alloc();
}

}  // namespace slipbench
