// A detector that does what its parameter `deed` names after a hundred updates, or when it is made
// if the deed begins with "make ". With SLIPBENCH_HONEST in the environment it behaves.
#include <cfenv>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <thread>

#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "detectors/plugin_abi.h"

namespace {

struct Detector {
  std::string deed;
  int updates = 0;
};

volatile int sink = 0;

[[gnu::noinline]] int overflow(int depth) {
  volatile char room[4096] = {};
  room[0] = static_cast<char>(depth);
  return depth < 0 ? 0 : overflow(depth + 1) + room[0];
}

void crash() { *reinterpret_cast<volatile int*>(std::getenv("SLIPBENCH_HONEST")) = 1; }  // which is null

// A size that no chunk has.
void corrupt_heap() {
  auto* const chunk = static_cast<std::size_t*>(std::malloc(100));
  const_cast<volatile std::size_t*>(chunk)[-1] = 0x7e7e;
  std::free(chunk);
}

[[noreturn]] void exhaust_memory() {
  const rlimit a_gigabyte{1 << 30, 1 << 30};
  ::setrlimit(RLIMIT_AS, &a_gigabyte);
  for (volatile char* block = nullptr;; block = new char[1 << 24]) sink = block == nullptr ? 0 : 1;
}

void ignore_signals() {
  for (int signal = 1; signal < NSIG; ++signal) std::signal(signal, SIG_IGN);
}

void write_to_pipes() {
  for (int descriptor = 3; descriptor < 1024; ++descriptor) {
    struct stat about {};
    if (::fstat(descriptor, &about) == 0 && S_ISFIFO(about.st_mode)) sink = static_cast<int>(::write(descriptor, "r.", 2));
  }
}

[[noreturn]] void loop() {
  while (true) sink = sink + 1;
}

void do_deed(const std::string& deed) {
  if (std::getenv("SLIPBENCH_HONEST") != nullptr) return;
  if (deed == "segv") crash();
  if (deed == "abort") std::abort();
  if (deed == "fpe") std::raise(SIGFPE);
  if (deed == "stack") sink = overflow(0);
  if (deed == "kill") ::kill(::getpid(), SIGKILL);
  if (deed == "exit") std::exit(0);
  if (deed == "_exit") ::_exit(0);
  if (deed == "heap") corrupt_heap();
  if (deed == "files") ::close_range(3, ~0U, 0);
  if (deed == "folder") sink = ::chdir("/");
  if (deed == "output") std::puts("not JSON"), std::fflush(stdout);
  if (deed == "memory") exhaust_memory();
  if (deed == "throw") throw std::runtime_error("out of ideas");
  if (deed == "rounding") std::fesetround(FE_DOWNWARD);
  if (deed == "signals") ignore_signals();
  if (deed == "fork" && ::fork() == 0) ::pause();
  if (deed == "thread") std::thread(crash).join();
  if (deed == "pipe") write_to_pipes();
  if (deed == "loop") loop();
  if (deed == "deaf") {
    ignore_signals();
    while (true) ::pause();
  }
}

void update(void* self, const slipbench_detector_input* input, slipbench_estimate* estimate) {
  auto& detector = *static_cast<Detector*>(self);
  if (++detector.updates == 100) do_deed(detector.deed);
  if (detector.deed == "slow") ::usleep(25'000);
  if (detector.deed == "latest" && std::getenv("SLIPBENCH_HONEST") == nullptr)
    const_cast<float*>(input->sensors[0].latest)[0] = 7.0F;
  estimate->state = 1;
}

void destroy(void* self) {
  const std::string deed = static_cast<Detector*>(self)->deed;
  delete static_cast<Detector*>(self);
  if (deed == "destroy") do_deed("segv");
}

}  // namespace

const slipbench_parameter slipbench_detector_parameters[] = {SLIPBENCH_A_TEXT("deed", "none"), SLIPBENCH_NO_MORE};
const slipbench_abi slipbench_detector_abi = SLIPBENCH_DETECTOR_BUILD;

void slipbench_make_detector(const slipbench_source* source, slipbench_detector* detector) {
  const std::string deed = source->parameters[0].text;
  if (deed.rfind("make ", 0) == 0) do_deed(deed.substr(5));
  detector->self = new Detector{deed};
  detector->update = update;
  detector->destroy = destroy;
}
