#include "tools/formats/export/formats.h"

#include <algorithm>
#include <memory>
#include <new>
#include <span>
#include <stdexcept>

#include <archive.h>
#include <archive_entry.h>
#include <fmt/format.h>

#include "tools/dataset/record/encoder.h"

namespace slipbench {
namespace {

constexpr std::string_view first_member = "about.npy";

// A zip archive in memory. Its members carry the format's earliest time instead of the
// current one.
class ZipArchive {
 public:
  ZipArchive() : archive_(archive_write_new(), &archive_write_free) {
    check(archive_write_set_format_zip(archive_.get()));
    check(archive_write_zip_set_compression_deflate(archive_.get()));
    check(archive_write_set_bytes_in_last_block(archive_.get(), 1));  // no padding
    check(archive_write_open2(archive_.get(), &bytes_, nullptr, &append, nullptr, nullptr));
  }

  void add(const std::string& name, std::string_view head, std::span<const std::uint8_t> body) {
    const std::unique_ptr<archive_entry, decltype(&archive_entry_free)> entry(archive_entry_new(), &archive_entry_free);
    archive_entry_set_pathname(entry.get(), name.c_str());
    archive_entry_set_filetype(entry.get(), AE_IFREG);
    archive_entry_set_perm(entry.get(), 0644);
    archive_entry_set_size(entry.get(), static_cast<la_int64_t>(head.size() + body.size()));
    check(archive_write_header(archive_.get(), entry.get()));
    write(head.data(), head.size());
    write(body.data(), body.size());
  }

  std::string finish() {
    check(archive_write_close(archive_.get()));
    return std::move(bytes_);
  }

 private:
  static la_ssize_t append(archive*, void* bytes, const void* data, std::size_t size) {
    static_cast<std::string*>(bytes)->append(static_cast<const char*>(data), size);
    return static_cast<la_ssize_t>(size);
  }
  void check(int status) const {
    if (status == ARCHIVE_FATAL) throw std::bad_alloc();  // the only possible failure, since it writes to memory
    if (status != ARCHIVE_OK) throw std::runtime_error(fmt::format("libarchive: {}", archive_error_string(archive_.get())));
  }
  void write(const void* data, std::size_t size) {
    if (size > 0 && archive_write_data(archive_.get(), data, size) != static_cast<la_ssize_t>(size)) check(ARCHIVE_FATAL);
  }

  std::string bytes_;  // outlives the archive, which appends to it until it is freed
  std::unique_ptr<archive, decltype(&archive_write_free)> archive_;
};

std::span<const std::uint8_t> bytes_of(const std::vector<double>& values) {
  return {reinterpret_cast<const std::uint8_t*>(values.data()), values.size() * sizeof(double)};
}

}  // namespace

std::string npy_header(std::string_view descr, const std::vector<std::size_t>& shape) {
  std::string extents;
  for (const std::size_t extent : shape) extents += fmt::format("{},", extent);
  std::string text = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}), }}", descr, extents);
  constexpr std::size_t before = 10;  // magic, version, length of the text
  constexpr std::size_t alignment = 64;
  const std::size_t size = (before + text.size() + 1 + alignment - 1) / alignment * alignment - before;
  text.resize(size - 1, ' ');
  text += '\n';
  std::string header("\x93NUMPY\x01\x00", 8);
  header += static_cast<char>(size & 0xff);
  header += static_cast<char>(size >> 8);
  return header + text;
}

std::string archive_path(const TrialRecord& record, const std::string& path) {
  constexpr std::string_view end = "/state_paper";
  const bool simulated = std::ranges::all_of(record.sensors, [](const SensorRecord& sensor) { return sensor.labels.truth; });
  return simulated || !path.ends_with(end) ? path : path.substr(0, path.size() - end.size()) + "/state_recorded";
}

std::string npz(const TrialRecord& record, const std::string& about) {
  ZipArchive archive;
  archive.add(std::string(first_member), npy_header(fmt::format("|S{}", about.size()), {}),
              {reinterpret_cast<const std::uint8_t*>(about.data()), about.size()});
  for (const ArrayView& array : arrays_of(record)) {
    archive.add(archive_path(record, array.path) + ".npy", npy_header(numpy_name(array.type), array.shape),
                {array.bytes, array.size_bytes()});
  }
  for (const SensorRecord& sensor : record.sensors) {
    for_each_unit_attribute(
        sensor.labels, [&](const char* name, const char*, const Extents& tail, const std::vector<double>& values) {
          Extents shape{sensor.labels.units()};
          shape.insert(shape.end(), tail.begin(), tail.end());
          archive.add(fmt::format("{}/{}.npy", label_group(sensor.name), name), npy_header("<f8", shape), bytes_of(values));
        });
  }
  return archive.finish();
}

bool begins_as_npz(std::string_view text) {
  constexpr std::size_t name_at = 30;  // offset in the local file header
  return text.starts_with("PK\x03\x04") && text.size() > name_at && text.substr(name_at).starts_with(first_member);
}

}  // namespace slipbench
