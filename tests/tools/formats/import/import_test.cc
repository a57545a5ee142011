// Stored content of each format, always without truth; a simulated trial through `export` and
// `import`; damaged and wrong sources.
#include <cmath>

#include <fmt/format.h>
#include <sys/stat.h>
#include <nlohmann/json.hpp>

#include "sim/core/process/interrupted.h"
#include "tests/expect.h"
#include "tests/tools/formats/import/sources.h"
#include "tools/dataset/reader.h"
#include "tools/formats/export/export.h"
#include "tools/formats/import/source_table.h"
#include "tools/registry/program_catalogues.h"
#include "tools/trial/sweep/run_sweep.h"
#include "tools/verify/verify.h"

namespace slipbench::import_test {
namespace {

using namespace slipbench::testing;

struct Import : slipbench::testing::ImportTest {
  [[nodiscard]] TrialRecord trial(std::size_t number) const { return DatasetReader(path("out.h5")).read_trial(number); }
  [[nodiscard]] nlohmann::json params(std::size_t number) const { return nlohmann::json::parse(trial(number).params); }
};

TEST_F(Import, GraspIsARowOfThreeFingers) {
  const std::string file =
      source("bts3v2_palm_45.csv", grasp_header() + grasp_row("coke", "0", 1000) + grasp_row("ball", "1", 2000));
  const ImportSummary summary = run({file}, "bts3v2");
  EXPECT_EQ(summary.trials, 2u);
  EXPECT_EQ(summary.samples, 2u);
  EXPECT_THAT(summary.objects, ElementsAre(std::pair("ball", 1u), std::pair("coke", 1u)));
  EXPECT_THAT(summary.files, ElementsAre(path("out.h5")));

  const TrialRecord held = trial(0), lost = trial(1);
  ASSERT_THAT(held.sensors, SizeIs(3));
  EXPECT_EQ(held.sensors[0].name, "ff");
  EXPECT_EQ(held.sensors[1].name, "mf");
  EXPECT_EQ(held.sensors[2].name, "th");
  for (std::size_t finger = 0; finger < 3; ++finger) {
    const SensorRecord& sensor = held.sensors[finger];
    EXPECT_EQ(sensor.type, "biotac_sp");
    EXPECT_THAT(sensor.time, ElementsAre(0.0));
    ASSERT_THAT(sensor.channels, SizeIs(1));
    EXPECT_EQ(sensor.channels[0].name, "electrodes");
    EXPECT_EQ(sensor.channels[0].unit, "counts");
    EXPECT_EQ(sensor.channel_names.front(), "E1");
    ASSERT_THAT(sensor.channels[0].values, SizeIs(24));
    // By finger: 24 of the 72 each.
    for (std::size_t e = 0; e < 24; ++e) EXPECT_EQ(sensor.channels[0].values[e], static_cast<float>(1000 + 24 * finger + e + 1));
    EXPECT_FALSE(sensor.labels.truth);
    EXPECT_THAT(sensor.labels.state_paper, ElementsAre(1));
    EXPECT_THAT(sensor.labels.rule, HasSubstr("bts3v2"));
    EXPECT_THAT(sensor.labels.state, IsEmpty());
    EXPECT_THAT(sensor.labels.unit_state, IsEmpty());
  }
  EXPECT_THAT(lost.sensors[0].labels.state_paper, ElementsAre(3));
  EXPECT_FALSE(held.outcome.grasp->dropped);
  EXPECT_TRUE(lost.outcome.grasp->dropped);
  EXPECT_TRUE(std::isnan(held.outcome.max_slip_distance));
  EXPECT_EQ(params(1), nlohmann::json::parse(
                           R"({"object": "ball", "palm": "45", "slipped": true, "file": "bts3v2_palm_45.csv", "row": 2})"));
}

TEST_F(Import, SlideIsAFileOfTheFoldersClass) {
  source("set/n/case7.csv", slide_header() + slide_row(0) + slide_row(1) + slide_row(2));
  // Line ends of Windows, and blanks.
  std::string windows = slide_header() + slide_row(5) + slide_row(6);
  for (std::size_t at = 0; (at = windows.find('\n', at)) != std::string::npos; at += 3) windows.replace(at, 1, " \r\n");
  source("set/t/pen12.csv", windows);
  source("set/notes.txt", "not a source");
  const ImportSummary summary = run({path("set")}, "biotacsp-dos");
  EXPECT_EQ(summary.sources, 2u);
  EXPECT_EQ(summary.samples, 5u);

  const SensorRecord slides = trial(0).sensors.at(0), rests = trial(1).sensors.at(0);
  EXPECT_EQ(slides.name, "pad");
  EXPECT_EQ(slides.rate, 100.0);
  EXPECT_THAT(slides.time, ElementsAre(0.0, 0.01, 0.02));
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t e = 0; e < 24; ++e)
      EXPECT_EQ(slides.channels[0].values[24 * row + e], static_cast<float>(100 * (e + 1) + row));
  }
  EXPECT_THAT(slides.labels.state_paper, ElementsAre(3, 3, 3));
  EXPECT_THAT(rests.labels.state_paper, ElementsAre(1, 1));
  EXPECT_EQ(rests.channels[0].values[0], 105.0F);
  EXPECT_EQ(params(0), nlohmann::json::parse(R"({"object": "case", "class": "n", "number": "7", "file": "n/case7.csv"})"));
}

