// A detector in a shared library, in plain C: `detector: {type: plugin, library: mine.so, parameters: {...}}`. What it exports
// and is handed, beside the structures and rules of sim/core/plugin_abi.h. A whole one: detectors/example.
#pragma once

#include "sim/core/plugin_abi.h"

// Version of this interface, sim/core/plugin_abi.h included. It grows whenever a library that was built with an older one would
// not work any more.
#define SLIPBENCH_DETECTOR_ABI 1

// What slipbench_detector_abi is to be set to.
#define SLIPBENCH_DETECTOR_BUILD                                                                                                \
  {                                                                                                                             \
    SLIPBENCH_DETECTOR_ABI, SLIPBENCH_SHARED_SIZES, sizeof(struct slipbench_detector), sizeof(struct slipbench_detector_input), \
        sizeof(struct slipbench_estimate)                                                                                       \
  }

#ifdef __cplusplus
extern "C" {
#endif

// What a detector is handed at an update.
struct slipbench_detector_input {
  double time;                              // s, of the newest sample of the detector's own sensor
  const struct slipbench_samples* sensors;  // of all sensors of the scene, in the order of slipbench_source
  size_t sensor_count;
};

// What it says. All but `state` may be left as they are handed over.
struct slipbench_estimate {
  int state;              // 0 no contact or not known yet, 1 non-slip, 2 incipient, 3 gross; handed over as -1, which is refused
  double latency;         // s, >= 0, from the sample until the estimate is there; handed over as 0
  double stuck_fraction;  // share of the touching units that stick, 0 to 1; handed over as NaN: not told
};

// A detector. `update` is called at its rate, at the first sample of its own sensor and then at every k-th, in order of time.
struct slipbench_detector {
  void* self;   // handed to both functions
  double rate;  // Hz, of the updates: the own sensor's rate over a whole number k; handed over as that rate itself
  void (*update)(void* self, const struct slipbench_detector_input* input, struct slipbench_estimate* estimate);
  void (*destroy)(void* self);           // called once at the end; null: nothing to do
  char refusal[SLIPBENCH_REFUSAL_SIZE];  // one line that says why there is none for this scene, `update` being null then
};

// The two symbols that a library exports. slipbench_make_detector is asked for one detector a trial; `detector` is handed over
// without functions.
SLIPBENCH_EXPORT extern const struct slipbench_abi slipbench_detector_abi;  // = SLIPBENCH_DETECTOR_BUILD
SLIPBENCH_EXPORT void slipbench_make_detector(const struct slipbench_source* source, struct slipbench_detector* detector);

// A third one that may be left out: the parameters of the library, ended by SLIPBENCH_NO_MORE.
SLIPBENCH_EXPORT extern const struct slipbench_parameter slipbench_detector_parameters[];

#ifdef __cplusplus
}
#endif
