// Valid metadata of a network, and the errors for the rest.

#include <string>
#include <utility>
#include <vector>

#include "detectors/network/description.h"
#include "tests/expect.h"

namespace slipbench::network {
namespace {

constexpr const char* full = R"({"format": 1,
  "input": {"sensor": "piezo_skin", "rate": 10000, "channels": [{"name": "signal", "values": [0]}], "median": 3, "window": 200,
            "stride": 100, "centre": true, "transform": "log_psd", "low": 50, "high": 600, "hann": true, "floor": 1e-3,
            "pixels": [[0], []], "offset": [1.5], "scale": [0.25], "history": 4},
  "states": [{"input": "h", "output": "h_next"}], "output": "probabilities",
  "classes": [{"name": "hold", "state": "non_slip"}, {"name": "slip", "state": "gross"}],
  "threshold": 0.75, "alarm": {"on": 2, "off": 5, "least": 9}, "trained": {"recipe": "fft-gru"}})";

// Returns `full` with `from`, which it must contain, replaced by `to`.
std::string with(const std::string& from, const std::string& to) {
  std::string text = full;
  const std::size_t at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("the example has no " + from);
  return text.replace(at, from.size(), to);
}

std::string refusal(const std::string& text) {
  return refusal_of([&] { parse_description(text, "net.onnx"); });
}

TEST(Description, HoldsWhatTheTextSays) {
  const Description d = parse_description(full, "net.onnx");
  EXPECT_EQ(d.input.sensor, "piezo_skin");
  EXPECT_EQ(d.input.rate, 10000.0);
  ASSERT_EQ(d.input.channels.size(), 1u);
  EXPECT_EQ(d.input.channels[0].name, "signal");
  EXPECT_THAT(d.input.channels[0].values, ElementsAre(0u));
  EXPECT_EQ(d.input.median, 3u);
  EXPECT_EQ(d.input.window, 200u);
  EXPECT_EQ(d.input.stride, 100u);
  EXPECT_TRUE(d.input.centre);
  EXPECT_EQ(d.input.transform, Transform::log_psd);
  EXPECT_EQ(d.input.low, 50.0);
  EXPECT_EQ(d.input.high, 600.0);
  EXPECT_TRUE(d.input.hann);
  EXPECT_EQ(d.input.floor, 1e-3);
  EXPECT_THAT(d.input.pixels, ElementsAre(ElementsAre(0u), ElementsAre()));
  EXPECT_THAT(d.input.offset, ElementsAre(1.5));
  EXPECT_THAT(d.input.scale, ElementsAre(0.25));
  EXPECT_EQ(d.input.history, 4u);
  ASSERT_EQ(d.states.size(), 1u);
  EXPECT_EQ(d.states[0].input, "h");
  EXPECT_EQ(d.states[0].output, "h_next");
  EXPECT_EQ(d.output, Output::probabilities);
  ASSERT_EQ(d.classes.size(), 2u);
  EXPECT_EQ(d.classes[1].name, "slip");
  EXPECT_EQ(d.classes[1].state, PadState::gross);
  EXPECT_EQ(d.threshold, 0.75);
  EXPECT_EQ(d.alarm.on, 2u);
  EXPECT_EQ(d.alarm.off, 5u);
  EXPECT_EQ(d.alarm.least, 9u);
  EXPECT_EQ(d.trained, R"({"recipe":"fft-gru"})");
}

TEST(Description, WhatIsLeftOutIsTheDefault) {
  const Description d = parse_description(example_description(), "net.onnx");
  const Description defaults;
  EXPECT_TRUE(d.input.channels.at(0).values.empty());
  EXPECT_EQ(d.input.median, 1u);
  EXPECT_EQ(d.input.history, 1u);
  EXPECT_EQ(d.input.transform, Transform::samples);
  EXPECT_TRUE(d.states.empty());
  EXPECT_EQ(d.output, Output::logits);
  EXPECT_EQ(d.threshold, defaults.threshold);
  EXPECT_EQ(d.trained, "{}");
}

