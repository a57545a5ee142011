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

TEST(Printable, EscapesWhatHidesOrReordersText) {
  // "txt.exe" is shown as "exe.txt" after U+202E, the right-to-left override, e2 80 ae in UTF-8.
  EXPECT_EQ(printable("\xe2\x80\xaetxt.exe"), R"(\u202etxt.exe)");
  EXPECT_EQ(printable("a\xe2\x81\xa6"
                      "b\xe2\x80\x8b\xef\xbb\xbf\xc2\xad"),
            R"(a\u2066b\u200b\ufeff\u00ad)");
  EXPECT_EQ(printable("\xf3\xa0\x81\x81"), R"(\U000e0041)");  // a tag, of which nothing is shown
}

TEST(Printable, EscapesBytesThatAreNotUtf8) {
  EXPECT_EQ(printable("b\xe9ton"), R"(b\xe9ton)");                  // Latin-1
  EXPECT_EQ(printable("\xe2\x80"), R"(\xe2\x80)");                  // a character without its last byte
  EXPECT_EQ(printable("\xc0\xaf"), R"(\xc0\xaf)");                  // "/" in a longer form
  EXPECT_EQ(printable("\xed\xa0\x80"), R"(\xed\xa0\x80)");          // half of a pair of UTF-16
  EXPECT_EQ(printable("\xf4\x90\x80\x80"), R"(\xf4\x90\x80\x80)");  // beyond U+10FFFF
  EXPECT_EQ(printable("\xf0\x9f\xa4\x96"), "\xf0\x9f\xa4\x96");     // U+1F916
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
  // The byte after the 60th is the second one of U+00B5: its first one is cut as well.
  EXPECT_EQ(quote(std::string(59, 'x') + "\xc2\xb5"), "'" + std::string(59, 'x') + "...'");
}

TEST(Quote, NamesTheCharacterThatLooksLikeAnother) {
  EXPECT_EQ(quote("4\xc2\xa0mm"), "'4\xc2\xa0mm' (with U+00A0 no-break space)");
  EXPECT_EQ(quote("\xe2\x88\x92"
                  "4 mm"),
            "'\xe2\x88\x92"
            "4 mm' (with U+2212 minus sign)");
  EXPECT_EQ(quote("4\xe2\x80\x89mm"), "'4\xe2\x80\x89mm' (with U+2009 thin space)");
  EXPECT_EQ(quote("\xef\xbc\x94 mm"), "'\xef\xbc\x94 mm' (with U+FF14 full-width 4)");
}

}  // namespace
}  // namespace slipbench
