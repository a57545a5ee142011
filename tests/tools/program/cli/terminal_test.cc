#include "tools/program/cli/terminal.h"

#include <cstdio>

#include <gtest/gtest.h>

namespace slipbench {
namespace {

TEST(Style, LeavesTextAloneWithoutColours) {
  const Style plain(false);
  EXPECT_EQ(plain.bold("a") + plain.dim("b") + plain.good("c") + plain.error("d") + plain.heading("e"), "abcde");
}

TEST(Style, ResetsAfterEveryMarkup) {
  EXPECT_EQ(Style(true).bold("a"), "\033[1ma\033[0m");
  EXPECT_EQ(Style(true).error("a"), "\033[1;31ma\033[0m");
}

TEST(StyleFor, AFileGetsNoColours) {
  std::FILE* file = std::tmpfile();
  EXPECT_FALSE(is_interactive(file));
  EXPECT_FALSE(style_for(file).colour());
  EXPECT_EQ(terminal_width(file), 100U);
  std::fclose(file);
}

TEST(Say, DoesNothingWhereItCannotBeWritten) {
  std::FILE* full = std::fopen("/dev/full", "w");
  ASSERT_NE(full, nullptr);
  say(full, "lost\n");
  EXPECT_NE(std::ferror(full), 0);
  std::fclose(full);
}

TEST(WrapText, BreaksAtSpacesAndIndents) {
  // "  one two" has 9 columns; " three" would make 15.
  EXPECT_EQ(wrap_text("one two three", 10, 2), "  one two\n  three\n");
}

TEST(WrapText, FillsALineToItsLastColumn) {
  EXPECT_EQ(wrap_text("ab cd", 5, 0), "ab cd\n");
  EXPECT_EQ(wrap_text("ab cd", 4, 0), "ab\ncd\n");
}

TEST(WrapText, KeepsLineEndsBlankLinesAndIndentation) { EXPECT_EQ(wrap_text("a =\n  b\n\nc", 80, 2), "  a =\n    b\n  \n  c\n"); }

TEST(WrapText, DoesNotBreakALongWord) { EXPECT_EQ(wrap_text("a longerword b", 5, 0), "a\nlongerword\nb\n"); }

TEST(WrapText, EmptyTextIsNoLine) { EXPECT_EQ(wrap_text("", 80, 2), ""); }

}  // namespace
}  // namespace slipbench
