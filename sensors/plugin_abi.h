// Plain C interface of a sensor in a shared library: `sensors: {pad: {type: plugin, library:
// mine.so, parameters: {...}}}`. Structures and rules shared with other plugins are in
// sim/api/plugin_abi.h. Complete example: sensors/example.
//
// Vectors are in the pad frame P: +Z points from the touched object into the pad, so compression is
// positive. A sensor reads the noise-free contact; detectors and controllers get only its output.
// Labels are computed without the library.
#pragma once

#include <stdint.h>

#include "sim/api/plugin_abi.h"

// Version of this interface, including sim/api/plugin_abi.h. It grows with each change that breaks
// libraries built with an older version.
#define SLIPBENCH_SENSOR_ABI 1

// Value for slipbench_sensor_abi.
#define SLIPBENCH_SENSOR_BUILD                                                                                        \
  {                                                                                                                   \
    SLIPBENCH_SENSOR_ABI, SLIPBENCH_SHARED_SIZES, sizeof(struct slipbench_readout), sizeof(struct slipbench_contact), \
        sizeof(struct slipbench_element)                                                                              \
  }

#ifdef __cplusplus
extern "C" {
#endif

// One friction point of the pad: springs with a Coulomb slider at the tip.
struct slipbench_element {
  double tip[3];        // m, undeformed
  double direction[3];  // unit vector out of the pad; (0, 0, -1) for a flat pad and where all three are 0
  double k_normal;      // N/m, > 0
  double k_tangential;  // N/m, > 0
  size_t unit;          // group that the sensor reads as one value, such as a taxel: 0 for the first element, then equal or +1
};

// Contact of the pad at one sample. U units and E elements, in the order of slipbench_readout.
struct slipbench_contact {
  double time;                 // s
  const double* force;         // [U, 3] N, of the object on the unit
  const double* displacement;  // [U, 3] m, deformed tip minus undeformed tip, mean of the unit's elements
  const double* depth;         // [E] m, of the undeformed tip below the surface; an elastic skin has depth also without contact
  const double* shear;         // [3, E] m, deformed tip minus undeformed tip along the surface
  size_t units;
  size_t elements;
};

// A sensor. `elements` and `channels` are read once, when slipbench_make_sensor returns, and must
// stay valid until then. `measure` is called once per sample, in order of time.
struct slipbench_readout {
  const char* name;      // input: the scene's name for the sensor, "pad"
  uint64_t seed, trial;  // input: with `name`, all that the sensor's random numbers may depend on
  void* self;            // passed to both functions
  double rate;           // Hz, sample rate
  const struct slipbench_element* elements;
  size_t element_count;
  const struct slipbench_channel* channels;  // name, unit and shape; `first` and `size` are ignored
  size_t channel_count;
  // Writes one sample: all channels in order, each in C order. All values are NaN on entry and must
  // be finite on return.
  void (*measure)(void* self, const struct slipbench_contact* contact, float* values);
  void (*destroy)(void* self);           // called once at the end; null: not needed
  char refusal[SLIPBENCH_REFUSAL_SIZE];  // the reason why this scene is refused, one line; `measure` is then null
};

// The two symbols that a library exports. slipbench_make_sensor is called once per trial, and also
// when the program inspects the scene. `source` holds the parameters; its sensors are empty.
SLIPBENCH_EXPORT extern const struct slipbench_abi slipbench_sensor_abi;  // = SLIPBENCH_SENSOR_BUILD
SLIPBENCH_EXPORT void slipbench_make_sensor(const struct slipbench_source* source, struct slipbench_readout* readout);

// Optional third symbol: the parameters of the library, ended by SLIPBENCH_NO_MORE.
SLIPBENCH_EXPORT extern const struct slipbench_parameter slipbench_sensor_parameters[];

// Optional fourth symbol, for a sensor built into the program (sensors/README.md): the text of
// `slipbench describe`. It is ignored in a shared library.
struct slipbench_note {  // for one parameter
  const char* doc;       // one sentence, what it does
  const char* source;    // source of the default: a paper, a data sheet, "assumed"
  double least, most;    // limits of a number; both 0: no limits
  const char* choices;   // values of a text: "rows|columns|zigzag"
};
struct slipbench_unit {  // unit of a channel, if no parameter changes it
  const char* channel;
  const char* unit;
};
struct slipbench_about {
  const char* summary;                 // one line
  const char* law;                     // the equations and their symbols
  const char* source;                  // source of the equations
  const struct slipbench_note* notes;  // one for each of slipbench_sensor_parameters, in the same order
  const struct slipbench_unit* units;  // ends with a null channel; null: none besides force in N and displacement in m
};
SLIPBENCH_EXPORT extern const struct slipbench_about slipbench_sensor_about;

#ifdef __cplusplus
}
#endif
