// Runs every command on an imported dataset: it works, or reports what the dataset lacks. No
// command crashes or leaves files.
#include <fstream>

#include <nlohmann/json.hpp>

#include "tests/expect.h"
#include "tests/tools/cli/commands/child_process.h"
#include "tests/tools/formats/import/sources.h"

namespace slipbench {
namespace {

struct ImportedFiles : ::testing::Test {
  ImportedFiles() {
    std::filesystem::create_directories(folder_ / "set/n");
    std::filesystem::create_directories(folder_ / "set/t");
    std::string header, row;
    for (int e = 1; e <= 24; ++e) {
      header += (e == 1 ? "ff_e" : ",ff_e") + std::to_string(e);
      row += (e == 1 ? "" : ",") + std::to_string(100 * e);
    }
    for (const char* name : {"set/n/case1.csv", "set/n/pen2.csv", "set/t/case3.csv"})
      std::ofstream(folder_ / name) << header << '\n' << row << '\n' << row << '\n';
    data_ = folder_ / "a.h5";
    imported_ = run_program_file({"import", folder_ / "set", "--format", "biotacsp-dos", "-o", data_});
  }
  static void expect_refusal(const std::vector<std::string>& arguments, const std::vector<std::string>& words) {
    const ChildResult result = run_program_file(arguments);
    EXPECT_EQ(result.status, 2) << arguments.front();
    EXPECT_THAT(result.err, mentions(words));
    EXPECT_EQ(result.out, "");
  }

