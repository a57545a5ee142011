#include <cstdint>
#include <limits>
#include <sstream>
#include <utility>
#include <vector>

#include "tests/expect.h"
#include "tools/cli/command.h"
#include "tools/cli/commands/command_table.h"
#include "tools/cli/commands/dataset_commands.h"
#include "tools/cli/commands/detectors/detector_commands.h"
#include "tools/cli/commands/help_commands.h"
#include "tools/cli/commands/reproduce_command.h"
#include "tools/cli/commands/simulation/simulation_commands.h"
#include "tools/cli/program.h"

namespace slipbench {
namespace {

Request parse(const std::vector<std::string>& words) {
  static Commands commands;  // the result points to one of them
  commands = command_table();
  return parse_command_line(commands, words);
}

// Returns the command of the words, with its options.
template <class Kind>
Kind parsed(const std::vector<std::string>& words) {
  return dynamic_cast<const Kind&>(*parse(words).command);
}

std::string refusal(const std::vector<std::string>& words) {
  return refusal_of([&] { parse(words); });
}

std::vector<std::string> paths(const std::vector<Override>& overrides) {
  std::vector<std::string> texts;
  for (const Override& change : overrides) texts.push_back(change.path + " -> " + change.value);
  return texts;
}

std::vector<std::string> run_paths(const std::vector<std::string>& words) {
  return paths(parsed<RunCommand>(words).sweep.overrides);
}

TEST(CommandLine, RunTakesEverything) {
  const auto command =
      parsed<RunCommand>({"run", "s.yaml", "--seed", "7", "--trials", "3", "--jobs", "2", "-o", "out.h5", "--quiet"});
  EXPECT_EQ(command.sweep.verb, "run");
  EXPECT_EQ(command.sweep.scene_path, "s.yaml");
  EXPECT_EQ(command.sweep.seed, 7U);
  EXPECT_EQ(command.sweep.limit, 3U);
  EXPECT_EQ(command.sweep.jobs, 2U);
  EXPECT_EQ(command.sweep.output, "out.h5");
  EXPECT_TRUE(command.quiet);
  EXPECT_FALSE(command.json);
}

TEST(CommandLine, RunIsOneTrialUnlessToldOtherwise) {
  EXPECT_EQ(parsed<RunCommand>({"run", "s.yaml"}).sweep.limit, 1U);
  const auto one = parsed<RunCommand>({"run", "s.yaml", "--trial", "7"});
  EXPECT_EQ(one.sweep.only, 7U);
  EXPECT_EQ(one.sweep.limit, 0U);
}

TEST(CommandLine, RecordSaysWhatIsWritten) {
  EXPECT_EQ(parsed<SweepCommand>({"sweep", "s.yaml", "-o", "out.h5"}).sweep.recording, Recording::full);
  EXPECT_EQ(parsed<SweepCommand>({"sweep", "s.yaml", "-o", "out.h5", "--record", "outcome"}).sweep.recording, Recording::outcome);
  EXPECT_THAT(refusal({"sweep", "s.yaml", "-o", "out.h5", "--record", "outcom"}),
              refused_at("sweep", {"--record", "outcom", "outcome"}));
  EXPECT_THAT(refusal({"run", "s.yaml", "--record", "outcome"}), refused_at("run", {"--record", "-o"}));
}

TEST(CommandLine, CheckTakesSeveralScenes) {
  const auto command = parsed<CheckCommand>(
      {"check", "a.yaml", "b.yaml", "--set", "seed=3", "c.yaml", "--trials", "5", "--junit", "j.xml", "-o", "left", "--quiet"});
  EXPECT_THAT(command.scenes, ElementsAre("a.yaml", "b.yaml", "c.yaml"));
  EXPECT_THAT(paths(command.options.overrides), ElementsAre("seed -> 3"));
  EXPECT_EQ(command.options.trials, 5U);
  EXPECT_EQ(command.junit, "j.xml");
  EXPECT_EQ(command.output, "left");
  EXPECT_THAT(refusal({"check", "a.yaml", "--junit", ""}), refused_at("check", {"--junit", "file name"}));
  EXPECT_THAT(refusal({"check", "a.yaml", "-o", ""}), refused_at("check", {"-o", "folder name"}));
}

TEST(CommandLine, WhatIsNotGivenIsEmpty) {
  const auto command = parsed<SweepCommand>({"sweep", "s.yaml"});
  EXPECT_FALSE(command.sweep.seed || command.sweep.only);
  EXPECT_EQ(command.sweep.trials, 0U);
  EXPECT_EQ(command.sweep.jobs, 0U);
  EXPECT_EQ(command.sweep.output, "");
}

TEST(CommandLine, SeedHolds64Bits) {
  EXPECT_EQ(parsed<RunCommand>({"run", "s.yaml", "--seed", "18446744073709551615"}).sweep.seed,
            std::numeric_limits<std::uint64_t>::max());
  EXPECT_THAT(refusal({"run", "s.yaml", "--seed", "18446744073709551616"}),
              refused_at("run", {"--seed", "18446744073709551616", "18446744073709551615"}));
}

TEST(CommandLine, SetTakesSeveralValuesWhereverItStands) {
  const auto expected = ElementsAre("motion.speed -> 8 mm/s", "friction.static -> 0.4");
  EXPECT_THAT(run_paths({"run", "s.yaml", "--set", "motion.speed=8 mm/s", "friction.static=0.4"}), expected);
  EXPECT_THAT(run_paths({"run", "--set", "motion.speed=8 mm/s", "friction.static=0.4", "s.yaml"}), expected);
  EXPECT_THAT(run_paths({"run", "--set", "motion.speed=8 mm/s", "s.yaml", "--set", "friction.static=0.4"}), expected);
  EXPECT_EQ(parsed<RunCommand>({"run", "--set", "a=1", "b=2", "s.yaml", "--seed", "1"}).sweep.scene_path, "s.yaml");
}

TEST(CommandLine, SetValueMayHoldEqualsSignsBracketsAndSpaces) {
  EXPECT_THAT(run_paths({"run", "s.yaml", "--set", "effects=[stribeck, {ageing: {}}]", "description=a = b"}),
              ElementsAre("effects -> [stribeck, {ageing: {}}]", "description -> a = b"));
}

TEST(CommandLine, HdReplay) {
  const auto command =
      parsed<HdReplayCommand>({"hd", "replay", "v.csv", "--memories", "m", "--encoder", "published_core", "--ties", "zero"});
  EXPECT_EQ(command.vectors, "v.csv");
  EXPECT_EQ(command.memories, "m");
  EXPECT_EQ(command.compat, hd::Compat::published_core);
  EXPECT_EQ(command.ties, hd::Ties::zero);
  EXPECT_EQ(command.engine, "kernel");
  const auto plain = parsed<HdReplayCommand>({"--json", "hd", "replay", "v.csv", "--memories", "m"});
  EXPECT_TRUE(plain.json);
  EXPECT_FALSE(plain.compat || plain.ties);
}

TEST(CommandLine, JsonMayStandBeforeTheCommand) {
  EXPECT_TRUE(parsed<ListCommand>({"--json", "list"}).json);
  EXPECT_TRUE(parsed<ListCommand>({"list", "--json"}).json);
  EXPECT_TRUE(parsed<HdReplayCommand>({"hd", "--json", "replay", "v.csv", "--memories", "m"}).json);
}

TEST(CommandLine, ReportAndExport) {
  const auto report = parsed<ReportCommand>({"report", "a.h5", "--trial", "4", "-o", "a.html"});
  EXPECT_EQ(report.dataset, "a.h5");
  EXPECT_EQ(report.options.trial, 4U);
  EXPECT_EQ(report.output, "a.html");
  const auto exported = parsed<ExportCommand>({"export", "a.h5", "--format", "training-csv", "-o", "dir"});
  EXPECT_EQ(exported.options.format, ExportFormat::training_csv);
  EXPECT_FALSE(exported.options.slip_rule);  // each format has its own default
  EXPECT_EQ(exported.output, "dir");
  EXPECT_FALSE(exported.options.rate);
  const auto slow = parsed<ExportCommand>({"export", "a.h5", "--format", "robomimic", "-o", "dir", "--rate", "0.1 kHz"});
  EXPECT_EQ(slow.options.rate, 100.0);
  EXPECT_THAT(refusal({"export", "a.h5", "--format", "robomimic", "-o", "dir", "--rate", "5 N"}), HasSubstr("export: --rate"));
}

TEST(CommandLine, ExportReadsWhatIsLeft) {
  const auto command = parsed<ExportCommand>(
      {"export", "a.h5", "--format", "parquet", "-o", "dir", "--labels", "micro", "--sensors", "pad,left", "--split", "valid"});
  EXPECT_EQ(command.options.format, ExportFormat::parquet);
  EXPECT_EQ(command.options.slip_rule, LabelRule::micro);
  EXPECT_EQ(command.options.sensors, (std::vector<std::string>{"pad", "left"}));
  EXPECT_EQ(command.options.split, "valid");
}

TEST(CommandLine, ExportReadsTheRuleAndItsSpeed) {
  const auto command = parsed<ExportCommand>({"export", "a.h5", "--format", "vendor-csv", "-o", "dir", "--slip", "paper",
                                              "--label-speed", "0.2 mm/s", "--sensor", "pad"});
  EXPECT_EQ(command.options.slip_rule, LabelRule::paper);
  EXPECT_DOUBLE_EQ(command.options.label_speed.value(), 2e-4);
  EXPECT_EQ(command.options.sensors, std::vector<std::string>{"pad"});
  EXPECT_THAT(refusal({"export", "a.h5", "--format", "vendor-csv", "-o", "dir", "--label-speed", "0 mm/s"}),
              HasSubstr("export: --label-speed"));
}

TEST(CommandLine, TrainHdTakesEverything) {
  const HdTraining options =
      parsed<TrainHdCommand>(
          {"train-hd", "a.h5",   "-o",     "m",      "--encoder",   "sthdc",    "--context",     "--dimension", "512",
           "--window", "7",      "--ties", "zero",   "--quantiser", "exact",    "--labels",      "micro",       "--sensor",
           "pad",      "--seed", "3",      "--jobs", "2",           "--compat", "published_core"})
          .options;
  EXPECT_EQ(options.dataset, "a.h5");
  EXPECT_EQ(options.output, "m");
  EXPECT_EQ(options.model.encoding, hd::Encoding::spatial_temporal);
  EXPECT_TRUE(options.model.context_driven);
  EXPECT_EQ(options.model.dimension, 512U);
  EXPECT_EQ(options.model.window, 7U);
  EXPECT_EQ(options.model.compat, hd::Compat::published_core);
  EXPECT_EQ(options.model.ties, hd::Ties::zero);
  EXPECT_EQ(options.quantiser, hd::Quantiser::exact);
  EXPECT_EQ(options.sequences.labels, LabelRule::micro);
  EXPECT_EQ(options.sequences.sensor, "pad");
  EXPECT_EQ(options.seed, 3U);
  EXPECT_EQ(options.jobs, 2U);
}

TEST(CommandLine, TrainTakesARecipe) {
  const TrainCommand& command = parsed<TrainCommand>(
      {"train",    "a.h5",    "-o",       "d.onnx",     "--recipe",   "piezo_fft_gru", "--labels", "latched",  "--split",
       "object",   "--steps", "100",      "--held-out", "25",         "--seed",        "3",        "--sensor", "pad",
       "--alarms", "30/h",    "--resume", "--rates",    "0.05..1 kHz"});
  EXPECT_EQ(command.request["datasets"], Json::array({"a.h5"}));
  EXPECT_EQ(command.request["output"], "d.onnx");
  EXPECT_EQ(command.request["sensor"], "pad");
  EXPECT_EQ(command.request["seed"], 3);
  EXPECT_DOUBLE_EQ(command.request["held_out"].get<double>(), 0.25);
  EXPECT_EQ(command.request["resume"], true);
  EXPECT_EQ(command.request["alarms"], 0.5);  // per minute
  EXPECT_EQ(command.request["labels"], "latched");
  EXPECT_EQ(command.request["split"], "object");
  EXPECT_EQ(command.request["steps"], 100);
  EXPECT_EQ(command.request["rates"], Json::array({50.0, 1000.0}));
  // Options that are not given are null: Python then uses the value of the recipe or the default of
  // train().
  const TrainCommand& plain = parsed<TrainCommand>({"train", "a.h5", "-o", "d.onnx", "--recipe", "piezo_fft_gru"});
  for (const char* key : {"labels", "split", "held_out", "steps", "turned", "rates", "alarms"})
    EXPECT_TRUE(plain.request[key].is_null()) << key;
  const TrainHdCommand& hd = parsed<TrainHdCommand>({"train-hd", "a.h5", "-o", "m", "--with", "b.h5", "--alarms", "30/h"});
  EXPECT_THAT(hd.options.with, ElementsAre("b.h5"));
  EXPECT_TRUE(hd.options.point);
  EXPECT_EQ(hd.options.alarms, 0.5);
}

TEST(CommandLine, TrainRefuses) {
  const auto refused = [](std::vector<std::string> words) {
    words.insert(words.begin(), {"train", "a.h5", "-o", "m.onnx"});
    return refusal(words);
  };
  EXPECT_THAT(refused({}), mentions({"--recipe", "list recipes", "train-hd"}));
  EXPECT_THAT(refused({"--recipe", "gst_hd"}), mentions({"gst_hd", "train-hd"}));
  EXPECT_THAT(refused({"--recipe", "piezo_fft_gr"}), mentions({"piezo_fft_gr", "piezo_fft_gru"}));
  EXPECT_THAT(refused({"--recipe", "piezo_mlp", "--encoder", "shdc"}), mentions({"--encoder"}));
  EXPECT_THAT(refused({"--recipe", "piezo_mlp", "--labels", "has_slipped"}), mentions({"--labels", "has_slipped"}));
  EXPECT_THAT(refused({"--recipe", "piezo_mlp", "--split", "window"}), mentions({"--split", "window"}));
  EXPECT_THAT(refusal({"train", "a.h5", "-o", "m", "--recipe", "piezo_mlp"}), mentions({"-o m", "ONNX", ".onnx"}));
  for (const char* rates : {"50 Hz", "1 kHz..50 Hz", "0 Hz..1 kHz", "50 mm..1 m", "..", "50 Hz.."}) {
    EXPECT_THAT(refused({"--recipe", "piezo_mlp", "--rates", rates}), mentions({"--rates", rates, "50 Hz..1 kHz"}));
  }
}

TEST(CommandLine, TrainHdRefuses) {
  const auto refused = [](std::vector<std::string> words) {
    words.insert(words.begin(), {"train-hd", "a.h5", "-o", "m"});
    return refusal(words);
  };
  EXPECT_THAT(refused({"--steps", "3"}), mentions({"--steps"}));
  EXPECT_THAT(refused({"--labels", "latched"}), mentions({"train-hd", "--labels", "latched"}));
  EXPECT_THAT(refused({"--context", "--no-context"}), mentions({"--context", "--no-context"}));
}

TEST(CommandLine, BothTrainingsRefuseAWrongOperatingPoint) {
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"train", "a.h5", "-o", "m.onnx", "--recipe", "slip_gru"}, {"train-hd", "a.h5", "-o", "m"}}) {
    const auto refused = [&](const std::vector<std::string>& words) {
      std::vector<std::string> all = command;
      all.insert(all.end(), words.begin(), words.end());
      return refusal(all);
    };
    for (const char* rate : {"1", "-1/min", "1/s", "nan/min", "often"})
      EXPECT_THAT(refused({"--alarms", rate}), mentions({command[0], "--alarms", rate, "1/min"}));
    EXPECT_THAT(refused({"--alarms", "1/min", "--score"}), mentions({command[0], "--score", "--alarms"}));
    EXPECT_THAT(refused({"--specificity", "90"}), mentions({"--specificity", "--score"}));
    EXPECT_THAT(refused({"--score", "--specificity", "101"}), mentions({"--specificity", "101"}));
  }
}

