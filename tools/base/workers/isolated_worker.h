// Numbered work in a process of its own, for code of others that may end its process or never return.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

#include "sim/core/error.h"
#include "tools/base/workers/child_process.h"

namespace slipbench {

// Work that ended its process or took longer than it may.
class LostWork : public InputError {
 public:
  LostWork(std::string path, const std::string& what) : InputError(what), path_(std::move(path)) {}
  // The key of the scene that named the library which was at work; empty: none was.
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

// What a work may take.
struct WorkLimits {
  double time = std::numeric_limits<double>::infinity();  // s
  std::size_t memory = 0;                                 // MB, beyond what the program has; 0: what there is
};

// A process that does one work after another, and is replaced where a work has ended it. Between the two stands a third, which has one thread as long
// as it lives, so that forking is safe whatever threads the caller makes. All three share the last answer's bytes, and a page that says what is under
// way. The processes end with the caller's, however that ends, and are no part of its terminal's group: Ctrl-C is the caller's affair.
class IsolatedWorker {
 public:
  // Call it while this process has no other thread and no file open that work should not hold open. Throws std::runtime_error where the system gives
  // no process.
  explicit IsolatedWorker(const std::function<std::string(std::size_t)>& work, const WorkLimits& limits = {});
  ~IsolatedWorker();  // kills what is under way
  IsolatedWorker(const IsolatedWorker&) = delete;
  IsolatedWorker& operator=(const IsolatedWorker&) = delete;

  // What work(index) returned; valid until the next call. The folder that is current is the caller's at each work's beginning. Throws InputError and
  // std::bad_alloc that it threw, other exceptions as std::runtime_error, LostWork, and Interrupted once `interrupt` (it may be null) is set. A work
  // that ends a process which has done other work is done once more in a fresh one: it may be innocent.
  std::string_view run(std::size_t index, const std::atomic<bool>* interrupt);

  // What make() returns, made here or, where `apart` says so, as the only work of such a process.
  template <class Make>
  static auto made(bool apart, const WorkLimits& limits, const Make& make) {
    if (!apart) return make();
    IsolatedWorker worker([&make](std::size_t) { return Packed::bytes_of(make()); }, limits);
    return Packed::of(worker.run(0, nullptr)).template take<decltype(make())>();
  }

 private:
  struct Page;
  struct Message;

  [[noreturn]] void keep_working(int channel, const std::function<std::string(std::size_t)>& work);
  [[noreturn]] void keep_a_worker(int channel, const std::function<std::string(std::size_t)>& work);
  void ask(std::size_t index);
  Message answer(std::size_t index, const std::atomic<bool>* interrupt);
  [[noreturn]] void tell_loss(const Message& message) const;
  void map(std::size_t size);

  WorkLimits limits_;
  int channel_ = -1;        // to both other processes
  int bytes_ = -1;          // file in memory, of the last answer
  int keeper_ = -1;         // process
  Page* page_ = nullptr;    // shared
  std::string folder_;      // that is current
  std::uint64_t sent_ = 0;  // requests
  bool fresh_ = true;       // the process has answered nothing yet
  const char* mapped_ = nullptr;
  std::size_t mapped_size_ = 0;
};

}  // namespace slipbench
