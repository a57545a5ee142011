// The recipes of each sensor's papers, for the catalogue, and what they begin with.
#pragma once

#include <vector>

#include "tools/program/train/recipes/recipe.h"

namespace slipbench::train {

// A recipe that says who it is and what it eats: `channels` of a sensor at `rate` [Hz].
Recipe begun_recipe(const std::string& name, const std::string& summary, const std::string& source, const std::string& sensor,
                    double rate, const std::vector<network::ChannelPick>& channels);
// `more` behind `layers`.
void append(Layers& layers, const Layers& more);

std::vector<Recipe> piezo_recipes();
std::vector<Recipe> papillarray_recipes();
std::vector<Recipe> myrmex_recipes();
std::vector<Recipe> biotac_recipes();

}  // namespace slipbench::train