// Two folders with a file of the same name each.
TEST_F(Import, FilesOfSeveralFoldersKeepTheFoldersNames) {
  for (const char* name : {"set/n/case1.csv", "set/t/case1.csv"}) source(name, slide_header() + slide_row(0));
  run({path("set/n"), path("set/t")}, "biotacsp-dos");
  EXPECT_EQ(params(0)["file"], "n/case1.csv");
  EXPECT_EQ(params(1)["file"], "t/case1.csv");
  EXPECT_THAT(refusal_of([&] { list_sources({path("set")}, {".txt", ".dat"}, true); }), mentions({path("set"), ".txt, .dat"}));
  std::filesystem::create_directory(path("set/bag"));
  source("set/bag/metadata.yaml", "");
  const std::vector<SourceFile> files = list_sources({path("set")}, {".csv"}, true);
  ASSERT_THAT(files, SizeIs(3));
  EXPECT_EQ(files[0].name, "bag");
}

TEST_F(Import, LinksOutOfTheFoldersOfTheCommandAreRefused) {
  namespace fs = std::filesystem;
  const std::string other = source("other/secret.csv", "root:x:0:0\n");
  source("set/n/case1.csv", slide_header() + slide_row(0));
  fs::create_symlink("case1.csv", path("set/n/case2.csv"));
  EXPECT_THAT(refusal_of([&] { list_sources({path("set")}, {".csv"}, true); }), mentions({"case2.csv: is given twice"}));
  fs::remove(path("set/n/case2.csv"));
  for (const std::string& target : {other, std::string("../../other/secret.csv")}) {
    fs::create_symlink(target, path("set/n/b.csv"));
    EXPECT_THAT(refusal_of([&] { list_sources({path("set")}, {".csv"}, true); }),
                mentions({path("set/n/b.csv") +
                          ": is a link to a file outside of the folders of the command; to read it, name the file"}));
    // As the remedy says.
    EXPECT_THAT(list_sources({path("set/n/case1.csv"), path("set/n/b.csv")}, {".csv"}, true), SizeIs(2));
    EXPECT_THAT(refusal_of([&] { list_sources({path("set"), path("other")}, {".csv"}, true); }), mentions({"is given twice"}));
    fs::remove(path("set/n/b.csv"));
  }
  // A bag with a link, in a folder and named; a link to a bag.
  source("set/bag/metadata.yaml", "");
  fs::create_symlink(other, path("set/bag/a.db3"));
  for (const char* named : {"set", "set/bag"})
    EXPECT_THAT(refusal_of([&] { list_sources({path(named)}, {".csv"}, true); }), mentions({"bag/a.db3: is a link"}));
  fs::remove_all(path("set/bag"));
  source("other/bag/metadata.yaml", "");
  fs::create_directory_symlink(path("other/bag"), path("set/bag"));
  EXPECT_THAT(refusal_of([&] { list_sources({path("set")}, {".csv"}, true); }), mentions({"set/bag: is a link"}));
  EXPECT_THAT(list_sources({path("set/bag")}, {".csv"}, true), SizeIs(1));
  // A folder that is reached by a link itself, with an inner link.
  fs::remove(path("set/bag"));
  fs::create_directory_symlink(path("set"), path("alias"));
  EXPECT_THAT(list_sources({path("alias")}, {".csv"}, true), SizeIs(1));
}

TEST_F(Import, FilesOfAFolderComeInTheOrderOfTheirNames) {
  for (const char* name : {"set/s/b1.csv", "set/e/z1.csv", "set/e/a1.csv"}) source(name, slide_header() + slide_row(0));
  run({path("set")}, "biotacsp-dos");
  EXPECT_EQ(params(0)["file"], "e/a1.csv");
  EXPECT_EQ(params(1)["file"], "e/z1.csv");
  EXPECT_EQ(params(2)["file"], "s/b1.csv");
}

