#include "tools/dataset/record/encoder.h"

#include <atomic>
#include <stdexcept>

#include <gtest/gtest.h>
#include <zlib.h>

#include "sim/core/process/interrupted.h"
#include "sim/core/random.h"
#include "tests/tools/dataset/record/test_records.h"

namespace slipbench::testing {
namespace {

const EncodedArray& array_of(const EncodedTrial& trial, const std::string& path) {
  for (const EncodedArray& array : trial.arrays) {
    if (array.path == path) return array;
  }
  throw std::runtime_error("no array " + path);
}

// Undoes deflate with zlib.
std::vector<std::uint8_t> inflated(const std::vector<std::uint8_t>& chunk, std::size_t bytes) {
  std::vector<std::uint8_t> values(bytes);
  uLongf size = bytes;
  EXPECT_EQ(::uncompress(values.data(), &size, chunk.data(), chunk.size()), Z_OK);
  EXPECT_EQ(size, bytes);
  return values;
}

// Undoes deflate, then HDF5's shuffle of 4-byte elements.
std::vector<float> decoded(const std::vector<std::uint8_t>& chunk, std::size_t count) {
  const std::vector<std::uint8_t> shuffled = inflated(chunk, 4 * count);
  std::vector<float> values(count);
  auto* bytes = reinterpret_cast<std::uint8_t*>(values.data());
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t byte = 0; byte < 4; ++byte) bytes[4 * i + byte] = shuffled[byte * count + i];
  }
  return values;
}

TEST(TrialEncoder, PutsASmallArrayInOneChunk) {
  const TrialRecord record = make_record(3, 50);
  const EncodedTrial trial = TrialEncoder().encode(record);
  const EncodedArray& force = array_of(trial, "sensors/pad/force");
  EXPECT_EQ(force.shape, (std::vector<std::size_t>{50, 2}));
  EXPECT_EQ(force.chunk_rows, 50U);
  ASSERT_EQ(force.chunks.size(), 1U);
  EXPECT_EQ(decoded(force.chunks[0], 100), record.sensors[0].channels[0].values);
}

// A zlib stream is larger than such values: 2 bytes of header, 5 of a stored block and 4 of
// checksum. libdeflate 1.23 (Debian 13) gives a bound for the stored block alone, without the
// margin that 1.14 (Debian 12) adds.
TEST(TrialEncoder, KeepsArraysOfAFewBytesOfNoise) {
  RandomStream stream(1, 0, "noise");
  for (std::size_t rows = 1; rows <= 40; ++rows) {
    TrialRecord record = make_record(0, rows);
    for (std::uint8_t& state : record.sensors[0].labels.state_paper)
      state = static_cast<std::uint8_t>(stream.uniform(0.0, 256.0));
    const EncodedTrial trial = TrialEncoder().encode(record);
    const EncodedArray& state = array_of(trial, "labels/pad/state_paper");
    ASSERT_EQ(state.chunks.size(), 1U);
    EXPECT_EQ(inflated(state.chunks[0], rows), record.sensors[0].labels.state_paper) << rows;
    EXPECT_EQ(decoded(array_of(trial, "labels/pad/margin").chunks.at(0), 2 * rows), record.sensors[0].labels.margin) << rows;
  }
}

TEST(TrialEncoder, StoresBytesOfNoiseAsTheyAre) {
  // From 1 to 2 the lower two bytes of a float are noise, and the third has seven random bits.
  constexpr std::size_t rows = 20'000, count = 2 * rows;
  TrialRecord record = make_record(0, rows);
  std::vector<float>& force = record.sensors[0].channels[0].values;
  RandomStream stream(1, 0, "noise");
  for (float& value : force) value = static_cast<float>(stream.uniform(1.0, 1.999));
  const std::vector<std::uint8_t> chunk = array_of(TrialEncoder().encode(record), "sensors/pad/force").chunks.at(0);
  EXPECT_EQ(decoded(chunk, count), force);
  // RFC 1951: a stored block that is not the last one, its length, and its inverted length.
  EXPECT_EQ(std::vector(chunk.begin() + 2, chunk.begin() + 7), (std::vector<std::uint8_t>{0, 0xFF, 0xFF, 0, 0}));
  EXPECT_LT(chunk.size(), count * (8 + 8 + 7 + 1) / 8);
}

