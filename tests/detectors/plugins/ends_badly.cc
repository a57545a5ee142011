// A library that does well, but for what it prints, a thread that it leaves at work for ever, and a crash when the process ends.
#include <cstdio>
#include <thread>

#include "detectors/plugin_abi.h"

namespace {

volatile unsigned beats = 0;

[[noreturn]] void beat() {
  while (true) beats = beats + 1;
}

void update(void* /*self*/, const slipbench_detector_input* /*input*/, slipbench_estimate* estimate) { estimate->state = 1; }

[[gnu::destructor]] void unload() {
  volatile size_t address = 64;
  *reinterpret_cast<volatile int*>(address) = 1;  // NOLINT(performance-no-int-to-ptr)
}

}  // namespace

const slipbench_abi slipbench_detector_abi = SLIPBENCH_DETECTOR_BUILD;

void slipbench_make_detector(const slipbench_source* /*source*/, slipbench_detector* detector) {
  std::thread(beat).detach();
  std::puts("made one");
  detector->update = update;
}
