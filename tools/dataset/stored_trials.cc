#include "tools/dataset/stored_trials.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "sim/core/counted.h"
#include "tools/dataset/hdf5/hdf5_place.h"
#include "tools/dataset/record/content_digest.h"
#include "tools/files/reject.h"

namespace slipbench {
namespace {

using hdf5::check;
using hdf5::Handle;
using hdf5::Place;

Digest parse_digest(const Place& place, const std::string& digits) {
  Digest digest{};
  bool good = digits.size() == 2 * digest.size();
  for (std::size_t i = 0; good && i < digest.size(); ++i) {
    const char* const from = digits.data() + 2 * i;
    const auto [end, error] = std::from_chars(from, from + 2, digest[i], 16);
    good = error == std::errc() && end == from + 2;
  }
  if (!good) place.fail("attribute 'sha256' is not a digest");
  return digest;
}

bool is_type(const Handle& type, hid_t known) { return H5Tequal(type.get(), known) > 0; }

EncodedAttribute read_attribute(const Place& place, const Handle& object, const std::string& path, const std::string& name) {
  EncodedAttribute result{path, name, {}};
  const hdf5::Attribute attribute = hdf5::open_attribute(place, object, name);
  const auto numbers = [&](void* to) {
    if (H5Aread(attribute.handle.get(), attribute.type.get(), to) < 0)
      place.fail("attribute '" + name + "' cannot be read: " + hdf5::last_error());
  };
  if (H5Tget_class(attribute.type.get()) == H5T_STRING) {
    std::vector<std::string> texts = hdf5::texts_of(place, attribute, name);
    if (attribute.shape.empty()) {
      result.value = std::move(texts.front());
    } else {
      result.value = std::move(texts);
    }
  } else if (is_type(attribute.type, H5T_STD_U64LE) && attribute.shape.empty()) {
    std::uint64_t value = 0;
    numbers(&value);
    result.value = value;
  } else if (is_type(attribute.type, H5T_IEEE_F64LE) && attribute.shape.empty()) {
    double value = 0.0;
    numbers(&value);
    result.value = value;
  } else if (is_type(attribute.type, H5T_IEEE_F64LE)) {
    EncodedAttribute::Doubles matrix{attribute.shape,
                                     std::vector<double>(hdf5::count_of(place, attribute.shape, sizeof(double), 1))};
    if (!matrix.values.empty()) numbers(matrix.values.data());
    result.value = std::move(matrix);
  } else {
    place.fail("attribute '" + name + "' has a type that trials do not have");
  }
  return result;
}

ElementType element_type(const Place& place, const Handle& array) {
  const Handle type(H5Dget_type(array.get()), &H5Tclose);
  if (is_type(type, H5T_IEEE_F64LE)) return ElementType::f64;
  if (is_type(type, H5T_IEEE_F32LE)) return ElementType::f32;
  if (is_type(type, H5T_STD_U32LE)) return ElementType::u32;
  if (is_type(type, H5T_STD_U8LE)) return ElementType::u8;
  place.fail("has a type that datasets do not have");
}

// Rows per chunk of an array that is stored as the encoder stores it: in chunks of whole rows, with
// its filters; else 0.
std::size_t chunk_rows_of(const Handle& properties, const std::vector<std::size_t>& extents, std::size_t element) {
  std::vector<H5Z_filter_t> wanted{H5Z_FILTER_DEFLATE};
  if (element > 1) wanted.insert(wanted.begin(), H5Z_FILTER_SHUFFLE);
  if (extents.empty() || H5Pget_layout(properties.get()) != H5D_CHUNKED ||
      H5Pget_nfilters(properties.get()) != static_cast<int>(wanted.size()))
    return 0;
  for (unsigned i = 0; i < wanted.size(); ++i) {
    unsigned flags = 0, config = 0;
    std::size_t count = 0;
    if (H5Pget_filter2(properties.get(), i, &flags, &count, nullptr, 0, nullptr, &config) != wanted[i]) return 0;
  }
  std::vector<hsize_t> chunk(extents.size());
  check(H5Pget_chunk(properties.get(), static_cast<int>(chunk.size()), chunk.data()));
  return std::equal(chunk.begin() + 1, chunk.end(), extents.begin() + 1, extents.end()) ? chunk.front() : 0;
}

// Reads the chunk that begins at a row, still compressed. Returns false if it is missing or
// unreadable.
bool read_chunk(const Handle& array, std::size_t rank, std::size_t row, std::vector<std::uint8_t>& to) {
  std::vector<hsize_t> offset(rank, 0);
  offset.front() = row;
  to.clear();
  hsize_t bytes = 0;
  std::uint32_t filters = 0;
  if (H5Dget_chunk_storage_size(array.get(), offset.data(), &bytes) < 0 || bytes > H5Dget_storage_size(array.get())) return false;
  to.resize(bytes);
  return bytes > 0 && H5Dread_chunk(array.get(), H5P_DEFAULT, offset.data(), &filters, to.data()) >= 0 && filters == 0;
}

void read_chunks(const Place& place, const Handle& dataset, const Handle& properties, EncodedArray& array) {
  array.chunk_rows = chunk_rows_of(properties, array.shape, size_of(array.type));
  bool good = array.chunk_rows > 0;
  for (std::size_t row = 0; good && row < array.shape.front(); row += array.chunk_rows)
    good = read_chunk(dataset, array.shape.size(), row, array.chunks.emplace_back());
  if (!good) place.fail("has a chunk that is missing or was not written by slipbench; expected the files of a sweep");
}

EncodedArray read_array(const Place& place, const Handle& dataset, const std::string& path) {
  const Handle properties(H5Dget_create_plist(dataset.get()), &H5Pclose);
  EncodedArray array{
      path, hdf5::text_of(place, dataset, "unit"), {}, element_type(place, dataset), hdf5::array_extents(place, dataset), 0, {}};
  if (H5Aexists(dataset.get(), "codes") > 0) array.codes = hdf5::text_of(place, dataset, "codes");
  if (H5Pget_layout(properties.get()) == H5D_CHUNKED) {
    read_chunks(place, dataset, properties, array);
  } else if (hdf5::count_of(place, array.shape, size_of(array.type), 1) > 0) {
    place.fail("is not stored in chunks; expected the files of a sweep");
  }
  return array;
}

// Reads a demo recursively from `object`, which is open at `place`; `path` is its path inside the
// demo.
void read_from(const Place& place, const Handle& object, const std::string& path, EncodedTrial& trial) {
  if (H5Iget_type(object.get()) == H5I_DATASET) {
    trial.arrays.push_back(read_array(place, object, path));
    return;
  }
  if (static_cast<std::size_t>(std::ranges::count(path, '/')) >= hdf5::deepest) place.fail("is nested too deeply");
  for (const std::string& name : hdf5::attributes_of(place, object)) {
    trial.attributes.push_back(read_attribute(place, object, path, name));
  }
  for (const std::string& name : hdf5::members_of(place, object)) {
    const Place member = place.below(name);
    read_from(member, hdf5::open_member(member, object, name), path.empty() ? name : path + "/" + name, trial);
  }
}

}  // namespace

std::string demo_path(std::size_t trial) { return fmt::format("/data/demo_{}", trial); }

std::size_t trial_number(const Place& list, const std::string& name) {
  constexpr std::string_view prefix = "demo_";
  std::size_t number = 0;
  const char* const end = name.data() + name.size();
  const bool prefixed = name.starts_with(prefix);
  const auto [stop, error] = std::from_chars(name.data() + (prefixed ? prefix.size() : 0), end, number);
  if (!prefixed || error != std::errc() || stop != end) list.fail("holds '" + name + "', which is not demo_<k>");
  return number;
}

std::vector<StoredTrial> stored_trials(const std::string& path) {
  const Handle file = hdf5::open_file(path);
  hdf5::keep_little(file);
  const Place list{file.get(), path, "/data"};
  const Handle list_group = hdf5::open_object(list);
  std::vector<StoredTrial> trials;
  for (const std::string& name : hdf5::members_of(list, list_group)) {
    const Place demo = list.below(name);
    const Handle group = hdf5::open_member(demo, list_group, name);
    const Digest digest = parse_digest(demo, hdf5::text_of(demo, group, trial_sha256_name));
    trials.push_back({trial_number(list, name), {}, digest, path});
  }
  std::ranges::sort(trials, {}, &StoredTrial::number);
  const bool is_batch = H5Lexists(file.get(), batch_groups_name, H5P_DEFAULT) > 0;
  const Place place{file.get(), path, std::string("/") + (is_batch ? batch_groups_name : shard_groups_name)};
  std::vector<std::string> groups = hdf5::texts_of(place, hdf5::open_object(place));
  if (groups.size() != trials.size())
    place.fail(fmt::format("has {} for {}", counted(groups.size(), "text"), counted(trials.size(), "trial")));
  for (std::size_t i = 0; i < trials.size(); ++i) trials[i].group = std::move(groups[i]);
  return trials;
}

EncodedTrial read_encoded(hid_t file, const StoredTrial& stored) {
  const Place demo{file, stored.file, demo_path(stored.number)};
  EncodedTrial trial;
  trial.trial = stored.number;
  trial.material = stored.group;
  trial.digest = stored.digest;
  read_from(demo, hdf5::open_object(demo), "", trial);
  std::ranges::sort(trial.arrays, {}, &EncodedArray::path);
  std::ranges::stable_sort(trial.attributes, {}, &EncodedAttribute::path);
  return trial;
}

}  // namespace slipbench
