#include "tools/base/workers/isolated_worker.h"

#include <csignal>
#include <filesystem>
#include <new>
#include <stdexcept>
#include <string>

#include <pthread.h>
#include <unistd.h>

#include "sim/core/process/interrupted.h"
#include "tests/expect.h"

namespace slipbench {
namespace {

TEST(IsolatedWorker, HandsOverWhatWorkReturnsAndThrows) {
  IsolatedWorker worker([](std::size_t index) -> std::string {
    if (index == 1) throw InputError("bad");
    if (index == 2) throw std::bad_alloc();
    if (index == 3) throw std::runtime_error("worse");
    return std::string(index, 'x');
  });
  // A larger answer after a small one, and then a smaller.
  for (const std::size_t size : {std::size_t{10}, std::size_t{5'000'000}, std::size_t{0}, std::size_t{7}}) {
    EXPECT_EQ(worker.run(size, nullptr), std::string(size, 'x'));
  }
  EXPECT_EQ(refusal_of([&] { worker.run(1, nullptr); }), "bad");
  EXPECT_THROW(worker.run(2, nullptr), std::bad_alloc);
  EXPECT_THROW(worker.run(3, nullptr), std::runtime_error);
}

// Work 0 leaves what ends its process in work 1, which is done once more and well. Work 2 ends every process.
TEST(IsolatedWorker, DoesInnocentWorkOnceMore) {
  bool harmed = false;
  IsolatedWorker worker([&](std::size_t index) -> std::string {
    if (index == 2 || (index == 1 && harmed)) ::_exit(0);
    harmed = true;
    return std::to_string(index);
  });
  EXPECT_EQ(worker.run(0, nullptr), "0");
  EXPECT_EQ(worker.run(1, nullptr), "1");
  EXPECT_THAT(refusal_of([&] { worker.run(2, nullptr); }), mentions({"process", "ended"}));
  EXPECT_EQ(worker.run(4, nullptr), "4");
}

// Without memory a process may end before it takes any work; a keeper's next one does, too.
TEST(IsolatedWorker, GivesUpWhereNoProcessBegins) {
  static int status = 0, generation = 0;  // of the keeper 1, of its processes 2
  ::pthread_atfork(nullptr, nullptr, [] {
    if (status > 0 && ++generation == 2) ::_exit(status);
  });
  for (status = 12; status > 0; status -= 6) {
    IsolatedWorker worker([](std::size_t) { return std::string(); });
    if (status == 12) {
      EXPECT_THROW(worker.run(0, nullptr), std::bad_alloc);
    } else {
      EXPECT_THAT(refusal_of([&] { worker.run(0, nullptr); }), mentions({"process", "ended"}));
    }
  }
}

// Each process is killed from outside as soon as it has answered, at the latest while it takes up the next work.
TEST(IsolatedWorker, LosesNoWorkWithAProcessThatEndsBetweenTwo) {
  IsolatedWorker worker([](std::size_t index) { return std::to_string(index) + " " + std::to_string(::getpid()); });
  for (std::size_t i = 0; i < 50; ++i) {
    const std::string answer(worker.run(i, nullptr));
    const std::size_t gap = answer.find(' ');
    EXPECT_EQ(answer.substr(0, gap), std::to_string(i));
    ::kill(std::stoi(answer.substr(gap)), SIGKILL);
  }
}

// A copy of the process would answer, too.
TEST(IsolatedWorker, HearsOfACopiedProcessOnce) {
  IsolatedWorker worker([](std::size_t index) {
    if (index == 0) static_cast<void>(::fork());
    return std::to_string(index);
  });
  for (const std::size_t index : {0, 1, 0, 2}) EXPECT_EQ(worker.run(index, nullptr), std::to_string(index));
}

TEST(IsolatedWorker, BeginsEachWorkInTheCallersFolder) {
  IsolatedWorker worker([](std::size_t) {
    std::string folder = std::filesystem::current_path().string();
    std::filesystem::current_path("/");
    return folder;
  });
  for (int i = 0; i < 2; ++i) EXPECT_EQ(worker.run(0, nullptr), std::filesystem::current_path().string());
}

// Work that sleeps for a minute: the test's own time shows that it is not waited for.
TEST(IsolatedWorker, EndsWhatTakesTooLongAndWhatIsInterrupted) {
  const auto sleep = [](std::size_t) {
    ::sleep(60);
    return std::string();
  };
  IsolatedWorker limited(sleep, {.time = 0.1});
  EXPECT_THAT(refusal_of([&] { limited.run(0, nullptr); }), mentions({"process", "0.1 s"}));
  IsolatedWorker interrupted(sleep);
  const std::atomic<bool> now{true};
  EXPECT_THROW(interrupted.run(0, &now), Interrupted);
}

}  // namespace
}  // namespace slipbench