TEST(Description, IsReadAsItWasWritten) {
  for (const std::string& text : {std::string(full), example_description()}) {
    const std::string written = description_text(parse_description(text, "net.onnx"));
    EXPECT_EQ(description_text(parse_description(written, "net.onnx")), written);
  }
  // Numbers keep every digit: 0.1 is the double nearest to it, not rounded further.
  Description d = parse_description(full, "net.onnx");
  d.input.offset = {0.1, 1.0 / 3.0};
  EXPECT_EQ(parse_description(description_text(d), "net.onnx").input.offset, d.input.offset);
}

TEST(Description, AFrameIsTheWindowsValuesOrBins) {
  Input input = parse_description(full, "net.onnx").input;
  EXPECT_EQ(frame_size(input, 3), 2u * 12u);  // two pixels; bins of 10 kHz/200 = 50 Hz from 50 to 600 Hz
  input.pixels.clear();
  EXPECT_EQ(frame_size(input, 3), 3u * 12u);
  input.transform = Transform::samples;
  EXPECT_EQ(frame_size(input, 3), 200u * 3u);
}

TEST(Description, SaysWhatIsWrong) {
  const std::vector<Refused<>> wrong{
      {"[]", "net.onnx", {"array of 0", "object"}},
      {"{", "net.onnx", {"not valid JSON"}},
      {with("\"format\": 1", "\"format\": 2"), "net.onnx", {"format", "2", "1"}},
      {with("\"format\": 1,", ""), "net.onnx", {"format", "no key"}},
      {with("\"stride\"", "\"strid\""), "net.onnx", {"input", "strid", "stride"}},
      {with("\"threshold\"", "\"treshold\""), "net.onnx", {"treshold", "threshold"}},
      {with("\"median\": 3", "\"window\": 3"), "net.onnx", {"window", "twice"}},
      {with("\"piezo_skin\"", "\"\""), "net.onnx", {"input.sensor", "''"}},
      {with("10000", "0"), "net.onnx", {"input.rate", "0", "1e9"}},
      {with("[{\"name\": \"signal\", \"values\": [0]}]", "[]"), "net.onnx", {"input.channels", "empty array", "one channel"}},
      {with("\"values\": [0]", "\"values\": []"), "net.onnx", {"input.channels.values", "empty array", "one value"}},
      {with("\"values\": [0]", "\"values\": [-1]"), "net.onnx", {"input.channels.values", "-1", "0", "999999"}},
      {with("\"values\": [0]", "\"value\": [0]"), "net.onnx", {"input.channels", "value", "values"}},
      {with("\"median\": 3", "\"median\": 2.5"), "net.onnx", {"input.median", "2.5", "1", "1000000"}},
      {with("\"window\": 200", "\"window\": 0"), "net.onnx", {"input.window", "0", "1", "1000000"}},
      {with("\"stride\": 100", "\"stride\": 1e300"), "net.onnx", {"input.stride", "1e+300", "1000000"}},
      {with("\"centre\": true", "\"centre\": 1"), "net.onnx", {"input.centre", "1", "true, false"}},
      {with("log_psd", "log_pds"), "net.onnx", {"input.transform", "log_pds", "log_psd"}},
      {with("\"low\": 50,", ""), "net.onnx", {"input", "no key", "low"}},
      {with("\"high\": 600", "\"high\": 6000"), "net.onnx", {"input.high", "6000", "0 Hz", "5 kHz"}},
      {with("\"low\": 50, \"high\": 600", "\"low\": 51, \"high\": 99"), "net.onnx", {"input.high", "51 Hz", "99 Hz", "50 Hz"}},
      {with("1e-3", "0"), "net.onnx", {"input.floor", "0"}},
      {with("log_psd", "samples"), "net.onnx", {"input.low", "log_psd", "amplitude"}},
      {with("log_psd", "amplitude"), "net.onnx", {"input.floor", "spreads", "log_psd"}},
      {with("[[0], []]", "[]"), "net.onnx", {"input.pixels", "empty array"}},
      {with("[1.5]", "[1e39]"), "net.onnx", {"input.offset", "1e+39"}},
      {with("[0.25]", "0.25"), "net.onnx", {"input.scale", "0.25", "array"}},
      {with("{\"input\": \"h\", \"output\": \"h_next\"}",
            "{\"input\": \"h\", \"output\": \"a\"}, {\"input\": \"h\", \"output\": \"b\"}"),
       "net.onnx",
       {"states.input", "h", "twice"}},
      {with("\"probabilities\"", "\"logit\""), "net.onnx", {"output", "logit", "logits"}},
      {with("{\"name\": \"hold\", \"state\": \"non_slip\"}, ", ""), "net.onnx", {"classes", "array of 1", "1000"}},
      {with("\"gross\"", "\"gros\""), "net.onnx", {"classes.state", "gros", "gross"}},
      {with("\"gross\"", "\"no_contact\""), "net.onnx", {"classes", "incipient", "gross"}},
      {with("\"non_slip\"", "\"incipient\""), "net.onnx", {"classes", "no_contact", "non_slip"}},
      {with("\"hold\"", "\"slip\""), "net.onnx", {"classes.name", "slip", "twice"}},
      {with("\"on\": 2", "\"on\": 0"), "net.onnx", {"alarm.on", "0", "1", "1000000"}},
      {with("\"off\": 5", "\"offs\": 5"), "net.onnx", {"alarm", "offs", "off"}},
      {with("\"floor\"", "\"spans\": [3], \"floor\""), "net.onnx", {"input.spans", "spreads, levels"}},
      {R"({"format": 1, "input": {"sensor": "s", "rate": 1, "channels": [{"name": "c"}], "window": 2, "transform": "spreads", "spans": [1]}})",
       "net.onnx",
       {"input.spans", "2 samples"}},
      {R"({"format": 1, "input": {"sensor": "s", "rate": 1, "channels": [{"name": "c"}], "window": 2, "transform": "levels"}})",
       "net.onnx",
       {"input", "no key", "spans"}},
      {with("0.75", "0"), "net.onnx", {"threshold", "0", "1"}},
      {with("{\"recipe\": \"fft-gru\"}", "[]"), "net.onnx", {"trained", "array of 0", "object"}},
      {with("{\"recipe\": \"fft-gru\"}", "{\"a\":" + std::string(40, '[') + std::string(40, ']') + "}"),
       "net.onnx",
       {"nested", "32"}},
  };
  expect_refusals(wrong, refusal);
}

