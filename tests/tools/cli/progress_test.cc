#include <csignal>
#include <cstdio>

#include <unistd.h>

#include "tests/expect.h"
#include "tools/cli/terminal.h"

namespace slipbench {
namespace {

// A stream's output, and a clock that the test controls.
struct ProgressTest : ::testing::Test {
  ~ProgressTest() override { std::fclose(stream_); }

  Progress make(Progress::Mode mode) {
    return {mode, stream_, [this] { return now_; }};
  }

  std::string written() {
    std::fflush(stream_);
    std::rewind(stream_);
    std::string text;
    for (int c = std::fgetc(stream_); c != EOF; c = std::fgetc(stream_)) text += static_cast<char>(c);
    return text;
  }

  std::FILE* stream_ = std::tmpfile();
  double now_ = 1000.0;
};

TEST(ShortCount, HasAtMostFourCharacters) {
  for (const auto& [count, text] : {std::pair{0.0, "0.0"},
                                    {9.94, "9.9"},
                                    {9.96, "10"},
                                    {999.4, "999"},
                                    {999.6, "1.0k"},
                                    {3123.0, "3.1k"},
                                    {31400.0, "31k"},
                                    {4.0e6, "4.0M"},
                                    {2.0e12, "2000G"}})
    EXPECT_EQ(short_count(count), text);
}

TEST(ClockText, NamesSecondsMinutesHours) {
  EXPECT_EQ(clock_text(0.2), "0 s");
  EXPECT_EQ(clock_text(59.4), "59 s");
  EXPECT_EQ(clock_text(59.6), "1:00");
  EXPECT_EQ(clock_text(125.0), "2:05");
  EXPECT_EQ(clock_text(3725.0), "1:02:05");
}

// 100 of 200 trials of 4 s in 5 s: 400/5 = 80 times real time, 100/5 = 20 trials/s, another 5 s to
// go.
constexpr ProgressState half{100, 200, 400.0, 5.0};

TEST(ProgressBarText, ShowsShareRatesAndTimeLeft) {
  const std::string text = progress_bar_text(half, 120);
  // The bar is at most 30 long; half of it is filled.
  EXPECT_THAT(text, StartsWith("[" + std::string(15, '#') + std::string(15, '-') + "] "));
  EXPECT_THAT(text, EndsWith(" 50 % 100/200  80 times real time  20 trials/s  ETA 5 s"));
}

TEST(ProgressBarText, FitsEveryWidth) {
  for (std::size_t width = 1; width < 150; ++width) EXPECT_LE(progress_bar_text(half, width).size(), width);
  EXPECT_THAT(progress_bar_text(half, 40), StartsWith(" 50 %"));  // no space for a bar; the figures stay
}

TEST(ProgressBarText, FullBarShowsTimeTaken) {
  const std::string text = progress_bar_text({200, 200, 800.0, 125.0}, 120);
  EXPECT_THAT(text, StartsWith("[" + std::string(30, '#') + "] 100 %"));
  EXPECT_THAT(text, EndsWith("2:05"));
  EXPECT_THAT(text, Not(HasSubstr("ETA")));
}

TEST(ProgressLineText, IsOneSentence) {
  EXPECT_EQ(progress_line_text(half), "100/200 trials (50 %), 80 times real time, 20 trials/s, ETA 5 s");
  EXPECT_EQ(progress_line_text({100, 200, {}, 5.0}), "100/200 trials (50 %), 20 trials/s, ETA 5 s");  // nothing is simulated
}

TEST(ProgressLineText, NothingDoneYetHasNoEta) {
  EXPECT_EQ(progress_line_text({0, 200, 0.0, 0.0}), "0/200 trials (0 %), 0.0 times real time, 0.0 trials/s, ETA ?");
}

TEST_F(ProgressTest, LinesComeEveryFewSecondsAndAtTheEnd) {
  Progress progress = make(Progress::Mode::lines);
  for (std::size_t done = 1; done <= 12; ++done) {
    now_ += 1.0;  // lines are 5 s apart: at 5 s, at 10 s, and the end at 12 s
    progress.update(done, 12, 4.0 * static_cast<double>(done));
  }
  EXPECT_EQ(written(),
            "5/12 trials (42 %), 4.0 times real time, 1.0 trials/s, ETA 7 s\n"
            "10/12 trials (83 %), 4.0 times real time, 1.0 trials/s, ETA 2 s\n"
            "12/12 trials (100 %), 4.0 times real time, 1.0 trials/s, 12 s\n");
}

TEST_F(ProgressTest, BarIsRedrawnInPlaceAtMostTenTimesASecond) {
  Progress progress = make(Progress::Mode::bar);
  for (std::size_t done = 1; done <= 100; ++done) {
    now_ += 0.01;  // 100 updates in 1 s
    progress.update(done, 1000, 0.0);
  }
  const std::string text = written();
  std::size_t redraws = 0;
  for (const char c : text) redraws += c == '\r' ? 1 : 0;
  EXPECT_GE(redraws, 8U);
  EXPECT_LE(redraws, 10U);
  EXPECT_THAT(text, Not(HasSubstr("\n")));
}

TEST_F(ProgressTest, FinishedBarEndsItsLine) {
  Progress progress = make(Progress::Mode::bar);
  now_ += 1.0;
  progress.update(2, 2, 8.0);
  progress.clear();  // nothing left to remove
  EXPECT_THAT(written(), EndsWith("1 s\n"));
}

TEST_F(ProgressTest, ClearRemovesAnUnfinishedBar) {
  Progress progress = make(Progress::Mode::bar);
  now_ += 1.0;
  progress.update(1, 2, 4.0);
  progress.clear();
  EXPECT_THAT(written(), EndsWith("\r\033[K"));
}

// A sweep continues if its progress cannot be written.
TEST_F(ProgressTest, AStreamThatCannotBeWrittenEndsNothing) {
  std::FILE* full = std::fopen("/dev/full", "w");
  ASSERT_NE(full, nullptr);
  for (const Progress::Mode mode : {Progress::Mode::bar, Progress::Mode::lines}) {
    Progress progress(mode, full, [this] { return now_; });
    now_ += 10.0;
    EXPECT_NO_THROW(progress.update(1, 2, 4.0));
    EXPECT_NO_THROW(progress.clear());
  }
  std::fclose(full);
}

TEST_F(ProgressTest, OffAndSingleTrialsDrawNothing) {
  Progress off = make(Progress::Mode::off);
  Progress single = make(Progress::Mode::bar);
  now_ += 10.0;
  off.update(2, 2, 8.0);
  single.update(1, 1, 4.0);
  EXPECT_EQ(written(), "");
}

TEST_F(ProgressTest, AFifthOfATrialInFiveSecondsLeavesTwenty) {
  Progress progress = make(Progress::Mode::lines);
  for (double share = 0.04; share < 0.3; share += 0.04) now_ += 1.0, progress.part(share);  // lines are 5 s apart
  EXPECT_EQ(written(), "20 % of the trial, 5 s, ETA 20 s\n");
}

// The alarm normally comes after 10 s, here at once.
TEST(PreparationNotice, SaysThatTrialsAreStillBeingPrepared) {
  for (const bool quiet : {false, true}) {
    const PreparationNotice notice(quiet);
    EXPECT_THAT(::alarm(10), AnyOf(9U, 10U));
    testing::internal::CaptureStderr();
    std::raise(SIGALRM);
    const std::string message = testing::internal::GetCapturedStderr();
    EXPECT_EQ(message.starts_with("slipbench: still preparing the trials"), !quiet) << message;
    EXPECT_EQ(message.empty(), quiet) << message;
  }
}

TEST(Style, LeavesTextAloneWithoutColours) {
  const Style plain(false);
  EXPECT_EQ(plain.bold("a") + plain.dim("b") + plain.good("c") + plain.error("d") + plain.heading("e"), "abcde");
}

TEST(Style, ResetsAfterEveryMarkup) {
  EXPECT_EQ(terminal_text(Style(true).bold("a")), "\033[1ma\033[0m");
  EXPECT_EQ(terminal_text(Style(true).error("a")), "\033[1;31ma\033[0m");
}

TEST(StyleFor, AFileGetsNoColours) {
  std::FILE* file = std::tmpfile();
  EXPECT_FALSE(is_interactive(file));
  EXPECT_FALSE(style_for(file).colour());
  EXPECT_EQ(terminal_width(file), 100U);
  std::fclose(file);
}

// ESC ] 0 ; sets a terminal's title, ESC [ 2 J clears it, ESC [ 8 m hides the following text.
TEST(TerminalText, KeepsTheMarksOfStyleAlone) {
  const Style style(true);
  EXPECT_EQ(terminal_text(style.error("no") + "\033]0;x\007\033[2J\033[8m\n"),
            "\033[1;31mno\033[0m\\x1b]0;x\\x07\\x1b[2J\\x1b[8m\n");
  EXPECT_EQ(terminal_text(style.bold("a\033[0mb")), "\033[1ma\\x1b[0mb\033[0m");
  // A text that equals a mark is text, also next to marks of Style.
  EXPECT_EQ(terminal_text(style.dim("x") + "\033[1;31mslipbench:\033[0m"), "\033[2mx\033[0m\\x1b[1;31mslipbench:\\x1b[0m");
  EXPECT_EQ(terminal_text("\xe2\x80\xae \xc2\xb5"), "\\u202e \xc2\xb5");
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
