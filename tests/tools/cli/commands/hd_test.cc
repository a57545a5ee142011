// Runs `slipbench hd replay` on the published vectors, as scripts do.
#include <fstream>
#include <functional>
#include <sstream>

#include <nlohmann/json.hpp>

#include "tests/expect.h"
#include "tests/tools/cli/commands/child_process.h"

namespace slipbench {
namespace {

const std::string published = SLIPBENCH_SOURCE_DIR "/tests/detectors/hd/data/published";
const std::string vectors = published + "/vectors.csv";

std::vector<std::string> lines_of(std::istream& stream) {
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
  return cells;
}

// Returns the lines that the command should print for a model of the file: the model's columns,
// from the first row with a class.
std::vector<std::string> expected_lines(const std::string& model) {
  std::ifstream file(vectors);
  const std::vector<std::string> lines = lines_of(file);
  const std::vector<std::string> names = cells_of(lines.at(0));
  const auto column = [&](const std::string& name) {
    return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
  };
  std::vector<std::string> expected{"step,class,d1,d2,d3"};
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const std::vector<std::string> cells = cells_of(lines[i]);
    if (cells.at(column(model + "_state")) == "-1") continue;
    std::string line = cells.at(column("n"));
    for (const char* what : {"_state", "_d1", "_d2", "_d3"}) line += "," + cells.at(column(model + what));
    expected.push_back(line);
  }
  return expected;
}

ChildResult replay(const std::vector<std::string>& more, const std::string& file = vectors) {
  std::vector<std::string> words{"hd", "replay", file, "--memories", published};
  words.insert(words.end(), more.begin(), more.end());
  return run_program_file(words);
}

TEST(HdReplay, PrintsThePublishedClassesAndDistances) {
  const std::vector<std::vector<std::string>> models{
      {"A", "published_core", "one"}, {"P1", "paper", "one"}, {"P0", "paper", "zero"}};
  for (const std::vector<std::string>& model : models) {
    const std::vector<std::string> expected = expected_lines(model[0]);
    ASSERT_EQ(expected.size(), 287U);  // the header and 300 steps, minus the 14 that fill the window
    for (const char* engine : {"kernel", "reference"}) {
      const ChildResult result = replay({"--encoder", model[1], "--ties", model[2], "--engine", engine});
      EXPECT_EQ(result.status, 0) << result.err;
      EXPECT_EQ(result.err, "");
      std::istringstream out(result.out);
      EXPECT_EQ(lines_of(out), expected) << model[0] << " " << engine;
    }
  }
  for (const std::size_t paper : {1U, 2U}) {
    const ChildResult result = replay({"--encoder", "paper", "--ties", models[paper][2], "--engine", "rtl"});
    std::istringstream out(result.out);
    EXPECT_EQ(lines_of(out), expected_lines(models[paper][0])) << result.err;
  }
  const ChildResult refused = replay({"--encoder", "published_core", "--engine", "rtl"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, mentions({"graph_spatial_temporal", "paper"}));
  EXPECT_EQ(replay({"--encoder", "paper"}).out, replay({"--encoder", "paper", "--ties", "one", "--engine", "kernel"}).out);
}

TEST(HdReplay, Json) {
  const ChildResult result = replay({"--encoder", "published_core", "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  const auto steps = nlohmann::json::parse(result.out).at("steps");
  const std::vector<std::string> expected = expected_lines("A");
  ASSERT_EQ(steps.size() + 1, expected.size());
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const auto& d = steps[i].at("distances");
    EXPECT_EQ(steps[i].at("step").dump() + "," + steps[i].at("class").dump() + "," + d[0].dump() + "," + d[1].dump() + "," +
                  d[2].dump(),
              expected[i + 1]);
  }
}

TEST(HdReplay, TheHelpsExamplesWork) {
  const TemporaryFolder folder;
  std::filesystem::copy(published, folder / "published");
  std::filesystem::copy(vectors, folder / "vectors.csv");
  std::istringstream help(run_program_file({"hd", "replay", "--help"}).out);
  int examples = 0;
  for (const std::string& line : lines_of(help)) {
    if (!line.starts_with("  slipbench ")) continue;
    const ChildResult result = run_shell(line.substr(2), folder / "");
    EXPECT_EQ(result.status, 0) << line << "\n" << result.err;
    ++examples;
  }
  EXPECT_EQ(examples, 2);
}

TEST(HdReplay, WordsThatAreNotUnderstood) {
  EXPECT_EQ(run_program_file({"hd"}).err, "slipbench: hd: no command given; commands: replay\n");
  EXPECT_EQ(run_program_file({"hd", "reply"}).err, "slipbench: hd: unexpected argument 'reply'; see slipbench hd --help\n");
  EXPECT_THAT(replay({"--encodr", "paper"}).err, HasSubstr("hd replay: unknown option '--encodr'; did you mean '--encoder'?"));
  EXPECT_THAT(replay({"--encoder", "papr"}).err, refused_at("slipbench: hd replay", {"--encoder", "papr", "paper"}));
  EXPECT_THAT(replay({"--ties", "two"}).err, refused_at("slipbench: hd replay", {"--ties", "two", "one", "zero"}));
  EXPECT_THAT(replay({"--encoder", "paper", "--engine", "kernl"}).err,
              HasSubstr("unknown engine 'kernl'; did you mean 'kernel'?"));
  EXPECT_THAT(replay({}).err, HasSubstr("model.txt: no such file, and the memories do not say which model they belong to"));
  EXPECT_THAT(replay({}).err, HasSubstr(", or --encoder paper or published_core\n"));
  for (const ChildResult& result : {run_program_file({"hd"}), replay({}), replay({"--ties", "two"})}) {
    EXPECT_EQ(result.status, 2);
    EXPECT_EQ(result.out, "");
  }
}

TEST(HdReplay, KnowsTheShippedClassifierByName) {
  const std::string shipped = SLIPBENCH_SOURCE_DIR "/detectors/hd/memories/cl_gst_hd";
  const ChildResult by_name = run_program_file({"hd", "replay", vectors, "--memories", "cl_gst_hd"});
  EXPECT_EQ(by_name.status, 0) << by_name.err;
  EXPECT_EQ(by_name.out, run_program_file({"hd", "replay", vectors, "--memories", shipped}).out);
}

// Returns the message for a file of vectors with `change` applied to its lines, without the
// folder's name.
std::string refusal(const std::function<void(std::vector<std::string>&)>& change) {
  const TemporaryFolder folder;
  std::vector<std::string> lines{"n,L0,L1,L2,L3,L4,L5,L6,L7,L8,ctx"};
  for (const char* n : {"7", "8", "9"}) lines.push_back(std::string(n) + ",0,1,2,3,4,5,6,7,20,3");
  change(lines);
  std::ofstream file(folder / "v.csv");
  for (const std::string& line : lines) file << line << "\n";
  file.close();
  const ChildResult result = replay({"--encoder", "paper"}, folder / "v.csv");
  if (result.status != 2) return "accepted";
  const std::size_t name = result.err.find("v.csv");
  return name == std::string::npos ? result.err : result.err.substr(name);
}

TEST(HdReplay, BadRowsAreRefusedWithFileAndLine) {
  using Lines = std::vector<std::string>;
  EXPECT_EQ(refusal([](Lines&) {}), "accepted");
  EXPECT_THAT(refusal([](Lines& l) { l.clear(); }), refused_at("v.csv:1", {"empty", "ctx"}));
  EXPECT_THAT(refusal([](Lines& l) { l[0] = "n,L0,L1,L2,L3,L4,L5,L6,L7,L8,context"; }),
              refused_at("v.csv:1", {"no column", "ctx"}));
  EXPECT_THAT(refusal([](Lines& l) { l[0] = "n,L0,L1,L2,L3,L4,L5,L6,L7,L8,n"; }),
              refused_at("v.csv:1", {"more than one column", "n"}));
  EXPECT_THAT(refusal([](Lines& l) { l[2] = "8,0,1,2,3,4,5,6,7,21,3"; }), refused_at("v.csv:3", {"L8", "21", "20"}));
  EXPECT_THAT(refusal([](Lines& l) { l[2] = "8,0,1,2,3,4,5,6,7,20,4"; }), refused_at("v.csv:3", {"ctx", "4", "3"}));
  EXPECT_THAT(refusal([](Lines& l) { l[3] = "9,0,1,2,3,-4,5,6,7,20,3"; }), refused_at("v.csv:4", {"L4", "-4", "20"}));
  EXPECT_THAT(refusal([](Lines& l) { l[3] = "9,0,1,2,3,,5,6,7,20,3"; }), refused_at("v.csv:4", {"L4", "''", "20"}));
  EXPECT_THAT(refusal([](Lines& l) { l[3] = "9,0,1,2,nan,4,5,6,7,20,3"; }), refused_at("v.csv:4", {"L3", "nan", "20"}));
  EXPECT_THAT(refusal([](Lines& l) { l[3] = "9,0,1,2,3,4,5,6,7,20"; }), refused_at("v.csv:4", {"10 cells", "11"}));
  EXPECT_THAT(refusal([](Lines& l) { l[3] += ",0"; }), refused_at("v.csv:4", {"12 cells", "11"}));
  EXPECT_THAT(refusal([](Lines& l) { l.erase(l.begin() + 2); }), refused_at("v.csv:3", {"step 9", "step 7"}));
  EXPECT_EQ(replay({"--encoder", "paper"}, published).err, "slipbench: " + published + ": is a folder, not a file\n");
  EXPECT_THAT(replay({"--encoder", "paper"}, "nowhere.csv").err, HasSubstr("nowhere.csv: No such file or directory"));
}

}  // namespace
}  // namespace slipbench
