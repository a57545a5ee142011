// Example of a custom detector: the whole pad slips once the ratio of its tangential to its normal
// force exceeds a threshold, and begins to slip at a share of that threshold. It is also valid C:
// copy it to ratio_gate.c and compile it with gcc.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "detectors/plugin_abi.h"

// In the order in which slipbench_make_detector receives them.
enum { threshold, warning, touch, rate };
const struct slipbench_parameter slipbench_detector_parameters[] = {
    SLIPBENCH_A_NUMBER("threshold", 0.45, ""),  // tangential over normal force at which the whole pad slips
    SLIPBENCH_A_NUMBER("warning", 0.8, ""),     // share of the threshold at which the pad begins to slip
    SLIPBENCH_A_NUMBER("touch", 0.05, "N"),     // normal force at which the pad touches
    SLIPBENCH_A_NUMBER("rate", 100.0, "Hz"),    // of the estimates
    SLIPBENCH_NO_MORE,
};

const struct slipbench_abi slipbench_detector_abi = SLIPBENCH_DETECTOR_BUILD;

struct ratio_gate {
  size_t sensor;        // index among the scene's sensors
  size_t first, units;  // place of the forces {units, 3} in a sample
  double threshold, warning, touch;
};

static void update(void* self, const struct slipbench_detector_input* input, struct slipbench_estimate* estimate) {
  const struct ratio_gate* gate = (const struct ratio_gate*)self;
  const float* force = input->sensors[gate->sensor].latest + gate->first;
  double x = 0.0, y = 0.0, normal = 0.0, ratio;
  size_t i;
  for (i = 0; i < gate->units; ++i) {
    x += (double)force[3 * i];
    y += (double)force[3 * i + 1];
    normal += (double)force[3 * i + 2];
  }
  estimate->state = 0;
  if (normal < gate->touch) return;
  ratio = sqrt(x * x + y * y) / normal;
  estimate->state = ratio < gate->warning * gate->threshold ? 1 : ratio < gate->threshold ? 2 : 3;
}

void slipbench_make_detector(const struct slipbench_source* source, struct slipbench_detector* detector) {
  const struct slipbench_sensor* sensor = &source->sensors[source->sensor];
  const struct slipbench_channel* channel = sensor->channels;
  const struct slipbench_channel* end = channel + sensor->channel_count;
  struct ratio_gate* gate;
  while (channel != end && strcmp(channel->name, "force") != 0) ++channel;
  if (channel == end || channel->dimensions != 2 || channel->shape[1] != 3) {
    strcpy(detector->refusal, "it reads a channel force {N, 3}, as a papillarray has it");
    return;
  }
  if (strcmp(channel->unit, "N") != 0) {
    sprintf(detector->refusal, "it reads force in N, but the sensor has it in '%.32s'", channel->unit);
    return;
  }
  gate = (struct ratio_gate*)malloc(sizeof *gate);
  if (!gate) return;
  gate->sensor = source->sensor;
  gate->first = channel->first;
  gate->units = channel->shape[0];
  gate->threshold = source->parameters[threshold].number;
  gate->warning = source->parameters[warning].number;
  gate->touch = source->parameters[touch].number;
  detector->self = gate;
  detector->rate = source->parameters[rate].number;
  detector->update = update;
  detector->destroy = free;
}
