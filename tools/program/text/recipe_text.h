// Recipes of `train` as `list` and `describe` show them.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/program/cli/terminal.h"
#include "tools/program/train/recipes/recipe.h"

namespace slipbench {

inline constexpr const char* hd_recipe = "gst_hd";  // the hyperdimensional detector's training, which is no network

// gst_hd and train::recipes().
std::vector<std::string> recipe_names();

std::string recipe_list_text(const Style& style, std::size_t width);
nlohmann::ordered_json recipe_list_json();

// What it reads, its layers, how it is taught, and where it is from.
std::string recipe_text(const train::Recipe& recipe, const Style& style, std::size_t width);
nlohmann::ordered_json recipe_json(const train::Recipe& recipe);

}  // namespace slipbench
