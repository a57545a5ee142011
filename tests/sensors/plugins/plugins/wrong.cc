// A pad of two points that is correct except for the fault named by its parameter `fault`.
#include <cmath>
#include <csignal>
#include <cstring>
#include <stdexcept>
#include <string>

#include "sensors/plugin_abi.h"

const slipbench_parameter slipbench_sensor_parameters[] = {SLIPBENCH_A_TEXT("fault", "none"), SLIPBENCH_NO_MORE};
const slipbench_abi slipbench_sensor_abi = SLIPBENCH_SENSOR_BUILD;

namespace {

std::string fault_of(void* self) { return *static_cast<const std::string*>(self); }

void measure(void* self, const slipbench_contact* contact, float* values) {
  const std::string fault = fault_of(self);
  for (std::size_t i = 0; i < 6; ++i) values[i] = static_cast<float>(contact->force[i]);
  if (fault == "writes") std::memset(const_cast<double*>(contact->force), 0, 6 * sizeof(double));
  if (fault == "nan") values[4] = std::nanf("");
  if (fault == "infinite") values[5] = HUGE_VALF;
  if (fault == "throws") throw std::runtime_error("out of ideas");
  if (fault == "crashes") static_cast<void>(std::raise(SIGSEGV));
}

void destroy(void* self) { delete static_cast<std::string*>(self); }

}  // namespace

void slipbench_make_sensor(const slipbench_source* source, slipbench_readout* readout) {
  static const std::size_t shape[] = {2, 3}, none[] = {0, 3};
  static const slipbench_channel force = {"force", "N", shape, 2, 0, 0}, empty = {"force", "N", none, 2, 0, 0},
                                 times = {"t", "s", shape, 2, 0, 0};
  static slipbench_element elements[2];
  const std::string fault = source->parameters[0].text;
  if (fault == "refuses") std::strcpy(readout->refusal, "no, thanks");
  if (fault == "refuses") return;
  for (slipbench_element& element : elements) element = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, 1e3, 500.0, 0};
  elements[1].unit = fault == "gap" ? 2 : 1;
  if (fault == "soft") elements[1].k_normal = 0.0;
  if (fault == "direction") elements[0].direction[0] = 2.0;
  if (fault == "nowhere") elements[1].tip[2] = std::nan("");
  readout->self = new std::string(fault);
  readout->rate = fault == "rate" ? -1.0 : 100.0;
  readout->elements = elements;
  readout->element_count = fault == "bare" ? 0 : 2;
  readout->channels = fault == "empty" ? &empty : fault == "times" ? &times : &force;
  readout->channel_count = fault == "mute" ? 0 : 1;
  readout->measure = measure;
  readout->destroy = destroy;
}
