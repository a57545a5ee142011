// Plain C interface of a detector in a shared library: `detector: {type: plugin, library: mine.so,
// parameters: {...}}`. Structures and rules shared with other plugins are in sim/api/plugin_abi.h.
// Complete example: detectors/example.
#pragma once

#include "sim/api/plugin_abi.h"

// Version of this interface, including sim/api/plugin_abi.h. It grows with each change that breaks
// libraries built with an older version.
#define SLIPBENCH_DETECTOR_ABI 1

// Value for slipbench_detector_abi.
#define SLIPBENCH_DETECTOR_BUILD                                                                                                \
  {                                                                                                                             \
    SLIPBENCH_DETECTOR_ABI, SLIPBENCH_SHARED_SIZES, sizeof(struct slipbench_detector), sizeof(struct slipbench_detector_input), \
        sizeof(struct slipbench_estimate)                                                                                       \
  }

#ifdef __cplusplus
extern "C" {
#endif

// Input of an update.
struct slipbench_detector_input {
  double time;                              // s, of the newest sample of the detector's own sensor
  const struct slipbench_samples* sensors;  // of all sensors of the scene, in the order of slipbench_source
  size_t sensor_count;
};

// Result of an update. All fields but `state` have valid defaults.
struct slipbench_estimate {
  int state;              // 0 no contact or not known yet, 1 non-slip, 2 incipient, 3 gross; preset to -1, which is refused
  double latency;         // s, >= 0, from the sample until the estimate is available; preset to 0
  double stuck_fraction;  // share of the touching units that stick, 0 to 1; preset to NaN: unknown
};

// A detector. `update` is called at its rate: at the first sample of its own sensor, then at every
// k-th, in order of time.
struct slipbench_detector {
  void* self;   // passed to both functions
  double rate;  // Hz, of the updates: the sensor's rate over a whole number k; preset to the sensor's rate
  void (*update)(void* self, const struct slipbench_detector_input* input, struct slipbench_estimate* estimate);
  void (*destroy)(void* self);           // called once at the end; null: not needed
  char refusal[SLIPBENCH_REFUSAL_SIZE];  // the reason why this scene is refused, one line; `update` is then null
};

// The two symbols that a library exports. slipbench_make_detector is called once per trial.
// `detector` comes without functions.
SLIPBENCH_EXPORT extern const struct slipbench_abi slipbench_detector_abi;  // = SLIPBENCH_DETECTOR_BUILD
SLIPBENCH_EXPORT void slipbench_make_detector(const struct slipbench_source* source, struct slipbench_detector* detector);

// Optional third symbol: the parameters of the library, ended by SLIPBENCH_NO_MORE.
SLIPBENCH_EXPORT extern const struct slipbench_parameter slipbench_detector_parameters[];

#ifdef __cplusplus
}
#endif
