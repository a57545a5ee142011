// The recipes of `train` by name. What they are stands in tools/python/slipbench/learning/recipes.py; gst_hd is train_hd.h.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace slipbench::train {

// The hyperdimensional detector's training, which is no network.
inline constexpr const char* hd_recipe = "gst_hd";

// As `list` shows it. A test holds the names and summaries against those in Python, which need PyTorch.
struct RecipeLine {
  std::string_view name, summary;
};

// gst_hd, then the networks by their sensor.
std::span<const RecipeLine> recipe_list();
std::vector<std::string> recipe_names();

// True if the recipe trains a network.
bool is_network_recipe(const std::string& name);
// Throws InputError for an unknown name, with the nearest one.
void check_recipe(const std::string& name);

}  // namespace slipbench::train
