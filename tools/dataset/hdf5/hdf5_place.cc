#include "tools/dataset/hdf5/hdf5_place.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numeric>
#include <optional>
#include <string_view>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/core/counted.h"
#include "sim/core/process/regular_file.h"
#include "tools/files/reject.h"

namespace slipbench::hdf5 {
namespace {

// Names of members, and the first of them that is a soft or external link.
struct Members {
  std::vector<std::string> names;
  std::string link;
};

herr_t add_member(hid_t, const char* name, const H5L_info_t* info, void* context) {
  auto& members = *static_cast<Members*>(context);
  if (info->type != H5L_TYPE_HARD && members.link.empty()) members.link = name;
  members.names.emplace_back(name);
  return 0;
}

herr_t add_attribute(hid_t, const char* name, const H5A_info_t*, void* names) {
  static_cast<std::vector<std::string>*>(names)->emplace_back(name);
  return 0;
}

[[noreturn]] void refuse_link(const Place& place) {
  place.fail("is a link to another file, but a dataset must contain all of its data");
}

void check_name(const Place& place, const std::string& name) {
  if (printable(name) != name) place.fail("contains the name " + quote(name) + "; allowed: names without control characters");
}

std::uint64_t file_bytes(const Place& place) {
  hsize_t bytes = 0;
  check(H5Fget_filesize(place.file, &bytes));
  return bytes;
}

// Cached for all attributes: creating a type takes HDF5 as long as writing an attribute.
const Handle& text_type(H5T_cset_t characters = H5T_CSET_UTF8) {
  const auto make = [](H5T_cset_t character_set) {
    Handle type(H5Tcopy(H5T_C_S1), &H5Tclose);
    check(H5Tset_size(type.get(), H5T_VARIABLE));
    check(H5Tset_cset(type.get(), character_set));
    return type;
  };
  static const Handle utf8 = make(H5T_CSET_UTF8), ascii = make(H5T_CSET_ASCII);
  return characters == H5T_CSET_UTF8 ? utf8 : ascii;
}

void write(hid_t object, const std::string& name, hid_t type, const std::vector<std::size_t>& shape, const void* values) {
  const Handle space = space_of(shape);
  Handle attribute(H5Acreate2(object, name.c_str(), type, space.get(), H5P_DEFAULT, H5P_DEFAULT), &H5Aclose);
  check(H5Awrite(attribute.get(), type, values));
  attribute.close();
}

struct Reason {
  std::string system;   // the operating system's message
  std::string library;  // innermost message of the HDF5 library
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

// The number after `name` in a message of the library.
std::optional<std::uint64_t> number_after(std::string_view message, std::string_view name) {
  const std::size_t start = message.find(name);
  if (start == std::string_view::npos) return std::nullopt;
  std::uint64_t number = 0;
  const char* const end = message.data() + message.size();
  const bool found = std::from_chars(message.data() + start + name.size(), end, number).ec == std::errc();
  return found ? std::optional(number) : std::nullopt;
}

// Explains why H5Fopen() refused a file with `message`: truncated, or one of the kinds often
// mistaken for a dataset.
std::string why_not_hdf5(const std::string& path, const std::string& message) {
  using namespace std::string_view_literals;
  constexpr std::size_t superblock = 96;  // bytes, at least
  std::array<char, superblock> bytes{};
  std::ifstream file(path, std::ios::binary);
  if (!file.is_open()) return "cannot be read: " + message;
  file.read(bytes.data(), bytes.size());
  const std::string_view start(bytes.data(), static_cast<std::size_t>(file.gcount()));
  if (start.empty()) return "is empty, not an HDF5 file";
  constexpr std::string_view signature = "\x89HDF\r\n\x1a\n"sv;
  if (start.starts_with(signature.substr(0, start.size()))) {
    const auto found = number_after(message, "truncated file: eof = "), written = number_after(message, "stored_eof = ");
    if (found && written) return fmt::format("is truncated: it has {} of {} bytes; copy or download it again", *found, *written);
    if (start.size() < superblock)
      return fmt::format("is truncated: it has {}; copy or download it again", counted(start.size(), "byte"));
    return "is damaged: " + message;
  }
  struct Kind {
    std::string_view start, what;
  };
  constexpr std::array kinds{
      Kind{"version https://git-lfs"sv, "is a Git LFS pointer, not the data; run 'git lfs pull' in its repository"sv},
      Kind{"\x1f\x8b"sv, "is compressed with gzip, not an HDF5 file; decompress it first"sv},
      Kind{"\x28\xb5\x2f\xfd"sv, "is compressed with zstd, not an HDF5 file; decompress it first"sv},
      Kind{"\xfd\x37zXZ"sv, "is compressed with xz, not an HDF5 file; decompress it first"sv},
      Kind{"BZh"sv, "is compressed with bzip2, not an HDF5 file; decompress it first"sv},
      Kind{"PK\x03\x04"sv, "is a ZIP archive, not an HDF5 file; unpack it first"sv},
  };
  for (const Kind& kind : kinds) {
    if (start.starts_with(kind.start)) return std::string(kind.what);
  }
  std::string text(start.substr(std::min(start.find_first_not_of(" \t\r\n\xef\xbb\xbf"sv), start.size())));
  std::ranges::transform(text, text.begin(), [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  if (text.starts_with("<!doctype html") || text.starts_with("<html"))
    return "is an HTML page, not an HDF5 file; download the file itself";
  return "is not an HDF5 file; `slipbench import` reads tables and bags";
}

// Checks the size of chunks without compression. Of a dataset's filters only shuffle keeps the
// number of bytes. A chunk that skips all other filters must have the bytes of all of its values:
// HDF5 1.10 reads beyond a shorter one.
void check_unfiltered_chunks(const Place& place, const Handle& array) {
  const Handle properties(H5Dget_create_plist(array.get()), &H5Pclose), type(H5Dget_type(array.get()), &H5Tclose);
  if (H5Pget_layout(properties.get()) != H5D_CHUNKED) return;
  std::array<hsize_t, H5S_MAX_RANK> extents{}, offset{};
  const int rank = check(H5Pget_chunk(properties.get(), H5S_MAX_RANK, extents.data()));
  const hsize_t whole =
      std::accumulate(extents.begin(), extents.begin() + rank, hsize_t{H5Tget_size(type.get())}, std::multiplies<>());
  unsigned resizing = 0;  // one bit per filter, as in a chunk's mask of skipped filters
  for (int i = 0; i < check(H5Pget_nfilters(properties.get())); ++i) {
    std::size_t values = 0;
    const auto filter = static_cast<unsigned>(i);
    if (H5Pget_filter2(properties.get(), filter, nullptr, &values, nullptr, 0, nullptr, nullptr) != H5Z_FILTER_SHUFFLE)
      resizing |= 1U << filter;
  }
  const Handle space(H5Dget_space(array.get()), &H5Sclose);
  hsize_t count = 0;
  // HDF5 1.14 detects damage of the index here.
  const auto fail = [&] { place.fail("cannot be read: " + last_error()); };
  if (H5Dget_num_chunks(array.get(), space.get(), &count) < 0) fail();
  for (hsize_t i = 0; i < count; ++i) {
    unsigned left_out = 0;
    haddr_t address = 0;
    hsize_t bytes = 0;
    if (H5Dget_chunk_info(array.get(), space.get(), i, offset.data(), &left_out, &address, &bytes) < 0) fail();
    if ((left_out & resizing) == resizing && bytes < whole)
      place.fail(fmt::format("is damaged: a chunk without compression has {} of {} bytes", bytes, whole));
  }
}

std::vector<std::size_t> extents_of(const Place& place, const Handle& space) {
  const int rank = H5Sget_simple_extent_ndims(space.get());
  if (rank < 0) place.fail("its extents cannot be read");
  std::vector<hsize_t> extents(static_cast<std::size_t>(rank));
  check(H5Sget_simple_extent_dims(space.get(), extents.data(), nullptr));
  return {extents.begin(), extents.end()};
}

}  // namespace

void Place::fail(const std::string& what) const { reject("{}: {}: {}", file_name, object, what); }

Place Place::below(const std::string& name) const { return {file, file_name, object == "/" ? "/" + name : object + "/" + name}; }

Handle open_file(const std::string& path) {
  check_regular_file(path);
  std::error_code error;
  if (!std::filesystem::exists(path, error)) reject("{}: no such file", path);
  Handle access(H5Pcreate(H5P_FILE_ACCESS), &H5Pclose);
  check(H5Pset_file_locking(access.get(), false, true));
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.get());
  if (file < 0) reject("{}: {}", path, why_not_hdf5(path, last_error()));
  return {file, &H5Fclose};
}

void keep_little(const Handle& file) {
  constexpr std::size_t bytes = 96 << 10;  // size on disk; about ten times as much when decoded
  H5AC_cache_config_t config{};
  config.version = H5AC__CURR_CACHE_CONFIG_VERSION;
  check(H5Fget_mdc_config(file.get(), &config));
  config.set_initial_size = true;
  config.initial_size = config.min_size = config.max_size = bytes;
  config.incr_mode = H5C_incr__off;
  config.flash_incr_mode = H5C_flash_incr__off;
  config.decr_mode = H5C_decr__off;
  check(H5Fset_mdc_config(file.get(), &config));
}

Handle open_object(const Place& place) {
  for (std::size_t end = place.object.find('/', 1); place.object != "/"; end = place.object.find('/', end + 1)) {
    const std::string path = place.object.substr(0, end);
    H5L_info_t info{};
    if (H5Lget_info(place.file, path.c_str(), &info, H5P_DEFAULT) < 0) place.fail("missing or damaged");
    if (info.type != H5L_TYPE_HARD) refuse_link({place.file, place.file_name, path});
    if (end == std::string::npos) break;
  }
  const hid_t id = H5Oopen(place.file, place.object.c_str(), H5P_DEFAULT);
  if (id < 0) place.fail("missing or damaged");
  return {id, &H5Oclose};
}

Handle open_member(const Place& place, const Handle& group, const std::string& name) {
  const hid_t id = H5Oopen(group.get(), name.c_str(), H5P_DEFAULT);
  if (id < 0) place.fail("missing or damaged");
  return {id, &H5Oclose};
}

Handle open_below(const Place& place, const Handle& group, const std::string& name) {
  H5L_info_t info{};
  if (H5Lget_info(group.get(), name.c_str(), &info, H5P_DEFAULT) < 0) place.fail("missing or damaged");
  if (info.type != H5L_TYPE_HARD) refuse_link(place);
  return open_member(place, group, name);
}

std::vector<std::string> members_of(const Place& place) { return members_of(place, open_object(place)); }

std::vector<std::string> members_of(const Place& place, const Handle& group) {
  Members members;
  hsize_t position = 0;
  if (H5Literate(group.get(), H5_INDEX_NAME, H5_ITER_INC, &position, &add_member, &members) < 0) {
    place.fail("its members cannot be listed: " + last_error());
  }
  for (const std::string& name : members.names) check_name(place, name);
  if (!members.link.empty()) refuse_link(place.below(members.link));
  return std::move(members.names);
}

std::vector<std::string> attributes_of(const Place& place, const Handle& object) {
  std::vector<std::string> names;
  hsize_t position = 0;
  if (H5Aiterate2(object.get(), H5_INDEX_NAME, H5_ITER_INC, &position, &add_attribute, &names) < 0) {
    place.fail("its attributes cannot be listed: " + last_error());
  }
  for (const std::string& name : names) check_name(place, name);
  return names;
}

std::size_t count_of(const Place& place, const std::vector<std::size_t>& extents, std::size_t element_bytes,
                     std::uint64_t compression) {
  if (std::ranges::find(extents, std::size_t{0}) != extents.end()) return 0;
  const std::uint64_t most = file_bytes(place) * compression / std::max<std::size_t>(1, element_bytes);
  std::uint64_t count = 1;
  for (const std::size_t extent : extents) {
    if (count > most / extent)
      place.fail(fmt::format("its extents [{}] are larger than a file of this size can contain", fmt::join(extents, ", ")));
    count *= extent;
  }
  return count;
}

std::vector<std::size_t> array_extents(const Place& place, const Handle& array) {
  if (H5Iget_type(array.get()) != H5I_DATASET) place.fail("is not an array");
  const Handle properties(H5Dget_create_plist(array.get()), &H5Pclose);
  const H5D_layout_t layout = H5Pget_layout(properties.get());
  constexpr const char* allowed = ", but a dataset must contain all of its data";
  if (layout == H5D_VIRTUAL) place.fail(std::string("is a virtual dataset with values in other files") + allowed);
  if (H5Pget_external_count(properties.get()) != 0) place.fail(std::string("has its values in another file") + allowed);
  const Handle space(H5Dget_space(array.get()), &H5Sclose);
  const Handle type(H5Dget_type(array.get()), &H5Tclose);
  const std::size_t size = H5Tget_size(type.get());
  std::vector<std::size_t> extents = extents_of(place, space);
  const std::uint64_t compression = layout == H5D_CHUNKED ? best_compression : 1;
  const std::size_t count = count_of(place, extents, size, compression);
  if (count > 0 && count * size / compression > H5Dget_storage_size(array.get())) {
    place.fail(fmt::format("its extents [{}] are larger than its stored bytes can decompress to", fmt::join(extents, ", ")));
  }
  if (layout == H5D_CHUNKED) {
    std::vector<hsize_t> chunk(std::max<std::size_t>(1, extents.size()));
    check(H5Pget_chunk(properties.get(), static_cast<int>(chunk.size()), chunk.data()));
    count_of(place, {chunk.begin(), chunk.end()}, size, compression);  // chunks are decompressed as a whole
  }
  return extents;
}

void read_values(const Place& place, const Handle& array, hid_t type, void* to) {
  check_unfiltered_chunks(place, array);
  if (H5Dread(array.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, to) < 0) place.fail("cannot be read: " + last_error());
}

Attribute open_attribute(const Place& place, const Handle& object, const std::string& name) {
  const hid_t opened = H5Aopen(object.get(), name.c_str(), H5P_DEFAULT);
  if (opened < 0) {
    const std::string why = last_error();
    if (H5Aexists(object.get(), name.c_str()) == 0) place.fail("has no attribute '" + name + "'");
    place.fail("attribute '" + name + "' cannot be read: " + why);
  }
  Attribute attribute;
  attribute.handle = Handle(opened, &H5Aclose);
  attribute.type = Handle(H5Aget_type(attribute.handle.get()), &H5Tclose);
  attribute.shape = extents_of(place, Handle(H5Aget_space(attribute.handle.get()), &H5Sclose));
  count_of(place, attribute.shape, H5Tget_size(attribute.type.get()), 1);
  return attribute;
}

std::vector<std::string> texts_of(const Place& place, const Attribute& attribute, const std::string& name) {
  if (H5Tis_variable_str(attribute.type.get()) <= 0) place.fail("attribute '" + name + "' is not a text");
  std::vector<char*> texts(count_of(place, attribute.shape, 1, 1), nullptr);
  const Handle& type = text_type(H5Tget_cset(attribute.type.get()));
  if (!texts.empty() && H5Aread(attribute.handle.get(), type.get(), texts.data()) < 0) {
    place.fail("attribute '" + name + "' cannot be read: " + last_error());
  }
  std::vector<std::string> result;
  for (char* text : texts) {
    result.emplace_back(text != nullptr ? text : "");
    if (text != nullptr) check(H5free_memory(text));
  }
  return result;
}

std::string text_of(const Place& place, const Handle& object, const std::string& name) {
  std::vector<std::string> texts = texts_of(place, open_attribute(place, object, name), name);
  if (texts.size() != 1) place.fail("attribute '" + name + "' is not a single text");
  return std::move(texts.front());
}

std::vector<std::string> texts_of(const Place& place, const Handle& array) {
  const std::vector<std::size_t> extents = array_extents(place, array);
  const Handle type(H5Dget_type(array.get()), &H5Tclose);
  if (H5Tget_class(type.get()) != H5T_STRING || H5Tis_variable_str(type.get()) != 0) place.fail("is not a list of names");
  const std::size_t width = H5Tget_size(type.get());
  const std::size_t count = count_of(place, extents, width, best_compression);
  std::string padded(count * width, '\0');
  if (count > 0) read_values(place, array, type.get(), padded.data());
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < count; ++i) {
    const std::string text = padded.substr(i * width, width);
    texts.push_back(text.substr(0, text.find('\0')));
  }
  return texts;
}

Handle untimed(hid_t kind) {
  Handle properties(H5Pcreate(kind), &H5Pclose);
  check(H5Pset_obj_track_times(properties.get(), 0));
  return properties;
}

Handle space_of(const std::vector<std::size_t>& shape) {
  if (shape.empty()) return {H5Screate(H5S_SCALAR), &H5Sclose};
  const std::vector<hsize_t> extents(shape.begin(), shape.end());
  return {H5Screate_simple(static_cast<int>(extents.size()), extents.data(), nullptr), &H5Sclose};
}

void write_attribute(hid_t object, const std::string& name, std::uint64_t value) {
  write(object, name, H5T_STD_U64LE, {}, &value);
}

void write_attribute(hid_t object, const std::string& name, std::int64_t value) {
  write(object, name, H5T_STD_I64LE, {}, &value);
}

void write_attribute(hid_t object, const std::string& name, double value) { write(object, name, H5T_IEEE_F64LE, {}, &value); }

void write_attribute(hid_t object, const std::string& name, const std::string& value) {
  const char* text = value.c_str();
  write(object, name, text_type().get(), {}, &text);
}

void write_attribute(hid_t object, const std::string& name, const std::vector<std::string>& values) {
  std::vector<const char*> texts;
  for (const std::string& value : values) texts.push_back(value.c_str());
  write(object, name, text_type().get(), {values.size()}, texts.data());
}

void write_attribute(hid_t object, const std::string& name, const std::vector<double>& values,
                     const std::vector<std::size_t>& shape) {
  write(object, name, H5T_IEEE_F64LE, shape, values.data());
}

void write_texts(hid_t group, const char* name, const std::vector<std::string>& texts) {
  std::size_t width = 1;
  for (const std::string& text : texts) width = std::max(width, text.size());
  std::string padded;
  for (const std::string& text : texts) padded += text + std::string(width - text.size(), '\0');
  Handle type(H5Tcopy(H5T_C_S1), &H5Tclose);
  check(H5Tset_size(type.get(), width));
  check(H5Tset_strpad(type.get(), H5T_STR_NULLPAD));
  const Handle space = space_of({texts.size()}), properties = untimed(H5P_DATASET_CREATE);
  Handle array(H5Dcreate2(group, name, type.get(), space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT), &H5Dclose);
  if (!texts.empty()) check(H5Dwrite(array.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, padded.data()));
  array.close();
}

void initialise() {
  static const bool done = [] {
    H5dont_atexit();
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    H5PLset_loading_state(0);  // a file may name a filter, which HDF5 would load as a library
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
