#include "tools/studies/hd_papillarray/hd_tables.h"

#include <fstream>

#include "tests/expect.h"
#include "tests/tools/base/record/test_records.h"

namespace slipbench::reproduce {
namespace {

class CoreFiguresTest : public ::slipbench::testing::FolderTest {
 protected:
  CoreFigures read(const std::string& text) {
    std::ofstream(path("results.json")) << text;
    return read_core_figures(path("results.json"));
  }
  std::string refusal(const std::string& text) {
    return refusal_of([&] { read(text); });
  }
};

TEST_F(CoreFiguresTest, HaveTheOrderOfTheFile) {
  const CoreFigures figures = read(R"json({"tools": {"yosys": "Yosys 0.70 (git sha1 28b)"}, "window": 15, "unrollings": {
    "small": {"latency_cycles": 37, "interval_cycles": 20, "lut": 20000, "ff": 9000, "bram36": 28.5, "dsp": 3, "levels": 18, "cells": {}},
    "big": {"latency_cycles": 10, "interval_cycles": 1, "lut": 60000, "ff": 30000, "bram36": 0, "dsp": 27, "levels": 21}}})json");
  EXPECT_EQ(figures.tool, "Yosys 0.70");
  ASSERT_THAT(figures.configurations, SizeIs(2));
  const CoreConfiguration& small = figures.configurations[0];
  EXPECT_EQ(small.name, "small");
  EXPECT_EQ(small.cycles, 37U);
  EXPECT_EQ(small.interval, 20U);
  EXPECT_EQ(small.lut, 20000);
  EXPECT_EQ(small.ff, 9000);
  EXPECT_EQ(small.bram, 28.5);
  EXPECT_EQ(small.dsp, 3);
  EXPECT_EQ(small.levels, 18);
  EXPECT_EQ(figures.configurations[1].name, "big");
}

TEST_F(CoreFiguresTest, WhatIsMissingIsNamed) {
  EXPECT_THAT(refusal("not json"), AllOf(HasSubstr("results.json"), HasSubstr("is no JSON object")));
  EXPECT_THAT(refusal("{}"), HasSubstr("tools is no object"));
  EXPECT_THAT(refusal(R"({"tools": {}})"), HasSubstr("tools: yosys is no text"));
  EXPECT_THAT(refusal(R"({"tools": {"yosys": "0.70"}, "unrollings": {}})"), HasSubstr("unrollings is no object"));
  EXPECT_THAT(refusal(R"({"tools": {"yosys": "0.70"}, "unrollings": {"big": {"latency_cycles": 10, "interval_cycles": 1}}})"),
              HasSubstr("unrolling 'big': lut is missing; allowed: a number from 0 on"));
  EXPECT_THAT(refusal(R"({"tools": {"yosys": "0.70"}, "unrollings": {"big": {"latency_cycles": -1}}})"),
              HasSubstr("latency_cycles is '-1'"));
  EXPECT_THAT(refusal_of([&] { read_core_figures(path("none.json")); }), HasSubstr("none.json: cannot be read"));
}

}  // namespace
}  // namespace slipbench::reproduce
