// Checked access to the objects of an open HDF5 file. All reading goes through here, so that no
// link leads out of the file and no damaged size allocates memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <hdf5.h>

namespace slipbench::hdf5 {

// Wraps the HDF5 C library: handles close themselves, and failures throw.

// Prepares the library: no error stack on stderr, and no clean-up at exit, which would repeat
// failed writes. Call before any other use; repeating it does nothing.
void initialise();

// Reason of the last failed call: the system's text ("No space left on device") if there is one,
// else the library's.
std::string last_error();

// Owns an HDF5 identifier of any kind.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);

  Handle() = default;
  // Throws std::runtime_error with last_error() if `id` is the result of a failed call.
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

  // Closes now. Throws std::runtime_error if that fails, since closing a file writes.
  void close();
  // Forgets the identifier without closing it: for a file that can no longer be written.
  void abandon() { id_ = H5I_INVALID_HID; }

 private:
  void reset() noexcept {
    if (id_ >= 0) close_(id_);
    id_ = H5I_INVALID_HID;
  }

  hid_t id_ = H5I_INVALID_HID;
  Close close_ = nullptr;
};

// Returns `status`, the result of a call. Throws std::runtime_error with last_error() if the call
// failed.
template <class Status>
Status check(Status status) {
  if (status < 0) throw std::runtime_error(last_error());
  return status;
}

// Maximum compression ratio of deflate: two bits for each 258 bytes, so 1032 bytes per byte.
inline constexpr std::uint64_t best_compression = 1032;

// An object of an open file. `file_name` must outlive it.
struct Place {
  hid_t file;
  const std::string& file_name;
  std::string object;  // "/data/demo_0"

  // Throws InputError "FILE: OBJECT: what".
  [[noreturn]] void fail(const std::string& what) const;
  [[nodiscard]] Place below(const std::string& name) const;
};

inline constexpr std::size_t deepest = 8;  // maximum nesting depth; following a group that contains itself would not end

// Opens a file for reading. Throws InputError if it is not a regular file (which might block) or
// not HDF5.
Handle open_file(const std::string& path);

// Limits HDF5's metadata cache of a file to the list of trials and one trial, for files of which
// many are open.
void keep_little(const Handle& file);

// Opens a group or array. Throws InputError if a soft or external link is on the way.
Handle open_object(const Place& place);

// Names of the members of `group`, which is open at `place`, in ascending order. Throws InputError
// for names with control characters and for soft or external links.
std::vector<std::string> members_of(const Place& place, const Handle& group);
// As above, for a group that is not open.
std::vector<std::string> members_of(const Place& place);
// Opens a member of `group` returned by members_of(), which is at `place`. Ten times as fast as
// open_object(), which starts at the root.
Handle open_member(const Place& place, const Handle& group, const std::string& name);
// As above, for any member. Throws InputError for a soft or external link.
Handle open_below(const Place& place, const Handle& group, const std::string& name);
// Names of an object's attributes in ascending order.
std::vector<std::string> attributes_of(const Place& place, const Handle& object);

// Number of elements. Throws InputError if `element_bytes` each are more than the file can hold at
// that compression ratio.
std::size_t count_of(const Place& place, const std::vector<std::size_t>& extents, std::size_t element_bytes,
                     std::uint64_t compression);

// Extents of an array, after checking that all of its values are in the file: no external storage,
// no virtual dataset, no more bytes than its storage can decompress to. Throws InputError also if
// the object at `place` is not an array.
std::vector<std::size_t> array_extents(const Place& place, const Handle& array);

// Reads all values of an array, converted to `type`, into `to`, which must be large enough.
void read_values(const Place& place, const Handle& array, hid_t type, void* to);

// An open attribute, whose extents are checked as by array_extents().
struct Attribute {
  Handle handle;
  Handle type;
  std::vector<std::size_t> shape;
};
Attribute open_attribute(const Place& place, const Handle& object, const std::string& name);

// Texts of an attribute, of variable length.
std::vector<std::string> texts_of(const Place& place, const Attribute& attribute, const std::string& name);
// The single text of an attribute.
std::string text_of(const Place& place, const Handle& object, const std::string& name);
// Texts of an array, of fixed length and padded with zeros.
std::vector<std::string> texts_of(const Place& place, const Handle& array);

// A property list for a kind of object, without time stamps.
Handle untimed(hid_t kind);

// Data space of an array with these extents; of a single value if there are none.
Handle space_of(const std::vector<std::size_t>& shape);

// Adds an attribute: a single value, texts of any length, or doubles [shape] in C order.
void write_attribute(hid_t object, const std::string& name, std::uint64_t value);
void write_attribute(hid_t object, const std::string& name, std::int64_t value);
void write_attribute(hid_t object, const std::string& name, double value);
void write_attribute(hid_t object, const std::string& name, const std::string& value);
void write_attribute(hid_t object, const std::string& name, const std::vector<std::string>& values);
void write_attribute(hid_t object, const std::string& name, const std::vector<double>& values,
                     const std::vector<std::size_t>& shape);

// Adds an array of texts, padded with zeros to the length of the longest.
void write_texts(hid_t group, const char* name, const std::vector<std::string>& texts);

}  // namespace slipbench::hdf5
