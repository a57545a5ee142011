// Work in child processes, and what they hand over.
#pragma once

#include <atomic>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "sim/core/process/interrupted.h"

namespace slipbench {

// Values as bytes on their way from a child process to its caller. Both are the same program.

// What Packed is told of a type that it cannot copy: all its members, in their order, in its namespace. A list that leaves one out does not compile.
#define SLIPBENCH_FIELDS(Type, ...) \
  template <MaybeConst<Type> Value> \
  auto fields_of(Value& of_these) { \
    auto& [__VA_ARGS__] = of_these; \
    return std::tie(__VA_ARGS__);   \
  }
template <class Value, class Type>
concept MaybeConst = std::is_same_v<std::remove_const_t<Value>, Type>;
template <class Value>
concept HasFields = requires(Value& value) {
  fields_of(value);
};

// What is put is taken in the same order: values that can be copied as bytes, those that have fields_of(), and of both texts, vectors, maps, optionals
// and variants.
// Taking throws std::out_of_range where the bytes are not those that were put.
class Packed {
 public:
  Packed() = default;
  explicit Packed(std::string bytes) : bytes_(std::move(bytes)) {}
  // Bytes that must outlive the object.
  static Packed of(std::string_view bytes) {
    Packed packed;
    packed.elsewhere_ = bytes;
    return packed;
  }

  // `values` put one after the other.
  template <class... Values>
  static std::string bytes_of(const Values&... values) {
    Packed packed;
    packed.put(values...);
    return packed.release();
  }

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
  [[nodiscard]] bool at_end() const { return place_ == all().size(); }
  std::string release() { return std::move(bytes_); }

 private:
  template <class Value>
  void put_one(const Value& value) {
    if constexpr (std::is_trivially_copyable_v<Value>) {
      bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    } else if constexpr (HasFields<const Value>) {
      std::apply([this](const auto&... fields) { put(fields...); }, fields_of(value));
    } else if constexpr (requires { value.has_value(); }) {
      put_one(value.has_value());
      if (value) put_one(*value);
    } else if constexpr (requires { value.valueless_by_exception(); }) {
      put_one(value.index());
      std::visit([this](const auto& held) { put_one(held); }, value);
    } else {
      put_one(value.size());
      if constexpr (requires { typename Value::mapped_type; }) {
        for (const auto& [key, mapped] : value) put(key, mapped);
      } else if constexpr (std::is_trivially_copyable_v<typename Value::value_type>) {
        bytes_.append(reinterpret_cast<const char*>(value.data()), value.size() * sizeof(typename Value::value_type));
      } else {
        for (const auto& each : value) put_one(each);
      }
    }
  }
  template <class Value>
  void take_one(Value& value) {
    if constexpr (std::is_trivially_copyable_v<Value>) {
      copy(&value, sizeof value);
    } else if constexpr (HasFields<Value>) {
      std::apply([this](auto&... fields) { take(fields...); }, fields_of(value));
    } else if constexpr (requires { value.has_value(); }) {
      if (take<bool>()) take_one(value.emplace());
    } else if constexpr (requires { typename Value::mapped_type; }) {
      for (auto left = take<std::size_t>(); left > 0; --left) {
        const auto key = take<typename Value::key_type>();
        take_one(value[key]);
      }
    } else {
      const auto count = take<std::size_t>();
      constexpr bool plain = std::is_trivially_copyable_v<typename Value::value_type>;
      expect(count, plain ? sizeof(typename Value::value_type) : 1);
      value.resize(count);
      if constexpr (plain) {
        copy(value.data(), count * sizeof(typename Value::value_type));
      } else {
        for (auto& each : value) take_one(each);
      }
    }
  }
  template <class... Kinds>
  void take_one(std::variant<Kinds...>& value) {
    const auto index = take<std::size_t>();
    std::size_t kind = 0;
    ((kind++ == index ? take_one(value.template emplace<Kinds>()) : void()), ...);
  }
  void copy(void* to, std::size_t size) {
    expect(size, 1);
    if (size > 0) std::memcpy(to, all().data() + place_, size);
    place_ += size;
  }
  void expect(std::size_t count, std::size_t size) const {
    if (count > (all().size() - place_) / size) throw std::out_of_range("bytes that are not those that were put");
  }
  [[nodiscard]] std::string_view all() const { return elsewhere_.empty() ? bytes_ : elsewhere_; }

  std::string bytes_;
  std::string_view elsewhere_;
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

  // How `action`, called here, ends.
  static ChildEnd of(const std::function<std::string()>& action);
  // What it returned. Throws InputError as such, all else as std::runtime_error.
  std::string result() &&;
};

// Bytes of the address space that this process has.
std::uint64_t own_bytes();
// Lets this process have so many more; none more under a sanitizer, which takes the whole address space for itself.
void limit_memory(std::uint64_t more);

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

// Ctrl-C that ends what runs and keeps what is finished.

// While alive, the first SIGINT, SIGTERM or SIGHUP sets the flag and says on stderr what happens next, `notice`, and the second
// ends the process as usual; a signal that was ignored before (a job that a script put in the background) stays ignored. A write
// beyond the process's limit on file sizes fails instead of ending it. One at a time.
class InterruptGuard {
 public:
  explicit InterruptGuard(std::string_view notice = "stopping");
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

  [[nodiscard]] static const std::atomic<bool>& flag();

 private:
  struct sigaction previous_int_ {};
  struct sigaction previous_term_ {};
  struct sigaction previous_hang_up_ {};
  struct sigaction previous_file_size_ {};
};

}  // namespace slipbench
