// Example of a custom sensor: nine pillars of three heights that read the force on their tips, with
// noise. It is also valid C: copy it to nine_pillars.c and compile it with gcc.
#include <stdlib.h>

#include "sensors/plugin_abi.h"

// In the order in which slipbench_make_sensor receives them.
enum { rate, pitch, edge_drop, corner_drop, k_normal, k_tangential, noise };
const struct slipbench_parameter slipbench_sensor_parameters[] = {
    SLIPBENCH_A_NUMBER("rate", 1000.0, "Hz"),         // samples a second
    SLIPBENCH_A_NUMBER("pitch", 0.007, "m"),          // from one pillar to the next
    SLIPBENCH_A_NUMBER("edge_drop", 0.0002, "m"),     // how much shorter the four at the edges are than the middle one
    SLIPBENCH_A_NUMBER("corner_drop", 0.00045, "m"),  // the same for those at the corners
    SLIPBENCH_A_NUMBER("k_normal", 7100.0, "N/m"),    // stiffness of a pillar
    SLIPBENCH_A_NUMBER("k_tangential", 3900.0, "N/m"),
    SLIPBENCH_A_NUMBER("noise", 0.0, "N"),  // largest error of a reading
    SLIPBENCH_NO_MORE,
};

const struct slipbench_abi slipbench_sensor_abi = SLIPBENCH_SENSOR_BUILD;

struct pillars {
  struct slipbench_element elements[9];
  double noise;
  uint64_t random;
};

static void measure(void* self, const struct slipbench_contact* contact, float* values) {
  struct pillars* pillars = (struct pillars*)self;
  size_t i;
  for (i = 0; i < 27; ++i) {
    pillars->random = pillars->random * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    values[i] = (float)(contact->force[i] + pillars->noise * ((double)(pillars->random >> 33) / 1073741824.0 - 1.0));
  }
}

void slipbench_make_sensor(const struct slipbench_source* source, struct slipbench_readout* readout) {
  static const size_t shape[] = {9, 3};
  static const struct slipbench_channel force = {"force", "N", shape, 2, 0, 0};
  const struct slipbench_parameter* parameters = source->parameters;
  struct pillars* pillars = (struct pillars*)calloc(1, sizeof *pillars);
  int i;
  if (!pillars) return;
  for (i = 0; i < 9; ++i) {
    struct slipbench_element* element = &pillars->elements[i];
    const int right = 1 - i % 3, up = 1 - i / 3;
    element->tip[0] = right * parameters[pitch].number;
    element->tip[1] = up * parameters[pitch].number;
    element->tip[2] = right && up ? parameters[corner_drop].number : right || up ? parameters[edge_drop].number : 0.0;
    element->k_normal = parameters[k_normal].number;
    element->k_tangential = parameters[k_tangential].number;
    element->unit = (size_t)i;
  }
  pillars->noise = parameters[noise].number;
  pillars->random = readout->seed * 1000003 + readout->trial;
  readout->self = pillars;
  readout->rate = parameters[rate].number;
  readout->elements = pillars->elements;
  readout->element_count = 9;
  readout->channels = &force;
  readout->channel_count = 1;
  readout->measure = measure;
  readout->destroy = free;
}
