#include "tools/dataset/dataset_file.h"

#include <fcntl.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <set>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "sim/core/process/regular_file.h"
#include "tools/dataset/record/content_digest.h"
#include "tools/dataset/stored_trials.h"
#include "tools/files/reject.h"

namespace slipbench {
namespace {

using hdf5::check;
using hdf5::Handle;
using hdf5::write_attribute;

std::string demo_name(std::size_t trial) { return fmt::format("demo_{}", trial); }

[[noreturn]] void fail(const std::string& path, const std::string& reason) { reject("cannot write {}: {}", path, reason); }

// Little-endian type in the file for values that have the same layout in memory.
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

// Groups keep their few members and attributes in the object header, which is small and fast. Time
// stamps are off.
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

// All groups that contain the arrays and attributes of a demo, parents before children, without the
// demo itself.
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

// Creation properties of an array, except the extents of its chunks.
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

// Writes the names of the trials in both `part` and `held` as robomimic does: fixed-length strings.
void write_mask(hid_t group, const char* name, const std::vector<std::size_t>& part, const std::vector<std::size_t>& held) {
  std::vector<std::size_t> members;
  if (!held.empty()) {  // `part` covers the whole dataset, which may be hundreds of files
    std::set_intersection(std::ranges::lower_bound(part, held.front()), std::ranges::upper_bound(part, held.back()), held.begin(),
                          held.end(), std::back_inserter(members));
  }
  std::vector<std::string> names;
  for (const std::size_t trial : members) names.push_back(demo_name(trial));
  hdf5::write_texts(group, name, names);
}

// Writes the group by which each trial is split, in ascending order of trial number.
void write_groups(hid_t file, const char* name, const std::vector<StoredTrial>& trials) {
  std::vector<std::string> groups;
  for (const StoredTrial& trial : trials) groups.push_back(trial.group);
  hdf5::write_texts(file, name, groups);
}

Handle write_masks(hid_t file, const Masks& masks, const std::vector<std::size_t>& held) {
  Handle group = create_group(file, "mask");
  write_attribute(group.get(), "split_by", masks.split_by);
  write_attribute(group.get(), "rule", masks.rule);
  write_mask(group.get(), "train", masks.train, held);
  write_mask(group.get(), "valid", masks.valid, held);
  write_mask(group.get(), "test", masks.test, held);
  return group;
}

void write_demo(hid_t list, const EncodedTrial& trial) {
  Handle demo = create_group(list, demo_name(trial.trial));
  for (const std::string& group : groups_of(trial)) create_group(demo.get(), group).close();
  for (const EncodedArray& array : trial.arrays) write_array(demo.get(), array);
  // `attributes` is sorted by group: each group is opened once.
  Handle group;
  const std::string* group_path = nullptr;
  for (const EncodedAttribute& attribute : trial.attributes) {
    if (group_path == nullptr || *group_path != attribute.path) {
      group_path = &attribute.path;
      group = Handle(H5Gopen2(demo.get(), group_path->empty() ? "." : group_path->c_str(), H5P_DEFAULT), &H5Gclose);
    }
    std::visit([&](const auto& value) { write_attribute(group.get(), attribute.name, value); }, attribute.value);
  }
  group.close();
  demo.close();
}

// Writes file format 1.8, which every HDF5 of the last fifteen years reads. HDF5's file lock is
// off: it would refuse readers of a file that is not renamed yet, and the run has locked its
// folder.
Handle file_access() {
  Handle access(H5Pcreate(H5P_FILE_ACCESS), &H5Pclose);
  check(H5Pset_libver_bounds(access.get(), H5F_LIBVER_V18, H5F_LIBVER_V18));
  check(H5Pset_meta_block_size(access.get(), 1 << 16));
  check(H5Pset_file_locking(access.get(), false, true));
  return access;
}

void write_header(hid_t root, const DatasetHeader& header, std::size_t index) {
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
}

}  // namespace

DatasetFile::DatasetFile(std::string path, const DatasetHeader& header, std::size_t index)
    : path_(std::move(path)),
      descriptor_(::open(path_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666)),
      of_sweep_shard_(header.part.has_value()),
      split_(header.split) {
  if (descriptor_.get() < 0) fail(path_, std::strerror(errno));
  hdf5::initialise();
  write([&] {
    const Handle creation = group_properties(H5P_FILE_CREATE), access = file_access();
    file_ = Handle(H5Fcreate(path_.c_str(), H5F_ACC_TRUNC, creation.get(), access.get()), &H5Fclose);
    write_header(file_.get(), header, index);
    list_ = create_group(file_.get(), "data");
  });
}

DatasetFile::~DatasetFile() {
  if (!finished_) remove();
}

// Frees the disk space now: HDF5 may keep the file open until the process ends.
void DatasetFile::remove() {
  std::error_code ignored;
  std::filesystem::resize_file(path_, 0, ignored);
  std::filesystem::remove(path_, ignored);
}

template <class Action>
void DatasetFile::write(const Action& action) {
  try {
    action();
  } catch (const std::runtime_error& error) {
    list_.abandon();  // closing would repeat the writes that failed
    file_.abandon();
    remove();
    fail(path_, error.what());
  }
}

void DatasetFile::append(const EncodedTrial& trial) {
  write([&] { write_demo(list_.get(), trial); });
  trials_.push_back({trial.trial, trial.material, trial.digest, path_});
  bytes_ += file_bytes(trial);
}

void DatasetFile::pause() {
  write([&] {
    list_.close();
    file_.close();
  });
}

void DatasetFile::write_digest() {
  std::vector<std::pair<std::size_t, Digest>> digests;
  for (const StoredTrial& trial : trials_) digests.emplace_back(trial.number, trial.digest);
  write_attribute(file_.get(), file_sha256_name, hexadecimal(stored_file_digest({file_.get(), path_, "/"}, digests)));
}

void DatasetFile::finish_batch() {
  write([&] {
    write_groups(file_.get(), batch_groups_name, trials_);
    write_digest();
    close();
  });
}

void DatasetFile::finish(const Masks& masks, const std::vector<FailedTrial>& failed, std::size_t files) {
  write([&] {
    if (!file_) file_ = Handle(H5Fopen(path_.c_str(), H5F_ACC_RDWR, file_access().get()), &H5Fclose);
    std::vector<std::size_t> numbers;
    for (const StoredTrial& trial : trials_) numbers.push_back(trial.number);
    Handle mask = write_masks(file_.get(), masks, numbers);
    if (of_sweep_shard_) write_groups(file_.get(), shard_groups_name, trials_);
    if (of_sweep_shard_ && split_)
      write_attribute(mask.get(), split_shares_name, {split_->shares.begin(), split_->shares.end()}, {split_->shares.size()});
    mask.close();
    if (!failed.empty()) write_attribute(file_.get(), "failed", failures_json(failed));
    write_attribute(file_.get(), "shards", static_cast<std::uint64_t>(files));
    write_attribute(file_.get(), "complete", std::uint64_t{1});
    write_digest();
    close();
  });
}

void DatasetFile::close() {
  list_.close();
  file_.close();
  if (!sync_file(descriptor_.get(), true)) throw std::runtime_error(std::strerror(errno));
  finished_ = true;
}

std::uint64_t file_bytes(const EncodedTrial& trial) {
  std::uint64_t bytes = 16384;  // groups, and the unused end of a metadata block
  for (const EncodedArray& array : trial.arrays) {
    bytes += 4096 + 64 * array.chunks.size();
    for (const auto& chunk : array.chunks) bytes += chunk.size();
  }
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

std::uint64_t closing_bytes(std::size_t trials) { return 32768 + 32 * static_cast<std::uint64_t>(trials); }

}  // namespace slipbench
