#include "tools/base/dataset/stored_trials.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "tools/base/dataset/shard.h"
#include "tools/base/files/reject.h"
#include "tools/base/record/content_digest.h"

namespace slipbench {
namespace {

using hdf5::check;
using hdf5::Handle;
using hdf5::Place;

// The attributes of a group in the order in which the encoder writes them, in which they must be written again for the same bytes. A header does
// not keep it: where it grows, HDF5 moves some.
std::vector<std::string> attributes_as_encoded(const Place& place, const Handle& object) {
  static const std::vector<std::string> order = [] {
    std::vector<std::string> names{"num_samples", "seed",       "params", "outcome", "model_sha256", libraries_name, "type",
                                   "detector",    "controller", "sensor", "rate_hz", "frame",        "follows"};
    const SampleTiming timing;
    for_each_timing_attribute(timing, [&](const char* name, double) { names.emplace_back(name); });
    for (const char* name : {"channels", "channel_names", "rule"}) names.emplace_back(name);
    LabelRecord labels;
    for_each_unit_attribute(labels,
                            [&](const char* name, const Extents&, const std::vector<double>&) { names.emplace_back(name); });
    for (const char* name : {"size", "confusion", trial_sha256_name}) names.emplace_back(name);
    return names;
  }();
  std::vector<std::string> names = hdf5::attributes_of(place, object);
  for (const std::string& name : names) {
    if (std::ranges::find(order, name) == order.end()) place.fail("has the attribute '" + name + "', which no trial has");
  }
  std::ranges::sort(names, {}, [&](const std::string& name) { return std::ranges::find(order, name); });
  return names;
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
    place.fail("attribute '" + name + "' is of a type that no trial has");
  }
  return result;
}

ElementType element_type(const Place& place, const Handle& array) {
  const Handle type(H5Dget_type(array.get()), &H5Tclose);
  if (is_type(type, H5T_IEEE_F64LE)) return ElementType::f64;
  if (is_type(type, H5T_IEEE_F32LE)) return ElementType::f32;
  if (is_type(type, H5T_STD_U32LE)) return ElementType::u32;
  if (is_type(type, H5T_STD_U8LE)) return ElementType::u8;
  place.fail("is of a type that no dataset has");
}

void read_chunks(const Place& place, const Handle& dataset, const Handle& properties, EncodedArray& array) {
  array.chunk_rows = hdf5::folded_rows(properties, array.shape, size_of(array.type));
  if (array.chunk_rows == 0) place.fail("is not stored as this program does it; allowed: the files of sweep --shard");
  for (std::size_t row = 0; row < array.shape.front(); row += array.chunk_rows) {
    if (!hdf5::read_chunk(dataset, array.shape.size(), row, array.chunks.emplace_back()))
      place.fail("has a chunk that is missing or not stored as this program does it; allowed: the files of sweep --shard");
  }
}

EncodedArray read_array(const Place& place, const Handle& dataset, const std::string& path) {
  const Handle properties = hdf5::array_properties(place, dataset);
  EncodedArray array{path,
                     hdf5::text_of(place, dataset, "unit"),
                     {},
                     element_type(place, dataset),
                     hdf5::array_extents(place, dataset, properties),
                     0,
                     {}};
  if (H5Aexists(dataset.get(), "codes") > 0) array.codes = hdf5::text_of(place, dataset, "codes");
  if (H5Pget_layout(properties.get()) == H5D_CHUNKED) {
    read_chunks(place, dataset, properties, array);
  } else if (hdf5::count_of(place, array.shape, size_of(array.type), 1) > 0) {
    place.fail("is not stored in chunks; allowed: the files of sweep --shard");
  }
  return array;
}

// All of a demo from `object` on, which is open at `place`; its path inside the demo is `path`.
void read_from(const Place& place, const Handle& object, const std::string& path, EncodedTrial& trial) {
  if (H5Iget_type(object.get()) == H5I_DATASET) {
    trial.arrays.push_back(read_array(place, object, path));
    return;
  }
  if (static_cast<std::size_t>(std::ranges::count(path, '/')) >= hdf5::deepest) place.fail("lies too deep in the file");
  for (const std::string& name : attributes_as_encoded(place, object)) {
    trial.attributes.push_back(read_attribute(place, object, path, name));
  }
  for (const std::string& name : hdf5::members_of(place, object)) {
    const Place member = place.below(name);
    read_from(member, hdf5::open_member(member, object, name), path.empty() ? name : path + "/" + name, trial);
  }
}

Digest digest_of(const Place& place, const std::string& hexadecimal_digits) {
  Digest digest{};
  bool good = hexadecimal_digits.size() == 2 * digest.size();
  for (std::size_t i = 0; good && i < digest.size(); ++i) {
    const char* const from = hexadecimal_digits.data() + 2 * i;
    const auto [end, error] = std::from_chars(from, from + 2, digest[i], 16);
    good = error == std::errc() && end == from + 2;
  }
  if (!good) place.fail("attribute 'sha256' is no digest");
  return digest;
}

// The scene's split, which the shard's masks do not tell.
std::optional<SplitRule> split_of(const Place& mask) {
  const Handle object = hdf5::open_object(mask);
  if (H5Aexists(object.get(), split_shares_name) <= 0) return std::nullopt;
  const EncodedAttribute read = read_attribute(mask, object, "", split_shares_name);
  const auto* shares = std::get_if<EncodedAttribute::Doubles>(&read.value);
  if (shares == nullptr || shares->values.size() != 3) mask.fail("attribute 'shares' is not three numbers");
  return SplitRule{hdf5::text_of(mask, object, "split_by"), {shares->values[0], shares->values[1], shares->values[2]}};
}

}  // namespace