  TemporaryFolder folder_;
  std::string data_;
  ChildResult imported_;
};

TEST_F(ImportedFiles, ImportSaysWhatItRead) {
  EXPECT_EQ(imported_.status, 0) << imported_.err;
  EXPECT_EQ(imported_.out, "3 recordings of 3 files, 6 samples, 2 objects\nwritten: " + data_ +
                               "\nnext: " SLIPBENCH_PROGRAM " verify " + data_ + "\n");
  const ChildResult looked = run_program_file({"import", folder_ / "set", "--format", "biotacsp-dos", "--json"});
  EXPECT_EQ(looked.status, 0);
  EXPECT_EQ(nlohmann::json::parse(looked.out),
            nlohmann::json::parse(R"({"sources": 3, "trials": 3, "samples": 6, "repeated_rows": 0,
                                                                         "objects": {"case": 2, "pen": 1}, "warnings": [], "files": []})"));
}

TEST_F(ImportedFiles, ImportRefusesBadWords) {
  expect_refusal({"import", folder_ / "set", "-o", folder_ / "b.h5"}, {"import", "--format"});
  expect_refusal({"import", "--format", "bts3v2"}, {"import"});
  expect_refusal({"import", folder_ / "set", "--format", "bts3v3"}, {"bts3v3", "bts3v2"});
  expect_refusal({"import", folder_ / "set", "--format", "bts3v2", "-o", folder_ / "b.h5"},
                 {"set/n/case1.csv:1", "column 1", "ff_e1", "object"});
  EXPECT_FALSE(std::filesystem::exists(folder_ / "b.h5"));
}

TEST_F(ImportedFiles, VerifyHoldsWhatIsThere) {
  const ChildResult result = run_program_file({"verify", data_});
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.out, AllOf(HasSubstr("ok: " + data_ + ": 3 trials"),
                                HasSubstr("all: the dataset has no truth (none: imported from biotacsp-dos)")));
}

TEST_F(ImportedFiles, ReadingsAreExported) {
  EXPECT_EQ(run_program_file({"export", data_, "--format", "npz", "-o", folder_ / "npz"}).status, 0);
  EXPECT_EQ(run_program_file({"export", data_, "--format", "csv", "-o", folder_ / "csv"}).status, 0);
  std::ifstream table(folder_ / "csv/demo_2-pad.csv");
  std::string header, first;
  std::getline(table, header);
  std::getline(table, first);
  EXPECT_THAT(header, EndsWith("E24 [counts],state_recorded"));
  EXPECT_THAT(first, EndsWith(",2400,1"));  // touch: non-slip according to the set
  EXPECT_EQ(run_program_file({"export", data_, "--format", "csv", "--labels", "recorded", "-o", folder_ / "csv"}).status, 0);
}

// Samples are 10 ms apart: 100 rows per second.
TEST_F(ImportedFiles, ReportAndViewShowTheReadings) {
  const std::string page = folder_ / "a.html";
  EXPECT_EQ(run_program_file({"report", data_}).status, 0);
  EXPECT_THAT(bytes_of(page), AllOf(HasSubstr("The recordings were imported from biotacsp-dos. They contain no truth"),
                                    HasSubstr("n/pen2.csv"), HasSubstr("over time [s]"), HasSubstr("<h2>Trial 2, case</h2>")));
  std::filesystem::remove(page);
  const ChildResult viewed = run_program_file({"view", data_, "--trial", "1", "--json"});
  EXPECT_EQ(viewed.status, 0) << viewed.err;
  EXPECT_THAT(bytes_of(page), HasSubstr("<h2>Trial 1, pen</h2>"));
  expect_refusal({"report", data_, "--trial", "3"}, {"a.h5", "no trial 3", "0 to 2"});
}

TEST_F(ImportedFiles, WhatNeedsTheTruthIsRefused) {
  const std::string truth = "truth", origin = "imported from biotacsp-dos";
  for (const char* format : {"robomimic", "vendor-csv", "training-csv", "grasp-csv", "slip-csv"})
    expect_refusal({"export", data_, "--format", format, "-o", folder_ / "out"},
                   {std::string("--format ") + format, truth, origin});
  expect_refusal({"export", data_, "--format", "myrmex-csv", "-o", folder_ / "out"}, {"myrmex"});
  expect_refusal({"export", data_, "--format", "myrmex-rotated", "-o", folder_ / "out"}, {"myrmex"});
  expect_refusal({"train-hd", data_, "-o", folder_ / "memories"}, {truth, origin});
  for (const char* rule : {"strict", "paper"}) {
    for (const char* format : {"csv", "npz", "parquet"})
      expect_refusal({"export", data_, "--format", format, "--labels", rule, "-o", folder_ / "out"},
                     {std::string("--labels ") + rule, truth, origin, "--labels recorded"});
    expect_refusal({"eval", "force_ratio", data_, "--labels", rule},
                   {std::string("eval --labels ") + rule, truth, origin, "recorded"});
  }
  for (const char* left : {"out", "memories"}) EXPECT_FALSE(std::filesystem::exists(folder_ / left)) << left;
}

#ifdef SLIPBENCH_WITH_ENGINE
// Two recordings each: one slips by its own labels, one does not. The networks divide by the norm
// of their input, so that their output is a number for a recording and NaN for zeros. The logs have
// 1004 us from row to row: 0.4 % below the rate of the network.
TEST_F(ImportedFiles, AreJudgedByTheirOwnLabels) {
  using namespace slipbench::testing;
  const auto network = [](const char* name) { return SLIPBENCH_SOURCE_DIR "/tests/detectors/network/data/" + std::string(name); };
  const std::string papillarray = network("unit13.onnx"), biotac = network("unit13_biotac.onnx");
  struct Format {
    std::string name, network, sensor, file, slipping,
        sticking;  // `file`: path of the slipping recording inside the folder
  };
  const auto log = [](int state) {
    std::string text = log_header(1);
    for (const long time : {1004, 2008, 3012}) text += log_row(time, {log_cells(std::vector<int>(9, state))});
    return text;
  };
  const auto training = [](const std::string& flags) {
    std::string text;
    for (const char* time : {"0.001004", "0.002008", "0.003012"}) text += training_row(time, std::vector<std::string>(9, flags));
    return text;
  };
  const std::string slide = slide_header() + slide_row(1) + slide_row(2);
  for (const Format& format : {Format{"bts3v2", biotac, "th", "a.csv", grasp_header() + grasp_row("coke", "1", 1000),
                                      grasp_header() + grasp_row("ball", "0", 1000)},
                               Format{"biotacsp-dos", biotac, "pad", "n/pen1.csv", slide, slide},
                               Format{"papillarray-csv", papillarray, "pad", "a.csv", log(3), log(1)},
                               Format{"training-csv", papillarray, "pad", "a.csv", training("1,1"), training("1,0")}}) {
    const std::filesystem::path set = folder_ / format.name;
    std::filesystem::create_directories(set / "n");
    std::filesystem::create_directories(set / "t");
    std::ofstream(set / format.file) << format.slipping;
    std::ofstream(set / "t/pen2.csv") << format.sticking;
    const std::string file = folder_ / (format.name + ".h5");
    const ChildResult imported = run_program_file({"import", set, "--format", format.name, "-o", file});
    ASSERT_EQ(imported.status, 0) << imported.err;
    const ChildResult judged =
        run_program_file({"eval", format.network, file, "--labels", "recorded", "--sensor", format.sensor, "--json"});
    ASSERT_EQ(judged.status, 0) << format.name << ": " << judged.err;
    const auto result = nlohmann::json::parse(judged.out);
    EXPECT_EQ(result["truth"], "none: imported from " + format.name);
    const auto& all = result["all"];
    EXPECT_EQ(all["trials"], 2) << format.name;
    EXPECT_EQ(all["slipping"], 1) << format.name;
    // A grasp has a single sample, and so no duration.
    EXPECT_EQ(all["figures"]["false_alarms_per_minute"]["value"].is_null(), format.name == "bts3v2") << format.name;
    EXPECT_THAT(result["worst"].dump(), Not(HasSubstr("nan"))) << format.name;
    // From a threshold below every probability, at which every sample is called slip, to one above,
    // at which none is.
    ASSERT_GT(result["alarms"].size(), 10U) << format.name;
    EXPECT_LT(result["alarms"].front()["threshold"], 0.02);
    EXPECT_GE(result["alarms"].front()["recall_of_slip"], result["alarms"].back()["recall_of_slip"]) << format.name;
    EXPECT_FALSE(result.contains("classes")) << format.name;  // two classes: slip or not
  }
}

// Ten samples 1 ms apart every 0.1 s: 1 kHz by the median step, 109 Hz on average. The network
// needs 1 kHz; nine steps of 91 ms are 90 % of 0.909 s.
TEST_F(ImportedFiles, ANetworkBridgesALostSampleAndRefusesBursts) {
  using namespace slipbench::testing;
  std::string text = log_header(1), even = log_header(1);
  for (long k = 0; k < 100; ++k) {
    text += log_row(100'000 * (k / 10) + 1000 * (k % 10), {log_cells(std::vector<int>(9, 3))});
    even += log_row(1000 * k + (k < 50 ? 0 : 1000), {log_cells(std::vector<int>(9, 3))});  // one sample of 101 is missing
  }
  const std::string network = SLIPBENCH_SOURCE_DIR "/tests/detectors/network/data/unit13.onnx", bursts = folder_ / "bursts.h5",
                    lost = folder_ / "lost.h5", resampled = folder_ / "resampled.h5";
  std::ofstream(folder_ / "bursts.csv") << text;
  std::ofstream(folder_ / "lost.csv") << even;
  const ChildResult imported = run_program_file({"import", folder_ / "bursts.csv", "--format", "papillarray-csv", "-o", bursts});
  ASSERT_EQ(imported.status, 0) << imported.err;
  EXPECT_THAT(imported.err, HasSubstr("slipbench: warning: " + std::string(folder_ / "bursts.csv") +
                                      ": its samples are not evenly spaced: 108.9"));  // 99 steps in 0.909 s
  expect_refusal({"eval", network, bursts, "--labels", "recorded"}, {"trial 0", "sensor 'pad'", "9 gaps", "90 %", "--resample"});
  const ChildResult interpolated = run_program_file({"eval", network, bursts, "--labels", "recorded", "--resample", "--json"});
  ASSERT_EQ(interpolated.status, 0) << interpolated.err;
  EXPECT_THAT(nlohmann::json::parse(interpolated.out)["command"].get<std::string>(), HasSubstr(" --resample"));
  ASSERT_EQ(run_program_file({"import", folder_ / "lost.csv", "--format", "papillarray-csv", "-o", lost}).status, 0);
  for (const char* command : {"eval", "detect"}) {
    const ChildResult bridged = run_program_file({command, network, lost});
    EXPECT_EQ(bridged.status, 0) << bridged.err;
    EXPECT_THAT(bridged.out, HasSubstr("  the network reads 1 kHz\n"));
    EXPECT_THAT(bridged.out, HasSubstr("  resampled evenly at 1 kHz for unit13.onnx; 1 gap of at most 2 ms bridged\n"));
  }
  // A detector that uses single samples needs no rate.
  EXPECT_EQ(run_program_file({"eval", "force_ratio", lost, "--labels", "recorded"}).status, 0);
  // A detector that picks every k-th sample refuses them.
  expect_refusal({"detect", "cl_gst_hd", lost}, {"trial 0", "sensor pad", "990 Hz", "1000 Hz", "0.002 s", "import --rate"});
  const ChildResult again =
      run_program_file({"import", folder_ / "lost.csv", "--format", "papillarray-csv", "--rate", "1 kHz", "-o", resampled});
  ASSERT_EQ(again.status, 0) << again.err;
  EXPECT_THAT(again.out, HasSubstr("resampled at 1 kHz by linear interpolation"));
  EXPECT_THAT(again.err, HasSubstr("in gaps of the recording: 1 of 101 samples at 1 kHz"));
  const ChildResult judged = run_program_file({"eval", network, resampled, "--labels", "recorded", "--json"});
  EXPECT_EQ(judged.status, 0) << judged.err;
}

TEST_F(ImportedFiles, ANetworkHasToBeNamed) {
  expect_refusal({"eval", "network", data_, "--labels", "recorded"}, {"no network", "FILE.onnx"});
}
#endif

TEST_F(ImportedFiles, IsNoScene) {
  for (const char* command : {"run", "sweep", "check", "cost"}) expect_refusal({command, data_}, {"a.h5"});
}

TEST_F(ImportedFiles, IsNotResumed) {
  expect_refusal({"run", SLIPBENCH_SOURCE_DIR "/scenes/papillarray/stage.yaml", "--resume", "-o", data_}, {"another run"});
}

}  // namespace
}  // namespace slipbench
