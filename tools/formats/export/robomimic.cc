#include "tools/formats/export/formats.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <iterator>

#include <unistd.h>

#include <fmt/format.h>

#include "sim/core/process/check_readable.h"
#include "sim/core/process/interrupted.h"
#include "sim/core/process/regular_file.h"
#include "tools/dataset/hdf5/hdf5_place.h"
#include "tools/dataset/record/codes.h"
#include "tools/dataset/record/encoder.h"
#include "tools/dataset/record/json.h"
#include "tools/files/output_file.h"
#include "tools/files/reject.h"

namespace slipbench {
namespace {

using hdf5::check;
using hdf5::Handle;
using hdf5::write_attribute;

constexpr const char* mark = "exported_by";  // root attribute that identifies such a file
constexpr const char* mark_text = "slipbench robomimic";

constexpr unsigned deflate_level = 4;

// robomimic's number for gym environments, the closest type for a recording that no environment can
// continue.
constexpr int gym_environment = 2;

Handle make_group(hid_t parent, const std::string& name) {
  const Handle properties = hdf5::untimed(H5P_GROUP_CREATE);
  return {H5Gcreate2(parent, name.c_str(), H5P_DEFAULT, properties.get(), H5P_DEFAULT), &H5Gclose};
}

// Writes one array, with the same type in file and memory. `level`: of deflate, in one chunk; 0:
// uncompressed. `codes`: JSON, meaning of its codes; empty: quantities.
void put(hid_t group, const std::string& name, hid_t type, const std::vector<std::size_t>& shape, const void* values,
         unsigned level, const std::string& codes = {}) {
  const bool empty = std::find(shape.begin(), shape.end(), 0) != shape.end();
  const Handle properties = hdf5::untimed(H5P_DATASET_CREATE);
  if (level > 0 && !empty) {
    const std::vector<hsize_t> chunk(shape.begin(), shape.end());
    check(H5Pset_chunk(properties.get(), static_cast<int>(chunk.size()), chunk.data()));
    check(H5Pset_shuffle(properties.get()));
    check(H5Pset_deflate(properties.get(), level));
  }
  const Handle space = hdf5::space_of(shape);
  Handle array(H5Dcreate2(group, name.c_str(), type, space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT), &H5Dclose);
  if (!empty) check(H5Dwrite(array.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values));
  if (!codes.empty()) write_attribute(array.get(), "codes", codes);
  array.close();
}

std::string demo_of(std::size_t trial) { return fmt::format("demo_{}", trial); }

void put_demo(hid_t data, const DatasetReader& reader, std::size_t trial, const Episode& episode, unsigned level) {
  Handle demo = make_group(data, demo_of(trial));
  const std::size_t steps = episode.steps;
  const DemoInfo info = reader.info(trial);
  // Signed, as in robomimic's own files: it subtracts counts, and numpy before 2 turns differences
  // of unsigned ones into floats.
  write_attribute(demo.get(), "num_samples", static_cast<std::int64_t>(steps));
  write_attribute(demo.get(), "seed", info.seed);
  write_attribute(demo.get(), "params", info.params);
  write_attribute(demo.get(), "outcome", info.outcome);
  Handle observed = make_group(demo.get(), "obs");
  Handle following = make_group(demo.get(), "next_obs");
  for (const Episode::Column& column : episode.observations) {
    put(observed.get(), column.name, H5T_IEEE_F32LE, {steps, column.width}, column.values.data(), level);
    put(following.get(), column.name, H5T_IEEE_F32LE, {steps, column.width}, column.values.data() + column.width, level);
  }
  observed.close();
  following.close();
  put(demo.get(), "actions", H5T_IEEE_F32LE, {steps, episode.actions.width}, episode.actions.values.data(), level);
  put(demo.get(), "states", H5T_IEEE_F32LE, {steps, episode.bodies.width}, episode.bodies.values.data(), level);
  put(demo.get(), "rewards", H5T_IEEE_F32LE, {steps}, episode.rewards.data(), level);
  std::vector<float> dones(episode.steps, 0.0F);
  dones.back() = 1.0F;
  put(demo.get(), "dones", H5T_IEEE_F32LE, {steps}, dones.data(), level);
  for (const Episode::Column& column : episode.states)
    put(demo.get(), column.name, H5T_IEEE_F32LE, {steps}, column.values.data(), level, std::string(codes_of("state")));
  demo.close();
}

void put_masks(hid_t file, const DatasetReader& reader, const std::vector<std::size_t>& trials) {
  Handle masks = make_group(file, "mask");
  for (const char* part : {"train", "valid", "test"}) {
    std::vector<std::size_t> members = reader.mask(part);
    std::sort(members.begin(), members.end());
    std::vector<std::size_t> held;
    std::set_intersection(members.begin(), members.end(), trials.begin(), trials.end(), std::back_inserter(held));
    std::vector<std::string> names;
    for (const std::size_t trial : held) names.push_back(demo_of(trial));
    hdf5::write_texts(masks.get(), part, names);
  }
  masks.close();
}

std::string environment_of(const DatasetHeader& header) {
  return Json{{"env_name", "slipbench"},
              {"type", gym_environment},
              {"env_kwargs",
               {{"scene", header.scene},
                {"overrides", header.overrides},
                {"seed", header.seed},
                {"command", header.command},
                {"version", header.version}}}}
      .dump();
}

void put_all(hid_t file, const DatasetReader& reader, const std::vector<std::size_t>& trials, const RobomimicOptions& options) {
  write_attribute(file, mark, std::string(mark_text));
  check(H5Fflush(file, H5F_SCOPE_LOCAL));  // identifies the file even if the run is killed
  const double rate = options.rate ? *options.rate : slowest_rate(reader, trials.front(), options.sensors);
  const ActionSpace space = action_space(reader, trials);
  Handle data = make_group(file, "data");
  std::uint64_t total = 0;
  std::size_t done = 0;
  for (const std::size_t trial : trials) {
    Episode episode = make_episode(reader, trial, options.sensors, rate, space);
    if (options.rule) std::erase_if(episode.states, [&](const Episode::Column& column) { return column.rule != *options.rule; });
    put_demo(data.get(), reader, trial, episode, options.compress ? deflate_level : 0);
    total += episode.steps;
    hsize_t size = 0;
    check(H5Fget_filesize(file, &size));
    if (options.progress) options.progress(++done, size);
  }
  write_attribute(data.get(), "total", static_cast<std::int64_t>(total));
  write_attribute(data.get(), "env_args", environment_of(reader.header()));
  write_attribute(data.get(), "rate_hz", rate);
  write_attribute(data.get(), "action_names", space.names);
  write_attribute(data.get(), "action_scale", space.scale, {space.scale.size()});
  write_attribute(data.get(), "action_offset", space.offset, {space.offset.size()});
  data.close();
  put_masks(file, reader, trials);
}

// File format 1.8, as for datasets. HDF5 would lock the file only after truncating it, so the
// caller locks it.
Handle make_file(const std::string& path) {
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), &H5Pclose);
  check(H5Pset_libver_bounds(access.get(), H5F_LIBVER_V18, H5F_LIBVER_V18));
  check(H5Pset_file_locking(access.get(), false, true));
  const Handle creation = hdf5::untimed(H5P_FILE_CREATE);
  return {H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation.get(), access.get()), &H5Fclose};
}

