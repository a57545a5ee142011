#include "tools/base/workers/child_process.h"

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <stdexcept>
#include <string>

#include "sim/core/process/interrupted.h"
#include "tests/expect.h"

namespace slipbench::child_process_test {
namespace {

using Kind = ChildEnd::Kind;

const std::atomic<bool> never{false};
void nothing(std::size_t) {}

ChildEnd ended(const std::function<std::string()>& action) {
  ChildProcess child(action);
  while (child.read()) continue;
  return child.end();
}

TEST(ChildProcess, SaysHowItEnded) {
  // More than a pipe holds, 64 kB.
  const std::string large(300000, 'x');
  EXPECT_EQ(ended([&] { return large; }).text, large);
  EXPECT_EQ(ended([] { return std::string(); }).kind, Kind::result);
  const ChildEnd refused = ended([]() -> std::string { throw InputError("bad"); });
  EXPECT_EQ(refused.kind, Kind::bad_input);
  EXPECT_EQ(refused.text, "bad");
  EXPECT_EQ(ended([]() -> std::string { throw std::runtime_error("worse"); }).kind, Kind::failure);
  EXPECT_EQ(ended([]() -> std::string { throw std::bad_alloc(); }).kind, Kind::no_memory);
  const ChildEnd killed = ended([]() -> std::string {
    ::raise(SIGKILL);
    return "never";
  });
  EXPECT_EQ(killed.kind, Kind::broken);
  EXPECT_EQ(WTERMSIG(killed.status), SIGKILL);
}

// The child would sleep for a minute: the test's own time shows that it is not waited for.
TEST(ChildProcess, EndsWithItsOwner) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  {
    const ChildProcess child([] {
      ::sleep(60);
      return std::string();
    });
  }
  ::close(ends[1]);
  char byte = 0;
  EXPECT_EQ(::read(ends[0], &byte, 1), 0) << "the child held the other end open";
  ::close(ends[0]);
}

TEST(RunInProcesses, HandsOverInOrder) {
  // Odd work takes longer, so that even work finishes out of turn.
  const auto work = [](std::size_t k) {
    ::usleep(k % 2 == 0 ? 10 : 5000);
    return std::to_string(k * k);
  };
  for (const std::size_t jobs : {1U, 2U, 5U}) {
    std::vector<std::size_t> begun;
    const std::vector<std::string> results = run_in_processes(
        7, jobs, work, [&](std::size_t k) { begun.push_back(k); }, never);
    EXPECT_THAT(results, ElementsAre("0", "1", "4", "9", "16", "25", "36"));
    EXPECT_THAT(begun, ElementsAre(0, 1, 2, 3, 4, 5, 6));
  }
  EXPECT_TRUE(run_in_processes(0, 2, work, nothing, never).empty());
}

// The first waits for a byte that only the second writes.
TEST(RunInProcesses, DoesAsManyAtATimeAsItIsTold) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  const auto work = [&](std::size_t k) {
    char byte = 'x';
    const ssize_t count = k == 0 ? ::read(ends[0], &byte, 1) : ::write(ends[1], &byte, 1);
    return std::to_string(count);
  };
  EXPECT_THAT(run_in_processes(2, 2, work, nothing, never), ElementsAre("1", "1"));
  for (const int end : ends) ::close(end);
}

// What work leaves in memory is its own: the next does not see it, whatever the jobs.
TEST(RunInProcesses, BeginsEachWithTheSameMemory) {
  int value = 1;
  const auto work = [&](std::size_t) { return std::to_string(value++); };
  for (const std::size_t jobs : {1U, 3U})
    EXPECT_THAT(run_in_processes(3, jobs, work, nothing, never), ElementsAre("1", "1", "1"));
  EXPECT_EQ(value, 1);
}

TEST(RunInProcesses, ThrowsWhatWorkThrew) {
  const auto failing = [](auto error) {
    return [error](std::size_t k) -> std::string {
      if (k == 1) throw error;
      return "";
    };
  };
  EXPECT_THROW(run_in_processes(3, 2, failing(InputError("bad")), nothing, never), InputError);
  EXPECT_THROW(run_in_processes(3, 2, failing(std::runtime_error("worse")), nothing, never), std::runtime_error);
  const auto dying = [](std::size_t) -> std::string { std::_Exit(3); };
  EXPECT_THROW(run_in_processes(1, 1, dying, nothing, never), std::runtime_error);
}

// The second work is never begun, and the first, which would take a minute, is ended.
TEST(RunInProcesses, AnInterruptEndsAll) {
  std::atomic<bool> interrupt{false};
  const auto work = [](std::size_t) {
    ::sleep(60);
    return std::string();
  };
  std::size_t begun = 0;
  const auto note = [&](std::size_t) {
    ++begun;
    interrupt = true;
  };
  EXPECT_THROW(run_in_processes(2, 2, work, note, interrupt), Interrupted);
  EXPECT_EQ(begun, 1U);
}

}  // namespace
}  // namespace slipbench::child_process_test
