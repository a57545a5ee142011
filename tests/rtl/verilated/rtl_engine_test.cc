#include "rtl/verilated/rtl_engine.h"

#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "detectors/hd/memory_files.h"
#include "sim/core/error.h"
#include "tests/detectors/hd/published.h"

namespace slipbench::hd::rtl_engine_test {
namespace {

constexpr std::array unrollings{Unrolling::fastest, Unrolling::middle, Unrolling::smallest};

SavedModel published(const std::string& column = "P1") { return load(published_folder, published_model(column)); }

// The file has -1 until the window of 15 is full.
Decision published_decision(const PublishedRow& row, const std::string& column) {
  Decision decision;
  if (row.at(column + "_state") < 0) return decision;
  decision.state = static_cast<PadState>(row.at(column + "_state"));
  for (std::size_t k = 0; k < class_count; ++k) {
    decision.distance[k] = static_cast<std::uint16_t>(row.at(column + "_d" + std::to_string(k + 1)));
  }
  return decision;
}

TEST(RtlEngine, GivesEveryPublishedClassAndDistance) {
  const std::vector<PublishedRow> rows = published_rows();
  ASSERT_GE(rows.size(), 300U);
  for (const Unrolling unrolling : unrollings) {
    for (const char* column : {"P1", "P0"}) {
      const SavedModel saved = published(column);
      const auto engine = make_rtl_engine(saved.model, saved.memories, {.unrolling = unrolling});
      for (const PublishedRow& row : rows) {
        ASSERT_EQ(engine->update(published_frame(row)), published_decision(row, column)) << column << ", step " << row.at("n");
      }
    }
  }
}

TEST(RtlEngine, StatesTheCyclesOfItsLastDecision) {
  const SavedModel saved = published();
  for (const Unrolling unrolling : unrollings) {
    const auto engine = make_rtl_engine(saved.model, saved.memories, {.unrolling = unrolling});
    engine->update(FixedFrame{});
    EXPECT_EQ(engine->cycles(), core_latency(unrolling));
    // A frame skips the feature's four cycles, and those in which its other pillars wait for their
    // turn.
    engine->update(Frame{});
    EXPECT_EQ(engine->cycles(), (unrolling == Unrolling::fastest ? 1U : unrolling == Unrolling::middle ? 4U : 20U) + 5U);
  }
}

TEST(RtlEngine, StartsAWindowAfterReset) {
  const SavedModel saved = published();
  const auto engine = make_rtl_engine(saved.model, saved.memories);
  const std::vector<PublishedRow> rows = published_rows();
  for (std::size_t i = 0; i < 20; ++i) engine->update(published_frame(rows[i]));
  engine->reset();
  for (std::size_t i = 0; i < 20; ++i) ASSERT_EQ(engine->update(published_frame(rows[i])), published_decision(rows[i], "P1"));
}

// Without contexts the prototypes are used alone, whatever the context memory holds.
TEST(RtlEngine, LeavesOutContextsWhereTheModelDoes) {
  SavedModel saved = published();
  saved.model.context_driven = false;
  const auto engine = make_rtl_engine(saved.model, saved.memories, {.golden = make_reference(saved.model, saved.memories)});
  for (const PublishedRow& row : published_rows()) ASSERT_NO_THROW(engine->update(published_frame(row)));
}

TEST(RtlEngine, RefusesLevelsAndContextsThatDoNotExist) {
  const SavedModel saved = published();
  const auto engine = make_rtl_engine(saved.model, saved.memories);
  Frame frame;
  frame.level[8] = 21;
  EXPECT_THROW(engine->update(frame), std::out_of_range);
  frame.level[8] = 20;
  frame.context = 4;
  EXPECT_THROW(engine->update(frame), std::out_of_range);
}

// The golden model has one bit changed in the prototype of gross slip: its distance differs by one
// in the first decision.
TEST(RtlEngine, ReportsTheFirstDifferenceFromTheGoldenModelOnce) {
  const SavedModel saved = published();
  Memories changed = saved.memories;
  changed.associative[2].set(0, !changed.associative[2].bit(0));
  const auto engine = make_rtl_engine(saved.model, saved.memories,
                                      {.unrolling = Unrolling::smallest, .golden = make_reference(saved.model, changed)});
  const std::vector<PublishedRow> rows = published_rows();
  const std::size_t full = core_window - 1;
  for (std::size_t i = 0; i < full; ++i) ASSERT_NO_THROW(engine->update(published_frame(rows[i])));
  const PublishedRow& row = rows[full];
  try {
    engine->update(published_frame(row));
    FAIL() << "no difference was reported";
  } catch (const std::logic_error& error) {
    // Each frame takes 25 cycles to its decision and one to take it; so this decision is in cycle
    // 14 * 26 + 25.
    const std::string text = error.what();
    EXPECT_EQ(text.find("rtl core: cycle 389, update 14: expected class "), 0U) << text;
    const std::string distances = "distances " + std::to_string(row.at("P1_d1")) + " " + std::to_string(row.at("P1_d2")) + " ";
    EXPECT_NE(
        text.find("actual class " + std::to_string(row.at("P1_state")) + ", " + distances + std::to_string(row.at("P1_d3"))),
        std::string::npos)
        << text;
  }
  EXPECT_NO_THROW(engine->update(published_frame(rows[full + 1])));
}

// An FST file begins with a block type and a length, then its first and last time, eight bytes
// each, most significant first.
std::array<std::uint64_t, 2> times_of(const std::filesystem::path& fst) {
  std::ifstream file(fst, std::ios::binary);
  std::array<char, 25> head{};
  file.read(head.data(), head.size());
  std::array<std::uint64_t, 2> times{};
  for (std::size_t i = 0; i < 16; ++i) times[i / 8] = times[i / 8] << 8 | static_cast<std::uint8_t>(head[9 + i]);
  return times;
}

TEST(RtlEngine, WritesAWaveformOfTheChosenUpdates) {
  const std::filesystem::path fst = std::filesystem::path(testing::TempDir()) / "rtl_engine_test.fst";
  std::filesystem::remove(fst);
  const SavedModel saved = published();
  {
    const auto engine =
        make_rtl_engine(saved.model, saved.memories,
                        {.unrolling = Unrolling::fastest, .trace = fst.string(), .trace_first = 2, .trace_count = 3});
    engine->update(Frame{});
    engine->update(Frame{});
    EXPECT_FALSE(std::filesystem::exists(fst));
    for (int i = 0; i < 8; ++i) engine->update(Frame{});
  }
  // A frame takes six cycles and one to take its decision, of 10 ns each; the last dump is at the
  // rising edge in the middle of a cycle.
  const auto [first, last] = times_of(fst);
  EXPECT_EQ(last - first, 3 * 70U - 5U);
  EXPECT_THROW(make_rtl_engine(saved.model, saved.memories, {.trace = "/no/such/folder/x.fst"})->update(Frame{}), InputError);
}

}  // namespace
}  // namespace slipbench::hd::rtl_engine_test