TEST(CommandLine, TrainsThePapersModelUnlessToldOtherwise) {
  const auto model = [](std::vector<std::string> words) {
    words.insert(words.begin(), {"train-hd", "a.h5", "-o", "m"});
    return parsed<TrainHdCommand>(words).options.model;
  };
  EXPECT_EQ(model({}), hd::Model());
  EXPECT_EQ(parsed<TrainHdCommand>({"train-hd", "a.h5", "-o", "m"}).options.sequences.labels, LabelRule::paper);
  // Only the ablation of graphs includes the context.
  EXPECT_FALSE(model({"--encoder", "shdc"}).context_driven);
  EXPECT_FALSE(model({"--no-context"}).context_driven);
}

TEST(CommandLine, EvalTakesADetectorAndItsParameters) {
  const auto command =
      parsed<EvalCommand>({"eval", "force_ratio", "a.h5", "--set", "ratio=0.3", "--set", "touch=20 mN", "--labels", "latched",
                           "--sensor", "pad", "--split", "test", "--all", "-o", "p.html"});
  EXPECT_EQ(command.detector, "force_ratio");
  EXPECT_EQ(command.options.dataset, "a.h5");
  ASSERT_EQ(command.parameters.size(), 2U);
  EXPECT_EQ(command.parameters[1].path, "touch");
  EXPECT_EQ(command.parameters[1].value, "20 mN");
  EXPECT_EQ(command.options.labels, LabelRule::latched);
  EXPECT_EQ(command.options.sensor, "pad");
  EXPECT_EQ(command.options.split, "test");
  EXPECT_TRUE(command.options.all);
  EXPECT_EQ(command.output, "p.html");
  const auto plain = parsed<EvalCommand>({"eval", "m", "a.h5"});
  EXPECT_EQ(plain.options.labels, std::nullopt) << "recorded, what a network learnt by, or strict";
  EXPECT_EQ(plain.options.split, "");
  EXPECT_EQ(parsed<EvalCommand>({"eval", "m", "a.h5", "--split", "all"}).options.split, "");
}

