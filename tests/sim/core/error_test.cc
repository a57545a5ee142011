#include "sim/core/error.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace slipbench {
namespace {

TEST(EditDistance, CountsInsertionsDeletionsAndSubstitutions) {
  EXPECT_EQ(edit_distance("", ""), 0u);
  EXPECT_EQ(edit_distance("speed", "speed"), 0u);
  EXPECT_EQ(edit_distance("", "abc"), 3u);  // three insertions
  EXPECT_EQ(edit_distance("abc", ""), 3u);  // three deletions
  EXPECT_EQ(edit_distance("sped", "speed"), 1u);
  EXPECT_EQ(edit_distance("sepd", "speed"), 2u);      // e<->p is a deletion and an insertion; one more e: s-e-p-d, s-p-e-e-d
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);  // k->s, e->i, +g
  EXPECT_EQ(edit_distance("sitting", "kitten"), 3u);  // symmetric
}

TEST(Printable, EscapesWhatATerminalObeys) {
  EXPECT_EQ(printable("a\x1b[31m\x07\x7f\n"), R"(a\x1b[31m\x07\x7f\x0a)");
  EXPECT_EQ(printable("one\ntwo\t", true), "one\ntwo\\x09");
  EXPECT_EQ(printable("\xc2\x9b"), R"(\xc2\x9b)");                           // U+009B, the one-byte form of ESC [
  EXPECT_EQ(printable("\xc2\xb5m \xe2\x82\xac"), "\xc2\xb5m \xe2\x82\xac");  // letters are kept
}

TEST(NearestName, IsGivenOnlyWhenATypingErrorIsLikely) {
  const std::vector<std::string> names{"rotation", "speed", "start", "stop"};
  EXPECT_EQ(nearest_name("sped", names), "speed");
  EXPECT_EQ(nearest_name("rotatoin", names), "rotation");  // distance 2
  EXPECT_EQ(nearest_name("colour", names), "");
  EXPECT_EQ(nearest_name("xy", std::array<std::string_view, 1>{"ab"}), "");  // a word of two letters may differ in one
  EXPECT_EQ(nearest_name("st", names), "");                                  // stop is two insertions away
  EXPECT_EQ(nearest_name("N", std::array<std::string_view, 1>{"%"}), "");    // one letter is no evidence
  EXPECT_EQ(nearest_name("", names), "");
  EXPECT_EQ(nearest_name(std::string(1'000'000, 's'), names), "");
}

TEST(NearestName, TakesTheFirstOfEquallyNearNames) {
  EXPECT_EQ(nearest_name("stap", std::vector<std::string>{"stop", "step"}), "stop");
}

TEST(AllowedNames, ListsThemWithTheNearestOne) {
  const std::vector<std::string> names{"speed", "stop"};
  EXPECT_EQ(allowed_names("sped", names), "; did you mean 'speed'? allowed: speed, stop");
  EXPECT_EQ(allowed_names("colour", names), "; allowed: speed, stop");
  EXPECT_EQ(allowed_names("colour", std::vector<std::string>{}), "; allowed: nothing");
}

TEST(Quote, ShortensAndEscapes) {
  EXPECT_EQ(quote("4 mm"), "'4 mm'");
  EXPECT_EQ(quote("a\tb\x7f"), "'a\\x09b\\x7f'");
  EXPECT_EQ(quote(std::string(60, 'x')), "'" + std::string(60, 'x') + "'");
  EXPECT_EQ(quote(std::string(61, 'x')), "'" + std::string(60, 'x') + "...'");
}

}  // namespace
}  // namespace slipbench
