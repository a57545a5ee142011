#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "sim/core/process/interrupted.h"
#include "tests/expect.h"
#include "tests/tools/base/record/test_records.h"
#include "tests/tools/program/train/small_dataset.h"
#include "tools/studies/hd_papillarray/hd_tables.h"
#include "tools/studies/study_catalogue.h"

namespace slipbench::reproduce {
namespace {

class Table1Test : public ::slipbench::testing::SmallDatasetTest {};

// On a given dataset: what needs fresh ones is left out.
TEST_F(Table1Test, IsTheSameOnAnyNumberOfThreads) {
  ReproduceOptions options;
  options.data = dataset();
  options.jobs = 1;
  const Result one = hd_table1(options);
  options.jobs = 3;
  const Result three = hd_table1(options);
  EXPECT_EQ(result_page("t", one), result_page("t", three));
  EXPECT_EQ(one.figures, three.figures);

  ASSERT_THAT(one.tables, SizeIs(4));
  EXPECT_THAT(one.tables[0].rows, SizeIs(5));  // four models, and the best constant answer
  for (const ResultTable& table : one.tables) EXPECT_THAT(table.rows, Each(SizeIs(table.head.size()))) << table.title;
  EXPECT_EQ(one.tables[0].rows[3][0], "CL-gstHDC");
  EXPECT_EQ(one.tables[0].head[1], "recall of slip");
  EXPECT_EQ(one.tables[0].head[4], "accuracy: paper");
  EXPECT_EQ(one.tables[0].rows[3][4], "91.78 +- 0.53");
  EXPECT_EQ(one.tables[0].rows[4][2], "33.33") << "of a constant answer, in three classes";
  EXPECT_THAT(one.setup[0], HasSubstr("data.h5"));
  EXPECT_FALSE(one.figures.contains("scatter"));
  // The model of the first row of the causes is that of the ablation.
  EXPECT_EQ(one.figures["causes"]["as published"], one.figures["by_sequence"]);
}

// The signal comes while the folder is there, and before the sweep that would fill it.
TEST_F(Table1Test, AnInterruptLeavesNoFolderBehind) {
  std::filesystem::create_directory(path("tmp"));
  const char* const before = std::getenv("TMPDIR");
  const std::string kept = before == nullptr ? "" : before;
  ::setenv("TMPDIR", path("tmp").c_str(), 1);
  ReproduceOptions options;
  options.say = [&](const std::string&) {
    EXPECT_FALSE(std::filesystem::is_empty(path("tmp")));
    std::raise(SIGINT);
  };
  EXPECT_THROW(hd_table1(options), Interrupted);
  before == nullptr ? ::unsetenv("TMPDIR") : ::setenv("TMPDIR", kept.c_str(), 1);
  EXPECT_TRUE(std::filesystem::is_empty(path("tmp")));
}

// On a given dataset nothing is simulated, and the models are what is cut short.
TEST_F(Table1Test, AnInterruptEndsTheModels) {
  ReproduceOptions options;
  options.data = dataset();
  std::size_t variants = 0;
  options.say = [&](const std::string&) {
    if (++variants == 2) std::raise(SIGTERM);
  };
  EXPECT_THROW(hd_table1(options), Interrupted);
  EXPECT_EQ(variants, 2U);
}

Json figure(const Json& value) { return {{"value", value}, {"low", nullptr}, {"high", nullptr}}; }

// Ten trials: eight slip, of which five are seen, two early and one is missed; one of the two others has a false alarm.
TEST(GruFigures, ArePlainCountsOfTheTrials) {
  const Json result{{"all",
                     {{"trials", 10},
                      {"slipping", 8},
                      {"seen", 5},
                      {"early", 2},
                      {"missed", 1},
                      {"false_alarms", 1},
                      {"figures",
                       {{"balanced_slip_accuracy", figure(0.9)},
                        {"auc", figure(0.95)},
                        {"delay_median_s", figure(0.05)},
                        {"delay_p10_s", figure(nullptr)},
                        {"delay_p90_s", figure(0.1)},
                        {"false_alarms_per_minute", figure(3.0)}}}}}};
  const Json figures = gru_figures(result);
  EXPECT_EQ(right_share(figures, false), 0.6) << "five seen, and one that is rightly quiet";
  EXPECT_EQ(right_share(figures, true), 0.8);
  EXPECT_EQ(figures.at("balanced_accuracy"), 0.9);
  EXPECT_EQ(figures.at("delay_p90_s"), 0.1);
  EXPECT_TRUE(figures.at("delay_p10_s").is_null());
}

TEST(HdTable3, UnknownRowsGetTheNearest) {
  ReproduceOptions options;
  options.only = {"gru_latch"};
  EXPECT_THAT(refusal_of([&] { hd_table3(options); }), HasSubstr("did you mean 'gru_latched'"));
}

struct CoreFiguresTest : ::slipbench::testing::FolderTest {
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
