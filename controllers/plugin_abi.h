// A controller in a shared library, in plain C so that any compiler's library will do: what it exports and what it is handed. Lengths
// in m, times in s, forces in N. No function may throw, and no pointer that is handed over may be kept after the call.
#pragma once

#include <stddef.h>

// Version of this file. It grows whenever a library that was built with an older one would not work any more.
#define SLIPBENCH_CONTROLLER_ABI 1

#ifdef __cplusplus
extern "C" {
#endif

// One array of a frame: extents shape[0] to shape[dimensions - 1], in C order.
struct slipbench_channel {
  const char* name;  // "force"
  const char* unit;  // "N"
  const size_t* shape;
  size_t dimensions;
};

// slipbench::ControlInput.
struct slipbench_control_input {
  double slip_time;       // of the frame that the estimate was made from
  double slip_latency;    // from that frame until the estimate was there
  int slip_state;         // 0 no contact, 1 non-slip, 2 incipient, 3 gross
  double stuck_fraction;  // 0 to 1; NaN: the detector tells none
  double frame_time;
  const float* values;  // all channels in the order in which they were announced
  size_t value_count;
  double status_time;
  int position;   // counts: 0 open, growing as the fingers close
  int moving;     // 1 while the fingers move
  int stopped;    // 1 when they stopped at the force limit
  double preset;  // the scene's grip.preset
};

// slipbench::GripCommand; the gripper refuses what is not within 0 to 255.
struct slipbench_grip_command {
  int position;
  int speed;
  int force;
};

// A controller: `update` is called once a period of the loop, in order of time, and `destroy` once at the end (null: nothing to do).
struct slipbench_controller {
  void* self;  // handed to both
  struct slipbench_grip_command (*update)(void* self, const struct slipbench_control_input* input);
  void (*destroy)(void* self);
};

// The two symbols of a library. The version is SLIPBENCH_CONTROLLER_ABI as the library was built with. A library is asked for one
// controller a trial, by several threads at once; one that cannot work with these channels returns a controller without `update`.
extern const unsigned slipbench_controller_abi;
struct slipbench_controller slipbench_make_controller(const struct slipbench_channel* channels, size_t count);

#ifdef __cplusplus
}
#endif
