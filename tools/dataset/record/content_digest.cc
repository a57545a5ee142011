#include "tools/dataset/record/content_digest.h"

#include <algorithm>
#include <array>
#include <functional>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace slipbench {
namespace {

using hdf5::check;
using hdf5::Handle;
using hdf5::Place;

// The kinds of numbers in a dataset, as numpy writes them; empty for other types.
std::string_view kind_of(const Handle& type) {
  struct Kind {
    hid_t type;
    std::string_view name;
  };
  const std::array kinds{Kind{H5T_IEEE_F64LE, "<f8"}, Kind{H5T_IEEE_F32LE, "<f4"}, Kind{H5T_STD_U64LE, "<u8"},
                         Kind{H5T_STD_U32LE, "<u4"}, Kind{H5T_STD_U8LE, "|u1"}};
  const auto found = std::ranges::find_if(kinds, [&](const Kind& kind) { return H5Tequal(type.get(), kind.type) > 0; });
  return found == kinds.end() ? std::string_view() : found->name;
}

struct Values {
  std::string_view kind;  // empty: texts
  std::vector<std::size_t> extents;
  std::vector<std::uint8_t> bytes;
  std::vector<std::string> texts;
};

// `what`: name in messages. `texts` and `read` return the stored values.
Values values_of(const Place& place, const std::string& what, const Handle& type, std::vector<std::size_t> extents,
                 std::uint64_t compression, const std::function<std::vector<std::string>()>& texts,
                 const std::function<herr_t(void*)>& read) {
  Values values{kind_of(type), std::move(extents), {}, {}};
  if (H5Tget_class(type.get()) == H5T_STRING) {
    values.texts = texts();
    return values;
  }
  if (values.kind.empty()) place.fail(what + "has a type that datasets do not have");
  const std::size_t size = H5Tget_size(type.get());
  values.bytes.resize(size * hdf5::count_of(place, values.extents, size, compression));
  if (!values.bytes.empty() && read(values.bytes.data()) < 0) place.fail(what + "cannot be read: " + hdf5::last_error());
  return values;
}

Values array_values(const Place& place, const Handle& array) {
  const Handle type(H5Dget_type(array.get()), &H5Tclose);
  const std::vector<std::size_t> extents = hdf5::array_extents(place, array);
  return values_of(
      place, "", type, extents, hdf5::best_compression, [&] { return hdf5::texts_of(place, array); },
      [&](void* bytes) {
        hdf5::read_values(place, array, type.get(), bytes);
        return herr_t{0};
      });
}

Values attribute_values(const Place& place, const Handle& object, const std::string& name) {
  const hdf5::Attribute attribute = hdf5::open_attribute(place, object, name);
  return values_of(
      place, "attribute " + name + " ", attribute.type, attribute.shape, 1,
      [&] { return hdf5::texts_of(place, attribute, name); },
      [&](void* bytes) { return H5Aread(attribute.handle.get(), attribute.type.get(), bytes); });
}

void add(ContentDigest& digest, const std::string& key, const Values& values) {
  if (values.kind.empty()) {
    digest.add_texts(key, values.extents, values.texts);
  } else {
    digest.add_numbers(key, values.kind, values.extents, values.bytes.data(), values.bytes.size());
  }
}

// Calls visit(place, object, path) for `object`, a group or array that is open at `place`, and all
// objects below it; `path` is relative to `object`.
template <class Visit>
void visit_from(const Place& place, const Handle& object, const std::string& path, const Visit& visit) {
  H5O_info_t info{};  // reads the lists of chunks and members too, as readers do that request all information
  if (H5Oget_info2(object.get(), &info, H5O_INFO_ALL) < 0) place.fail("is damaged: " + hdf5::last_error());
  visit(place, object, path);
  if (H5Iget_type(object.get()) != H5I_GROUP) return;
  if (static_cast<std::size_t>(std::ranges::count(path, '/')) >= hdf5::deepest) place.fail("is nested too deeply");
  for (const std::string& name : hdf5::members_of(place, object)) {
    const Place member = place.below(name);
    visit_from(member, hdf5::open_member(member, object, name), path.empty() ? name : path + "/" + name, visit);
  }
}

template <class Visit>
void visit_all(const Place& place, const std::string& path, const Visit& visit) {
  visit_from(place, hdf5::open_object(place), path, visit);
}

// True if an array has the type and extents with which it was read.
bool is_as_read(const Place& place, const Handle& array, const ArrayView& read) {
  const Handle type(H5Dget_type(array.get()), &H5Tclose);
  return kind_of(type) == numpy_name(read.type) && hdf5::array_extents(place, array) == read.shape;
}

// Adds the entries of an object: an array's values, and all attributes except `except`, which only
// the first object has.
void add_object(ContentDigest& digest, const Place& place, const Handle& object, const std::string& path, const char* except,
                const std::map<std::string, ArrayView>& read = {}) {
  if (H5Iget_type(object.get()) != H5I_GROUP) {
    const auto known = read.find(path);
    if (known != read.end() && is_as_read(place, object, known->second)) {
      const ArrayView& view = known->second;
      digest.add_numbers(path, numpy_name(view.type), view.shape, view.bytes, view.size_bytes());
    } else {
      add(digest, path, array_values(place, object));
    }
  }
  for (const std::string& name : hdf5::attributes_of(place, object)) {
    if (path.empty() && name == except) continue;
    add(digest, path + "@" + name, attribute_values(place, object, name));
  }
}

}  // namespace

