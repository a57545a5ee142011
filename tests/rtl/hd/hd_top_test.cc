// The board's interface: frames on a UART, bit by bit, at eight clocks per bit, with the published
// memories read from their files.
#include <VTop.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "detectors/hd/memory_files.h"
#include "sim/core/random.h"
#include "tests/detectors/hd/published.h"

namespace slipbench::hd {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr unsigned clk_per_bit = 8;
constexpr unsigned request_bytes = 58;
constexpr unsigned reply_bytes = 10;

// CRC-16 with polynomial 0x1021 and start 0xFFFF, the highest bit first.
std::uint16_t crc_of(const Bytes& bytes) {
  unsigned crc = 0xFFFF;
  for (const std::uint8_t byte : bytes) {
    crc ^= unsigned{byte} << 8;
    for (int bit = 0; bit < 8; ++bit) crc = (crc << 1) ^ ((crc & 0x8000U) != 0 ? 0x11021U : 0U);
  }
  return static_cast<std::uint16_t>(crc);
}

// The catalogue of CRCs gives 0x29B1 for the digits 1 to 9 (CRC-16/IBM-3740).
TEST(HdTopTest, HasTheRightCrc) { EXPECT_EQ(crc_of({'1', '2', '3', '4', '5', '6', '7', '8', '9'}), 0x29B1); }

Bytes with_crc(std::uint8_t mark, Bytes body) {
  const std::uint16_t crc = crc_of(body);
  body.insert(body.begin(), mark);
  body.push_back(static_cast<std::uint8_t>(crc >> 8));
  body.push_back(static_cast<std::uint8_t>(crc));
  return body;
}

Bytes request_of(const FixedFrame& sample, std::uint8_t flags = 0) {
  Bytes body{flags};
  for (const FixedVector& displacement : sample) {
    for (const std::int16_t value : displacement) {
      body.push_back(static_cast<std::uint8_t>(value));
      body.push_back(static_cast<std::uint8_t>(static_cast<std::uint16_t>(value) >> 8));
    }
  }
  return with_crc(0xA5, body);
}

Bytes reply_of(std::uint8_t status, const Decision& decision = {}) {
  Bytes body{status};
  for (const std::uint16_t distance : decision.distance) {
    body.push_back(static_cast<std::uint8_t>(distance));
    body.push_back(static_cast<std::uint8_t>(distance >> 8));
  }
  return with_crc(0x5A, body);
}

// The board and both ends of its line.
struct HdTop : testing::Test {
  HdTop() {
    top_->uart_rx_i = 1;
    top_->rst_ni = 1;
    top_->eval();  // from here on, changes are edges
    reset();
  }

  void reset() {
    top_->rst_ni = 0;
    clock();
    top_->rst_ni = 1;
    received_.clear();
    bit_ = 0;
  }

  // Sends bytes; with `break_last` the last one has no stop bit.
  void send(const Bytes& bytes, bool break_last = false) {
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      line(false);
      for (int bit = 0; bit < 8; ++bit) line((bytes[i] >> bit & 1) != 0);
      line(!break_last || i + 1 < bytes.size());
    }
    top_->uart_rx_i = 1;
  }

  // Keeps the line idle for `bytes` byte times and `clocks` clocks.
  void wait(unsigned bytes, unsigned clocks = 0) {
    for (unsigned i = 0; i < 10 * bytes; ++i) line(true);
    for (unsigned i = 0; i < clocks; ++i) clock();
  }

  // Returns the bytes received since the last call, after time for a pause to be noticed (three
  // bytes) and for two replies.
  Bytes received() {
    wait(3 + 2 * reply_bytes + 1);
    return std::exchange(received_, {});
  }

  FixedFrame sample() {
    FixedFrame frame;
    for (FixedVector& displacement : frame) {
      for (std::int16_t& value : displacement) value = static_cast<std::int16_t>(static_cast<int>(random_.integer(40)) - 20);
    }
    return frame;
  }

  Bytes answer_of(const FixedFrame& sample) {
    const Decision decision = golden_->update(quantise(sample));
    return reply_of(static_cast<std::uint8_t>(decision.state), decision);
  }

  // Sends enough good samples to fill the window and checks each answer.
  void fill() {
    for (std::size_t i = 0; i < saved_.model.window; ++i) {
      const FixedFrame displacement = sample();
      send(request_of(displacement));
      ASSERT_EQ(received(), answer_of(displacement)) << "sample " << i;
    }
  }

  void expect_error(std::uint8_t status) {
    EXPECT_EQ(received(), reply_of(status));
    // The window is unchanged.
    const FixedFrame displacement = sample();
    send(request_of(displacement));
    EXPECT_EQ(received(), answer_of(displacement));
  }

  SavedModel saved_ = load(published_folder, published_model("P1"));
  std::unique_ptr<Engine> golden_ = make_reference(saved_.model, saved_.memories);

 private:
  void line(bool level) {
    top_->uart_rx_i = level;
    for (unsigned i = 0; i < clk_per_bit; ++i) clock();
  }

  void clock() {
    top_->clk_i = 1;
    top_->eval();
    top_->clk_i = 0;
    top_->eval();
    listen(top_->uart_tx_o != 0);
  }

