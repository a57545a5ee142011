#include "tools/program/cli/options.h"

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/core/error.h"

namespace slipbench {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string refusal(const std::vector<std::string>& arguments) {
  try {
    parse_options(arguments);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

std::vector<std::string> paths(const Options& options) {
  std::vector<std::string> result;
  for (const Override& change : options.overrides) result.push_back(change.path + " -> " + change.value);
  return result;
}

TEST(Options, RunTakesEverything) {
  const Options options =
      parse_options({"run", "s.yaml", "--seed", "7", "--trials", "3", "--jobs", "2", "-o", "out.h5", "--quiet"});
  EXPECT_EQ(options.command, "run");
  EXPECT_EQ(options.scene, "s.yaml");
  EXPECT_EQ(options.seed, 7U);
  EXPECT_EQ(options.trials, 3U);
  EXPECT_EQ(options.jobs, 2U);
  EXPECT_EQ(options.output, "out.h5");
  EXPECT_TRUE(options.quiet);
  EXPECT_FALSE(options.json);
}

TEST(Options, RecordSaysWhatIsWritten) {
  EXPECT_EQ(parse_options({"sweep", "s.yaml", "-o", "out.h5"}).record, Recording::full);
  EXPECT_EQ(parse_options({"sweep", "s.yaml", "-o", "out.h5", "--record", "outcome"}).record, Recording::outcome);
  EXPECT_EQ(refusal({"sweep", "s.yaml", "-o", "out.h5", "--record", "outcom"}),
            "sweep: --record is 'outcom'; did you mean 'outcome'? allowed: full, outcome");
  EXPECT_EQ(refusal({"run", "s.yaml", "--record", "outcome"}), "run: --record says what -o writes; allowed: with -o");
}

TEST(Options, CheckTakesSeveralScenes) {
  const Options options = parse_options(
      {"check", "a.yaml", "b.yaml", "--set", "seed=3", "c.yaml", "--trials", "5", "--junit", "j.xml", "-o", "left", "--quiet"});
  EXPECT_THAT(options.scenes, ElementsAre("a.yaml", "b.yaml", "c.yaml"));
  EXPECT_THAT(paths(options), ElementsAre("seed -> 3"));
  EXPECT_EQ(options.trials, 5U);
  EXPECT_EQ(options.junit, "j.xml");
  EXPECT_EQ(options.output, "left");
  EXPECT_EQ(parse_options({"run", "s.yaml", "--trial", "7"}).trial, 7U);
  EXPECT_EQ(refusal({"check", "a.yaml", "--junit", ""}), "check: --junit needs a file name");
  EXPECT_EQ(refusal({"check", "a.yaml", "-o", ""}), "check: -o needs a folder name");
}

TEST(Options, BenchComparesWithAFileOrTheCommittedResults) {
  const Options plain = parse_options({"bench", "-o", "ci.json"});
  EXPECT_FALSE(plain.simulation.compare);
  EXPECT_EQ(plain.output, "ci.json");
  const Options committed = parse_options({"bench", "--compare", "--jobs", "2"});
  EXPECT_TRUE(committed.simulation.compare);
  EXPECT_EQ(committed.simulation.compare_with, "");
  EXPECT_EQ(committed.jobs, 2U);
  EXPECT_EQ(parse_options({"bench", "--compare", "old.json"}).simulation.compare_with, "old.json");
  EXPECT_EQ(refusal({"bench", "-o", ""}), "bench: -o needs a file name");
}

TEST(Options, WhatIsNotGivenIsEmpty) {
  const Options options = parse_options({"sweep", "s.yaml"});
  EXPECT_EQ(options.command, "sweep");
  EXPECT_FALSE(options.seed || options.trials || options.jobs || options.trial);
  EXPECT_EQ(options.output, "");
}

TEST(Options, SeedHolds64Bits) {
  EXPECT_EQ(parse_options({"run", "s.yaml", "--seed", "18446744073709551615"}).seed, std::numeric_limits<std::uint64_t>::max());
  EXPECT_THAT(refusal({"run", "s.yaml", "--seed", "18446744073709551616"}),
              "run: --seed is '18446744073709551616'; allowed: a whole number from 0 to 18446744073709551615");
}

TEST(Options, SetTakesSeveralValuesWhereverItStands) {
  const auto expected = ElementsAre("motion.speed -> 8 mm/s", "friction.static -> 0.4");
  EXPECT_THAT(paths(parse_options({"run", "s.yaml", "--set", "motion.speed=8 mm/s", "friction.static=0.4"})), expected);
  EXPECT_THAT(paths(parse_options({"run", "--set", "motion.speed=8 mm/s", "friction.static=0.4", "s.yaml"})), expected);
  EXPECT_THAT(paths(parse_options({"run", "--set", "motion.speed=8 mm/s", "s.yaml", "--set", "friction.static=0.4"})), expected);
  EXPECT_EQ(parse_options({"run", "--set", "a=1", "b=2", "s.yaml", "--seed", "1"}).scene, "s.yaml");
}

TEST(Options, SetValueMayHoldEqualsSignsBracketsAndSpaces) {
  EXPECT_THAT(paths(parse_options({"run", "s.yaml", "--set", "effects=[stribeck, {ageing: {}}]", "description=a = b"})),
              ElementsAre("effects -> [stribeck, {ageing: {}}]", "description -> a = b"));
}

TEST(Options, HdReplay) {
  const Options options =
      parse_options({"hd", "replay", "v.csv", "--memories", "m", "--encoder", "published_core", "--ties", "zero"});
  EXPECT_EQ(options.command, "hd replay");
  EXPECT_EQ(options.vectors, "v.csv");
  EXPECT_EQ(options.memories, "m");
  EXPECT_EQ(options.hd_compat, hd::Compat::published_core);
  EXPECT_EQ(options.hd_ties, hd::Ties::zero);
  EXPECT_EQ(options.engine, "kernel");
  const Options plain = parse_options({"--json", "hd", "replay", "v.csv", "--memories", "m"});
  EXPECT_TRUE(plain.json);
  EXPECT_FALSE(plain.hd_compat || plain.hd_ties);
}

TEST(Options, JsonMayStandBeforeTheCommand) {
  EXPECT_TRUE(parse_options({"--json", "list"}).json);
  EXPECT_TRUE(parse_options({"list", "--json"}).json);
}

TEST(Options, ReportAndExport) {
  const Options report = parse_options({"report", "a.h5", "--trial", "4", "-o", "a.html"});
  EXPECT_EQ(report.dataset, "a.h5");
  EXPECT_EQ(report.trial, 4U);
  EXPECT_EQ(report.output, "a.html");
  const Options exported = parse_options({"export", "a.h5", "--format", "training-csv", "-o", "dir"});
  EXPECT_EQ(exported.format, ExportFormat::training_csv);
  EXPECT_EQ(exported.slip_rule, SlipRule::strict);
  EXPECT_EQ(exported.output, "dir");
  EXPECT_FALSE(exported.rate);
  EXPECT_EQ(parse_options({"export", "a.h5", "--format", "robomimic", "-o", "dir", "--rate", "0.1 kHz"}).rate, 100.0);
  EXPECT_THAT(refusal({"export", "a.h5", "--format", "robomimic", "-o", "dir", "--rate", "5 N"}), HasSubstr("export: --rate"));
}

TEST(Options, ExportReadsTheRuleAndItsSpeed) {
  const Options options = parse_options({"export", "a.h5", "--format", "vendor-csv", "-o", "dir", "--slip", "paper",
                                         "--label-speed", "0.2 mm/s", "--sensor", "pad"});
  EXPECT_EQ(options.slip_rule, SlipRule::paper);
  EXPECT_DOUBLE_EQ(options.label_speed.value(), 2e-4);
  EXPECT_EQ(options.sensor, "pad");
  EXPECT_THAT(refusal({"export", "a.h5", "--format", "vendor-csv", "-o", "dir", "--label-speed", "0 mm/s"}),
              HasSubstr("export: --label-speed"));
}

TEST(Options, TrainTakesEverything) {
  const Options options = parse_options(
      {"train",    "a.h5",   "-o",     "m",      "--encoder",   "sthdc",    "--context",     "--dimension", "512",
       "--window", "7",      "--ties", "zero",   "--quantiser", "exact",    "--labels",      "micro",       "--sensor",
       "pad",      "--seed", "3",      "--jobs", "2",           "--compat", "published_core"});
  EXPECT_EQ(options.dataset, "a.h5");
  EXPECT_EQ(options.output, "m");
  EXPECT_EQ(options.model.encoding, hd::Encoding::spatial_temporal);
  EXPECT_TRUE(options.model.context_driven);
  EXPECT_EQ(options.model.dimension, 512U);
  EXPECT_EQ(options.model.window, 7U);
  EXPECT_EQ(options.hd_compat, hd::Compat::published_core);
  EXPECT_EQ(options.hd_ties, hd::Ties::zero);
  EXPECT_EQ(options.quantiser, hd::Quantiser::exact);
  EXPECT_EQ(options.slip_rule, SlipRule::micro);
  EXPECT_EQ(options.sensor, "pad");
  EXPECT_EQ(options.seed, 3U);
  EXPECT_EQ(options.jobs, 2U);
}

TEST(Options, TrainsThePapersModelUnlessToldOtherwise) {
  EXPECT_EQ(parse_options({"train", "a.h5", "-o", "m"}).model, hd::Model());
  EXPECT_EQ(parse_options({"train", "a.h5", "-o", "m"}).slip_rule, SlipRule::paper);
  EXPECT_EQ(parse_options({"eval", "a.h5", "--memories", "m"}).slip_rule, SlipRule::paper);
  // The context is part of the graphs' ablation alone.
  EXPECT_FALSE(parse_options({"train", "a.h5", "-o", "m", "--encoder", "shdc"}).model.context_driven);
  EXPECT_FALSE(parse_options({"train", "a.h5", "-o", "m", "--no-context"}).model.context_driven);
}

TEST(Options, ReproduceTakesItsName) {
  EXPECT_EQ(parse_options({"reproduce"}).name, "");
  const Options options =
      parse_options({"reproduce", "paper/table", "--data", "a.h5", "--synthesise", "-o", "p.html", "--quiet"});
  EXPECT_EQ(options.name, "paper/table");
  EXPECT_EQ(options.data, "a.h5");
  EXPECT_TRUE(options.synthesise);
  EXPECT_TRUE(options.quiet);
  EXPECT_EQ(options.output, "p.html");
}

// What follows the list is not one of its names.
TEST(Options, ReproduceTakesAListOfRows) {
  const Options options =
      parse_options({"reproduce", "--trials", "3", "--memories", "m", "--only", "felt,light", "--only", "gst_hd", "table"});
  EXPECT_THAT(options.only, ElementsAre("felt", "light", "gst_hd"));
  EXPECT_EQ(options.name, "table");
  EXPECT_EQ(options.trials, 3U);
  EXPECT_EQ(options.memories, "m");
}

TEST(Options, HelpIsTextToPrint) {
  EXPECT_THAT(parse_options({}).help, HasSubstr("Usage: slipbench"));
  EXPECT_THAT(parse_options({"--help"}).help, HasSubstr("describe"));
  EXPECT_EQ(parse_options({"--version"}).command, "--version");
}

TEST(Options, EveryCommandExplainsItself) {
  for (const std::string& command : command_names()) {
    const std::string text = parse_options({command, "--help"}).help;
    EXPECT_THAT(text, HasSubstr("Usage: slipbench " + command)) << command;
    EXPECT_THAT(text, HasSubstr("--json")) << command;
  }
}

// One refusal: the words typed and the whole message.
struct Refusal {
  std::vector<std::string> arguments;
  std::string message;
};

class OptionsRefusal : public ::testing::TestWithParam<Refusal> {};

TEST_P(OptionsRefusal, SaysWhatIsAllowed) { EXPECT_EQ(refusal(GetParam().arguments), GetParam().message); }

INSTANTIATE_TEST_SUITE_P(
    All, OptionsRefusal,
    ::testing::Values(
        Refusal{
            {"swep", "s.yaml"},
            "unknown command 'swep'; did you mean 'sweep'? commands: run, sweep, check, report, export, hd, train, eval, reproduce, cost, bench, list, describe, doctor, plugin-path"},
        Refusal{
            {"xyzzy"},
            "unknown command 'xyzzy'; commands: run, sweep, check, report, export, hd, train, eval, reproduce, cost, bench, list, describe, doctor, plugin-path"},
        Refusal{
            {"--json", "lst"},
            "unknown command 'lst'; did you mean 'list'? commands: run, sweep, check, report, export, hd, train, eval, reproduce, cost, bench, list, describe, doctor, plugin-path"},
        Refusal{{"--quiet"}, "unknown option '--quiet'; options: --help, --version, --json"},
        Refusal{
            {"--json"},
            "no command given; commands: run, sweep, check, report, export, hd, train, eval, reproduce, cost, bench, list, describe, doctor, plugin-path"},
        Refusal{{"run"}, "run: SCENE is required"}, Refusal{{"describe"}, "describe: NAME is required"},
        Refusal{
            {"run", "s.yaml", "--job", "2"},
            "run: unknown option '--job'; did you mean '--jobs'? options: --help, --json, --set, --seed, --quiet, --trials, --jobs, --output, --record, --trial"},
        Refusal{{"run", "s.yaml", "t.yaml"}, "run: unexpected argument 't.yaml'; see slipbench run --help"},
        Refusal{{"cost"}, "cost: a scene is missing; allowed: SCENE.yaml, --stability, or both"},
        Refusal{{"cost", "s.yaml", "--budget", "0 s"}, "cost: --budget: '0 s' is out of range; allowed: > 0 s"},
        Refusal{{"cost", "s.yaml", "--budget", "3 N"},
                "cost: --budget: unknown unit 'N' of a time in '3 N'; allowed: s, ms, us, min"},
        Refusal{
            {"view", "s.yaml"},
            "command 'view' is not available in this version; available: run, sweep, check, report, export, hd, train, eval, reproduce, cost, bench, list, describe, doctor, plugin-path"},
        Refusal{{"run", "s.yaml", "-o"}, "run: --output needs one value"},
        Refusal{{"run", "s.yaml", "-o", ""}, "run: -o needs a file name"},
        Refusal{{"report", "a.h5", "--output", ""}, "report: -o needs a file name"},
        Refusal{{"export", "a.h5", "--format", "vendor-csv", "-o", ""}, "export: -o needs a folder name"},
        Refusal{{"run", "s.yaml", "--set"}, "run: --set needs one value"},
        Refusal{{"run", "s.yaml", "--set", "speed"},
                "run: --set 'speed'; expected key=value, as in --set motion.speed=\"8 mm/s\""},
        Refusal{{"run", "s.yaml", "--set", "=1"}, "run: --set '=1'; expected key=value, as in --set motion.speed=\"8 mm/s\""},
        Refusal{{"run", "s.yaml", "--seed", "-1"}, "run: --seed is '-1'; allowed: a whole number from 0 to 18446744073709551615"},
        Refusal{{"run", "s.yaml", "--seed", "1e3"},
                "run: --seed is '1e3'; allowed: a whole number from 0 to 18446744073709551615"},
        Refusal{{"run", "s.yaml", "--trials", "0"},
                "run: --trials is '0'; allowed: a whole number from 1 to 18446744073709551615"},
        Refusal{{"sweep", "s.yaml", "--jobs", "0"}, "sweep: --jobs is '0'; allowed: a whole number from 1 to 1024"},
        Refusal{{"run", "s.yaml", "--jobs", "1025"}, "run: --jobs is '1025'; allowed: a whole number from 1 to 1024"},
        Refusal{{"report", "a.h5", "--trial", "first"},
                "report: --trial is 'first'; allowed: a whole number from 0 to 18446744073709551615"},
        Refusal{{"export", "a.h5", "-o", "dir"}, "export: --format is required"},
        Refusal{{"train", "a.h5"}, "train: --output is required"},
        Refusal{{"train", "a.h5", "-o", ""}, "train: -o needs a folder name"},
        Refusal{{"train", "a.h5", "-o", "m", "--encoder", "gshdc"},
                "train: --encoder is 'gshdc'; did you mean 'shdc'? allowed: shdc, sthdc, gsthdc"},
        Refusal{{"train", "a.h5", "-o", "m", "--ties", "up"}, "train: --ties is 'up'; allowed: one, zero"},
        Refusal{{"train", "a.h5", "-o", "m", "--compat", "papr"},
                "train: --compat is 'papr'; did you mean 'paper'? allowed: paper, published_core"},
        Refusal{{"train", "a.h5", "-o", "m", "--quantiser", "fixed"},
                "train: --quantiser is 'fixed'; allowed: fixed_point, exact, unrounded"},
        Refusal{{"train", "a.h5", "-o", "m", "--dimension", "7"},
                "train: --dimension is '7'; allowed: a whole number from 8 to 65535"},
        Refusal{{"train", "a.h5", "-o", "m", "--window", "0"}, "train: --window is '0'; allowed: a whole number from 1 to 1000"},
        Refusal{{"train", "a.h5", "-o", "m", "--context", "--no-context"},
                "train: --context and --no-context exclude each other"},
        Refusal{{"eval", "a.h5"}, "eval: --memories is required"},
        Refusal{{"export", "a.h5", "--format", "vendor-csv"}, "export: --output is required"}));

TEST(Options, AWrongFormatIsNamedBeforeAMissingFolder) {
  EXPECT_THAT(refusal({"export", "a.h5", "--format", "vendor"}), HasSubstr("'vendor'"));
}

}  // namespace
}  // namespace slipbench
