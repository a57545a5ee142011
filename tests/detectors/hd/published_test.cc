// The engines against the published hardware.
#include "tests/detectors/hd/published.h"

#include <gtest/gtest.h>

#include "detectors/hd/memory_files.h"

namespace slipbench::hd {
namespace {

void expect_published(Engine& engine, const std::string& column) {
  const std::vector<PublishedRow> rows = published_rows();
  ASSERT_EQ(rows.size(), 300U);
  for (const PublishedRow& row : rows) {
    const Decision decision = engine.update(published_frame(row));
    Decision expected;  // -1 in the file until the window of 15 is full
    if (row.at(column + "_state") >= 0) {
      expected.state = static_cast<PadState>(row.at(column + "_state"));
      for (std::size_t k = 0; k < class_count; ++k) {
        expected.distance[k] = static_cast<std::uint16_t>(row.at(column + "_d" + std::to_string(k + 1)));
      }
    }
    ASSERT_EQ(decision, expected) << column << ", step " << row.at("n");
  }
}

struct Published : testing::TestWithParam<const char*> {
  SavedModel saved_ = load(published_folder, published_model(GetParam()));
};

TEST_P(Published, ReferenceGivesEveryClassAndDistance) {
  expect_published(*make_reference(saved_.model, saved_.memories), GetParam());
}

TEST_P(Published, KernelGivesEveryClassAndDistanceOnEveryPath) {
  for (const KernelPath path : kernel_paths()) {
    SCOPED_TRACE(static_cast<int>(path));
    expect_published(*make_kernel(saved_.model, saved_.memories, path), GetParam());
  }
}

INSTANTIATE_TEST_SUITE_P(Models, Published, testing::Values("A", "P1", "P0"), [](const auto& info) { return info.param; });

}  // namespace
}  // namespace slipbench::hd