TEST_F(Import, LogHasItsPillarsItsRateAndTheDevicesOwnSlip) {
  const std::vector<int> none{-2, -2, -2, -2, -2, -2, -2, -2, -2}, held{1, 2, -2, -2, -2, -2, -2, -2, -1},
      some{3, 2, -2, -2, -2, -2, -2, -2, -1}, all{3, 3, -2, -2, -2, -2, -2, -2, -1};
  // Steps of 2, 2 and 5 ms: 3 steps in 9 ms. Stamps in us give the rate within 1 us in 9 ms, 0.04
  // Hz: 333.3 Hz. One row is repeated.
  const std::string file = source("LOG_1.csv", log_header(1) + log_row(1'000'000, {log_cells(none)}) +
                                                   log_row(1'002'000, {log_cells(held)}) + log_row(1'002'000, {log_cells(held)}) +
                                                   log_row(1'004'000, {log_cells(some)}) + log_row(1'009'000, {log_cells(all)}));
  const ImportSummary summary = run({file}, "papillarray-csv");
  EXPECT_EQ(summary.repeated_rows, 1u);
  const SensorRecord sensor = trial(0).sensors.at(0);
  EXPECT_EQ(sensor.name, "pad");
  EXPECT_EQ(sensor.type, "papillarray");
  EXPECT_EQ(sensor.rate, 333.3);
  ASSERT_TRUE(sensor.timing);
  EXPECT_NEAR(sensor.timing->mean_rate, 3.0 / 0.009, 1e-9);
  EXPECT_NEAR(sensor.timing->median_rate, 500.0, 1e-9);
  EXPECT_NEAR(sensor.timing->largest_gap, 0.005, 1e-12);
  EXPECT_EQ(sensor.timing->largest_gap_at, 1.004);
  EXPECT_NEAR(sensor.timing->resolution, 1e-6, 1e-12);
  ASSERT_THAT(summary.warnings, SizeIs(1));
  EXPECT_EQ(
      summary.warnings[0].text,
      file +
          ": its samples are not evenly spaced: 333.333 Hz on average, 500 Hz by the median step, the longest step is 0.005 s, 0.004 s after the first sample; `detect` and `eval` bridge steps of up to 0.1 s, --rate RATE resamples it for all detectors");
  EXPECT_THAT(sensor.time, ElementsAre(1.0, 1.002, 1.004, 1.009));
  ASSERT_THAT(sensor.channels, SizeIs(2));
  EXPECT_EQ(sensor.channels[0].name, "force");
  EXPECT_EQ(sensor.channels[1].name, "displacement");
  EXPECT_EQ(sensor.channels[1].unit, "m");
  EXPECT_EQ(sensor.channel_names.front(), "P0_FX");
  for (std::size_t p = 0; p < 9; ++p) {
    const auto number = static_cast<float>(p);
    EXPECT_EQ(sensor.channels[0].values[3 * p], number);
    EXPECT_EQ(sensor.channels[0].values[3 * p + 2], 2.0F);
    EXPECT_EQ(sensor.channels[1].values[3 * p], static_cast<float>(static_cast<double>(p) / 1e3));  // mm
    EXPECT_EQ(sensor.channels[1].values[3 * p + 1], 0.00025F);
  }
  EXPECT_THAT(sensor.labels.state_paper, ElementsAre(0, 1, 2, 3));
  EXPECT_EQ(params(0), nlohmann::json::parse(R"({"file": "LOG_1.csv", "slip_detection": true, "repeated_rows": 1})"));
}

TEST_F(Import, LogOfTwoSensorsWithoutSlipDetectionHasNoLabels) {
  const std::vector<int> idle(9, 0), held(9, 1);
  const std::string file = source("LOG_2.csv", log_header(2, true) + log_row(0, {log_cells(idle, false), log_cells(held)}) +
                                                   log_row(1000, {log_cells(idle, false), log_cells(held)}));
  run({file}, "papillarray-csv");
  const DatasetReader reader(path("out.h5"));
  EXPECT_THAT(reader.sensors(0), ElementsAre("s0", "s1"));
  EXPECT_THAT(reader.read_sensor(0, "s0").labels.state_paper, IsEmpty());
  EXPECT_THAT(reader.read_sensor(0, "s1").labels.state_paper, ElementsAre(1, 1));
  EXPECT_FALSE(params(0)["slip_detection"].get<bool>());
}

TEST_F(Import, TrainingFileSaysItsMoveAndWhichPillarsSlip) {
  // (contact, slip) of nine pillars: none; two that hold; one of the two slips; both.
  const std::vector<std::string> none(9, "0,0");
  std::vector<std::string> held = none, some = none, all = none, centre = none;
  held[0] = held[4] = "1,0";
  some[0] = "1,1", some[4] = "1,0";
  all[0] = all[4] = "1,1";
  centre[4] = "1,0";
  const std::string rows = training_row("0", none) + training_row("0.001", held) + training_row("0.002", some) +
                           training_row("0.003", all) + training_row("0.004", centre);
  source("set/rotation/demo_3-v_4.0-slip.csv", rows);
  source("set/translation/other.csv", rows);
  run({path("set")}, "training-csv");
  const SensorRecord turns = trial(0).sensors.at(0), slides = trial(1).sensors.at(0);
  EXPECT_EQ(turns.rate, 1000.0);
  EXPECT_THAT(turns.time, ElementsAre(0.0, 0.001, 0.002, 0.003, 0.004));
  EXPECT_THAT(slides.labels.state_paper, ElementsAre(0, 1, 2, 3, 1));
  // In a turn the centre pillar does not slide and does not count: pillar 0 alone decides.
  EXPECT_THAT(turns.labels.state_paper, ElementsAre(0, 1, 3, 3, 1));
  EXPECT_EQ(params(0),
            nlohmann::json::parse(
                R"({"file": "rotation/demo_3-v_4.0-slip.csv", "move": "rotation", "speed_mm_s": 4.0, "end": "slip"})"));
  EXPECT_EQ(params(1), nlohmann::json::parse(R"({"file": "translation/other.csv", "move": "translation"})"));
}