StoredTrials::StoredTrials(std::string path, std::optional<FileAbout> about) : path_(std::move(path)) {
  if (!about) throw InputError(path_ + ": is no dataset");
  if (!about->header.part) {
    throw InputError(path_ + ": is no shard of a sweep; allowed: files of sweep --shard k/n");
  }
  if (about->shard != 0) reject("{}: is file {} of a shard; allowed: the first with it", path_, about->shard);
  if (!about->complete) {
    throw InputError(path_ +
                     ": its run did not come to its end; allowed: the whole shard, which its command with --resume gives");
  }
  about_ = std::move(*about);
  open(0);
  about_.header.split = split_of(place("/mask"));
}

std::vector<std::string> StoredTrials::files() const {
  std::vector<std::string> paths;
  for (std::size_t k = 0; k < *about_.shards; ++k) paths.push_back(shard_path(path_, k));
  return paths;
}

void StoredTrials::open(std::size_t file) {
  index_ = file;
  name_ = shard_path(path_, file);
  if (file > 0) {
    const std::optional<FileAbout> about = file_about(name_);
    if (!about || !same_dataset(about->header, about_.header) || about->shard != file || about->shards != about_.shards) {
      reject("{}: is not file {} of {}", name_, file, path_);
    }
  }
  file_ = hdf5::open_file(name_);
  hdf5::keep_little(file_);
  const Place root = place("/");
  content_sha256_ = hdf5::text_of(root, hdf5::open_object(root), file_sha256_name);
  const Place list = place("/data");
  std::vector<std::size_t> numbers;
  for (const std::string& name : hdf5::members_of(list)) numbers.push_back(trial_number(list, name));
  std::ranges::sort(numbers);
  const Place group_place = place("/mask/group");
  std::vector<std::string> groups = hdf5::texts_of(group_place, hdf5::open_object(group_place));
  if (groups.size() != numbers.size()) group_place.fail(fmt::format("has {} texts for {} trials", groups.size(), numbers.size()));
  trials_.clear();
  for (std::size_t i = 0; i < numbers.size(); ++i) trials_.emplace_back(numbers[i], std::move(groups[i]));
  digests_.clear();
  next_ = 0;
}

std::vector<std::pair<std::size_t, std::string>> StoredTrials::list() {
  std::vector<std::pair<std::size_t, std::string>> all;
  for (std::size_t file = 0; file < *about_.shards; ++file) {
    if (file != index_) open(file);
    if (!all.empty() && !trials_.empty() && trials_.front().first <= all.back().first) {
      reject("{}: holds trial {} after trial {} of the file before", name_, trials_.front().first, all.back().first);
    }
    all.insert(all.end(), trials_.begin(), trials_.end());
  }
  if (index_ != 0) open(0);
  return all;
}

std::optional<std::size_t> StoredTrials::trial() {
  if (next_ == trials_.size()) return std::nullopt;
  return trials_[next_].first;
}

std::string StoredTrials::sha256() {
  const Place demo = place(fmt::format("/data/demo_{}", trials_[next_].first));
  return hdf5::text_of(demo, hdf5::open_object(demo), trial_sha256_name);
}

std::size_t trial_number(const Place& list, const std::string& name) {
  constexpr std::string_view prefix = "demo_";
  std::size_t number = 0;
  const char* const end = name.data() + name.size();
  const bool prefixed = name.starts_with(prefix);
  const auto [stop, error] = std::from_chars(name.data() + (prefixed ? prefix.size() : 0), end, number);
  if (!prefixed || error != std::errc() || stop != end) list.fail("holds '" + name + "', which is no demo_<k>");
  return number;
}

EncodedTrial read_encoded(const Place& demo, std::size_t number) {
  EncodedTrial trial;
  trial.trial = number;
  read_from(demo, hdf5::open_object(demo), "", trial);
  std::ranges::sort(trial.arrays, {}, &EncodedArray::path);
  std::ranges::stable_sort(trial.attributes, {}, &EncodedAttribute::path);
  // The digest stands last.
  const auto digest = std::ranges::find_if(trial.attributes, [](const EncodedAttribute& attribute) {
    return attribute.path.empty() && attribute.name == trial_sha256_name;
  });
  if (digest == trial.attributes.end()) demo.fail("has no attribute 'sha256'");
  std::rotate(digest, digest + 1, trial.attributes.end());
  const auto* digits = std::get_if<std::string>(&trial.attributes.back().value);
  trial.digest = digest_of(demo, digits != nullptr ? *digits : "");
  return trial;
}

EncodedTrial StoredTrials::read() {
  const auto& [number, material] = trials_[next_];
  EncodedTrial trial = read_encoded(place(fmt::format("/data/demo_{}", number)), number);
  trial.material = material;
  return trial;
}

void StoredTrials::advance() {
  const Place demo = place(fmt::format("/data/demo_{}", trials_[next_].first));
  digests_.emplace_back(trials_[next_].first, digest_of(demo, sha256()));
  if (++next_ < trials_.size()) return;
  if (hexadecimal(stored_file_digest(place("/"), digests_)) != content_sha256_) {
    throw InputError(name_ + ": is damaged: content_sha256 is not that of what it holds; slipbench verify says more");
  }
  if (index_ + 1 < *about_.shards) open(index_ + 1);
}

}  // namespace slipbench
