// A sensor in a shared library, in plain C: `sensors: {pad: {type: plugin, library: mine.so, parameters: {...}}}`. What it
// exports and is handed, beside the structures and rules of sim/core/plugin_abi.h. A whole one: sensors/example.
//
// Vectors are in the pad frame P: +Z points from the touched object into the pad, so compression is positive. A sensor reads the
// contact as it is, without noise; detectors and controllers get what it makes of it. Labels need nothing of the library.
#pragma once

#include <stdint.h>

#include "sim/core/plugin_abi.h"

// Version of this interface, sim/core/plugin_abi.h included. It grows whenever a library that was built with an older one would
// not work any more.
#define SLIPBENCH_SENSOR_ABI 1

// What slipbench_sensor_abi is to be set to.
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
  double direction[3];  // unit vector out of the pad; (0, 0, -1) of a flat one, and where all three are 0
  double k_normal;      // N/m, > 0
  double k_tangential;  // N/m, > 0
  size_t unit;          // what the sensor reads as one, a taxel: 0 of the first element, then the same or one more
};

// The contact of the pad at one sample, of U units and E elements in the order of slipbench_readout.
struct slipbench_contact {
  double time;                 // s
  const double* force;         // [U, 3] N, of the object on the unit
  const double* displacement;  // [U, 3] m, deformed tip minus undeformed tip, mean of the unit's elements
  const double* depth;         // [E] m, of the undeformed tip in the surface; of a skin also where nothing touches
  const double* shear;         // [3, E] m, deformed tip minus undeformed tip along the surface
  size_t units;
  size_t elements;
};

// A sensor. `elements` and `channels` are read once, when slipbench_make_sensor returns, and must stand until then. `measure` is
// called at each sample, in order of time.
struct slipbench_readout {
  const char* name;      // handed over: the scene's name for the sensor, "pad"
  uint64_t seed, trial;  // handed over: what a sensor's random numbers are to depend on, with the name, and on nothing else
  void* self;            // handed to both functions
  double rate;           // Hz, of the samples
  const struct slipbench_element* elements;
  size_t element_count;
  const struct slipbench_channel* channels;  // name, unit and shape; `first` and `size` are not read
  size_t channel_count;
  // Writes a sample: all channels in their order, each in C order. Each value is handed over as NaN and must become finite.
  void (*measure)(void* self, const struct slipbench_contact* contact, float* values);
  void (*destroy)(void* self);           // called once at the end; null: nothing to do
  char refusal[SLIPBENCH_REFUSAL_SIZE];  // one line that says why there is none for this scene, `measure` being null then
};

// The two symbols that a library exports. slipbench_make_sensor is asked for one sensor a trial, and for more where the program
// looks at the scene; `source` holds the parameters and no sensors.
SLIPBENCH_EXPORT extern const struct slipbench_abi slipbench_sensor_abi;  // = SLIPBENCH_SENSOR_BUILD
SLIPBENCH_EXPORT void slipbench_make_sensor(const struct slipbench_source* source, struct slipbench_readout* readout);

// A third one that may be left out: the parameters of the library, ended by SLIPBENCH_NO_MORE.
SLIPBENCH_EXPORT extern const struct slipbench_parameter slipbench_sensor_parameters[];

// A fourth one for a sensor that the program is to be built with (sensors/README.md): what `slipbench describe` says of it. Of a library it is not
// read.
struct slipbench_note {  // of a parameter
  const char* doc;       // one sentence, what it does
  const char* source;    // of its default: a paper, a data sheet, "assumed"
  double least, most;    // of a number; both 0: any
  const char* choices;   // of a text: "rows|columns|zigzag"
};
struct slipbench_about {
  const char* summary;                 // one line
  const char* law;                     // the equations with their symbols
  const char* source;                  // where they come from
  const struct slipbench_note* notes;  // in the order of slipbench_sensor_parameters, as many
};
SLIPBENCH_EXPORT extern const struct slipbench_about slipbench_sensor_about;

#ifdef __cplusplus
}
#endif
