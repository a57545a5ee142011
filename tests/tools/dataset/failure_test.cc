// Datasets whose writing cannot continue.
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <numeric>

#include <hdf5.h>
#include <zlib.h>

#include "tests/expect.h"
#include "tests/tools/dataset/record/test_records.h"
#include "tools/dataset/checked_dataset.h"
#include "tools/dataset/hdf5/hdf5_place.h"
#include "tools/dataset/reader.h"
#include "tools/dataset/writer.h"

namespace slipbench::testing::failure_test {
namespace {

const DatasetHeader header{"1.2.3", "scene", "{}", 7, "slipbench sweep a.yaml"};
constexpr std::size_t rows = 400;

struct FailureTest : FolderTest {
  std::string refusal(const std::string& target) {
    return refusal_of([&] { DatasetWriter writer(target, header); });
  }
  static void write(const std::string& target, std::size_t trials) {
    DatasetWriter writer(target, header);
    for (std::size_t k = 0; k < trials; ++k) writer.append(make_trial(k, rows));
    writer.commit();
  }
};

TEST_F(FailureTest, FullFilesAreNotKeptOpen) {
  DatasetWriter writer(path("out.h5"), header, 1);  // bytes, so that each trial gets a file
  std::vector<ssize_t> open;                        // files, groups and arrays, with HDF5
  for (std::size_t k = 0; k < 9; ++k) {
    writer.append(make_trial(k, rows));
    open.push_back(H5Fget_obj_count(H5F_OBJ_ALL, H5F_OBJ_ALL));
  }
  EXPECT_EQ(open.back(), open.front());
  EXPECT_EQ(writer.commit().size(), 9U);
  const DatasetReader reader(path("out.h5"));
  for (std::size_t k = 0; k < 9; ++k)
    EXPECT_EQ(reader.read<float>(k, "labels/pad/force"), make_record(k, rows).sensors[0].labels.force);
}

TEST_F(FailureTest, MissingFolderIsRefused) {
  EXPECT_THAT(refusal(path("no/out.h5")), mentions({path("no/out.h5"), "folder " + path("no")}));
  EXPECT_THAT(names(), IsEmpty());
}

TEST_F(FailureTest, FolderAsTargetIsRefused) {
  ::mkdir(path("out.h5").c_str(), 0777);
  EXPECT_THAT(refusal(path("out.h5")), mentions({path("out.h5"), "folder"}));
  EXPECT_THAT(refusal(path("out.h5") + "/"), mentions({"file name"}));
  EXPECT_THAT(refusal(""), mentions({"file name"}));
}

TEST_F(FailureTest, SpecialFileIsRefused) { EXPECT_THAT(refusal("/dev/null"), mentions({"/dev/null", "regular file"})); }

TEST_F(FailureTest, ReadOnlyTargetIsRefusedAndKept) {
  std::ofstream(path("out.h5")) << "precious";
  ::chmod(path("out.h5").c_str(), 0444);
  EXPECT_THAT(refusal(path("out.h5")), mentions({"read-only"}));
  EXPECT_EQ(bytes_of(path("out.h5")), "precious");
  EXPECT_THAT(names(), ElementsAre("out.h5"));
}

TEST_F(FailureTest, FileThatIsNoDatasetIsRefusedAndKept) {
  std::ofstream(path("out.h5")) << "slipbench: 1\n";
  EXPECT_THAT(refusal(path("out.h5")), mentions({path("out.h5"), "dataset"}));
  EXPECT_EQ(bytes_of(path("out.h5")), "slipbench: 1\n");
  EXPECT_THAT(names(), ElementsAre("out.h5"));
}

TEST_F(FailureTest, EmptyFileIsReplaced) {
  std::ofstream(path("out.h5")).flush();
  write(path("out.h5"), 1);
  EXPECT_EQ(DatasetReader(path("out.h5")).trials().size(), 1U);
}

TEST_F(FailureTest, SymbolicLinkIsRefusedAndKept) {
  std::filesystem::create_symlink(path("real.h5"), path("out.h5"));  // dangling
  EXPECT_THAT(refusal(path("out.h5")), mentions({path("out.h5"), "symbolic link", path("real.h5")}));
  write(path("real.h5"), 1);
  EXPECT_THAT(refusal(path("out.h5")), mentions({"symbolic link"}));
  EXPECT_TRUE(std::filesystem::is_symlink(path("out.h5")));
}

TEST_F(FailureTest, FolderWithoutPermissionIsRefused) {
  ::mkdir(path("locked").c_str(), 0555);
  ::chmod(path("").c_str(), 0755);
  const int status = in_child([&] {
    constexpr uid_t nobody = 65534;
    if (::geteuid() == 0 && ::seteuid(nobody) != 0) ::_exit(2);  // root may write everywhere
    ::_exit(refusal(path("locked/out.h5")).ends_with("Permission denied") ? 0 : 1);
  });
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

TEST_F(FailureTest, TwoRunsDoNotShareATarget) {
  const DatasetWriter first(path("out.h5"), header);
  EXPECT_THAT(refusal(path("out.h5")), mentions({"another run"}));
}

TEST_F(FailureTest, OldTargetStaysUntilTheNewOneIsWhole) {
  write(path("out.h5"), 1);
  const std::string old = bytes_of(path("out.h5"));
  DatasetWriter writer(path("out.h5"), header);
  writer.append(make_trial(0, rows));
  writer.append(make_trial(1, rows));
  EXPECT_EQ(bytes_of(path("out.h5")), old);
  writer.commit();
  EXPECT_EQ(DatasetReader(path("out.h5")).trials().size(), 2U);
  EXPECT_THAT(names(), ElementsAre("out.h5"));
}

TEST_F(FailureTest, UnfinishedDatasetLeavesNothing) {
  {
    DatasetWriter writer(path("out.h5"), header);
    for (std::size_t k = 0; k < 3; ++k) writer.append(make_trial(k, rows));
    EXPECT_THAT(names(), ElementsAre("out.h5.partial"));
  }
  EXPECT_THAT(names(), IsEmpty());
}

TEST_F(FailureTest, WhatAKilledRunHasLeftIsReplaced) {
  const int status = in_child([&] {
    DatasetWriter writer(path("out.h5"), header);
    writer.append(make_trial(0, rows));
    ::raise(SIGKILL);
  });
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_THAT(names(), ElementsAre("out.h5.partial"));
  write(path("out.h5"), 2);
  EXPECT_EQ(DatasetReader(path("out.h5")).trials().size(), 2U);
  EXPECT_THAT(names(), ElementsAre("out.h5"));
}

// HDF5 leaves out an optional filter that does not shrink a chunk, and records that in the chunk's
// filter mask; h5repack and h5py write such files. A chunk that was never written reads as zeros.
TEST_F(FailureTest, ChunksAreReadWhateverFiltersTheyLeaveOut) {
  constexpr std::size_t rows_of_chunk = 25, columns = 24, values_of_chunk = rows_of_chunk * columns;
  const std::string name = path("chunks.h5");
  const hdf5::Handle file(H5Fcreate(name.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), &H5Fclose);
  const hdf5::Handle properties(H5Pcreate(H5P_DATASET_CREATE), &H5Pclose);
  const std::array<hsize_t, 2> size{5 * rows_of_chunk, columns}, chunk{rows_of_chunk, columns};
  H5Pset_chunk(properties.get(), 2, chunk.data());
  H5Pset_shuffle(properties.get());
  H5Pset_deflate(properties.get(), 1);
  const hdf5::Handle space(H5Screate_simple(2, size.data(), nullptr), &H5Sclose);
  const hdf5::Handle array(
      H5Dcreate2(file.get(), "force", H5T_IEEE_F32LE, space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT), &H5Dclose);

  // Bit 0 of the mask disables shuffle, bit 1 deflate. The fifth chunk is missing.
  std::vector<float> written(5 * values_of_chunk);
  for (std::uint32_t mask = 0; mask < 4; ++mask) {
    float* const values = written.data() + mask * values_of_chunk;
    std::iota(values, values + values_of_chunk, 1.5F + 1000.0F * static_cast<float>(mask));
    std::vector<std::uint8_t> bytes(4 * values_of_chunk);
    std::memcpy(bytes.data(), values, bytes.size());
    if ((mask & 1) == 0) {
      for (std::size_t i = 0; i < values_of_chunk; ++i)
        for (std::size_t byte = 0; byte < 4; ++byte)
          bytes[byte * values_of_chunk + i] = reinterpret_cast<const std::uint8_t*>(values)[4 * i + byte];
    }
    if ((mask & 2) == 0) {
      std::vector<std::uint8_t> deflated(::compressBound(bytes.size()));
      uLongf count = deflated.size();
      ASSERT_EQ(::compress(deflated.data(), &count, bytes.data(), bytes.size()), Z_OK);
      deflated.resize(count);
      bytes = deflated;
    }
    const std::array<hsize_t, 2> offset{mask * rows_of_chunk, 0};
    ASSERT_GE(H5Dwrite_chunk(array.get(), H5P_DEFAULT, mask, offset.data(), bytes.size(), bytes.data()), 0);
  }
  const hdf5::Place place{file.get(), name, "/force"};
  std::vector<float> read(written.size(), -1.0F);
  hdf5::read_values(place, array, H5T_IEEE_F32LE, read.data());
  EXPECT_EQ(read, written);

  for (const std::uint32_t mask : {2U, 3U}) {
    const std::array<hsize_t, 2> offset{mask * rows_of_chunk, 0};
    ASSERT_GE(H5Dwrite_chunk(array.get(), H5P_DEFAULT, mask, offset.data(), 40, written.data()), 0);
    EXPECT_THAT(refusal_of([&] { hdf5::read_values(place, array, H5T_IEEE_F32LE, read.data()); }),
                refused_at(name, {"/force", "40", "2400"}));
  }
}

// HDF5 1.10 reads beyond a chunk that decompresses to too few bytes.
TEST_F(FailureTest, AChunkThatDecompressesToTooLittleIsRefused) {
  write(path("a.h5"), 1);
  {
    const hdf5::Handle file(H5Fopen(path("a.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT), &H5Fclose);
    const hdf5::Handle array(H5Dopen2(file.get(), "/data/demo_0/labels/pad/force", H5P_DEFAULT), &H5Dclose);
    const std::array<std::uint8_t, 40> bytes{};
    std::array<std::uint8_t, 100> deflated{};
    uLongf count = deflated.size();
    ASSERT_EQ(::compress(deflated.data(), &count, bytes.data(), bytes.size()), Z_OK);
    const std::array<hsize_t, 3> offset{};
    ASSERT_GE(H5Dwrite_chunk(array.get(), H5P_DEFAULT, 0, offset.data(), count, deflated.data()), 0);
  }
  EXPECT_THAT(refusal_of([&] { checked_dataset(path("a.h5")); }), AllOf(HasSubstr(path("a.h5") + ": "), HasSubstr("damaged")));
}

// For any lost or changed bytes a check gives a file that this process can read, or an InputError
// that names the file.
TEST_F(FailureTest, DamagedFilesAreRefusedOrRead) {
  {
    DatasetWriter writer(path("whole.h5"), header);
    writer.append(make_trial(0, 20));
    writer.commit();
  }
  const std::string whole = bytes_of(path("whole.h5"));
  constexpr std::size_t steps = 200;
  for (std::size_t step = 0; step < steps; ++step) {
    std::string damaged = whole;
    if (step % 3 == 0) {
      damaged.resize(whole.size() * step / steps);
    } else {
      damaged[(step * 7919) % whole.size()] ^= static_cast<char>(1 + step % 255);
    }
    std::ofstream(path("damaged.h5"), std::ios::binary | std::ios::trunc) << damaged;
    try {
      const DatasetReader reader = checked_dataset(path("damaged.h5"));
      for (const std::size_t trial : reader.trials()) EXPECT_EQ(reader.read_trial(trial).trial, trial);
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("damaged.h5")) << step;
    }
  }
}

}  // namespace
}  // namespace slipbench::testing::failure_test