// Properties of every imported file.
struct Imported : Import {
  void SetUp() override {
    std::string rows;
    for (int k = 0; k < 40; ++k) rows += grasp_row("object_" + std::to_string(k % 4), k % 3 == 0 ? "1" : "0", k);
    file_ = source("grasps.csv", grasp_header() + rows);
    run({file_}, "bts3v2");
  }
  std::string file_;
};

TEST_F(Imported, SaysThatItHoldsNoTruth) {
  const DatasetReader reader(path("out.h5"));
  EXPECT_EQ(reader.header().truth, "none: imported from bts3v2");
  EXPECT_EQ(reader.header().scene, "");
  EXPECT_EQ(reader.header().command, "slipbench import " + file_ + " --format bts3v2 --seed 7");
  EXPECT_THAT(reader.bodies(0), IsEmpty());
  EXPECT_THAT(refusal_of([&] { reader.check_truth("a report"); }), refused_at(path("out.h5"), {"a report", "bts3v2"}));
}

// Source names can be pasted into a shell.
TEST_F(Imported, NamesItsSourcesAsAShellTakesThem) {
  const std::string file = source("my grasps.csv", grasp_header() + grasp_row("coke", "0", 1000));
  run({file}, "bts3v2", "spaced.h5");
  EXPECT_EQ(DatasetReader(path("spaced.h5")).header().command, "slipbench import '" + file + "' --format bts3v2 --seed 7");
}

// As spreadsheets write it: a UTF-8 mark in front, an empty line at the end.
TEST_F(Imported, MarkAndLastEmptyLineAreNoRows) {
  const std::string mark = "\xef\xbb\xbf", rows = grasp_header() + grasp_row("coke", "0", 1000);
  EXPECT_EQ(run({source("a.csv", mark + rows + "\n")}, "bts3v2", "a.h5").trials, 1u);
  EXPECT_EQ(run({source("b.csv", mark + rows + "\r\n")}, "bts3v2", "b.h5").trials, 1u);
  EXPECT_EQ(
      run({source("n/case1.csv", mark + slide_header() + slide_row(1) + slide_row(2) + "\n")}, "biotacsp-dos", "c.h5").samples,
      2u);
}

TEST_F(Imported, IsSplitByObject) {
  const DatasetReader reader(path("out.h5"));
  std::size_t all = 0;
  std::set<std::string> seen;
  for (const char* part : {"train", "valid", "test"}) {
    std::set<std::string> objects;
    for (const std::size_t trial : reader.mask(part)) {
      objects.insert(nlohmann::json::parse(reader.info(trial).params)["object"].get<std::string>());
      ++all;
    }
    EXPECT_FALSE(objects.empty()) << part;
    for (const std::string& object : objects) EXPECT_TRUE(seen.insert(object).second) << object << " is in two parts";
  }
  EXPECT_EQ(all, 40u);
}

TEST_F(Imported, IsVerifiedWithoutTheTruth) {
  const Verified verified = verify_datasets({path("out.h5")});
  EXPECT_TRUE(verified.readable);
  EXPECT_TRUE(verified.holds) << verified.datasets.dump();
  for (const auto& check : verified.datasets[0]["checks"]) {
    const bool of_truth =
        check["check"] == "events" || check["check"] == "cone" || check["check"] == "slip" || check["check"] == "contact";
    EXPECT_EQ(check["checked"].get<std::size_t>() == 0, of_truth) << check;
    if (!of_truth) continue;
    EXPECT_EQ(check["left_out"][0], "all: the dataset has no truth (none: imported from bts3v2)");
  }
}

TEST_F(Imported, HasTheSameBytesAgain) {
  const std::string before = bytes_of(path("out.h5"));
  run({file_}, "bts3v2");  // replaces it
  EXPECT_EQ(bytes_of(path("out.h5")), before);
}

TEST_F(Imported, WithoutAnOutputIsOnlyRead) {
  const ImportSummary summary = import_recordings({{file_}, &import_format("bts3v2"), "", 1});
  EXPECT_EQ(summary.trials, 40u);
  EXPECT_THAT(summary.files, IsEmpty());
  EXPECT_THAT(names(), ElementsAre("grasps.csv", "out.h5"));
}

TEST_F(Imported, InterruptedLeavesNothing) {
  std::filesystem::remove(path("out.h5"));
  const std::atomic<bool> interrupt{true};
  const InterruptScope scope(&interrupt);
  EXPECT_THROW(run({file_}, "bts3v2"), Interrupted);
  EXPECT_THAT(names(), ElementsAre("grasps.csv"));
}

