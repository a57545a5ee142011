#include "tools/base/hdf5/crash_safe_file.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <span>
#include <stdexcept>
#include <string_view>
#include <vector>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "sim/core/process/regular_file.h"

namespace slipbench::hdf5 {
namespace {

constexpr std::size_t root_field = 36;      // of a superblock: the address of the root's header
constexpr std::size_t end_field = 28;       // where the file ends
constexpr std::size_t superblock_sum = 44;  // its checksum

[[noreturn]] void fail() { throw std::runtime_error(std::strerror(errno)); }

void put(std::uint8_t* to, std::uint64_t value, std::size_t bytes) {
  for (std::size_t i = 0; i < bytes; ++i) to[i] = static_cast<std::uint8_t>(value >> (8 * i));
}

// Checksum of all metadata: Jenkins' lookup3 (hashlittle, 2006), begun with 0.
std::uint32_t checksum(std::span<const std::uint8_t> bytes) {
  const auto turned = [](std::uint32_t value, int by) { return (value << by) | (value >> (32 - by)); };
  std::uint32_t a = 0xdeadbeef + static_cast<std::uint32_t>(bytes.size());
  std::uint32_t b = a;
  std::uint32_t c = a;
  if (bytes.empty()) return c;
  while (true) {
    std::array<std::uint8_t, 12> block{};
    std::copy_n(bytes.begin(), std::min(block.size(), bytes.size()), block.begin());
    std::array<std::uint32_t, 3> words{};
    for (std::size_t i = 0; i < block.size(); ++i) words[i / 4] |= std::uint32_t{block[i]} << (8 * (i % 4));
    a += words[0];
    b += words[1];
    c += words[2];
    if (bytes.size() <= block.size()) break;
    bytes = bytes.subspan(block.size());
    a -= c, a ^= turned(c, 4), c += b;
    b -= a, b ^= turned(a, 6), a += c;
    c -= b, c ^= turned(b, 8), b += a;
    a -= c, a ^= turned(c, 16), c += b;
    b -= a, b ^= turned(a, 19), a += c;
    c -= b, c ^= turned(b, 4), b += a;
  }
  c ^= b, c -= turned(b, 14);
  a ^= c, a -= turned(c, 11);
  b ^= a, b -= turned(a, 25);
  c ^= b, c -= turned(b, 16);
  a ^= c, a -= turned(c, 4);
  b ^= a, b -= turned(a, 14);
  c ^= b, c -= turned(b, 24);
  return c;
}

bool write_at(int descriptor, std::span<const std::uint8_t> bytes, std::uint64_t address) {
  return write_whole(descriptor, {reinterpret_cast<const char*>(bytes.data()), bytes.size()}, address);
}

// What lies beyond the file's end reads as zeros: space that is allocated and not written yet.
bool read_whole(int descriptor, std::span<std::uint8_t> bytes, std::uint64_t address) {
  while (!bytes.empty()) {
    const ssize_t count = ::pread(descriptor, bytes.data(), bytes.size(), static_cast<off_t>(address));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return false;
    if (count == 0) {
      std::ranges::fill(bytes, std::uint8_t{0});
      return true;
    }
    bytes = bytes.subspan(static_cast<std::size_t>(count));
    address += static_cast<std::uint64_t>(count);
  }
  return true;
}

// What is to be copied must lie in one block: HDF5 would rewrite the others.
H5O_info_t check_one_block(hid_t object) {
  H5O_info_t info;
  check(H5Oget_info2(object, &info, H5O_INFO_BASIC | H5O_INFO_HDR));
  if (info.hdr.nchunks != 1) throw std::runtime_error("more trials than its list was made for");
  return info;
}

// An object's header.
std::vector<std::uint8_t> read_header(int descriptor, hid_t object, std::uint64_t& address) {
  const H5O_info_t info = check_one_block(object);
  address = info.addr;
  std::vector<std::uint8_t> bytes(info.hdr.space.total);
  if (!read_whole(descriptor, bytes, address)) fail();
  return bytes;
}

// Leads the link `name` of a group's header to another address.
void relink(std::vector<std::uint8_t>& header, std::string_view name, std::uint64_t from, std::uint64_t to) {
  std::vector<std::uint8_t> link{static_cast<std::uint8_t>(name.size())};
  link.insert(link.end(), name.begin(), name.end());
  link.resize(link.size() + 8);
  put(&link[link.size() - 8], from, 8);
  const auto found = std::search(header.begin(), header.end(), link.begin(), link.end());
  if (found == header.end()) throw std::logic_error("the list is no member of the root");
  put(&*found + link.size() - 8, to, 8);
  const std::span<const std::uint8_t> summed(header.data(), header.size() - 4);
  put(&header[header.size() - 4], checksum(summed), 4);
}

}  // namespace

// HDF5's side: reads and writes go to the disk, but for those of the superblock.
struct CrashSafeDriver {
  using Disk = CrashSafeFile::Disk;
  struct File {
    H5FD_t base;  // HDF5's own, first
    Disk* disk;
  };

