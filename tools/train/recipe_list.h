// Names of the recipes of `train`, which are in python/slipbench/learning/recipes.py.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace slipbench::train {

// A line of `list`. A test compares names and summaries with those in Python, which needs PyTorch.
struct RecipeLine {
  std::string_view name, summary;
};

// By sensor.
std::span<const RecipeLine> recipe_list();
std::vector<std::string> recipe_names();

bool is_recipe(const std::string& name);
// Throws InputError for an unknown name, with the nearest one; for gst_hd it names train-hd.
void check_recipe(const std::string& name);

}  // namespace slipbench::train
