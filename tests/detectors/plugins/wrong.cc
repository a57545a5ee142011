// A library that is correct except for the faults in the environment variable SLIPBENCH_WRONG at
// load time: words joined by commas, each a key and a number. So one library stands for any number
// of faulty ones.
//   version=7  size3=40  rows=1 (each value a fault of the parameter table)  make=1 (no function)  rate=7  state=9  latency=-1  stuck=2
//   crash=1 (CRASH) in=1 (IN)
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>

// The library sets these at load time, so they cannot be the header's constants.
#define slipbench_detector_abi declared_abi
#define slipbench_detector_parameters declared_parameters
#include "detectors/plugin_abi.h"
#undef slipbench_detector_abi
#undef slipbench_detector_parameters

namespace {

enum In { nowhere, in_load, in_make, in_update, in_destroy };
enum Crash { none, bad_address, aborted, divided, illegal, bus, stack, thrown, exited };

double asked(const char* key, double otherwise) {
  const char* const words = std::getenv("SLIPBENCH_WRONG");
  if (words == nullptr) return otherwise;
  const std::string all = "," + std::string(words);
  const std::size_t at = all.find("," + std::string(key) + "=");
  return at == std::string::npos ? otherwise : std::strtod(all.c_str() + at + std::strlen(key) + 2, nullptr);
}

int asked_int(const char* key) { return static_cast<int>(asked(key, 0.0)); }

int sink(volatile const int* depth, int level) {
  volatile char room[4096] = {};
  if (level >= *depth) return 0;
  room[0] = static_cast<char>(sink(depth, level + 1));
  return room[0];
}

void crash_in(In place) {
  if (asked_int("in") != place) return;
  const int depth = 1'000'000'000;
  switch (asked_int("crash")) {
    case bad_address: {
      volatile std::uintptr_t address = 64;
      *reinterpret_cast<volatile int*>(address) = 1;  // NOLINT(performance-no-int-to-ptr)
      break;
    }
    case aborted: std::abort();
    case divided: std::raise(SIGFPE); break;
    case illegal: std::raise(SIGILL); break;
    case bus: std::raise(SIGBUS); break;
    case stack: static_cast<void>(sink(&depth, 0)); break;
    case thrown: throw std::runtime_error("out of ideas");
    case exited: std::exit(0);
    default: break;
  }
}

void update(void* /*self*/, const slipbench_detector_input* /*input*/, slipbench_estimate* estimate) {
  crash_in(in_update);
  estimate->state = static_cast<int>(asked("state", 1));
  estimate->latency = asked("latency", 0.0);
  estimate->stuck_fraction = asked("stuck", 1.0);
}

void destroy(void* /*self*/) { crash_in(in_destroy); }

// Runs when the library is loaded.
struct Loaded {
  Loaded();
};

}  // namespace

extern "C" {
SLIPBENCH_EXPORT extern slipbench_abi slipbench_detector_abi;
slipbench_abi slipbench_detector_abi = SLIPBENCH_DETECTOR_BUILD;
SLIPBENCH_EXPORT extern slipbench_parameter slipbench_detector_parameters[3000];
slipbench_parameter slipbench_detector_parameters[3000] = {SLIPBENCH_A_NUMBER("threshold", 0.5, "N"), SLIPBENCH_NO_MORE};
}

namespace {

Loaded::Loaded() {
  slipbench_abi& abi = slipbench_detector_abi;
  abi.version = static_cast<unsigned>(asked("version", abi.version));
  unsigned* const sizes[] = {&abi.parameter_size, &abi.channel_size, &abi.sensor_size, &abi.source_size,
                             &abi.samples_size,   &abi.object_size,  &abi.input_size,  &abi.result_size};
  for (std::size_t i = 0; i < std::size(sizes); ++i) {
    *sizes[i] = static_cast<unsigned>(asked(("size" + std::to_string(i)).c_str(), *sizes[i]));
  }
  slipbench_parameter& row = slipbench_detector_parameters[0];
  switch (asked_int("rows")) {
    case 2: row.name = "no name"; break;
    case 3: row.type = 0; break;
    case 4: row.type = 1'000'000; break;
    case 5: row.number = std::nan(""); break;
    case 6: row.unit = "bananas"; break;
    case 7: row.unit = "mN"; break;
    case 9: slipbench_detector_parameters[1] = row; break;
    case 10:
      for (slipbench_parameter& any : slipbench_detector_parameters) any = row;
      break;
    default: break;
  }
  crash_in(in_load);
}

const Loaded loaded;

}  // namespace

void slipbench_make_detector(const slipbench_source* /*source*/, slipbench_detector* detector) {
  crash_in(in_make);
  detector->rate = asked("rate", detector->rate);
  detector->destroy = destroy;
  if (asked_int("make") == 1) return;
  if (asked_int("make") == 2) std::memset(detector->refusal, 'x', sizeof detector->refusal);
  if (asked_int("make") == 2) return;
  detector->update = update;
}