TEST(CommandLine, ReproduceTakesItsName) {
  EXPECT_EQ(parsed<ReproduceCommand>({"reproduce"}).name, "");
  const auto command = parsed<ReproduceCommand>(
      {"reproduce", "paper/table", "--data", "a.h5", "--real", "r.h5", "--synthesise", "-o", "p.html", "--quiet"});
  EXPECT_EQ(command.name, "paper/table");
  EXPECT_EQ(command.data, "a.h5");
  EXPECT_EQ(command.real, "r.h5");
  EXPECT_TRUE(command.synthesise);
  EXPECT_TRUE(command.quiet);
  EXPECT_EQ(command.output, "p.html");
}

// The word after the list is not one of its names.
TEST(CommandLine, ReproduceTakesAListOfRows) {
  const auto command = parsed<ReproduceCommand>(
      {"reproduce", "--trials", "3", "--full", "--memories", "m", "--only", "felt,light", "--only", "gst_hd", "table"});
  EXPECT_THAT(command.only, ElementsAre("felt", "light", "gst_hd"));
  EXPECT_EQ(command.name, "table");
  EXPECT_EQ(command.trials, 3U);
  EXPECT_TRUE(command.full);
  EXPECT_EQ(command.memories, "m");
}

TEST(CommandLine, HelpIsTextToPrint) {
  EXPECT_THAT(parse({}).help, HasSubstr("Usage: slipbench"));
  EXPECT_THAT(parse({"--help"}).help, HasSubstr("describe"));
  EXPECT_TRUE(parse({"--version"}).version);
}