// Files that no import writes, because any file may be given.
struct MadeUp : Import {
  std::string write(TrialRecord record) {
    return slipbench::testing::write_dataset(
        path("out.h5"),
        {.version = "1", .scene = "", .seed = 7, .command = "slipbench import a.csv", .truth = "none: imported from a.csv"},
        {record});
  }
  static TrialRecord record() {
    TrialRecord record = slipbench::testing::make_record(0, 3);
    record.bodies.clear();
    LabelRecord labels;
    labels.truth = false;
    labels.rule = "a rule";
    labels.state_paper = {1, 2, 3};
    record.sensors[0].labels = labels;
    return record;
  }
};

TEST_F(MadeUp, RecordComesBackAsItWas) {
  write(record());
  const TrialRecord back = trial(0);
  EXPECT_EQ(trial_digest(back), trial_digest(record()));
  EXPECT_EQ(back.sensors[0].labels.rule, "a rule");
}

TEST_F(MadeUp, UnknownStateComesBackWithItsCode) {
  TrialRecord some = record();
  some.sensors[0].labels.state_paper[1] = static_cast<std::uint8_t>(unknown_state);
  write(some);
  EXPECT_EQ(trial(0).sensors[0].labels.state_paper, some.sensors[0].labels.state_paper);
  EXPECT_TRUE(verify_datasets({path("out.h5")}).holds);
}

TEST_F(MadeUp, StateThatDoesNotExistIsRefused) {
  TrialRecord wrong = record();
  wrong.sensors[0].labels.state_paper[1] = 7;
  write(wrong);
  EXPECT_THAT(refusal_of([&] { static_cast<void>(trial(0)); }), mentions({"labels/pad/state_paper", "7"}));
  EXPECT_FALSE(verify_datasets({path("out.h5")}).holds);
}

TEST_F(MadeUp, ControlLoopInARecordingIsRefused) {
  TrialRecord wrong = record();
  wrong.control = slipbench::testing::make_controlled_record(0, 3).control;
  write(wrong);
  EXPECT_THAT(refusal_of([&] { static_cast<void>(trial(0)); }), mentions({"control", "imported"}));
}

// Pressed, slid and turned; 60 ms of sliding at 16 mm/s make all nine pillars slip.
struct RoundTrip : slipbench::testing::ImportTest {
  void SetUp() override {
    SweepOptions options;
    options.scene_path = SLIPBENCH_SOURCE_DIR "/scenes/papillarray/stage.yaml";
    options.overrides = {{"duration", "1.3 s"}, {"motion.start", "1 s"}, {"motion.speed", "16 mm/s"}};
    options.output = path("made.h5");
    options.limit = 1;
    run_sweep(options, program_catalogues(), {});
  }
  // Exports with the flags of the strict rule and imports again.
  void around(ExportFormat format, const std::string& import_format) {
    ExportOptions options;
    options.format = format;
    export_dataset(path("made.h5"), path("csv"), options);
    run({path("csv")}, import_format);
  }
  [[nodiscard]] SensorRecord pad(const std::string& name) const { return DatasetReader(path(name)).read_sensor(0, "pad"); }

  void expect_same() const {
    const SensorRecord made = pad("made.h5"), back = pad("out.h5");
    EXPECT_EQ(back.type, made.type);
    EXPECT_EQ(back.rate, made.rate);
    EXPECT_EQ(back.time, made.time);
    EXPECT_EQ(back.channel_names, made.channel_names);
    ASSERT_EQ(back.channels.size(), made.channels.size());
    for (std::size_t c = 0; c < made.channels.size(); ++c) {
      EXPECT_EQ(back.channels[c].name, made.channels[c].name);
      EXPECT_EQ(back.channels[c].unit, made.channels[c].unit);
      EXPECT_EQ(back.channels[c].shape, made.channels[c].shape);
      EXPECT_EQ(back.channels[c].values, made.channels[c].values) << made.channels[c].name;
    }
    // The strict rule's flags give the strict rule's states.
    EXPECT_EQ(back.labels.state_paper, made.labels.state);
    EXPECT_EQ(std::ranges::count(made.labels.state, 0) > 0, true);
    EXPECT_EQ(std::ranges::count(made.labels.state, 3) > 0, true);
  }
};

TEST_F(RoundTrip, OfTheVendorsLog) {
  around(ExportFormat::vendor_csv, "papillarray-csv");
  expect_same();
}

TEST_F(RoundTrip, OfTheTrainingFiles) {
  around(ExportFormat::training_csv, "training-csv");
  expect_same();
}

using namespace slipbench::testing;

