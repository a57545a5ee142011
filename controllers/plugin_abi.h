// A controller in a shared library, in plain C: `controller: {type: plugin, library: mine.so, parameters: {...}}`. What it
// exports and is handed, beside the structures and rules of sim/core/plugin_abi.h. A whole one: controllers/example.
#pragma once

#include "sim/core/plugin_abi.h"

// Version of this interface, sim/core/plugin_abi.h included. It grows whenever a library that was built with an older one would
// not work any more. 2: all sensors, parameters, sizes of structures.
#define SLIPBENCH_CONTROLLER_ABI 2

// What slipbench_controller_abi is to be set to.
#define SLIPBENCH_CONTROLLER_BUILD                                                         \
  {                                                                                        \
    SLIPBENCH_CONTROLLER_ABI, SLIPBENCH_SHARED_SIZES, sizeof(struct slipbench_controller), \
        sizeof(struct slipbench_control_input), sizeof(struct slipbench_grip_command)      \
  }

#ifdef __cplusplus
extern "C" {
#endif

// What a controller is handed at an update.
struct slipbench_control_input {
  double slip_time;                         // s, of the sample that the detector's estimate was made from
  double slip_latency;                      // s, from that sample until the estimate was there
  int slip_state;                           // 0 no contact, 1 non-slip, 2 incipient, 3 gross
  double stuck_fraction;                    // 0 to 1; NaN: the detector tells none
  const struct slipbench_samples* sensors;  // of all sensors of the scene, in the order of slipbench_source
  size_t sensor_count;
  double status_time;  // s, of the read of the gripper's status
  int position;        // counts: 0 open, growing as the fingers close
  int moving;          // 1 while the fingers move
  int stopped;         // 1 when they stopped at the force limit
  double preset;       // N, the scene's grip.preset
};

// The registers that are written next, each 0 to 255.
struct slipbench_grip_command {
  int position;  // counts; handed over as -1, which is refused
  int speed;     // 0 slowest; handed over as 0
  int force;     // 0 weakest; handed over as 0
};

// A controller. `update` is called once a period of the loop, in order of time.
struct slipbench_controller {
  void* self;  // handed to both functions
  void (*update)(void* self, const struct slipbench_control_input* input, struct slipbench_grip_command* command);
  void (*destroy)(void* self);           // called once at the end; null: nothing to do
  char refusal[SLIPBENCH_REFUSAL_SIZE];  // one line that says why there is none for this scene, `update` being null then
};

// The two symbols that a library exports. slipbench_make_controller is asked for one controller a trial; `controller` is handed
// over without functions.
SLIPBENCH_EXPORT extern const struct slipbench_abi slipbench_controller_abi;  // = SLIPBENCH_CONTROLLER_BUILD
SLIPBENCH_EXPORT void slipbench_make_controller(const struct slipbench_source* source, struct slipbench_controller* controller);

// A third one that may be left out: the parameters of the library, ended by SLIPBENCH_NO_MORE.
SLIPBENCH_EXPORT extern const struct slipbench_parameter slipbench_controller_parameters[];

#ifdef __cplusplus
}
#endif