// The commands that the answer to an unknown one lists.
std::vector<std::string> command_names() {
  const std::string message = refusal({"xyzzy"}), head = "commands: ";
  std::istringstream list(message.substr(message.find(head) + head.size()));
  std::vector<std::string> names;
  for (std::string name; std::getline(list >> std::ws, name, ',');) names.push_back(name);
  return names;
}

TEST(CommandLine, EveryCommandExplainsItself) {
  for (const std::string& name : command_names()) {
    const std::string text = parse({name, "--help"}).help;
    EXPECT_THAT(text, HasSubstr("Usage: slipbench " + name));
    EXPECT_THAT(text, HasSubstr("--json")) << name;
  }
}

// The text does not depend on how it is requested.
TEST(CommandLine, HelpIsACommandToo) {
  const auto help = [](const std::vector<std::string>& path) {
    std::vector<std::string> words{"help"};
    words.insert(words.end(), path.begin(), path.end());
    return parsed<HelpCommand>(words).text();
  };
  EXPECT_EQ(help({}), parse({"--help"}).help);
  for (const std::string& name : command_names()) EXPECT_EQ(help({name}), parse({name, "--help"}).help);
  EXPECT_EQ(help({"hd", "replay"}), parse({"hd", "replay", "--help"}).help);
}