Digest stored_trial_digest(const Place& demo, const std::map<std::string, ArrayView>& read) {
  ContentDigest digest;
  visit_all(demo, "", [&](const Place& place, const Handle& object, const std::string& path) {
    add_object(digest, place, object, path, trial_sha256_name, read);
  });
  return digest.finish();
}

Digest stored_arrays_digest(const Place& demo) {
  std::vector<std::string> paths;
  visit_all(demo, "", [&](const Place&, const Handle& object, const std::string& path) {
    if (H5Iget_type(object.get()) != H5I_GROUP) paths.push_back(path);
  });
  std::ranges::sort(paths);
  Sha256 hash;
  for (const std::string& path : paths) {
    const Place place = demo.below(path);
    const Values values = array_values(place, hdf5::open_object(place));
    hash.update(path.c_str(), path.size() + 1);  // with its final zero byte
    hash.update(values.bytes.data(), values.bytes.size());
  }
  return hash.finish();
}

Digest stored_file_digest(const Place& root, const std::vector<std::pair<std::size_t, Digest>>& trials) {
  ContentDigest digest;
  add_object(digest, root, hdf5::open_object(root), "", file_sha256_name);
  for (const std::string& name : hdf5::members_of(root)) {
    const Place place = root.below(name);
    if (name == "data") {
      add_object(digest, place, hdf5::open_object(place), name, "");
      continue;
    }
    visit_all(place, name,
              [&](const Place& at, const Handle& object, const std::string& path) { add_object(digest, at, object, path, ""); });
  }
  for (const auto& [trial, sum] : trials) digest.add_trial(fmt::format("data/demo_{}", trial), sum);
  return digest.finish();
}

void ContentDigest::begin(const std::string& key, std::string_view type, const std::vector<std::size_t>& extents) {
  std::string head = key;
  head.push_back('\0');
  head += type;
  head.push_back('\0');
  head += fmt::format("{}", fmt::join(extents, ","));
  head.push_back('\0');
  hash_.update(head.data(), head.size());
}

const Digest& ContentDigest::add_numbers(const std::string& key, std::string_view type, const std::vector<std::size_t>& extents,
                                         const void* bytes, std::size_t size) {
  begin(key, type, extents);
  hash_.update(bytes, size);
  return entries_[key] = hash_.finish();
}

void ContentDigest::add_texts(const std::string& key, const std::vector<std::size_t>& extents,
                              const std::vector<std::string>& texts) {
  begin(key, "text", extents);
  for (const std::string& text : texts) hash_.update(text.c_str(), text.size() + 1);
  entries_[key] = hash_.finish();
}

Digest ContentDigest::finish() const {
  for (const auto& [key, digest] : entries_) hash_.update(digest.data(), digest.size());
  return hash_.finish();
}

}  // namespace slipbench
