// An array of piezoresistive cells under a conductive foam: the Myrmex, 16 x 16 taxels of 5 mm.
#pragma once

#include "sim/api/sensor_kind.h"

namespace slipbench {

// A myrmex with one channel "taxels" {rows, columns} [counts], 4095 without load and less under
// load. Its pad is the foam's surface, one unit of one element per taxel, row by row: taxel (r, c)
// is at x = (c - (columns - 1)/2) pitch, y = ((rows - 1)/2 - r) pitch, z = 0, so that the image is
// upright with X to the right and Y upwards. Without electronics counts are not rounded. create()
// throws SceneValueError for unknown or repeated electronics and for a scan that takes longer than
// a sample.
SensorKind myrmex_sensor();

}  // namespace slipbench
