// The places of an open HDF5 file. What is read of a file goes through here: nothing leads out of it, and nothing is as large as
// a damaged number says.
#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <hdf5.h>

namespace slipbench::hdf5 {

// The HDF5 C library with handles that close themselves and failures that throw.

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

// Deflate cannot do better: a pair of bits for 258 bytes twice over, so 1032 bytes for one.
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

inline constexpr std::size_t deepest = 8;  // groups below each other: a group that holds itself has no end

// Opens a file to read. Throws InputError where it is no regular file (which might block) or no HDF5.
Handle open_file(const std::string& path);

// Bounds what HDF5 keeps of a file's metadata in memory to what the list of its trials and one of these need: for files of which many are open.
void keep_little(const Handle& file);

// Opens a group or array by the links of the file itself: a soft or external link on the way is refused.
Handle open_object(const Place& place);

// Names of the members of `group`, which is open at `place`, in ascending order. Names with control characters and links that lead elsewhere are
// refused.
std::vector<std::string> members_of(const Place& place, const Handle& group);
// The same of a group that is not open.
std::vector<std::string> members_of(const Place& place);
// Opens a member of `group` that members_of() has named, which lies at `place`: without the way there from the root, which costs ten times as much.
Handle open_member(const Place& place, const Handle& group, const std::string& name);
// The same of any member: a link that leads elsewhere is refused.
Handle open_below(const Place& place, const Handle& group, const std::string& name);
// Names of an object's attributes in ascending order.
std::vector<std::string> attributes_of(const Place& place, const Handle& object);

// Number of elements, refused where `element_bytes` each are more than the file can hold at that compression.
std::size_t count_of(const Place& place, const std::vector<std::size_t>& extents, std::size_t element_bytes,
                     std::uint64_t compression);

// Extents of an array, once it is known that all of its values lie in the file: no external storage, no virtual dataset, no more
// bytes than what is stored can decompress to. Throws InputError also where what is open at `place` is not an array.
std::vector<std::size_t> array_extents(const Place& place, const Handle& array);

// Reads all values of an array, converted to `type`, into `to`, which must have room for them.
void read_values(const Place& place, const Handle& array, hid_t type, void* to);

// An attribute that is there; its extents are checked likewise.
struct Attribute {
  Handle handle;
  Handle type;
  std::vector<std::size_t> shape;
};
Attribute open_attribute(const Place& place, const Handle& object, const std::string& name);

// The texts of an attribute, which has variable length.
std::vector<std::string> texts_of(const Place& place, const Attribute& attribute, const std::string& name);
// The one text of an attribute.
std::string text_of(const Place& place, const Handle& object, const std::string& name);
// The texts of an array, which have a fixed length and are padded with zeros.
std::vector<std::string> texts_of(const Place& place, const Handle& array);

// A property list of a kind of object, which then carries no time of day.
Handle untimed(hid_t kind);

// Of an array of these extents; without any: of a single value.
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
