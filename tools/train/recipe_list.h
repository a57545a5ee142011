// Names of the recipes of `train`. The recipes are in
// python/slipbench/learning/recipes.py; gst_hd is in train_hd.h.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace slipbench::train {

// Training of the hyperdimensional detector, which is not a network.
inline constexpr const char* hd_recipe = "gst_hd";

// A line of `list`. A test compares names and summaries with those in Python, which needs PyTorch.
struct RecipeLine {
  std::string_view name, summary;
};

// gst_hd, then the networks by sensor.
std::span<const RecipeLine> recipe_list();
std::vector<std::string> recipe_names();

// True if the recipe trains a network.
bool is_network_recipe(const std::string& name);
// Throws InputError for an unknown name, with the nearest one.
void check_recipe(const std::string& name);

}  // namespace slipbench::train
