#include "tools/base/hdf5/hdf5_handle.h"

#include <string_view>

namespace slipbench::hdf5 {
namespace {

struct Reason {
  std::string system;   // of the operating system
  std::string library;  // innermost message of the library
};

herr_t note_reason(unsigned, const H5E_error2_t* error, void* context) {
  Reason& reason = *static_cast<Reason*>(context);
  const std::string text = error->desc != nullptr ? error->desc : "";
  if (reason.library.empty()) reason.library = text;
  constexpr std::string_view mark = "error message = '";
  const std::size_t start = text.find(mark);
  if (start != std::string::npos && reason.system.empty()) {
    const std::size_t first = start + mark.size();
    reason.system = text.substr(first, text.find('\'', first) - first);
  }
  return 0;
}

}  // namespace

void initialise() {
  static const bool done = [] {
    H5dont_atexit();
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    H5PLset_loading_state(0);  // a file may name a filter, which would be loaded as a library
    return true;
  }();
  static_cast<void>(done);
}

std::string last_error() {
  Reason reason;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, &note_reason, &reason);
  if (!reason.system.empty()) return reason.system;
  return reason.library.empty() ? "HDF5 gives no reason" : reason.library;
}

Handle::Handle(hid_t id, Close close) : id_(check(id)), close_(close) {}

void Handle::close() {
  if (id_ < 0) return;
  const hid_t id = std::exchange(id_, H5I_INVALID_HID);
  check(close_(id));
}

}  // namespace slipbench::hdf5
