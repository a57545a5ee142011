// Boards and submissions as a user makes and checks them. The tests use the BioTac, for which no
// hand-made detector exists, so its boards take some seconds.
#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tests/expect.h"
#include "tests/tools/cli/commands/child_process.h"

namespace slipbench {
namespace {

using Json = nlohmann::json;

const std::vector<std::string> quick{"benchmark", "--sensor", "biotac_sp", "--trials", "1", "--quiet"};

struct Submissions : ::testing::Test {
  static ChildResult run(std::vector<std::string> words, const std::vector<std::string>& more = {}) {
    words.insert(words.end(), more.begin(), more.end());
    return run_program_file(words);
  }
  TemporaryFolder folder_;
};

TEST_F(Submissions, AreRecomputed) {
  const std::string file = folder_ / "mine.json", page = folder_ / "board.html";
  const ChildResult made = run(quick, {"--submit", file, "-o", page});
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("always slip"));
  EXPECT_THAT(bytes_of(page), HasSubstr("always slip"));
  EXPECT_THAT(bytes_of(page), Not(HasSubstr("<script")));
  EXPECT_EQ(Json::parse(bytes_of(folder_ / "board.json")), Json::parse(bytes_of(file)));

  const ChildResult same = run_program_file({"benchmark", "--verify", file, "--quiet"});
  EXPECT_EQ(same.status, 0) << same.out << same.err;

  // A changed score, as in a forged submission.
  std::string text = bytes_of(file);
  const std::string delay = "\"half_delay_s\": 0.1";
  ASSERT_NE(text.find(delay), std::string::npos);
  text.replace(text.find(delay), delay.size(), "\"half_delay_s\": 0.9");
  std::ofstream(file) << text;
  const ChildResult changed = run_program_file({"benchmark", "--verify", file, "--quiet"});
  EXPECT_EQ(changed.status, 1);
  EXPECT_THAT(changed.out, HasSubstr("/protocol/half_delay_s: 0.9 in the file, but 0.1 recomputed"));