  static Disk& disk(const H5FD_t* file) { return *reinterpret_cast<const File*>(file)->disk; }

  // What last_error() finds.
  static herr_t failed(const char* what) {
    H5Epush2(H5E_DEFAULT, __FILE__, what, __LINE__, H5E_ERR_CLS, H5E_IO, H5E_WRITEERROR, "%s failed: error message = '%s'", what,
             std::strerror(errno));
    return -1;
  }

  static H5FD_t* open(const char*, unsigned, hid_t access, haddr_t) {
    Disk* const disk = *static_cast<Disk* const*>(H5Pget_driver_info(access));
    return &(new File{H5FD_t{}, disk})->base;
  }
  static herr_t close(H5FD_t* file) {
    delete reinterpret_cast<File*>(file);
    return 0;
  }
  static herr_t query(const H5FD_t*, unsigned long* flags) {
    *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE | H5FD_FEAT_AGGREGATE_SMALLDATA;
    return 0;
  }
  static haddr_t get_eoa(const H5FD_t* file, H5FD_mem_t) { return disk(file).end; }
  static herr_t set_eoa(H5FD_t* file, H5FD_mem_t, haddr_t end) {
    disk(file).end = end;
    return 0;
  }
  static haddr_t get_eof(const H5FD_t* file, H5FD_mem_t) {
    struct stat status {};
    return ::fstat(disk(file).descriptor, &status) == 0 ? static_cast<haddr_t>(status.st_size) : HADDR_UNDEF;
  }
  static herr_t read(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t address, std::size_t size, void* buffer) {
    const Disk& from = disk(file);
    const std::span<std::uint8_t> bytes(static_cast<std::uint8_t*>(buffer), size);
    if (!read_whole(from.descriptor, bytes, address)) return failed("read");
    for (std::size_t i = address; i < std::min<std::size_t>(from.superblock.size(), address + size); ++i)
      bytes[i - address] = from.superblock[i];
    return 0;
  }
  static herr_t write(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t address, std::size_t size, const void* buffer) {
    Disk& to = disk(file);
    std::span<const std::uint8_t> bytes(static_cast<const std::uint8_t*>(buffer), size);
    if (address < to.superblock.size()) {
      const std::size_t held = std::min(size, to.superblock.size() - address);
      std::copy_n(bytes.begin(), held, to.superblock.begin() + static_cast<std::ptrdiff_t>(address));
      bytes = bytes.subspan(held);
      address += held;
    }
    return write_at(to.descriptor, bytes, address) ? 0 : failed("write");
  }
  // The length follows when what lies there is shown.
  static herr_t truncate(H5FD_t*, hid_t, hbool_t) { return 0; }

  static hid_t id() {
    static const H5FD_class_t driver = [] {
      H5FD_class_t made{};
#ifdef H5FD_CLASS_VERSION  // HDF5 1.14
      made.version = H5FD_CLASS_VERSION;
      made.value = H5_VFD_MAX;
#endif
      made.name = "slipbench_crash_safe";
      made.maxaddr = std::numeric_limits<off_t>::max();
      made.fc_degree = H5F_CLOSE_WEAK;
      made.fapl_size = sizeof(Disk*);
      made.open = &open;
      made.close = &close;
      made.query = &query;
      made.get_eoa = &get_eoa;
      made.set_eoa = &set_eoa;
      made.get_eof = &get_eof;
      made.read = &read;
      made.write = &write;
      made.truncate = &truncate;
      constexpr std::array<H5FD_mem_t, H5FD_MEM_NTYPES> one_list H5FD_FLMAP_DICHOTOMY;
      std::ranges::copy(one_list, made.fl_map);
      return made;
    }();
    static const hid_t registered = check(H5FDregister(&driver));
    return registered;
  }