// Content of an existing non-empty file.
enum class Found {
  own,      // such an export
  damaged,  // unreadable HDF5, as a killed export leaves it
  other,
};

bool has_mark(const std::string& path) {
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), &H5Pclose);
  check(H5Pset_file_locking(access.get(), false, true));
  const hid_t id = H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.get());
  if (id < 0) throw InputError(path + ": cannot be opened");
  const Handle file(id, &H5Fclose);
  return H5Aexists(file.get(), mark) > 0;
}

Found found_at(const std::string& path) {
  if (H5Fis_hdf5(path.c_str()) <= 0) return Found::other;
  try {
    check_readable(FileKind::dataset_file, path);
    return has_mark(path) ? Found::own : Found::other;
  } catch (const NotChecked&) {
    throw;
  } catch (const InputError&) {
    return Found::damaged;
  }
}

}  // namespace

void check_robomimic_target(const std::string& path, const std::vector<std::string>& inputs) {
  hdf5::initialise();
  const TextKind any{"robomimic dataset", [](std::string_view) { return true; }};
  check_text_target(path, inputs, any);
  for (const std::string& name : {path, temporary_path(path)}) {
    std::error_code none;
    const auto size = std::filesystem::file_size(name, none);
    if (none || size == 0) continue;
    const Found found = found_at(name);
    // A killed export leaves the temporary name, which the next run replaces.
    if (found == Found::own || (found == Found::damaged && name != path)) continue;
    reject("cannot write {}: {} exists and is not a {}; choose a new name, or a {} to replace", path, name, any.name, any.name);
  }
}

void write_robomimic(const DatasetReader& reader, const std::vector<std::size_t>& trials, const std::string& path,
                     const RobomimicOptions& options) {
  const std::string temporary = temporary_path(path);
  // From here on this run owns the file and may replace or remove it.
  const Descriptor own = lock_file(temporary);
  Handle file;
  try {
    file = make_file(temporary);
    put_all(file.get(), reader, trials, options);
    file.close();
    if (!sync_file(own.get()) || std::rename(temporary.c_str(), path.c_str()) != 0)
      throw std::runtime_error(std::strerror(errno));
  } catch (const std::runtime_error& error) {
    file.abandon();
    ::unlink(temporary.c_str());
    if (dynamic_cast<const InputError*>(&error) != nullptr || dynamic_cast<const Interrupted*>(&error) != nullptr) throw;
    reject("cannot write {}: {}", path, error.what());
  }
}

}  // namespace slipbench
