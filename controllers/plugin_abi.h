// Plain C interface of a controller in a shared library: `controller: {type: plugin, library:
// mine.so, parameters: {...}}`. Structures and rules shared with other plugins are in
// sim/api/plugin_abi.h. Complete example: controllers/example.
#pragma once

#include "sim/api/plugin_abi.h"

// Version of this interface, including sim/api/plugin_abi.h. It grows with each change that breaks
// libraries built with an older version. Version 2 added all sensors, parameters and sizes of
// structures.
#define SLIPBENCH_CONTROLLER_ABI 2

// Value for slipbench_controller_abi.
#define SLIPBENCH_CONTROLLER_BUILD                                                         \
  {                                                                                        \
    SLIPBENCH_CONTROLLER_ABI, SLIPBENCH_SHARED_SIZES, sizeof(struct slipbench_controller), \
        sizeof(struct slipbench_control_input), sizeof(struct slipbench_grip_command)      \
  }

#ifdef __cplusplus
extern "C" {
#endif

// Input of an update.
struct slipbench_control_input {
  double slip_time;                         // s, of the sample behind the detector's estimate; -inf before the first
  double slip_latency;                      // s, from that sample until the estimate was available
  int slip_state;                           // 0 no contact, 1 non-slip, 2 incipient, 3 gross
  double stuck_fraction;                    // 0 to 1; NaN: the detector does not give it
  const struct slipbench_samples* sensors;  // of all sensors of the scene, in the order of slipbench_source
  size_t sensor_count;
  double status_time;  // s, when the gripper's status was read
  int position;        // counts: 0 open, larger when closed
  int moving;          // 1 while the fingers move
  int stopped;         // 1 if the fingers stopped at the force limit
  double preset;       // N, the scene's grip.preset
};

// The registers written next, each 0 to 255.
struct slipbench_grip_command {
  int position;  // counts; preset to -1, which is refused
  int speed;     // 0 slowest; preset to 0
  int force;     // 0 weakest; preset to 0
};

// A controller. `update` is called once per period of the loop, in order of time.
struct slipbench_controller {
  void* self;  // passed to both functions
  void (*update)(void* self, const struct slipbench_control_input* input, struct slipbench_grip_command* command);
  void (*destroy)(void* self);           // called once at the end; null: not needed
  char refusal[SLIPBENCH_REFUSAL_SIZE];  // the reason why this scene is refused, one line; `update` is then null
};

// The two symbols that a library exports. slipbench_make_controller is called once per trial.
// `controller` comes without functions.
SLIPBENCH_EXPORT extern const struct slipbench_abi slipbench_controller_abi;  // = SLIPBENCH_CONTROLLER_BUILD
SLIPBENCH_EXPORT void slipbench_make_controller(const struct slipbench_source* source, struct slipbench_controller* controller);

// Optional third symbol: the parameters of the library, ended by SLIPBENCH_NO_MORE.
SLIPBENCH_EXPORT extern const struct slipbench_parameter slipbench_controller_parameters[];

#ifdef __cplusplus
}
#endif
