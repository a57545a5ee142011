// The recipes of each sensor's papers, for the catalogue.
#pragma once

#include <vector>

#include "tools/program/learn/recipe.h"

namespace slipbench::learn {

std::vector<Recipe> piezo_recipes();
std::vector<Recipe> papillarray_recipes();
std::vector<Recipe> myrmex_recipes();
std::vector<Recipe> biotac_recipes();

}  // namespace slipbench::learn
