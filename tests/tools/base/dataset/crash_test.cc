// Whatever instant a run is ended at, the trials that were published can be read.
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <map>
#include <random>
#include <vector>

#include <dlfcn.h>

#include <gtest/gtest.h>

#include "tests/tools/base/record/test_records.h"
#include "tools/base/dataset/header.h"
#include "tools/base/dataset/reader.h"
#include "tools/base/dataset/writer.h"

namespace slipbench::testing::crash_test {
namespace {

// What a program does to a file, as the system is asked for it.
struct Operation {
  enum class Kind { write, length, sync };
  Kind kind = Kind::write;
  std::size_t at = 0;  // where a write begins, or the new length
  std::string bytes{};
  std::size_t published = 0;  // trials that were published when it began
};

// The operations of the writer that is being watched; null: none is.
std::vector<Operation>* watched = nullptr;
std::size_t published = 0;

void note(Operation operation) {
  if (watched == nullptr) return;
  operation.published = published;
  watched->push_back(std::move(operation));
}

template <class Function>
Function original(const char* name) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

}  // namespace
}  // namespace slipbench::testing::crash_test

// These stand before the system's own. A write is cut where pages end: a process may be killed between two pages of one write.
extern "C" {
ssize_t pwrite(int descriptor, const void* bytes, std::size_t size, off_t at) {
  using slipbench::testing::crash_test::note;
  constexpr std::size_t page = 4096;
  for (std::size_t from = 0; from < size;) {
    const std::size_t place = static_cast<std::size_t>(at) + from;
    const std::size_t count = std::min(size - from, page - place % page);
    note({.at = place, .bytes = {static_cast<const char*>(bytes) + from, count}});
    from += count;
  }
  return slipbench::testing::crash_test::original<decltype(&pwrite)>("pwrite")(descriptor, bytes, size, at);
}
int ftruncate(int descriptor, off_t length) noexcept {
  slipbench::testing::crash_test::note(
      {.kind = slipbench::testing::crash_test::Operation::Kind::length, .at = static_cast<std::size_t>(length)});
  return slipbench::testing::crash_test::original<decltype(&ftruncate)>("ftruncate")(descriptor, length);
}
int fdatasync(int descriptor) {
  slipbench::testing::crash_test::note({.kind = slipbench::testing::crash_test::Operation::Kind::sync});
  return slipbench::testing::crash_test::original<decltype(&fdatasync)>("fdatasync")(descriptor);
}
int fsync(int descriptor) {
  slipbench::testing::crash_test::note({.kind = slipbench::testing::crash_test::Operation::Kind::sync});
  return slipbench::testing::crash_test::original<decltype(&fsync)>("fsync")(descriptor);
}
}

namespace slipbench::testing::crash_test {
namespace {

constexpr std::size_t rows = 40;
constexpr std::size_t trials = 7;

void perform(std::string& file, const Operation& operation) {
  switch (operation.kind) {
    case Operation::Kind::length: file.resize(operation.at); break;
    case Operation::Kind::write:
      file.resize(std::max(file.size(), operation.at + operation.bytes.size()));
      std::copy(operation.bytes.begin(), operation.bytes.end(), file.begin() + static_cast<std::ptrdiff_t>(operation.at));
      break;
    case Operation::Kind::sync: break;
  }
}

bool is_sync(const Operation& operation) { return operation.kind == Operation::Kind::sync; }

struct CrashTest : FolderTest {
  // A run that publishes after one trial, after four more, and after the last.
  void SetUp() override {
    watched = &operations_;
    published = 0;
    DatasetWriter writer(path("out.h5"), {"1.2.3", "scene", "{}", 7, "slipbench sweep a.yaml"}, trials);
    for (std::size_t k = 0; k < trials; ++k) {
      writer.append(make_trial(k, rows));
      if (k == 0 || k == 4 || k + 1 == trials) {
        writer.publish();
        published = writer.published();
      }
    }
    writer.commit();
    watched = nullptr;
  }

  // Whether the first `count` trials are in a file of these bytes, word for word.
  void expect_trials(const std::string& file, std::size_t count, const std::string& where) {
    std::ofstream(path("after.h5"), std::ios::binary | std::ios::trunc) << file;
    const DatasetReader reader(path("after.h5"));
    ASSERT_GE(reader.trials().size(), count) << where;
    for (const std::size_t trial : reader.trials()) {
      const TrialRecord record = reader.read_trial(trial);
      const TrialRecord written = make_record(trial, rows);
      ASSERT_EQ(record.sensors.at(0).labels.force, written.sensors[0].labels.force) << where;
      ASSERT_EQ(record.sensors[0].channel_names, written.sensors[0].channel_names) << where;
      ASSERT_EQ(record.sensors[0].labels.k_normal, written.sensors[0].labels.k_normal) << where;
      ASSERT_EQ(record.params, written.params) << where;
    }
  }

  std::vector<Operation> operations_;
};

TEST_F(CrashTest, EveryPrefixOfTheWritesIsReadable) {
  std::string file;
  std::size_t readable = 0;
  for (std::size_t i = 0; i < operations_.size(); ++i) {
    perform(file, operations_[i]);
    const std::size_t count = i + 1 < operations_.size() ? operations_[i + 1].published : trials;
    if (count == 0) continue;
    expect_trials(file, count, "operation " + std::to_string(i));
    if (HasFatalFailure()) return;
    ++readable;
  }
  EXPECT_GT(readable, 200U);  // six trials of 25 arrays, each of which is a write, and their headers
}

// A text is read through its heap, in which all others of the demo lie. A heap that is cut short can keep HDF5 busy for ever.
TEST_F(CrashTest, NoHeapIsWrittenAgainOnceItsTrialIsPublished) {
  std::map<std::size_t, std::size_t> heaps;  // trials that were published when it was written first, by address
  for (const Operation& operation : operations_) {
    for (std::size_t found = operation.bytes.find("GCOL"); found != std::string::npos;
         found = operation.bytes.find("GCOL", found + 1)) {
      const auto [heap, first] = heaps.try_emplace(operation.at + found, operation.published);
      EXPECT_EQ(heap->second, operation.published) << "the heap at " << heap->first;
    }
  }
  EXPECT_EQ(heaps.size(), trials + 2);  // the root's at first, one a trial, the root's at the end
}

// A disk keeps what was synced. Of what came after, any pages may be on it and others not.
TEST_F(CrashTest, PowerMayFailBetweenSyncs) {
  std::mt19937 random(18);
  for (int attempt = 0; attempt < 300; ++attempt) {
    const std::size_t end = random() % operations_.size();
    std::size_t synced = end;
    while (synced > 0 && !is_sync(operations_[synced])) --synced;
    const std::size_t count = operations_[end].published;
    if (count == 0) continue;
    std::string file;
    for (std::size_t i = 0; i < end; ++i) {
      if (i < synced || random() % 2 == 0) perform(file, operations_[i]);
    }
    expect_trials(file, count, "attempt " + std::to_string(attempt));
    if (HasFatalFailure()) return;
  }
}

}  // namespace
}  // namespace slipbench::testing::crash_test