  // A submission to another protocol is recognised by the digest before anything is computed, so no
  // progress is printed.
  const std::string digest = Json::parse(text).at("protocol").at("sha256"), other(digest.rbegin(), digest.rend());
  text.replace(text.find(digest), digest.size(), other);
  std::ofstream(file) << text;
  const ChildResult foreign = run_program_file({"benchmark", "--verify", file});
  EXPECT_EQ(foreign.status, 2);
  EXPECT_THAT(foreign.err, refused_at("slipbench: " + file, {"/protocol/sha256", other, digest, "slip-4"}));
}

// Two recordings of a slide, written and read like those of a real sensor.
TEST_F(Submissions, RealRecordingsAreATrackOfTheirOwn) {
  const std::string scene = SLIPBENCH_SOURCE_DIR "/scenes/papillarray/stage.yaml";
  ASSERT_EQ(run_program_file({"run", scene, "--trials", "2", "--quiet", "-o", folder_ / "sim.h5"}).status, 0);
  ASSERT_EQ(run_program_file({"export", folder_ / "sim.h5", "--format", "training-csv", "-o", folder_ / "csv"}).status, 0);
  const ChildResult read = run_program_file({"import", folder_ / "csv", "--format", "training-csv", "-o", folder_ / "real.h5"});
  ASSERT_EQ(read.status, 0) << read.err;
  const std::vector<std::string> words{"benchmark", "--sensor", "papillarray", "--trials", "1", "--quiet", "--json"};
  const ChildResult made = run(words, {"--real", folder_ / "real.h5"});
  ASSERT_EQ(made.status, 0) << made.err;
  const Json result = Json::parse(made.out);
  const Json& set = result.at("sets").back();
  EXPECT_EQ(set.at("track"), "transfer");
  EXPECT_EQ(set.at("trials"), 2);
  EXPECT_EQ(set.at("rows").back().at("detector"), "always slip");
  EXPECT_FALSE(result.contains("transfer"));
  const ChildResult twice = run(words, {"--real", folder_ / "real.h5", "--real", folder_ / "./real.h5"});
  EXPECT_EQ(twice.status, 2);
  EXPECT_THAT(twice.err, mentions({"./real.h5: was given twice; give each dataset once"}));
  const ChildResult simulated = run(words, {"--real", folder_ / "sim.h5"});
  EXPECT_EQ(simulated.status, 2);
  EXPECT_THAT(simulated.err, mentions({"simulation"}));
}

#ifdef SLIPBENCH_WITH_NETWORKS
// A network that was trained on judged trials is left out of the board. Two trials of the protocol
// are trials 1 and 120 of the 240.
TEST_F(Submissions, WhoHasSeenTheTrialsIsNotJudged) {
  const std::string scene = SLIPBENCH_SOURCE_DIR "/scenes/benchmark/slip-4/open_papillarray.yaml";
  ASSERT_EQ(run_program_file({"sweep", scene, "--quiet", "-o", folder_ / "seen.h5"}).status, 0);
  const std::string model = folder_ / "seen.onnx";
  const ChildResult taught =
      run_program_file({"train", folder_ / "seen.h5", "--recipe", "grasp_gru", "--steps", "2", "-o", model, "--json"});
  ASSERT_EQ(taught.status, 0) << taught.err;
  const ChildResult made = run({"benchmark", model, "--sensor", "papillarray", "--trials", "2", "--quiet", "--json"});
  ASSERT_EQ(made.status, 0) << made.err;
  const Json left_out = Json::parse(made.out).at("sets").at(0).at("left_out");
  const auto named = std::ranges::find_if(left_out, [&](const Json& one) { return one.at("detector") == model; });
  ASSERT_NE(named, left_out.end());
  EXPECT_THAT(named->at("why"), HasSubstr("was trained on"));
}
#endif

// plugins/exits.cc ends the program with its own status when it is loaded.
TEST_F(Submissions, NoCodeRunsThatItsReaderHasNotNamed) {
  const std::string library = SLIPBENCH_TEST_PLUGINS "/exits.so", file = folder_ / "mine.json";
  ASSERT_EQ(run(quick, {"--submit", file}).status, 0);
  Json submission = Json::parse(bytes_of(file));
  submission["asked"]["detectors"] = Json::array({"plugin"});
  submission["asked"]["set"] = Json::array({Json::array({"library", library})});
  std::ofstream(file) << submission.dump(2);
  const ChildResult unnamed = run_program_file({"benchmark", "--verify", file, "--quiet"});
  EXPECT_EQ(unnamed.status, 2);
  EXPECT_THAT(unnamed.err, refused_at("slipbench: " + file, {"library", "--set library=" + library}));
  EXPECT_EQ(run_program_file({"benchmark", "--verify", file, "--quiet", "--set", "library=other.so"}).err, unnamed.err);
  EXPECT_EQ(run_program_file({"benchmark", "--verify", file, "--quiet", "--set", "library=" + library}).status, 77);
}

TEST_F(Submissions, WhatIsRefused) {
  const auto expect_refusal = [](const std::vector<std::string>& arguments, const std::vector<std::string>& words) {
    const ChildResult result = run_program_file(arguments);
    EXPECT_EQ(result.status, 2);
    EXPECT_THAT(result.err, mentions(words));
  };
  expect_refusal({"benchmark", "--sensor", "papilarray"}, {"papilarray", "papillarray"});
  expect_refusal({"benchmark", "--protocol", "slip-3"}, {"slip-3", "slip-4"});
  expect_refusal({"benchmark", "shear_rat", "--sensor", "myrmex"}, {"shear_rat", "shear_rate"});
  // Both options would write one file, in spite of the different spelling.
  for (const std::string& submission : {folder_ / "b.json", folder_ / "./b.json", folder_ / "b.html"}) {
    expect_refusal({"benchmark", "-o", folder_ / "b.html", "--submit", submission},
                   {"--submit " + submission, "--output " + folder_ / "b.html"});
  }
  expect_refusal({"benchmark", "--set", "flip=1"}, {"--set", "DETECTOR"});
  expect_refusal({"benchmark", "--verify", "a.json", "-o", "b.html"}, {"--verify", "submission"});
  expect_refusal({"benchmark", "--verify", folder_ / "none.json"}, {"none.json", "read"});
  std::ofstream(folder_ / "no.json") << "{}";
  expect_refusal({"benchmark", "--verify", folder_ / "no.json"}, {"no.json", "submission"});
  // An unknown protocol is reported with the file, before anything is computed.
  std::ofstream(folder_ / "no.json") << R"({"slipbench_benchmark": 1, "asked": {}, "protocol": {"name": "slip-9"}})";
  expect_refusal({"benchmark", "--verify", folder_ / "no.json"}, {"no.json", "slip-9", "slip-4"});
  std::ofstream(folder_ / "no.json") << R"({"slipbench_benchmark": 1, "asked": {}, "protocol": {"name": 3}})";
  expect_refusal({"benchmark", "--verify", folder_ / "no.json"}, {"no.json", "/protocol/name"});
  std::ofstream(folder_ / "no.json") << "{}";
  expect_refusal({"benchmark", "--submit", folder_ / "no.json"}, {"no.json"});
  expect_refusal({"benchmark", "--verify", "/dev/zero"}, {"/dev/zero", "device"});
}

}  // namespace
}  // namespace slipbench