TEST(CommandLine, AnUnknownCommandIsAnsweredByAllThatThereAre) {
  EXPECT_EQ(command_names().size(), command_table().size());
  EXPECT_THAT(refusal({"--json"}), mentions(command_names()));
}

// The help of a command shows the same options as its declaration.
TEST(CommandLine, AnUnknownOptionIsAnsweredByAllThatThereAre) {
  const std::string help = parse({"run", "--help"}).help, message = refusal({"run", "s.yaml", "--xyzzy"});
  std::size_t count = 0;
  for (std::size_t at = help.find("  --"); at != std::string::npos; at = help.find("  --", at + 1)) {
    const std::string option = help.substr(at + 2, help.find_first_of(" ,=\n", at + 4) - at - 2);
    EXPECT_THAT(message, mentions({option}));
    ++count;
  }
  EXPECT_GT(count, 5U);
}

TEST(CommandLine, ARefusalSaysWhatIsAllowed) {
  const std::vector<Refused<std::vector<std::string>>> refusals = {
      {{"swep", "s.yaml"}, "", {"unknown command", "swep", "sweep"}},
      {{"xyzzy"}, "", {"unknown command", "xyzzy"}},
      {{"--json", "lst"}, "", {"unknown command", "lst", "list"}},
      {{"doctor", "list"}, "doctor", {"list"}},
      {{"completion", "csh"}, "completion", {"csh", "bash", "fish", "zsh"}},
      {{"help", "swep"}, "", {"unknown command", "swep", "sweep"}},
      {{"help", "hd", "repla"}, "hd", {"unknown command", "repla", "replay"}},
      {{"help", "run", "sweep"}, "run", {"unknown command", "sweep"}},
      {{"list", "run", "sweep"}, "list", {"sweep"}},
      {{"--quiet"}, "", {"--quiet", "--help", "--version", "--json"}},
      {{"--json"}, "", {"no command"}},
      {{"run"}, "run", {"SCENE"}},
      {{"verify"}, "verify", {"FILE"}},
      {{"describe"}, "describe", {"NAME"}},
      {{"merge", "-o", "m.h5"}, "merge", {"FILE"}},
      {{"merge", "a.h5"}, "merge", {"--output"}},
      {{"cluster", "s.yaml", "-o", "dir"}, "cluster", {"--shards"}},
      {{"sweep", "s.yaml", "--shard", "0/3", "-o", "a.h5"}, "sweep", {"--shard", "0/3", "k/n"}},
      {{"sweep", "s.yaml", "--shard", "1/3"}, "sweep", {"--shard", "-o"}},
      {{"run", "s.yaml", "--job", "2"}, "run", {"--job", "--jobs"}},
      {{"run", "s.yaml", "t.yaml"}, "run", {"t.yaml"}},
      {{"cost"}, "cost", {"SCENE.yaml", "--stability"}},
      {{"cost", "s.yaml", "--budget", "0 s"}, "cost", {"--budget", "'0 s'"}},
      {{"cost", "s.yaml", "--budget", "3 N"}, "cost", {"--budget", "3 N", "time"}},
      {{"view", "a.h5", "--seed", "3"}, "view", {"a.h5", "only to a scene"}},
      {{"view", "a.h5", "--set", "seed=3"}, "view", {"a.h5", "only to a scene"}},
      {{"view"}, "view", {"FILE"}},
      {{"view", "a.h5", "-o", "b.h5"}, "view", {"-o", "b.h5", ".html"}},
      {{"run", "s.yaml", "-o"}, "run", {"--output", "needs a value"}},
      {{"run", "s.yaml", "-o", ""}, "run", {"-o", "file name"}},
      {{"report", "a.h5", "--output", ""}, "report", {"-o", "file name"}},
      {{"export", "a.h5", "--format", "vendor-csv", "-o", ""}, "export", {"-o", "folder name"}},
      {{"run", "s.yaml", "--set"}, "run", {"--set", "needs a value"}},
      {{"run", "s.yaml", "--set", "speed"}, "run", {"--set", "'speed'", "key=value"}},
      {{"run", "s.yaml", "--set", "=1"}, "run", {"--set", "=1", "key=value"}},
      {{"run", "s.yaml", "--seed", "-1"}, "run", {"--seed", "-1", "18446744073709551615"}},
      {{"run", "s.yaml", "--seed", "1e3"}, "run", {"--seed", "1e3", "18446744073709551615"}},
      {{"run", "s.yaml", "--trials", "0"}, "run", {"--trials", "0", "1"}},
      {{"sweep", "s.yaml", "--jobs", "0"}, "sweep", {"--jobs", "0", "1024"}},
      {{"run", "s.yaml", "--jobs", "1025"}, "run", {"--jobs", "1025", "1024"}},
      {{"report", "a.h5", "--trial", "first"}, "report", {"--trial", "first", "18446744073709551615"}},
      {{"export", "a.h5", "-o", "dir"}, "export", {"--format"}},
      {{"import", "a.csv"}, "import", {"--format"}},
      {{"train", "a.h5"}, "train", {"--output"}},
      {{"train", "a.h5", "-o", ""}, "train", {"-o", "file name"}},
      {{"train-hd", "a.h5", "-o", "m", "--encoder", "gshdc"}, "train-hd", {"--encoder", "gshdc", "shdc"}},
      {{"train-hd", "a.h5", "-o", "m", "--ties", "up"}, "train-hd", {"--ties", "up", "one, zero"}},
      {{"train-hd", "a.h5", "-o", "m", "--compat", "papr"}, "train-hd", {"--compat", "papr", "paper"}},
      {{"train-hd", "a.h5", "-o", "m", "--quantiser", "fixed"}, "train-hd", {"--quantiser", "fixed", "exact"}},
      {{"train-hd", "a.h5", "-o", "m", "--dimension", "7"}, "train-hd", {"--dimension", "7", "8", "65535"}},
      {{"train-hd", "a.h5", "-o", "m", "--window", "0"}, "train-hd", {"--window", "0", "1000"}},
      {{"train-hd", "a.h5", "-o", "m", "--context", "--no-context"}, "train-hd", {"--context", "--no-context"}},
      {{"eval", "m"}, "eval", {"FILE"}},
      {{"eval", "m", "a.h5", "--labels", "stric"}, "", {"stric", "strict"}},
      {{"detect", "m"}, "detect", {"RECORDING"}},
      {{"eval", "m", "a.h5", "--split", "tests"}, "eval", {"--split", "tests", "test"}},
      {{"export", "a.h5", "--format", "vendor-csv"}, "export", {"--output"}},
  };
  expect_refusals(refusals, refusal);
}