TEST(TrialEncoder, GivesTheBytesOfATrialWhateverCameBefore) {
  TrialRecord moved = make_record(0, 50);
  moved.bodies[0].velocity.back() += 1.0F;
  TrialEncoder encoder;
  for (const TrialRecord& record : {make_record(0, 50), make_record(1, 50), moved, make_record(0, 60), make_record(0, 50)}) {
    const EncodedTrial trial = encoder.encode(record), alone = TrialEncoder().encode(record);
    for (std::size_t i = 0; i < alone.arrays.size(); ++i) EXPECT_EQ(trial.arrays[i].chunks, alone.arrays[i].chunks);
  }
}

// Compressing a large record takes seconds.
TEST(TrialEncoder, EndsAtAnInterrupt) {
  const std::atomic<bool> interrupt{true};
  const InterruptScope scope(&interrupt);
  EXPECT_THROW(TrialEncoder().encode(make_record(0, 50)), Interrupted);
}

TEST(TrialEncoder, CutsALargeArrayAndPadsTheLastChunk) {
  // labels/pad/force: 2 units, 3 axes, 4 bytes: 24 bytes per row. 100,001 rows are 2.29 MiB: 3
  // chunks of 33,334 rows, with one row padded.
  const TrialRecord record = make_record(0, 100'001);
  const EncodedTrial trial = TrialEncoder().encode(record);
  const EncodedArray& force = array_of(trial, "labels/pad/force");
  EXPECT_EQ(force.chunk_rows, 33'334U);
  ASSERT_EQ(force.chunks.size(), 3U);
  std::vector<float> all;
  for (const auto& chunk : force.chunks) {
    const std::vector<float> part = decoded(chunk, 33'334 * 6);
    all.insert(all.end(), part.begin(), part.end());
  }
  for (std::size_t i = 100'001 * 6; i < all.size(); ++i) EXPECT_EQ(all[i], 0.0F);
  all.resize(100'001 * 6);
  EXPECT_EQ(all, record.sensors[0].labels.force);
}

TEST(TrialEncoder, ListsArraysInOrderOfPath) {
  const EncodedTrial trial = make_trial(0, 10);
  for (std::size_t i = 1; i < trial.arrays.size(); ++i) EXPECT_LT(trial.arrays[i - 1].path, trial.arrays[i].path);
}

TEST(TrialEncoder, TakesTrialsWithoutEvents) {
  TrialRecord record = make_record(0, 10);
  record.sensors[0].labels.event_time.clear();
  record.sensors[0].labels.event_unit.clear();
  record.sensors[0].labels.event_kind.clear();
  EXPECT_TRUE(array_of(TrialEncoder().encode(record), "labels/pad/events/t").chunks.empty());
}

TEST(TrialEncoder, RefusesAColumnOfTheWrongLength) {
  TrialRecord record = make_record(0, 10);
  record.sensors[0].labels.margin.pop_back();
  EXPECT_THAT(refusal_of<std::logic_error>([&] { TrialEncoder().encode(record); }),
              refused_at("labels/pad/margin", {"19", "10"}));
}

TEST(TrialEncoder, DigestFollowsEveryByte) {
  const Digest digest = make_trial(0, 10).digest;
  EXPECT_EQ(make_trial(0, 10).digest, digest);
  TrialRecord record = make_record(0, 10);
  record.bodies[0].velocity.back() += 1.0F;
  EXPECT_NE(TrialEncoder().encode(record).digest, digest);
  record = make_record(0, 10);
  record.sensors[0].channels[0].name = "forces";
  EXPECT_NE(TrialEncoder().encode(record).digest, digest);
  record = make_record(0, 10);
  record.sensors[0].labels.onset_time[1] = 1.2345;
  EXPECT_NE(TrialEncoder().encode(record).digest, digest);
  record = make_record(0, 10);
  record.params = "{}";
  EXPECT_NE(TrialEncoder().encode(record).digest, digest);
}

TEST(ContentDigest, IsSha256) {
  // FIPS 180-4: SHA-256 of the empty message.
  EXPECT_EQ(content_digest({}), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_NE(content_digest({Digest{1}, Digest{2}}), content_digest({Digest{2}, Digest{1}}));
}

}  // namespace
}  // namespace slipbench::testing