// Recordings of one channel that counts the samples, as a map's reader passes them to the writer.
struct Timed : Import {
  static TrialRecord record(const std::vector<double>& times, double resolution) {
    SensorRecord sensor;
    sensor.name = "pad";
    sensor.type = "meter";
    sensor.labels.truth = false;
    sensor.time = times;
    sensor.rate = rate_of(times, resolution);
    sensor.timing = timing_of(times, resolution);
    sensor.channels = {{"force", "N", {1}, {}}};
    sensor.channel_names = {"f"};
    for (std::size_t k = 0; k < times.size(); ++k) sensor.channels[0].values.push_back(static_cast<float>(k));
    TrialRecord record = make_recording({{"file", "a.csv"}}, "");
    record.body_time = times;
    record.sensors.push_back(std::move(sensor));
    return record;
  }
  // Stamps as in a table with that many decimals.
  ImportSummary written(const std::vector<double>& times, int decimals, std::optional<double> rate = {}) {
    std::vector<double> stamps;
    for (const double time : times) stamps.push_back(std::stod(fmt::format("{:.{}f}", time, decimals)));
    return written(record(stamps, std::pow(10.0, -decimals)), rate);
  }
  ImportSummary written(TrialRecord record, std::optional<double> rate = {}) {
    RecordingWriter writer({{file}, nullptr, path("out.h5"), 7, "map.yaml", rate}, "trial");
    writer.add(std::move(record), file, 0);
    return writer.finish(1);
  }
  const std::string file = "a.csv";
  [[nodiscard]] SensorRecord pad() const { return DatasetReader(path("out.h5")).read_sensor(0, "pad"); }
  static std::vector<double> clock(double rate, std::size_t count) {
    std::vector<double> times;
    for (std::size_t k = 0; k < count; ++k) times.push_back(static_cast<double>(k) / rate);
    return times;
  }
  // 100 Hz with a pause of 0.5 s before sample 30.
  static std::vector<double> with_gap() {
    std::vector<double> times = clock(100.0, 60);
    for (std::size_t k = 30; k < 60; ++k) times[k] += 0.5;
    return times;
  }
};

