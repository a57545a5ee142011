// A CSV file that a scene names, as the rows that the scene could have written itself.
#pragma once

#include <string>
#include <vector>

#include "sim/core/parameters.h"
#include "sim/scene/yaml_tree.h"

namespace slipbench {

// A sequence of rows, each a sequence of the file's cells with the file's line as their origin. With `columns` the first line is a header of their
// names in any order, each perhaps with a unit for its cells, "x [mm]"; a row then has a cell for each column, null where the file has none.
// Empty lines are passed over. Throws InputError at `named`, where the scene names the file, for a file that cannot be read or of more than
// max_yaml_bytes, and with the file's name and line for an unknown or repeated column and a row of another length than the header.
YamlNode read_csv(const std::string& path, const std::vector<TableColumn>& columns, const Origin& named);

}  // namespace slipbench
