// The interface between the program and a user's shared library with a sensor, a detector or a
// controller, in plain C so that any compiler's library works. The plugin_abi.h of sensors,
// detectors and controllers include this header and declare what such a library exports.
//
// Rules of every call:
// - Lengths are in m, times in s, forces in N, as in a dataset.
// - No pointer may be kept after the call. A library copies the names and texts that it needs
//   later.
// - No function may throw, and none may end the program. An exception ends the trial with a message
//   that names the library and the function. A crash ends the program, or with --isolate the
//   trial; an endless loop ends with --trial-limit, or at a signal.
// - Several threads run trials at once. A library makes one object per trial, and each object is
//   used by one thread at a time; data that its objects share must be safe for several threads.
// - No input of a detector or a controller holds the truth. The process does hold it, so this
//   prevents mistakes, not an attack.
#pragma once

#include <stddef.h>

// Makes an export visible also in a library built with -fvisibility=hidden.
#define SLIPBENCH_EXPORT __attribute__((visibility("default")))

#ifdef __cplusplus
extern "C" {
#endif

// The interface that a library was built with: its version, and the sizes of all structures. The
// sizes differ if a binding to another language or a compiler option (packing) lays the structures
// out differently. The program refuses a library whose values differ from its own.
struct slipbench_abi {
  // SLIPBENCH_SENSOR_ABI, SLIPBENCH_DETECTOR_ABI or SLIPBENCH_CONTROLLER_ABI
  unsigned version;
  unsigned parameter_size;  // sizeof(struct slipbench_parameter)
  unsigned channel_size;    // sizeof(struct slipbench_channel)
  unsigned sensor_size;     // sizeof(struct slipbench_sensor)
  unsigned source_size;     // sizeof(struct slipbench_source)
  unsigned samples_size;    // sizeof(struct slipbench_samples)
  // sizeof(struct slipbench_readout), (struct slipbench_detector) or (struct slipbench_controller)
  unsigned object_size;
  // of slipbench_contact, slipbench_detector_input or slipbench_control_input
  unsigned input_size;
  // of slipbench_element, slipbench_estimate or slipbench_grip_command
  unsigned result_size;
};

// The sizes that the three interfaces share, for SLIPBENCH_SENSOR_BUILD, SLIPBENCH_DETECTOR_BUILD
// and SLIPBENCH_CONTROLLER_BUILD.
#define SLIPBENCH_SHARED_SIZES                                                                           \
  sizeof(struct slipbench_parameter), sizeof(struct slipbench_channel), sizeof(struct slipbench_sensor), \
      sizeof(struct slipbench_source), sizeof(struct slipbench_samples)

// Type of a parameter's value.
enum slipbench_parameter_type {
  SLIPBENCH_NUMBER = 1,   // finite
  SLIPBENCH_TEXT = 2,     // any text of one line
  SLIPBENCH_BOOLEAN = 3,  // true or false
};

// One parameter. A library declares its parameters with their defaults and receives them in the
// same order, with the values that the scene gives under `parameters`. A name that the library does
// not declare is an error of the scene, and so is a value that is not of the declared type.
struct slipbench_parameter {
  const char* name;  // letters, digits and '_', no digit first: "threshold"
  int type;          // a slipbench_parameter_type
  double number;     // of a number, in SI; of a boolean 1 or 0; of a text 0
  const char* text;  // of a text; else ""
  // of a number, its SI unit: "N", "m/s"; the scene may then write "300 mN". "": a bare number
  const char* unit;
};

// Rows of a declaration.
#define SLIPBENCH_A_NUMBER(name, value, unit) \
  { name, SLIPBENCH_NUMBER, value, "", unit }
#define SLIPBENCH_A_TEXT(name, value) \
  { name, SLIPBENCH_TEXT, 0.0, value, "" }
#define SLIPBENCH_A_BOOLEAN(name, value) \
  { name, SLIPBENCH_BOOLEAN, value, "", "" }
#define SLIPBENCH_NO_MORE \
  { "", 0, 0.0, "", "" }  // the last row: one without a name

// One array of a sample: extents shape[0] to shape[dimensions - 1], in C order.
struct slipbench_channel {
  const char* name;  // "force"
  const char* unit;  // "N"
  const size_t* shape;
  size_t dimensions;
  size_t first;  // index of its first value in a sample
  size_t size;   // number of its values
};

// One sensor of the scene.
struct slipbench_sensor {
  const char* name;  // the scene's name for it: "pad"
  const char* type;  // "papillarray"
  double rate;       // Hz, of its samples
  const struct slipbench_channel* channels;
  size_t channel_count;
  size_t value_count;  // of one sample: all channels in order
};

// The scene for which an object is made.
struct slipbench_source {
  const struct slipbench_sensor* sensors;  // all of the scene, in its order; null for a sensor
  size_t sensor_count;
  // Index of the detector's sensor, `detector.sensor`; for a controller 0, the pad on the finger
  // with the sensor.
  size_t sensor;
  // As many as the library declares, in its order.
  const struct slipbench_parameter* parameters;
  size_t parameter_count;
};

// The samples of one sensor since the last call.
struct slipbench_samples {
  const float* values;  // [count, value_count], oldest first
  const double* times;  // [count] s
  size_t count;         // 0: nothing new
  // [value_count], the newest sample, even if it is not new; null before the first
  const float* latest;
  double latest_time;  // s; NaN before the first sample
};

// Size of the text of a refusal in bytes, its terminating zero included.
#define SLIPBENCH_REFUSAL_SIZE 256

#ifdef __cplusplus
}
#endif