TEST_F(Timed, RateIsThatOfTheClockWithinTheStampsDigits) {
  for (const auto& [rate, decimals] :
       std::vector<std::pair<double, int>>{{44'100.0, 9}, {2e6, 9}, {700e3, 9}, {30.0, 9}, {444.0, 3}}) {
    const ImportSummary summary = written(clock(rate, 3000), decimals);
    EXPECT_EQ(pad().rate, rate);
    EXPECT_THAT(summary.warnings, IsEmpty()) << rate;
  }
  std::vector<double> since_1970;
  for (int k = 0; k < 600; ++k) since_1970.push_back(1e-9 * static_cast<double>(1581073084690542592L + 10'000'000L * k));
  written(record(since_1970, 1e-9));
  EXPECT_EQ(pad().rate, 100.0);
}

TEST_F(Timed, ResolutionIsThatOfTheLastDigit) {
  EXPECT_DOUBLE_EQ(resolution_of("7"), 1.0);
  EXPECT_DOUBLE_EQ(resolution_of("1.250"), 1e-3);
  EXPECT_DOUBLE_EQ(resolution_of("-1.25e-3"), 1e-5);
  EXPECT_DOUBLE_EQ(resolution_of("1.2E+3"), 100.0);
  EXPECT_DOUBLE_EQ(resolution_of("3."), 1.0);
}

TEST_F(Timed, WarnsOfTimesInAnotherUnit) {
  const ImportSummary summary = written(clock(0.1, 60), 0);  // 0, 10, 20: 100 Hz in ms
  ASSERT_THAT(summary.warnings, SizeIs(1));
  EXPECT_EQ(summary.warnings[0].text,
            file + ": has one sample every 10 s; times in ms would give 100 Hz (time: {unit: ms} in the map)");
  EXPECT_THAT(written(clock(100.0, 60), 2).warnings, IsEmpty());
}

// Sensors of a table share its stamps; sensors of a bag have their own.
TEST_F(Timed, WarnsOfEachSensorsOwnStamps) {
  TrialRecord two = record(clock(100.0, 60), 1e-3);
  two.sensors.push_back(record(with_gap(), 1e-3).sensors.front());
  two.sensors.back().name = "skin";
  const ImportSummary summary = written(std::move(two));
  ASSERT_THAT(summary.warnings, SizeIs(1));
  EXPECT_THAT(summary.warnings[0].text, HasSubstr(file + ": sensor skin: its samples are not evenly spaced: "));
}

// Values count the rows and so show the time: row k was recorded at k/100 s before the gap and at
// k/100 s + 0.5 s after it.
TEST_F(Timed, ResamplingTakesValuesBetweenTheSamples) {
  const ImportSummary summary = written(with_gap(), 3, 80.0);
  const SensorRecord sensor = pad();
  EXPECT_EQ(sensor.rate, 80.0);
  ASSERT_THAT(sensor.time, SizeIs(88));  // 1.09 s: 87 steps of 12.5 ms
  for (std::size_t k = 0; k < sensor.time.size(); ++k) {
    EXPECT_NEAR(sensor.time[k], static_cast<double>(k) / 80.0, 1e-12);
    const double t = sensor.time[k], row = t <= 0.29 ? 100.0 * t : t >= 0.8 ? 100.0 * (t - 0.5) : 29.0 + (t - 0.29) / 0.51;
    EXPECT_NEAR(sensor.channels[0].values[k], row, 1e-4) << k;
  }
  EXPECT_NO_THROW(check_evenly_spaced(sensor));
  ASSERT_TRUE(sensor.timing);  // of the original stamps
  EXPECT_NEAR(sensor.timing->median_rate, 100.0, 1e-6);
  // Strictly between 0.29 and 0.8 s: 24/80 to 63/80 s.
  EXPECT_EQ(params(0)["resampled"], nlohmann::json::parse(R"({"rate_hz": 80.0, "samples_in_gaps": 40})"));
  ASSERT_THAT(summary.warnings, SizeIs(2));
  EXPECT_EQ(summary.warnings[1].text, file + ": interpolated linearly in gaps of the recording: 40 of 88 samples at 80 Hz");
  EXPECT_THAT(DatasetReader(path("out.h5")).header().command, HasSubstr(" --map map.yaml --rate '80 Hz' --seed 7"));
  EXPECT_TRUE(verify_datasets({path("out.h5")}).holds);
}

// Rows k at k/100 s, 0 to 0.1 s, at 250 Hz: 26 samples, of which every fifth is a recorded one. The
// others lie on straight lines, so nothing above 50 Hz, half of the recorded rate, is shown.
TEST_F(Timed, ResamplingAboveTheRecordingsRateSaysWhatIsMadeUp) {
  const ImportSummary summary = written(clock(100.0, 11), 3, 250.0);
  const SensorRecord sensor = pad();
  EXPECT_EQ(sensor.rate, 250.0);
  ASSERT_THAT(sensor.time, SizeIs(26));
  for (std::size_t k = 0; k < sensor.time.size(); ++k)
    EXPECT_NEAR(sensor.channels[0].values[k], static_cast<double>(k) / 2.5, 1e-5) << k;
  EXPECT_EQ(params(0)["resampled"], nlohmann::json::parse(R"({"rate_hz": 250.0, "samples_in_gaps": 0, "samples_made_up": 20})"));
  ASSERT_THAT(summary.warnings, SizeIs(1));
  EXPECT_THAT(summary.warnings[0].text, mentions({file, "250 Hz", "100 Hz", "20 of 26 samples", "50 Hz"}));
}

TEST_F(Timed, ResamplingStaysWithinTheRecording) {
  EXPECT_EQ(written(clock(99.99, 500), 6, 100.0).samples, 500u);
  EXPECT_EQ(pad().rate, 100.0);
  EXPECT_THAT(refusal_of([&] { written(clock(99.99, 500), 6, 0.1); }), refused_at(file, {"0.1 Hz"}));
  const std::string grasp = source("grasp.csv", grasp_header() + grasp_row("coke", "0", 1));
  EXPECT_THAT(refusal_of([&] {
                import_recordings({{grasp}, &import_format("bts3v2"), "", 7, "", 10.0});
              }),
              refused_at(grasp, {"one sample", "--rate"}));
}

struct ImportErrors : slipbench::testing::ImportTest {
  static std::string place(const std::string& file, int line) { return line == 0 ? file : file + ":" + std::to_string(line); }
  // Imports a source and expects an error at `line`, or for the whole source if 0; only the source
  // is left.
  void expect_refusal(const std::string& format, const std::string& name, const std::string& text, int line,
                      const std::vector<std::string>& words) {
    const std::string file = source(name, text);
    const std::vector<std::string> before = names();
    EXPECT_THAT(refusal_of([&] { run({file}, format); }), refused_at(place(file, line), words));
    EXPECT_EQ(names(), before);
  }
};

std::string with(std::string text, const std::string& old, const std::string& now) {
  const std::size_t at = text.rfind(old);
  if (at == std::string::npos) throw std::logic_error("no " + old);
  return text.replace(at, old.size(), now);
}

TEST_F(ImportErrors, GraspsAreChecked) {
  const auto refused = [&](const std::string& text, int line, const std::vector<std::string>& words) {
    expect_refusal("bts3v2", "a.csv", text, line, words);
  };
  // 2,100 good rows come first: they fill a first file of the dataset.
  std::string good;
  for (int k = 0; k < 2100; ++k) good += grasp_row("coke", "0", 1);
  refused(grasp_header() + good + grasp_row("coke", "2", 1), 2102, {"slipped", "2", "0, 1"});
  refused("", 1, {"empty", "object"});
  refused(grasp_header(), 1, {"only line"});
  refused(grasp_header() + "\n", 1, {"only line"});
  refused(grasp_header() + "\n" + grasp_row("coke", "0", 1), 2, {"1 column", "74"});
  refused(with(grasp_header(), "th_biotac_24", "th_biotac_25"), 1, {"column 74", "th_biotac_25", "th_biotac_24"});
  refused(with(grasp_header(), ",th_biotac_24", ""), 1, {"73 columns", "74"});
  refused(grasp_header() + "coke\n", 2, {"1 column", "74"});
  refused(grasp_header() + grasp_row("", "0", 1), 2, {"column 1", "object", "''"});
  refused(grasp_header() + grasp_row("\xff", "0", 1), 2, {"column 1", "object", "\\xff"});
  refused(grasp_header() + with(grasp_row("coke", "0", 1), ",73", ",x"), 2, {"column 74", "x", "4095"});
  refused(grasp_header() + with(grasp_row("coke", "0", 1), ",73", ",4096"), 2, {"column 74", "4096", "4095"});
  refused(grasp_header() + with(grasp_row("coke", "0", 1), ",73", ",nan"), 2, {"column 74", "nan", "4095"});
  refused(grasp_header() + std::string(70'000, 'x'), 2, {"65536"});
}

TEST_F(ImportErrors, SlidesAreChecked) {
  const auto refused = [&](const std::string& name, const std::string& text, int line, const std::vector<std::string>& words) {
    expect_refusal("biotacsp-dos", name, text, line, words);
  };
  const std::string good = slide_header() + slide_row(0);
  refused("north/case1.csv", good, 0, {"north", "aw"});
  refused("n/12.csv", good, 0, {"object", "case112.csv"});
  refused("n/case1.csv", slide_header(), 1, {"only line"});
  refused("n/case1.csv", good + "1,2\n", 3, {"2 columns", "24"});
}

TEST_F(ImportErrors, LogsAreChecked) {
  const auto refused = [&](const std::string& text, int line, const std::vector<std::string>& words) {
    expect_refusal("papillarray-csv", "a.csv", text, line, words);
  };
  const std::vector<int> held(9, 1);
  const std::string first = log_header(1) + log_row(1000, {log_cells(held)});
  refused("", 1, {"empty", "T_us"});
  refused("time,x\n", 1, {"column 1", "time", "T_us"});
  refused(with(log_header(1), ",S0_FrictionEst", ""), 1, {"81 columns", "82", "163"});
  refused(with(log_header(2), "S1_FrictionEst", "S2_FrictionEst"), 1, {"column 163", "S2_FrictionEst", "S1_FrictionEst"});
  refused(first, 2, {"1 sample", "two"});
  refused(first + log_row(500, {log_cells(held)}), 3, {"T_us", "500", "1000"});
  refused(first + log_row(1000, {log_cells(std::vector<int>(9, 2))}), 3, {"T_us", "1000", "ascending"});
  refused(first + log_row(2000, {log_cells({1, 1, 1, 1, 1, 1, 1, 1, 0})}), 3, {"column 81", "S0_P8_slipState", "0", "-2"});
  refused(first + with(log_row(2000, {log_cells(held)}), ",-1", ",inf"), 3, {"column 82", "S0_FrictionEst", "inf"});
}

TEST_F(ImportErrors, TrainingFilesAreChecked) {
  const auto refused = [&](const std::string& text, int line, const std::vector<std::string>& words) {
    expect_refusal("training-csv", "a.csv", text, line, words);
  };
  const std::vector<std::string> held(9, "1,0");
  refused("", 1, {"0 samples", "two"});
  refused(training_row("0", held) + training_row("0", held), 2, {"column 1", "time", "0", "ascending"});
  refused(training_row("0", held) + "0.001\n", 2, {"1 column", "73"});
  refused(training_row("0", std::vector<std::string>(9, "1,2")), 1, {"column 3", "P0 slip", "2", "0, 1"});
  refused(training_row("0", std::vector<std::string>(9, "1,0.5")), 1, {"column 3", "P0 slip", "0.5", "0, 1"});
}

TEST_F(ImportErrors, SourcesAreChecked) {
  const auto refusal = [&](const std::vector<std::string>& sources) { return refusal_of([&] { run(sources, "bts3v2"); }); };
  EXPECT_THAT(refusal({path("none.csv")}), refused_at(path("none.csv"), {"no such file"}));
  std::filesystem::create_directory(path("empty"));
  EXPECT_THAT(refusal({path("empty")}), refused_at(path("empty"), {".csv"}));
  const std::string file = source("set/a.csv", grasp_header() + grasp_row("coke", "0", 1));
  EXPECT_THAT(refusal({path("set"), file}), refused_at(file, {"twice"}));
  ::mkfifo(path("pipe").c_str(), 0600);
  EXPECT_THAT(refusal({path("pipe")}), mentions({path("pipe"), "a pipe"}));
  EXPECT_THAT(refusal_of([] { import_format("bts3"); }), mentions({"bts3", "bts3v2"}));
}

// The output's name is checked before a row is read.
TEST_F(ImportErrors, SourceIsNotReplaced) {
  const std::string file = source("a.csv", grasp_header() + grasp_row("coke", "0", 1));
  const std::string before = bytes_of(file);
  EXPECT_THAT(refusal_of([&] { run({file}, "bts3v2", "a.csv"); }), mentions({"exists", "dataset"}));
  EXPECT_EQ(bytes_of(file), before);
  EXPECT_THAT(names(), ElementsAre("a.csv"));
}

}  // namespace
}  // namespace slipbench::import_test
