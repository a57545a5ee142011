// An HDF5 file that is readable at every instant of its writing.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "tools/base/hdf5/hdf5_place.h"

namespace slipbench::hdf5 {

// HDF5 rewrites in place: its superblock, the header of a group that gets a member, a heap of texts that has room left. A process
// that is killed in between leaves a file that nothing reads. Here nothing that a reader can reach is ever rewritten but the
// superblock:
//
// - HDF5's own superblock stays in memory. The one on the disk leads to one of two copies of the root's and the list's object
//   headers.
// - publish() copies the list into the copy that is not shown, syncs, and shows it by writing the superblock: 48 bytes, in one
//   sector. It syncs again, so that the copy shown before may be rewritten.
// - close() does the same with HDF5's own superblock and headers, and clears both copies. Until then the file is longer than its
//   superblock says.
//
// Format: HDF5 File Format Specification 3.0, II.A "Superblock", versions 2 and 3; IV.A.1.b "Version 2 Data Object Header
// Prefix". All functions throw std::runtime_error with the system's reason.
class CrashSafeFile {
 public:
  CrashSafeFile() = default;
  // Makes the file anew. `descriptor`: open for reading and writing, and for as long as the file is; it stays the caller's.
  // `creation`: properties, under which the root's header must take all that the root gets before begin() in one block.
  CrashSafeFile(int descriptor, hid_t creation);

  [[nodiscard]] hid_t get() const { return file_.get(); }

  // From here on the file is readable. `list`: name of a group in the root, whose header is one block for as long as the file
  // grows. Until close() the root itself gets nothing more, and what has been published is not changed.
  void begin(const char* list);
  // Hands what has been written so far to the system, and does not show it. HDF5 then begins new blocks: where the next objects
  // lie depends on when this is called.
  void flush();
  // What has been flushed, and is a member of the list, can be read from now on whatever happens. Where objects lie does not
  // depend on when this is called.
  void publish();
  // What has been flushed is on the disk, without being shown.
  void sync();
  // Shows what has been flushed and synced, what the root has got since begin() too, which takes no further space, and closes the
  // file.
  void close();
  // Lets go of the memory and of all that HDF5 has open, of a file whose members have all been published; they can be read on. Until reopen() nothing
  // may be called but abandon() and the destructor.
  void park();
  // Goes on, with close() to come.
  void reopen();
  // Gives up a file that cannot be written any more. As when it is destroyed without close(), what was published last stays.
  void abandon() {
    list_.abandon();
    reserve_.abandon();
    file_.abandon();
  }

  // Whether close() came to its end, of a file that is readable. Else its bytes are not those of a file that was written undisturbed.
  [[nodiscard]] static bool cleared(int descriptor);

  // Bytes of the file if it were closed now.
  [[nodiscard]] std::uint64_t size_bytes() const;

 private:
  // What HDF5's file driver works on. It lies where HDF5 can keep its address.
  struct Disk {
    int descriptor = -1;
    std::array<std::uint8_t, 48> superblock{};  // as HDF5 has written it last
    std::uint64_t end = 0;                      // of the space that HDF5 has allocated
  };
  friend struct CrashSafeDriver;

  // A copy of both headers.
  struct View {
    std::uint64_t root = 0;
    std::uint64_t list = 0;
  };

  void show(const std::array<std::uint8_t, 48>& superblock);
  void lengthen(std::uint64_t by = 0);
  void write_back();

  std::unique_ptr<Disk> disk_;
  Handle file_;
  Handle list_;
  Handle reserve_;  // keeps HDF5 from the copies' space
  std::uint64_t list_address_ = 0;
  std::uint64_t list_bytes_ = 0;
  std::uint64_t reserve_bytes_ = 0;
  std::array<View, 2> views_{};
  std::size_t shown_ = 0;
  std::uint64_t written_back_ = 0;  // from here on the disk has not been asked to write
};

}  // namespace slipbench::hdf5
