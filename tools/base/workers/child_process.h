// Work in child processes, and what they hand over.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstring>
#include <functional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace slipbench {

// Values as bytes on their way from a child process (child_process.h) to its caller. Both are the same program.

// What is put is taken in the same order: values that can be copied as bytes, and texts and vectors of such.
class Packed {
 public:
  Packed() = default;
  explicit Packed(std::string bytes) : bytes_(std::move(bytes)) {}

  template <class... Values>
  void put(const Values&... values) {
    (put_one(values), ...);
  }
  template <class... Values>
  void take(Values&... values) {
    (take_one(values), ...);
  }
  template <class Value>
  Value take() {
    Value value{};
    take_one(value);
    return value;
  }
  [[nodiscard]] bool at_end() const { return place_ == bytes_.size(); }
  std::string release() { return std::move(bytes_); }

 private:
  template <class Value>
  void put_one(const Value& value) {
    if constexpr (std::is_trivially_copyable_v<Value>) {
      bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    } else {
      put_one(value.size());
      bytes_.append(reinterpret_cast<const char*>(value.data()), value.size() * sizeof(typename Value::value_type));
    }
  }
  template <class Value>
  void take_one(Value& value) {
    if constexpr (std::is_trivially_copyable_v<Value>) {
      copy(&value, sizeof value);
    } else {
      value.resize(take<std::size_t>());
      copy(value.data(), value.size() * sizeof(typename Value::value_type));
    }
  }
  void copy(void* to, std::size_t size) {
    if (size > 0) std::memcpy(to, bytes_.data() + place_, size);
    place_ += size;
  }

  std::string bytes_;
  std::size_t place_ = 0;
};

// Work in child processes: for what may end its process, and for libraries that bear one thread only.

// How a child process ended.
struct ChildEnd {
  enum class Kind : char {
    result = 'r',
    bad_input = 'i',  // threw InputError
    no_memory = 'm',  // std::bad_alloc
    failure = 'f',    // another exception
    broken = 'b',     // it ended without a word, or was ended
  };
  Kind kind = Kind::broken;
  std::string text;  // what it returned, or the exception's words
  int status = 0;    // waitpid's
};

// A copy of this process that does one thing. It ends with its parent, and a Ctrl-C of the terminal is the parent's affair. Call it while this
// process has no other thread.
class ChildProcess {
 public:
  // Throws std::runtime_error where the system gives no process.
  explicit ChildProcess(const std::function<std::string()>& action);
  ~ChildProcess();  // kills it where it has not ended
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&&) = delete;

  // A descriptor that is readable where read() has something to do.
  [[nodiscard]] int channel() const { return channel_; }
  // Takes what it has sent so far, waiting for the first of it; false: it sends no more.
  bool read();
  // Waits for its end, after read() gave false.
  ChildEnd end();

 private:
  int channel_ = -1, process_ = -1;
  std::string sent_;
};

// Does work 0 to count - 1, up to `jobs` at a time, each in a child process of its own, and returns what each returned, in this order: whatever
// `jobs`, each begins with the memory of this process as it is now. `begun` is told of the number of each work before it begins, `done` of each that
// has ended, and of what it returned; it may be empty. Rethrows what work threw: InputError as such, others as std::runtime_error; throws
// Interrupted once `interrupt` is set. No child outlives it.
std::vector<std::string> run_in_processes(std::size_t count, std::size_t jobs,
                                          const std::function<std::string(std::size_t)>& work,
                                          const std::function<void(std::size_t)>& begun, const std::atomic<bool>& interrupt,
                                          const std::function<void(std::size_t, const std::string&)>& done = {});

}  // namespace slipbench