TEST(CommandLine, CalibrateTakesASceneRecordingsAndKeys) {
  const std::string fit = "friction.scale: {min: 0.5, max: 2}";
  const auto given =
      parsed<CalibrateCommand>({"calibrate", "s.yaml", "a.h5", "b.h5", "--fit", fit, "--fit", "lag: {min: 0 ms, max: 5 ms}",
                                "--set", "motion.speed=1", "--starts", "2", "--jobs", "3", "-o", "f.yaml"});
  EXPECT_EQ(given.options.scene_path, "s.yaml");
  EXPECT_THAT(given.options.recordings, ElementsAre("a.h5", "b.h5"));
  ASSERT_EQ(given.options.keys.size(), 2u);
  EXPECT_EQ(given.options.keys[1].max, 0.005);
  EXPECT_EQ(given.options.starts, 2u);
  EXPECT_EQ(given.options.jobs, 3u);
  EXPECT_EQ(given.output, "f.yaml");
  EXPECT_EQ(given.options.command, "slipbench calibrate s.yaml a.h5 b.h5 --fit '" + fit +
                                       "' --fit 'lag: {min: 0 ms, max: 5 ms}' --set motion.speed=1 --starts 2");
  EXPECT_THAT(refusal({"calibrate", "s.yaml", "a.h5"}), refused_at("calibrate", {"--fit"}));
  EXPECT_THAT(refusal({"calibrate", "s.yaml", "--fit", fit}), refused_at("calibrate", {"recordings", "--synthetic-truth"}));
  EXPECT_THAT(refusal({"calibrate", "s.yaml", "a.h5", "--synthetic-truth", "--fit", fit}),
              refused_at("calibrate", {"recordings", "--synthetic-truth"}));
  EXPECT_THAT(refusal({"calibrate", "s.yaml", "a.csv", "--format", "papillaray-csv", "--fit", fit}),
              mentions({"papillaray-csv", "papillarray-csv"}));
}

TEST(CommandLine, AWrongFormatIsNamedBeforeAMissingFolder) {
  EXPECT_THAT(refusal({"export", "a.h5", "--format", "vendor"}), HasSubstr("'vendor'"));
  EXPECT_THAT(refusal({"import", "a.csv", "--format", "bts"}), mentions({"bts"}));
  EXPECT_THAT(refusal({"import", "a.csv", "--format", "bts3v2", "--seed", "-1"}), HasSubstr("import: --seed"));
}

}  // namespace
}  // namespace slipbench
