// A library that crashes while it is unloaded. Without the standard library: what that brings along would keep it from being unloaded.
#include "detectors/plugin_abi.h"

namespace {

void update(void* /*self*/, const slipbench_detector_input* /*input*/, slipbench_estimate* estimate) { estimate->state = 1; }

[[gnu::destructor]] void unload() {
  volatile size_t address = 64;
  *reinterpret_cast<volatile int*>(address) = 1;  // NOLINT(performance-no-int-to-ptr)
}

}  // namespace

const slipbench_abi slipbench_detector_abi = SLIPBENCH_DETECTOR_BUILD;

void slipbench_make_detector(const slipbench_source* /*source*/, slipbench_detector* detector) { detector->update = update; }