  // Samples the board's output in the middle of each bit.
  void listen(bool level) {
    if (bit_ == 0) {
      if (level) return;
      bit_ = 1;
      timer_ = clk_per_bit + clk_per_bit / 2;
      byte_ = 0;
    }
    if (--timer_ != 0) return;
    timer_ = clk_per_bit;
    if (bit_ == 9) {
      EXPECT_TRUE(level) << "a byte without a stop bit";
      received_.push_back(byte_);
      bit_ = 0;
    } else {
      byte_ = static_cast<std::uint8_t>(byte_ | unsigned{level} << (bit_ - 1));
      ++bit_;
    }
  }

  VerilatedContext context_;
  std::unique_ptr<VTop> top_ = std::make_unique<VTop>(&context_);
  RandomStream random_{1, 0, "hd_top test"};
  Bytes received_;
  unsigned bit_ = 0;
  unsigned timer_ = 0;
  std::uint8_t byte_ = 0;
};

TEST_F(HdTop, AnswersEverySampleWithItsDecision) {
  fill();
  for (int i = 0; i < 10; ++i) {
    const FixedFrame displacement = sample();
    send(request_of(displacement));
    EXPECT_EQ(received(), answer_of(displacement));
  }
}

TEST_F(HdTop, AnswersSamplesThatFollowAtOnce) {
  Bytes expected;
  for (int i = 0; i < 20; ++i) {
    const FixedFrame displacement = sample();
    send(request_of(displacement));
    const Bytes answer = answer_of(displacement);
    expected.insert(expected.end(), answer.begin(), answer.end());
  }
  EXPECT_EQ(received(), expected);
}

TEST_F(HdTop, StartsAWindowWhenTheFlagIsSet) {
  fill();
  golden_->reset();
  const FixedFrame displacement = sample();
  send(request_of(displacement, 1));
  const Bytes answer = answer_of(displacement);
  ASSERT_EQ(answer, reply_of(0));
  EXPECT_EQ(received(), answer);
  fill();
}

TEST_F(HdTop, IgnoresBytesOutsideAFrame) {
  fill();
  send({0x00, 0x5A, 0xFF});
  const FixedFrame displacement = sample();
  send(request_of(displacement));
  EXPECT_EQ(received(), answer_of(displacement));
}

TEST_F(HdTop, SaysWhenTheChecksumIsWrong) {
  fill();
  Bytes request = request_of(sample());
  request[20] ^= 0x10;
  send(request);
  expect_error(0x80);
}

TEST_F(HdTop, SaysWhenAFrameStops) {
  fill();
  Bytes request = request_of(sample());
  request.resize(30);
  send(request);
  expect_error(0x81);
}

TEST_F(HdTop, SaysWhenAByteHasNoStopBit) {
  fill();
  Bytes request = request_of(sample());
  request.resize(30);
  send(request, true);
  expect_error(0x81);
}

TEST_F(HdTop, SaysWhenAFlagIsUnknown) {
  fill();
  send(request_of(sample(), 0x02));
  expect_error(0x82);
}

// Two idle bytes are not a pause, one clock more is; before the last byte, and before another one.
TEST_F(HdTop, TakesAPauseOfTwoBytesWithinAFrame) {
  fill();
  for (const std::ptrdiff_t before : {request_bytes - 1, request_bytes - 20}) {
    const FixedFrame displacement = sample();
    const Bytes request = request_of(displacement);
    send({request.begin(), request.begin() + before});
    wait(2);
    send({request.begin() + before, request.end()});
    EXPECT_EQ(received(), answer_of(displacement)) << "before byte " << before;
  }
}

TEST_F(HdTop, GivesUpAfterAPauseOfMore) {
  fill();
  const Bytes request = request_of({});  // zeros: no mark in the rest
  send({request.begin(), request.end() - 20});
  wait(2, 1);
  send({request.end() - 20, request.end()});
  expect_error(0x81);
}

// Marks among zeros, where a receiver soon finds the start of a frame again.
FixedFrame full_of_marks() {
  FixedFrame frame;
  frame.fill({0, 0, 0xA5});
  return frame;
}

TEST_F(HdTop, ReadsNothingFromTheRestOfABrokenFrame) {
  fill();
  const Bytes request = request_of(full_of_marks());
  send({request.begin(), request.begin() + 20}, true);
  send({request.begin() + 20, request.end()});
  expect_error(0x81);
}

// The mark of the second request is taken for the byte that the first one lacks.
TEST_F(HdTop, ReadsNothingFromARequestThatFollowsAnErrorAtOnce) {
  fill();
  Bytes request = request_of(sample());
  request.erase(request.begin() + 30);
  send(request);
  send(request_of(full_of_marks()));
  expect_error(0x80);
}

TEST_F(HdTop, ReadsARequestThatFollowsAnErrorAfterAPause) {
  fill();
  Bytes bad = request_of(sample());
  bad[20] ^= 0x10;
  send(bad);
  wait(2);
  send(request_of(sample()));
  EXPECT_EQ(received(), reply_of(0x80)) << "a time of two bytes is too short for a pause";

  send(bad);
  wait(2, 1);
  const FixedFrame displacement = sample();
  send(request_of(displacement));
  Bytes expected = reply_of(0x80);
  const Bytes answer = answer_of(displacement);
  expected.insert(expected.end(), answer.begin(), answer.end());
  EXPECT_EQ(received(), expected);
}

TEST_F(HdTop, StartsAfreshAfterAResetWithinAFrame) {
  fill();
  Bytes request = request_of(sample());
  request.resize(request_bytes / 2);
  send(request);
  reset();
  golden_->reset();
  EXPECT_EQ(received(), Bytes{});
  fill();
}

}  // namespace
}  // namespace slipbench::hd
