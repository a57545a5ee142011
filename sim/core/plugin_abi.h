// What the program and a shared library with a sensor, a detector or a controller of one's own hand each other, in plain C so
// that any compiler's library will do. The plugin_abi.h of sensors, detectors and controllers include it and declare what such a
// library exports.
//
// Rules of every call:
// - Lengths are in m, times in s, forces in N, as a dataset has them.
// - No pointer that is handed over may be kept after the call. Who needs a name or a text later copies it.
// - No function may throw, and none may end the program. What one throws ends the trial with a message that names the library and
//   the function. A crash ends the program, or with --isolate the trial; a loop without end ends with --trial-limit, or at a signal.
// - Several threads run trials at once. A library makes one object a trial, and each object is used by one thread at a time; what
//   its objects share must be safe for several.
// - Nothing that is handed to a detector or a controller holds the truth. A library runs in a process that holds it, though: this keeps out mistakes and
//   no intruder.
#pragma once

#include <stddef.h>

// What a library exports has to be found, also where it is built with -fvisibility=hidden.
#define SLIPBENCH_EXPORT __attribute__((visibility("default")))

#ifdef __cplusplus
extern "C" {
#endif

// What a library was built with: the version of its interface, and the sizes of all structures, which differ where a binding to
// another language or a compiler's option (packing) lays them out otherwise. Both have to be the program's own; the library is
// refused else.
struct slipbench_abi {
  unsigned version;         // SLIPBENCH_SENSOR_ABI, SLIPBENCH_DETECTOR_ABI or SLIPBENCH_CONTROLLER_ABI
  unsigned parameter_size;  // sizeof(struct slipbench_parameter)
  unsigned channel_size;    // sizeof(struct slipbench_channel)
  unsigned sensor_size;     // sizeof(struct slipbench_sensor)
  unsigned source_size;     // sizeof(struct slipbench_source)
  unsigned samples_size;    // sizeof(struct slipbench_samples)
  unsigned object_size;     // sizeof(struct slipbench_readout), (struct slipbench_detector) or (struct slipbench_controller)
  unsigned input_size;      // of slipbench_contact, slipbench_detector_input or slipbench_control_input
  unsigned result_size;     // of slipbench_element, slipbench_estimate or slipbench_grip_command
};

// The sizes that all of them share, for SLIPBENCH_SENSOR_BUILD, SLIPBENCH_DETECTOR_BUILD and SLIPBENCH_CONTROLLER_BUILD.
#define SLIPBENCH_SHARED_SIZES                                                                           \
  sizeof(struct slipbench_parameter), sizeof(struct slipbench_channel), sizeof(struct slipbench_sensor), \
      sizeof(struct slipbench_source), sizeof(struct slipbench_samples)

// What a parameter holds.
enum slipbench_parameter_type {
  SLIPBENCH_NUMBER = 1,   // finite
  SLIPBENCH_TEXT = 2,     // any text of one line
  SLIPBENCH_BOOLEAN = 3,  // true or false
};

// One parameter. A library declares those that it has, with their defaults, and gets them back in the same order with what the
// scene says of them under `parameters`. A name that the library does not declare is an error of the scene, as is a value that is
// not of the declared type.
struct slipbench_parameter {
  const char* name;  // letters, digits and '_', no digit first: "threshold"
  int type;          // a slipbench_parameter_type
  double number;     // of a number, in SI; of a boolean 1 or 0; of a text 0
  const char* text;  // of a text; else ""
  const char* unit;  // of a number, as SI has it: "N", "m/s"; the scene may write "300 mN" then. "": a bare number
};

// The rows of a declaration.
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
  size_t first;  // where it begins among the values of a sample
  size_t size;   // how many values it has
};

// One sensor of the scene.
struct slipbench_sensor {
  const char* name;  // the scene's own: "pad"
  const char* type;  // "papillarray"
  double rate;       // Hz, of its samples
  const struct slipbench_channel* channels;
  size_t channel_count;
  size_t value_count;  // of one sample: all channels in their order
};

// What an object is made for.
struct slipbench_source {
  const struct slipbench_sensor* sensors;  // all of the scene, in its order; of a sensor null
  size_t sensor_count;
  size_t sensor;  // index of the detector's own, `detector.sensor`; of a controller 0, the pad on the finger that feels
  const struct slipbench_parameter* parameters;  // as many as the library declares, in its order
  size_t parameter_count;
};

// What one sensor has said since the call before.
struct slipbench_samples {
  const float* values;  // [count, value_count], the oldest first; what count samples hold
  const double* times;  // [count] s
  size_t count;         // 0: nothing new
  const float* latest;  // [value_count], the newest sample of all, also where it is not new; null before the sensor's first
  double latest_time;   // s; NaN before the sensor's first
};

// Bytes of a refusal with its end.
#define SLIPBENCH_REFUSAL_SIZE 256

#ifdef __cplusplus
}
#endif
