// What a network's metadata may say, and what is said of the rest.

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

// `full` with one text for another, which it must hold.
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
  // Every digit of a number: 0.1 is the double nearest to it, and nothing rounder.
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
  const std::vector<std::pair<std::string, std::string>> wrong{
      {"[]", "net.onnx: an array of 0; allowed: an object"},
      {"{", "net.onnx: is no JSON"},
      {with("\"format\": 1", "\"format\": 2"), "net.onnx: format: 2; allowed: 1"},
      {with("\"format\": 1,", ""), "net.onnx: has no key 'format', which must be there"},
      {with("\"stride\"", "\"strid\""), "net.onnx: input: unknown key 'strid'; did you mean 'stride'? allowed: sensor, rate"},
      {with("\"threshold\"", "\"treshold\""), "net.onnx: unknown key 'treshold'; did you mean 'threshold'?"},
      {with("\"median\": 3", "\"window\": 3"), "net.onnx: key 'window' stands twice in one object"},
      {with("\"piezo_skin\"", "\"\""), "input.sensor: ''; allowed: a text that is not empty"},
      {with("10000", "0"), "input.rate: 0; allowed: a number of Hz above 0, to 1e9"},
      {with("[{\"name\": \"signal\", \"values\": [0]}]", "[]"), "input.channels: an array of 0; allowed: one channel at least"},
      {with("\"values\": [0]", "\"values\": []"), "input.channels.values: an array of 0; allowed: one value at least"},
      {with("\"values\": [0]", "\"values\": [-1]"), "input.channels.values: -1; allowed: a whole number, 0 to 999999"},
      {with("\"values\": [0]", "\"value\": [0]"), "input.channels: unknown key 'value'; did you mean 'values'?"},
      {with("\"median\": 3", "\"median\": 2.5"), "input.median: 2.5; allowed: a whole number, 1 to 1000000"},
      {with("\"window\": 200", "\"window\": 0"), "input.window: 0; allowed: a whole number, 1 to 1000000"},
      {with("\"stride\": 100", "\"stride\": 1e300"), "input.stride: 1e+300; allowed: a whole number, 1 to 1000000"},
      {with("\"centre\": true", "\"centre\": 1"), "input.centre: 1; allowed: true, false"},
      {with("log_psd", "log_pds"), "input.transform: 'log_pds'; did you mean 'log_psd'? allowed: samples, log_psd, amplitude"},
      {with("\"low\": 50,", ""), "input: has no key 'low', which must be there"},
      {with("\"high\": 600", "\"high\": 6000"), "input.high: 6000; allowed: 0 Hz to 5 kHz, half the rate"},
      {with("\"low\": 50, \"high\": 600", "\"low\": 51, \"high\": 99"),
       "input.high: no bin of the spectrum lies between 51 Hz and 99 Hz; allowed: a band that holds a multiple of 50 Hz"},
      {with("1e-3", "0"), "input.floor: 0; allowed: a number above 0"},
      {with("log_psd", "samples"), "input.low: belongs to a spectrum; allowed: with transform log_psd or amplitude"},
      {with("log_psd", "amplitude"),
       "input.floor: belongs to a density, to spreads, levels and units; allowed: with transform log_psd or one of these"},
      {with("[[0], []]", "[]"), "input.pixels: an array of 0; allowed: one pixel at least"},
      {with("[1.5]", "[1e39]"), "input.offset: 1e+39; allowed: numbers that a float32 can hold"},
      {with("[0.25]", "0.25"), "input.scale: 0.25; allowed: an array"},
      {with("{\"input\": \"h\", \"output\": \"h_next\"}",
            "{\"input\": \"h\", \"output\": \"a\"}, {\"input\": \"h\", \"output\": \"b\"}"),
       "states.input: 'h' twice; allowed: each name once"},
      {with("\"probabilities\"", "\"logit\""), "output: 'logit'; did you mean 'logits'? allowed: logits, probabilities"},
      {with("{\"name\": \"hold\", \"state\": \"non_slip\"}, ", ""), "classes: an array of 1; allowed: 2 to 1000"},
      {with("\"gross\"", "\"gros\""),
       "classes.state: 'gros'; did you mean 'gross'? allowed: no_contact, non_slip, incipient, gross"},
      {with("\"gross\"", "\"no_contact\""), "classes: none slips; allowed: one class at least with the state incipient or gross"},
      {with("\"non_slip\"", "\"incipient\""),
       "classes: all slip; allowed: one class at least with the state no_contact or non_slip"},
      {with("\"hold\"", "\"slip\""), "classes.name: 'slip' twice; allowed: each name once"},
      {with("\"on\": 2", "\"on\": 0"), "alarm.on: 0; allowed: a whole number, 1 to 1000000"},
      {with("\"off\": 5", "\"offs\": 5"), "alarm: unknown key 'offs'; did you mean 'off'? allowed: on, off, least"},
      {with("\"floor\"", "\"spans\": [3], \"floor\""),
       "input.spans: belongs to spreads, levels and units; allowed: with one of these transforms"},
      {R"({"format": 1, "input": {"sensor": "s", "rate": 1, "channels": [{"name": "c"}], "window": 2, "transform": "spreads", "spans": [1]}})",
       "input.spans: a span of fewer than two samples"},
      {R"({"format": 1, "input": {"sensor": "s", "rate": 1, "channels": [{"name": "c"}], "window": 2, "transform": "levels"}})",
       "input: has no key 'spans', which must be there"},
      {with("0.75", "0"), "threshold: 0; allowed: a number above 0, to 1"},
      {with("{\"recipe\": \"fft-gru\"}", "[]"), "trained: an array of 0; allowed: an object"},
      {with("{\"recipe\": \"fft-gru\"}", "{\"a\":" + std::string(40, '[') + std::string(40, ']') + "}"),
       "JSON nested more than 32 deep"},
  };
  for (const auto& [text, message] : wrong) EXPECT_THAT(refusal(text), HasSubstr(message));
}

TEST(Description, ADeepNestIsRefusedBeforeItIsFollowed) {
  EXPECT_THAT(refusal(std::string(1'000'000, '[')), HasSubstr("nested more than 32 deep"));
}

}  // namespace
}  // namespace slipbench::network