TEST(Description, ADeepNestIsRefusedBeforeItIsFollowed) {
  EXPECT_THAT(refusal(std::string(1'000'000, '[')), mentions({"nested", "32"}));
}

TEST(Description, SaysTheRatesOfTheSensorsOfItsTraining) {
  const std::string ranged = with("\"history\": 4", "\"history\": 4, \"rates\": [2000, 20000]");
  const Input input = parse_description(ranged, "net.onnx").input;
  EXPECT_EQ(least_rate(input), 2000.0);
  EXPECT_EQ(rate_read(input), 10000.0);
  EXPECT_EQ(least_rate(parse_description(full, "net.onnx").input), 10000.0);
  const Description again = parse_description(description_text(parse_description(ranged, "net.onnx")), "net.onnx");
  EXPECT_EQ(again.input.slowest, 2000.0);
  EXPECT_EQ(again.input.fastest, 20000.0);
  for (const char* rates : {"[1]", "[2, 1]", "[0, 1]", "[1, 2, 3]", "[1, 2e9]"}) {
    EXPECT_THAT(refusal(with("\"history\": 4", "\"history\": 4, \"rates\": " + std::string(rates))),
                refused_at("net.onnx: input.rates", {"lowest", "highest"}));
  }
}

// A plain stride skips samples; a window, a median or a spectrum reads all of them.
TEST(Description, SaysTheRateThatIsRead) {
  Input input;
  input.rate = 1000.0;
  input.stride = 10;
  EXPECT_EQ(rate_read(input), 100.0);
  EXPECT_EQ(at_rate_read(input).rate, 100.0);
  EXPECT_EQ(at_rate_read(input).stride, 1u);
  for (const auto& change : {+[](Input& one) { one.window = 2; }, +[](Input& one) { one.median = 3; }}) {
    Input every = input;
    change(every);
    EXPECT_EQ(rate_read(every), 1000.0);
    EXPECT_EQ(at_rate_read(every).stride, 10u);
  }
}

}  // namespace
}  // namespace slipbench::network
