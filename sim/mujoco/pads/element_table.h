// A pad that is given element by element.
#pragma once

#include <memory>

#include "sim/core/pad_layout.h"
#include "sim/core/sensor.h"
#include "sim/scene/yaml_tree.h"

namespace slipbench {

// Reads rows of x, y, z, k_n, k_t and, where they have three more, the axis; numbers in SI or with units. `units`: a sequence of
// how many elements each unit has, or null for one each. Throws InputError when a row is not that or the units do not add up.
PadLayout read_element_table(const YamlNode& rows, const YamlNode* units);

// A sensor without electronics that reports every unit's force [N] and displacement [m] in the pad frame, one sample a step. `of_elements`: and
// depth and shear [m] of each element (contact_frame.h), for a layout with element_truth.
std::unique_ptr<Sensor> make_table_sensor(const PadLayout& layout, double rate, bool of_elements);

}  // namespace slipbench
