// The recipes of each sensor's papers, for the catalogue.
#pragma once

#include <vector>

#include "tools/program/train/recipes/recipe.h"

namespace slipbench::train {

std::vector<Recipe> piezo_recipes();
std::vector<Recipe> papillarray_recipes();
std::vector<Recipe> myrmex_recipes();
std::vector<Recipe> biotac_recipes();

}  // namespace slipbench::train
