#include "tools/base/dataset/shard.h"

#include <algorithm>
#include <functional>
#include <set>

#include <unistd.h>

#include <fmt/format.h>

#include "tools/base/files/reject.h"
#include "tools/base/hdf5/hdf5_place.h"
#include "tools/base/record/content_digest.h"

namespace slipbench {
namespace {

using hdf5::check;
using hdf5::Handle;
using hdf5::write_attribute;

std::string demo_name(std::size_t trial) { return fmt::format("demo_{}", trial); }

[[noreturn]] void fail(const std::string& path, const std::string& reason) { reject("cannot write {}: {}", path, reason); }

// Little-endian type in the file for values that lie in memory as they are stored.
hid_t file_type(ElementType type) {
  switch (type) {
    case ElementType::f64: return H5T_IEEE_F64LE;
    case ElementType::f32: return H5T_IEEE_F32LE;
    case ElementType::u32: return H5T_STD_U32LE;
    case ElementType::u8: return H5T_STD_U8LE;
  }
  return H5I_INVALID_HID;
}

void write_attribute(hid_t object, const std::string& name, const EncodedAttribute::Doubles& matrix) {
  write_attribute(object, name, matrix.values, matrix.shape);
}

// Groups keep their few members and attributes in the object header, which is small and quick; no time stamps.
Handle group_properties(hid_t kind) {
  Handle properties = hdf5::untimed(kind);
  check(H5Pset_link_phase_change(properties.get(), 32, 28));
  check(H5Pset_attr_phase_change(properties.get(), 32, 28));
  return properties;
}

Handle create_group(hid_t parent, const std::string& path) {
  static const Handle properties = group_properties(H5P_GROUP_CREATE);
  return {H5Gcreate2(parent, path.c_str(), H5P_DEFAULT, properties.get(), H5P_DEFAULT), &H5Gclose};
}

// The group of the demos keeps its list in its header, which is allocated whole: one block, as CrashSafeFile needs it.
Handle create_demo_list(hid_t file, std::size_t planned, std::size_t last) {
  const auto name_length = static_cast<unsigned>(demo_name(last).size());
  const auto entries = static_cast<unsigned>(std::clamp<std::size_t>(planned, 32, most_trials_per_file));
  const Handle properties = group_properties(H5P_GROUP_CREATE);
  check(H5Pset_link_phase_change(properties.get(), entries, entries));
  check(H5Pset_est_link_info(properties.get(), entries, name_length));
  return {H5Gcreate2(file, "data", H5P_DEFAULT, properties.get(), H5P_DEFAULT), &H5Gclose};
}

// All groups that the arrays and attributes of a demo lie in, parents before children, without the demo itself.
std::set<std::string> groups_of(const EncodedTrial& trial) {
  std::set<std::string> groups;
  const auto add_parents = [&](const std::string& path) {
    for (std::size_t slash = path.find('/'); slash != std::string::npos; slash = path.find('/', slash + 1)) {
      groups.insert(path.substr(0, slash));
    }
  };
  for (const EncodedArray& array : trial.arrays) add_parents(array.path);
  for (const EncodedAttribute& attribute : trial.attributes) add_parents(attribute.path + "/");
  groups.erase("");
  return groups;
}

enum class Storage : std::uint8_t { whole, deflated, shuffled };

// Of an array, but for the extents of its chunks.
Handle array_properties(Storage storage) {
  Handle properties = hdf5::untimed(H5P_DATASET_CREATE);
  check(H5Pset_fill_time(properties.get(), H5D_FILL_TIME_NEVER));
  if (storage == Storage::shuffled) check(H5Pset_shuffle(properties.get()));
  if (storage != Storage::whole) check(H5Pset_deflate(properties.get(), TrialEncoder::deflate_level));
  return properties;
}

void write_array(hid_t demo, const EncodedArray& array) {
  static const Handle whole = array_properties(Storage::whole);
  static const Handle deflated = array_properties(Storage::deflated);
  static const Handle shuffled = array_properties(Storage::shuffled);
  const Handle space = hdf5::space_of(array.shape);
  const Handle& properties = array.chunk_rows == 0 ? whole : size_of(array.type) > 1 ? shuffled : deflated;
  if (array.chunk_rows > 0) {
    std::vector<hsize_t> chunk(array.shape.begin(), array.shape.end());
    chunk[0] = array.chunk_rows;
    check(H5Pset_chunk(properties.get(), static_cast<int>(chunk.size()), chunk.data()));
  }
  Handle dataset(
      H5Dcreate2(demo, array.path.c_str(), file_type(array.type), space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
      &H5Dclose);
  std::vector<hsize_t> offset(array.shape.size(), 0);
  for (const auto& chunk : array.chunks) {
    check(H5Dwrite_chunk(dataset.get(), H5P_DEFAULT, 0, offset.data(), chunk.size(), chunk.data()));
    offset[0] += array.chunk_rows;
  }
  write_attribute(dataset.get(), "unit", array.unit);
  if (!array.codes.empty()) write_attribute(dataset.get(), "codes", array.codes);
  dataset.close();
}

// HDF5 puts texts into heaps, and goes on with one that has room left for as long as it holds it in memory. While `insert` makes
// an object it has no room in memory and must let go of all that is there, so that what follows does not rewrite the heap of a
// demo.
// `kept`: bytes of what `insert` looks at first of all and that is to stay; with 2,000 names the demos' list takes longer to be read again than a
// demo to be written. A heap has 4096 bytes or more.
void forget_heaps(hid_t file, std::size_t kept, const std::function<void()>& insert) {
  H5AC_cache_config_t usual{};
  usual.version = H5AC__CURR_CACHE_CONFIG_VERSION;
  check(H5Fget_mdc_config(file, &usual));
  H5AC_cache_config_t least = usual;
  least.set_initial_size = true;
  least.initial_size = least.min_size = least.max_size = 1024 + kept;
  check(H5Fset_mdc_config(file, &least));
  insert();
  usual.set_initial_size = true;
  check(H5Fset_mdc_config(file, &usual));
}

// Names of the trials that are both in `part` and in `held`, as robomimic writes them: fixed-length strings.
void write_mask(hid_t group, const char* name, const std::vector<std::size_t>& part, const std::vector<std::size_t>& held) {
  std::vector<std::size_t> members;
  if (!held.empty()) {  // `part` is that of the whole dataset, which may be hundreds of files
    std::set_intersection(std::ranges::lower_bound(part, held.front()), std::ranges::upper_bound(part, held.back()), held.begin(),
                          held.end(), std::back_inserter(members));
  }
  std::vector<std::string> names;
  for (const std::size_t trial : members) names.push_back(demo_name(trial));
  hdf5::write_texts(group, name, names);
}

Handle write_masks(hid_t file, const Masks& masks, const std::vector<std::size_t>& held) {
  Handle group;
  forget_heaps(file, 0, [&] { group = create_group(file, "mask"); });
  write_attribute(group.get(), "split_by", masks.split_by);
  write_attribute(group.get(), "rule", masks.rule);
  write_mask(group.get(), "train", masks.train, held);
  write_mask(group.get(), "valid", masks.valid, held);
  write_mask(group.get(), "test", masks.test, held);
  return group;
}

// The root's header takes in one block what the constructor of Shard gives it, as CrashSafeFile needs it. No other creation
// property: any would add an object that carries the time of day.
Handle file_properties(bool of_shard) {
  const unsigned entries = of_shard ? 24 : 16;
  constexpr unsigned name_length = 32;
  Handle properties = group_properties(H5P_FILE_CREATE);
  check(H5Pset_est_link_info(properties.get(), entries, name_length));
  return properties;
}

void write_demo(hid_t file, hid_t list, std::size_t list_bytes, const EncodedTrial& trial) {
  Handle demo;
  forget_heaps(file, list_bytes, [&] { demo = create_group(list, demo_name(trial.trial)); });
  for (const std::string& group : groups_of(trial)) create_group(demo.get(), group).close();
  for (const EncodedArray& array : trial.arrays) write_array(demo.get(), array);
  // Attributes of one group stand together.
  Handle group;
  const std::string* of = nullptr;
  for (const EncodedAttribute& attribute : trial.attributes) {
    if (of == nullptr || *of != attribute.path) {
      of = &attribute.path;
      group = Handle(H5Gopen2(demo.get(), of->empty() ? "." : of->c_str(), H5P_DEFAULT), &H5Gclose);
    }
    std::visit([&](const auto& value) { write_attribute(group.get(), attribute.name, value); }, attribute.value);
  }
  group.close();
  demo.close();
}

}  // namespace

Shard::Shard(std::string temporary, const DatasetHeader& header, std::size_t index, std::size_t planned, std::size_t last)
    : path_(std::move(temporary)), descriptor_(lock_file(path_)), of_shard_(header.part.has_value()), split_(header.split) {
  hdf5::initialise();
  try {
    write([&] {
      file_ = hdf5::CrashSafeFile(descriptor_.get(), file_properties(of_shard_).get());
      const hid_t root = file_.get();
      write_attribute(root, "schema", dataset_schema);
      write_attribute(root, "version", header.version);
      write_attribute(root, "scene", header.scene);
      write_attribute(root, "overrides", header.overrides);
      write_attribute(root, "seed", header.seed);
      write_attribute(root, "command", header.command);
      if (!header.truth.empty()) write_attribute(root, "truth", header.truth);
      if (!header.files.empty()) write_attribute(root, "files", files_json(header.files));
      if (header.part) {
        write_attribute(root, "sweep_shard", shard_text(*header.part));
        write_attribute(root, "sweep_trials", static_cast<std::uint64_t>(header.part->trials));
      }
      write_attribute(root, "shard", static_cast<std::uint64_t>(index));
      list_ = create_demo_list(root, planned, last);
      H5O_info_t info;
      check(H5Oget_info2(list_.get(), &info, H5O_INFO_HDR));
      list_bytes_ = info.hdr.space.total;
      file_.begin("data");
    });
  } catch (const InputError&) {
    list_.abandon();
    file_.abandon();
    ::unlink(path_.c_str());
    throw;
  }
}

Shard::~Shard() {
  if (!failed_) return;
  list_.abandon();
  file_.abandon();
}

template <class Action>
void Shard::write(const Action& action) {
  try {
    action();
  } catch (const std::runtime_error& error) {
    failed_ = true;
    fail(path_, error.what());
  }
}

void Shard::append(const EncodedTrial& trial) {
  write([&] {
    write_demo(file_.get(), list_.get(), list_bytes_, trial);
    file_.flush();
  });
  trials_.push_back(trial.trial);
  if (of_shard_) groups_.push_back(trial.material);
  digests_.push_back(trial.digest);
}

void Shard::publish() {
  if (published_ == trials_.size()) return;
  write([&] { file_.publish(); });
  published_ = trials_.size();
}

void Shard::park() {
  publish();
  write([&] {
    list_.close();
    file_.park();
  });
  parked_ = true;
}

std::uint64_t Shard::size_bytes() const { return file_.size_bytes(); }

void Shard::prepare(const Masks& masks, const std::vector<FailedTrial>& failed, std::size_t shards, bool complete) {
  publish();
  write([&] {
    if (parked_) file_.reopen();
    Handle mask = write_masks(file_.get(), masks, trials_);
    if (of_shard_) hdf5::write_texts(mask.get(), split_groups_name, groups_);  // what merging splits the whole sweep by
    if (of_shard_ && split_)
      write_attribute(mask.get(), split_shares_name, {split_->shares.begin(), split_->shares.end()}, {split_->shares.size()});
    mask.close();
    if (!failed.empty()) write_attribute(file_.get(), "failed", failures_json(failed));
    write_attribute(file_.get(), "shards", static_cast<std::uint64_t>(shards));
    write_attribute(file_.get(), "complete", static_cast<std::uint64_t>(complete));
    std::vector<std::pair<std::size_t, Digest>> digests;
    for (std::size_t i = 0; i < trials_.size(); ++i) digests.emplace_back(trials_[i], digests_[i]);
    write_attribute(file_.get(), file_sha256_name, hexadecimal(stored_file_digest({file_.get(), path_, "/"}, digests)));
    list_.close();
    file_.flush();
    file_.sync();
  });
  prepared_ = true;
}

void Shard::close() {
  write([&] { file_.close(); });
}

std::uint64_t overhead_bytes(const EncodedTrial& trial) {
  std::uint64_t bytes = 16384;  // groups, and the free rest of a metadata block
  for (const EncodedArray& array : trial.arrays) bytes += 4096 + 64 * array.chunks.size();
  for (const EncodedAttribute& attribute : trial.attributes) {
    bytes += 256;
    if (const auto* text = std::get_if<std::string>(&attribute.value)) bytes += text->size();
    if (const auto* texts = std::get_if<std::vector<std::string>>(&attribute.value)) {
      for (const std::string& text : *texts) bytes += text.size() + 64;
    }
    if (const auto* matrix = std::get_if<EncodedAttribute::Doubles>(&attribute.value)) bytes += 8 * matrix->values.size();
  }
  return bytes;
}

}  // namespace slipbench
