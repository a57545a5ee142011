// Values as bytes on their way from a child process (child_process.h) to its caller. Both are the same program.
#pragma once

#include <cstddef>
#include <cstring>
#include <string>
#include <type_traits>
#include <utility>

namespace slipbench {

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

}  // namespace slipbench
