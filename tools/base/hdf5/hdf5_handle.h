// The HDF5 C library with handles that close themselves and failures that throw.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

#include <hdf5.h>

namespace slipbench::hdf5 {

// Prepares the library: no error stack on stderr, and no clean-up at exit, which would try again to write what could not be
// written. Call before any other use; repeating it does nothing.
void initialise();

// The reason of the last failed call: the system's text ("No space left on device") where there is one, else the library's own.
std::string last_error();

// Owns an identifier of any kind.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);

  Handle() = default;
  // Throws std::runtime_error with last_error() when `id` is the result of a failed call.
  Handle(hid_t id, Close close);
  ~Handle() { reset(); }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
  Handle& operator=(Handle&& other) noexcept {
    if (this != &other) {
      reset();
      id_ = std::exchange(other.id_, H5I_INVALID_HID);
      close_ = other.close_;
    }
    return *this;
  }

  [[nodiscard]] hid_t get() const { return id_; }
  explicit operator bool() const { return id_ >= 0; }

  // Closes now, and throws std::runtime_error when that fails: closing a file writes.
  void close();
  // Gives up without closing: for a file that cannot be written any more.
  void abandon() { id_ = H5I_INVALID_HID; }

 private:
  void reset() noexcept {
    if (id_ >= 0) close_(id_);
    id_ = H5I_INVALID_HID;
  }

  hid_t id_ = H5I_INVALID_HID;
  Close close_ = nullptr;
};

// Throws std::runtime_error with last_error() when `status`, the result of a call, says that it failed.
template <class Status>
Status check(Status status) {
  if (status < 0) throw std::runtime_error(last_error());
  return status;
}

}  // namespace slipbench::hdf5
