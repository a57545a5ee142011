#include "tools/workers/child_process.h"

#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <set>
#include <stdexcept>
#include <string>

#include "sim/core/process/interrupted.h"
#include "tests/expect.h"

namespace slipbench::child_process_test {
namespace {

using Clock = std::chrono::steady_clock;
using Kind = ChildEnd::Kind;

constexpr double plenty = 60.0;  // s

ChildEnd ended(const std::function<std::string()>& action, double limit = plenty) {
  ChildProcesses children(limit);
  children.start(3, action);
  auto found = children.wait_until(Clock::now() + std::chrono::minutes(1));
  EXPECT_EQ(found->first, 3U);
  EXPECT_EQ(children.running(), 0U);
  return std::move(found->second);
}

TEST(ChildProcesses, SayHowTheyEnded) {
  // More than a pipe's 64 kB.
  const std::string large(300000, 'x');
  EXPECT_EQ(ended([&] { return large; }).text, large);
  EXPECT_EQ(ended([] { return std::string(); }).kind, Kind::result);
  const ChildEnd refused = ended([]() -> std::string { throw InputError("bad"); });
  EXPECT_EQ(refused.kind, Kind::bad_input);
  EXPECT_EQ(refused.text, "bad");
  EXPECT_EQ(ended([]() -> std::string { throw std::runtime_error("worse"); }).kind, Kind::failure);
  EXPECT_EQ(ended([]() -> std::string { throw std::bad_alloc(); }).text, "out of memory");
}

// User code may write to any descriptor: the answer arrives as it was sent, or not at all.
TEST(ChildProcesses, KnowWhetherTheirAnswerIsWhole) {
  const auto is_pipe = [](int descriptor) {
    struct stat about {};
    return ::fstat(descriptor, &about) == 0 && S_ISFIFO(about.st_mode);
  };
  std::set<int> others;  // pipes of the process that runs the tests
  for (int descriptor = 0; descriptor < 1024; ++descriptor) {
    if (is_pipe(descriptor)) others.insert(descriptor);
  }
  const auto writes = [&](int first, int last) {
    return [&is_pipe, &others, first, last]() -> std::string {
      for (int descriptor = first; descriptor < last; ++descriptor) {
        const bool writable = is_pipe(descriptor) && !others.contains(descriptor);
        [[maybe_unused]] const ssize_t written = writable ? ::write(descriptor, "r1.", 3) : 0;  // fails for a read end
      }
      return "done";
    };
  };
  EXPECT_EQ(ended(writes(3, 100)).text, "done");  // numbers that code guesses
  const ChildEnd end = ended(writes(3, 1024));
  EXPECT_EQ(end.kind, Kind::lost);
  EXPECT_THAT(end.loss(plenty), HasSubstr("returned an invalid result"));
}

// A host that ignores its children's ends leaves no exit status.
TEST(ChildProcesses, NeedNoStatus) {
  const auto before = std::signal(SIGCHLD, SIG_IGN);
  EXPECT_EQ(ended([] { return std::string("done"); }).text, "done");
  EXPECT_EQ(ended([]() -> std::string { std::_Exit(0); }).loss(plenty), "ended before its work was done");
  // A child that has ended before start() checks it.
  ChildProcesses children(plenty, [] {
    const pid_t process = ::fork();
    if (process > 0) ::waitpid(process, nullptr, 0);
    return process;
  });
  children.start(3, [] { return std::string("done"); });
  EXPECT_EQ(children.wait_until(Clock::now())->second.text, "done");
  std::signal(SIGCHLD, before);
}

TEST(ChildProcesses, SayHowTheyWereLost) {
  const ChildEnd killed = ended([]() -> std::string {
    ::raise(SIGKILL);
    return "never";
  });
  EXPECT_EQ(killed.kind, Kind::lost);
  EXPECT_EQ(killed.loss(plenty), "was killed by SIGKILL (Killed)");
  EXPECT_EQ(ended([]() -> std::string { std::_Exit(0); }).loss(plenty), "ended with status 0 before its work was done");
  // A child that has closed the pipe and continues is waited for.
  const ChildEnd closed = ended([]() -> std::string {
    ::close_range(3, ~0U, 0);
    ::usleep(20'000);
    return "never";
  });
  EXPECT_EQ(closed.loss(plenty), "ended with status 1 before its work was done");
}

// Either would sleep for a minute: the test's duration shows that they are not waited for.
TEST(ChildProcesses, EndWithTheirLimitAndWithTheirOwner) {
  const auto sleep = [] {
    ::sleep(60);
    return std::string();
  };
  EXPECT_EQ(ended(sleep, 0.1).loss(0.1), "was still running at the limit of 0.1 s");
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  {
    ChildProcesses children;
    children.start(0, sleep);
    EXPECT_FALSE(children.wait_until(Clock::now()));
  }
  ::close(ends[1]);
  char byte = 0;
  EXPECT_EQ(::read(ends[0], &byte, 1), 0) << "the child held the other end open";
  ::close(ends[0]);
}

// A copy made by the action holds the pipe open. It ends with the child, and its result is ignored.
TEST(ChildProcesses, EndWhatTheyHaveStarted) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  const ChildEnd end = ended([] {
    if (::fork() == 0) ::sleep(60);
    return std::string("original");
  });
  EXPECT_EQ(end.text, "original");
  EXPECT_EQ(ended([] { return std::string(::fork() == 0 ? "copy" : "original"); }).text, "original");
  ::close(ends[1]);
  char byte = 0;
  EXPECT_EQ(::read(ends[0], &byte, 1), 0) << "the copy held the other end open";
  ::close(ends[0]);
}

TEST(RunInChild, ReturnsAndThrows) {
  EXPECT_EQ(run_in_child(
                "a.h5", [] { return std::string("read"); }, nullptr),
            "read");
  EXPECT_THROW(run_in_child(
                   "a.h5", []() -> std::string { throw std::logic_error("bug"); }, nullptr),
               std::runtime_error);
  EXPECT_EQ(refusal_of([] {
              run_in_child(
                  "a.h5", []() -> std::string { std::_Exit(3); }, nullptr);
            }),
            "a.h5: its process ended with status 3 before its work was done");
  const std::atomic<bool> now{true};
  EXPECT_THROW(run_in_child(
                   "a.h5", [] { return std::string(); }, &now),
               Interrupted);
}

}  // namespace
}  // namespace slipbench::child_process_test
