// Damaged and wrong sources: what was found, where, what is allowed, and nothing left.
#include <sys/stat.h>

#include "tests/expect.h"
#include "tests/tools/program/import/sources.h"
#include "tools/base/dataset/reader.h"

namespace slipbench::import_errors_test {
namespace {

using namespace slipbench::testing;

struct ImportErrors : slipbench::testing::ImportTest {
  // Imports a source and expects a message about it that begins with its path; nothing but the source is left.
  void expect_refusal(const std::string& format, const std::string& name, const std::string& text, const std::string& message) {
    const std::string file = source(name, text);
    const std::vector<std::string> before = names();
    EXPECT_EQ(refusal_of([&] { run({file}, format); }), file + message);
    EXPECT_EQ(names(), before);
  }
};

std::string with(std::string text, const std::string& old, const std::string& now) {
  const std::size_t at = text.rfind(old);
  if (at == std::string::npos) throw std::logic_error("no " + old);
  return text.replace(at, old.size(), now);
}

TEST_F(ImportErrors, GraspsAreChecked) {
  const auto refused = [&](const std::string& text, const std::string& message) {
    expect_refusal("bts3v2", "a.csv", text, message);
  };
  // 2,100 good rows come first: a first file of the dataset is full then.
  std::string good;
  for (int k = 0; k < 2100; ++k) good += grasp_row("coke", "0", 1);
  refused(grasp_header() + good + grasp_row("coke", "2", 1), ":2102: column 2, slipped, is '2'; allowed: 0, 1");
  refused("", ":1: the file is empty; allowed: a header that begins with object");
  refused(grasp_header(), ":1: is the only line; allowed: a header and a row a grasp");
  refused(grasp_header() + "\n", ":1: is the only line; allowed: a header and a row a grasp");
  refused(grasp_header() + "\n" + grasp_row("coke", "0", 1), ":2: has 1 column; allowed: 74");
  refused(with(grasp_header(), "th_biotac_24", "th_biotac_25"),
          ":1: column 74 is called 'th_biotac_25'; allowed: 'th_biotac_24'");
  refused(with(grasp_header(), ",th_biotac_24", ""), ":1: has 73 columns; allowed: 74");
  refused(grasp_header() + "coke\n", ":2: has 1 column; allowed: 74");
  refused(grasp_header() + grasp_row("", "0", 1), ":2: column 1, object, is ''; allowed: a name");
  refused(grasp_header() + grasp_row("\xff", "0", 1), ":2: column 1, object, is '\xff'; allowed: a name");
  refused(grasp_header() + with(grasp_row("coke", "0", 1), ",73", ",x"),
          ":2: column 74, th_biotac_24, is 'x'; allowed: a number from 0 to 4095");
  refused(grasp_header() + with(grasp_row("coke", "0", 1), ",73", ",4096"),
          ":2: column 74, th_biotac_24, is '4096'; allowed: a number from 0 to 4095");
  refused(grasp_header() + with(grasp_row("coke", "0", 1), ",73", ",nan"),
          ":2: column 74, th_biotac_24, is 'nan'; allowed: a number from 0 to 4095");
  refused(grasp_header() + std::string(70'000, 'x'), ":2: is longer than 65536 bytes; allowed: lines of text");
}

TEST_F(ImportErrors, SlidesAreChecked) {
  const auto refused = [&](const std::string& name, const std::string& text, const std::string& message) {
    expect_refusal("biotacsp-dos", name, text, message);
  };
  const std::string good = slide_header() + slide_row(0);
  refused("north/case1.csv", good,
          ": lies in a folder called 'north'; allowed: n, e, s, w, cw, aw, t, the class of its recordings");
  refused("n/12.csv", good, ": its name says no object; allowed: object and number, as in case112.csv");
  refused("n/case1.csv", slide_header(), ":1: is the only line; allowed: a header and a row a sample");
  refused("n/case1.csv", good + "1,2\n", ":3: has 2 columns; allowed: 24");
}

TEST_F(ImportErrors, LogsAreChecked) {
  const auto refused = [&](const std::string& text, const std::string& message) {
    expect_refusal("papillarray-csv", "a.csv", text, message);
  };
  const std::vector<int> held(9, 1);
  const std::string first = log_header(1) + log_row(1000, {log_cells(held)});
  refused("", ":1: the file is empty; allowed: a header that begins with T_us");
  refused("time,x\n", ":1: column 1 is called 'time'; allowed: 'T_us'");
  refused(with(log_header(1), ",S0_FrictionEst", ""), ":1: has 81 columns; allowed: 82 for one sensor, 163 for two");
  refused(with(log_header(2), "S1_FrictionEst", "S2_FrictionEst"),
          ":1: column 163 is called 'S2_FrictionEst'; allowed: 'S1_FrictionEst'");
  refused(first, ":2: ends a recording of 1 samples; allowed: two at least, which tell the rate");
  refused(first + log_row(500, {log_cells(held)}),
          ":3: column 1, T_us, is '500' after 1000; allowed: rising times, or the same row again");
  refused(first + log_row(1000, {log_cells(std::vector<int>(9, 2))}),
          ":3: column 1, T_us, is '1000' after 1000; allowed: rising times, or the same row again");
  refused(first + log_row(2000, {log_cells({1, 1, 1, 1, 1, 1, 1, 1, 0})}),
          ":3: column 81, S0_P8_slipState, is '0'; allowed: -2, -1, 1, 2, 3");
  refused(first + with(log_row(2000, {log_cells(held)}), ",-1", ",inf"),
          ":3: column 82, S0_FrictionEst, is 'inf'; allowed: a number");
}

TEST_F(ImportErrors, TrainingFilesAreChecked) {
  const auto refused = [&](const std::string& text, const std::string& message) {
    expect_refusal("training-csv", "a.csv", text, message);
  };
  const std::vector<std::string> held(9, "1,0");
  refused("", ":1: ends a recording of 0 samples; allowed: two at least, which tell the rate");
  refused(training_row("0", held) + training_row("0", held), ":2: column 1, time, is '0' after 0; allowed: rising times");
  refused(training_row("0", held) + "0.001\n", ":2: has 1 column; allowed: 73");
  refused(training_row("0", std::vector<std::string>(9, "1,2")), ":1: column 3, P0 slip, is '2'; allowed: 0, 1");
  refused(training_row("0", std::vector<std::string>(9, "1,0.5")), ":1: column 3, P0 slip, is '0.5'; allowed: 0, 1");
}

TEST_F(ImportErrors, SourcesAreChecked) {
  const auto refusal = [&](const std::vector<std::string>& sources) { return refusal_of([&] { run(sources, "bts3v2"); }); };
  EXPECT_EQ(refusal({path("none.csv")}), path("none.csv") + ": no such file or folder");
  std::filesystem::create_directory(path("empty"));
  EXPECT_EQ(refusal({path("empty")}), path("empty") + ": holds no file .csv; allowed: a source file, or a folder with some");
  const std::string file = source("set/a.csv", grasp_header() + grasp_row("coke", "0", 1));
  EXPECT_EQ(refusal({path("set"), file}), file + ": is named twice; allowed: each source once");
  ::mkfifo(path("pipe").c_str(), 0600);
  EXPECT_THAT(refusal({path("pipe")}), HasSubstr("pipe: is a pipe, no file"));
  EXPECT_EQ(refusal_of([] { import_format("bts3"); }),
            "unknown format 'bts3'; did you mean 'bts3v2'? allowed: bts3v2, biotacsp-dos, papillarray-csv, training-csv, csv");
}

// The dataset's own name is checked before a row is read.
TEST_F(ImportErrors, SourceIsNotReplaced) {
  const std::string file = source("a.csv", grasp_header() + grasp_row("coke", "0", 1));
  const std::string before = bytes_of(file);
  EXPECT_THAT(refusal_of([&] { run({file}, "bts3v2", "a.csv"); }), HasSubstr("exists and is no dataset"));
  EXPECT_EQ(bytes_of(file), before);
  EXPECT_THAT(names(), ElementsAre("a.csv"));
}

TEST_F(ImportErrors, TablesByAColumnMapAreChecked) {
  const std::string map =
                        "{sensor: skin, type: taxels, time: {column: t, scale: 1e-3}, state: {column: slip, rule: a button},\n"
                        "channels: {force: {unit: N, scale: 1e-3, components: 3, columns: [a .. c]}}}\n",
                    table = "t,a,b,c,slip\n5,1,2,3,1\n7,4,5,6,3\n";
  const auto refused = [&](const std::string& mapped, const std::string& text, const std::string& message) {
    const std::string file = source("a.csv", text), columns = source("map.yaml", mapped);
    EXPECT_EQ(refusal_of([&] { run({file}, "csv", "out.h5", columns); }), (mapped == map ? file : columns) + message);
    EXPECT_EQ(names(), (std::vector<std::string>{"a.csv", "map.yaml"}));
  };
  refused(with(map, "type: taxels, ", ""), table, ":1: the column map has no key 'type'; allowed: one that has");
  refused(with(map, "components", "component"), table,
          ":2: unknown key 'component' in channels.force; did you mean 'components'? allowed: columns, components, scale, unit");
  refused(with(map, "[a .. c]", "a"), table,
          ":2: channels.force.columns is 'a'; allowed: titles, or FIRST .. LAST, in a sequence");
  refused(map, with(table, "c,", "d,"), ":1: has no column 'c'; allowed: t, a, b, d, slip");
  refused(map, with(table, "7,", "5,"), ":3: column 1, t, is 0.005 s after 0.005 s; allowed: rising times");
  refused(map, with(table, "6,3", "6,4"), ":3: column 5, slip, is '4'; allowed: 0, 1, 2, 3");

  run({source("a.csv", table)}, "csv", "out.h5", source("map.yaml", map));
  const SensorRecord skin = DatasetReader(path("out.h5")).read_sensor(0, "skin");
  EXPECT_THAT(skin.channels.at(0).values, ElementsAre(1e-3F, 2e-3F, 3e-3F, 4e-3F, 5e-3F, 6e-3F));
  EXPECT_THAT(skin.labels.state_paper, ElementsAre(1, 3));
}

}  // namespace
}  // namespace slipbench::import_errors_test