  // Properties under which HDF5 opens what lies on `disk`.
  static Handle access(Disk& disk) {
    // File format 1.8: readable by every HDF5 of the last fifteen years, and without the "open for writing" mark of later ones,
    // which would lock a killed run's file.
    Handle access(H5Pcreate(H5P_FILE_ACCESS), &H5Pclose);
    check(H5Pset_libver_bounds(access.get(), H5F_LIBVER_V18, H5F_LIBVER_V18));
    check(H5Pset_meta_block_size(access.get(), 1 << 16));
    Disk* const address = &disk;
    check(H5Pset_driver(access.get(), id(), &address));
    return access;
  }
};

CrashSafeFile::CrashSafeFile(int descriptor, hid_t creation) : disk_(std::make_unique<Disk>(Disk{descriptor})) {
  if (::ftruncate(descriptor, 0) != 0) fail();
  file_ = Handle(H5Fcreate("crash safe", H5F_ACC_TRUNC, creation, CrashSafeDriver::access(*disk_).get()), &H5Fclose);
}

void CrashSafeFile::begin(const char* list) {
  flush();
  std::uint64_t root_address = 0;
  const Handle root_group(H5Gopen2(file_.get(), "/", H5P_DEFAULT), &H5Gclose);
  std::vector<std::uint8_t> root = read_header(disk_->descriptor, root_group.get(), root_address);
  list_ = Handle(H5Gopen2(file_.get(), list, H5P_DEFAULT), &H5Gclose);
  list_bytes_ = read_header(disk_->descriptor, list_.get(), list_address_).size();

  reserve_bytes_ = 2 * (root.size() + list_bytes_);
  const hsize_t extent = reserve_bytes_;
  const Handle space(H5Screate_simple(1, &extent, nullptr), &H5Sclose);
  const Handle properties(H5Pcreate(H5P_DATASET_CREATE), &H5Pclose);
  check(H5Pset_alloc_time(properties.get(), H5D_ALLOC_TIME_EARLY));
  check(H5Pset_fill_time(properties.get(), H5D_FILL_TIME_NEVER));
  check(H5Pset_obj_track_times(properties.get(), 0));
  reserve_ = Handle(H5Dcreate_anon(file_.get(), H5T_STD_U8LE, space.get(), properties.get(), H5P_DEFAULT), &H5Dclose);
  std::uint64_t address = check(H5Dget_offset(reserve_.get()));
  std::uint64_t linked = list_address_;
  for (View& view : views_) {
    view = {address, address + root.size()};
    relink(root, list, linked, view.list);
    linked = view.list;
    if (!write_at(disk_->descriptor, root, view.root)) fail();
    address += root.size() + list_bytes_;
  }
  flush();
  publish();
}

void CrashSafeFile::flush() {
  check(H5Fflush(file_.get(), H5F_SCOPE_GLOBAL));
  write_back();
}

void CrashSafeFile::publish() {
  check_one_block(list_.get());
  shown_ = 1 - shown_;
  std::vector<std::uint8_t> list(list_bytes_);
  if (!read_whole(disk_->descriptor, list, list_address_)) fail();
  if (!write_at(disk_->descriptor, list, views_[shown_].list)) fail();
  std::array<std::uint8_t, 48> superblock = disk_->superblock;
  put(&superblock[root_field], views_[shown_].root, 8);
  put(&superblock[end_field], disk_->end, 8);
  put(&superblock[superblock_sum], checksum(std::span(superblock).first(superblock_sum)), 4);
  show(superblock);
}

void CrashSafeFile::close() {
  const std::uint64_t reserve = views_[0].root;
  park();
  lengthen(1);  // not cleared yet
  show(disk_->superblock);
  const std::vector<std::uint8_t> nothing(reserve_bytes_);
  if (!write_at(disk_->descriptor, nothing, reserve)) fail();
  sync();
  if (::ftruncate(disk_->descriptor, static_cast<off_t>(disk_->end)) != 0 || !sync_file(disk_->descriptor)) fail();
}

void CrashSafeFile::park() {
  list_.close();
  reserve_.close();
  file_.close();
}

void CrashSafeFile::reopen() {
  file_ = Handle(H5Fopen("crash safe", H5F_ACC_RDWR, CrashSafeDriver::access(*disk_).get()), &H5Fclose);
}

void CrashSafeFile::show(const std::array<std::uint8_t, 48>& superblock) {
  sync();
  if (!write_at(disk_->descriptor, superblock, 0) || !sync_file(disk_->descriptor)) fail();
}

// The disk begins to write what has been flushed, and nobody waits for it: a sync then has little left to do. Where it fails, the sync says so.
void CrashSafeFile::write_back() {
  constexpr std::uint64_t least = 8 << 20;  // bytes
  if (disk_->end < written_back_ + least) return;
  ::sync_file_range(disk_->descriptor, static_cast<off_t>(written_back_), static_cast<off_t>(disk_->end - written_back_),
                    SYNC_FILE_RANGE_WRITE);
  written_back_ = disk_->end;
}

// A file that is shorter than its superblock says is refused by readers, a longer one is not.
void CrashSafeFile::lengthen(std::uint64_t by) {
  struct stat status {};
  if (::fstat(disk_->descriptor, &status) != 0) fail();
  const auto end = static_cast<off_t>(disk_->end + by);
  if (status.st_size < end && ::ftruncate(disk_->descriptor, end) != 0) fail();
}

void CrashSafeFile::sync() {
  lengthen();
  if (!sync_file(disk_->descriptor)) fail();
}

bool CrashSafeFile::cleared(int descriptor) {
  std::array<std::uint8_t, 8> end{};
  struct stat status {};
  if (!read_whole(descriptor, end, end_field) || ::fstat(descriptor, &status) != 0) fail();
  std::array<std::uint8_t, 8> size{};
  put(size.data(), static_cast<std::uint64_t>(status.st_size), size.size());
  return size == end;
}

std::uint64_t CrashSafeFile::size_bytes() const {
  hsize_t bytes = 0;
  check(H5Fget_filesize(file_.get(), &bytes));
  return bytes;
}

}  // namespace slipbench::hdf5
