// Foreign files, which slipbench-reader reads before this process does.
#include "tools/dataset/checked_dataset.h"

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <hdf5.h>

#include "sim/core/process/check_readable.h"
#include "sim/core/process/interrupted.h"
#include "tests/expect.h"
#include "tests/tools/dataset/record/test_records.h"
#include "tools/dataset/hdf5/hdf5_place.h"
#include "tools/dataset/writer.h"

namespace slipbench::testing {
namespace {

struct CheckedDataset : FolderTest {
  void SetUp() override {
    FolderTest::SetUp();
    DatasetWriter writer(path("a.h5"), {"1.2.3", "scene", "{}", 7, "slipbench sweep a.yaml"},
                         1);  // bytes: each trial gets a file
    for (std::size_t k = 0; k < 3; ++k) writer.append(make_trial(k, 50));
    writer.commit();
  }
};

TEST_F(CheckedDataset, IsReadWithAllItsFiles) {
  EXPECT_EQ(checked_dataset(path("a.h5")).trials().size(), 3U);
  const std::string names = path("a.h5") + '\0' + path("a-0001.h5") + '\0' + path("a-0002.h5") + '\0';
  for (const FileKind kind : {FileKind::dataset, FileKind::dataset_header}) EXPECT_EQ(check_readable(kind, path("a.h5")), names);
}

TEST_F(CheckedDataset, DamageInAnyFileIsNamed) {
  {
    const hdf5::Handle file(H5Fopen(path("a-0001.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT), &H5Fclose);
    ASSERT_GE(H5Ldelete(file.get(), "/data/demo_1/labels/pad/margin", H5P_DEFAULT), 0);
  }
  EXPECT_THAT(refusal_of([&] { checked_dataset(path("a.h5")); }), HasSubstr(path("a-0001.h5") + ": "));
  EXPECT_EQ(dataset_header_at(path("a.h5")).trials().size(), 3U);
}

TEST_F(CheckedDataset, WhatIsNoDatasetIsRefused) {
  EXPECT_THAT(refusal_of([&] { checked_dataset(path("none.h5")); }), HasSubstr(path("none.h5")));
  std::ofstream(path("text.h5")) << "text";
  EXPECT_THAT(refusal_of([&] { dataset_header_at(path("text.h5")); }), HasSubstr(path("text.h5")));
  std::filesystem::remove(path("a-0001.h5"));
  EXPECT_THAT(refusal_of([&] { whole_dataset(path("a.h5")); }), HasSubstr("a-0001.h5"));
}

// An invalid library ends the reader at load time.
TEST_F(CheckedDataset, ReaderThatCannotRunSaysNothingOfTheFile) {
  std::ofstream(path("libstdc++.so.6"));
  const int status = in_child([&] {
    ::setenv("LD_LIBRARY_PATH", path("").c_str(), 1);
    std::ofstream(path("message")) << refusal_of([&] { check_readable(FileKind::dataset, path("a.h5")); });
  });
  EXPECT_EQ(status, 0);
  EXPECT_THAT(bytes_of(path("message")), StartsWith(path("a.h5") + ": cannot be read: slipbench-reader was stopped"));
}

// A crash is damage.
TEST_F(CheckedDataset, CrashOfTheReaderIsDamage) {
  const int status = in_child([&] {
    ::setenv("LD_PRELOAD", SLIPBENCH_TEST_PLUGINS "/crash.so", 1);
    std::ofstream(path("message")) << refusal_of([&] { check_readable(FileKind::dataset, path("a.h5")); });
  });
  EXPECT_EQ(status, 0);
  EXPECT_THAT(bytes_of(path("message")), StartsWith(path("a.h5") + ": is damaged: reading it crashed (Segmentation fault)"));
}

// A host that ignores its children's ends leaves no exit status.
TEST_F(CheckedDataset, NoStatusIsNeeded) {
  const auto before = std::signal(SIGCHLD, SIG_IGN);
  EXPECT_EQ(checked_dataset(path("a.h5")).trials().size(), 3U);
  EXPECT_THAT(refusal_of([&] { checked_dataset(path("none.h5")); }), HasSubstr("no such file"));
  std::signal(SIGCHLD, before);
}

TEST_F(CheckedDataset, AnInterruptEndsTheReader) {
  const std::atomic<bool> now{true};
  const InterruptScope scope(&now);
  EXPECT_THROW(checked_dataset(path("a.h5")), Interrupted);
}

TEST_F(CheckedDataset, OnceIsEnoughWhileTheFileStaysTheSame) {
  std::ofstream(path("model.xml")) << "<mujoco/>";
  check_readable_once(FileKind::model, path("model.xml"));
  const std::atomic<bool> now{true};
  const InterruptScope scope(&now);  // ends a reader
  EXPECT_NO_THROW(check_readable_once(FileKind::model, path("model.xml")));
  std::ofstream(path("model.xml")) << "<mujoco></mujoco>";
  EXPECT_THROW(check_readable_once(FileKind::model, path("model.xml")), Interrupted);
}

}  // namespace
}  // namespace slipbench::testing
