// What is said of recipes, and of what was learnt by them.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tools/base/record/json.h"
#include "tools/program/cli/terminal.h"
#include "tools/program/train/recipes/recipe.h"
#include "tools/program/train/train_hd.h"

namespace slipbench {

// Recipes of `train` as `list` and `describe` show them.
inline constexpr const char* hd_recipe = "gst_hd";  // the hyperdimensional detector's training, which is no network

// gst_hd and train::recipes().
std::vector<std::string> recipe_names();

std::string recipe_list_text(const Style& style, std::size_t width);
Json recipe_list_json();

// What it reads, its layers, how it is taught, and where it is from.
std::string recipe_text(const train::Recipe& recipe, const Style& style, std::size_t width);
Json recipe_json(const train::Recipe& recipe);

// How a slip detector's classes compare with the truth, as text.

// A table of figures, the most telling first: mean and standard deviation over the draws that make them, by sequence and by frame.
std::string draws_text(const HdSummary& summary, const Style& style);
// Counts by true and by called class.
std::string confusion_text(const Confusion& confusion, const Style& style);
// Two lines: the delays, and how the sequences were seen.
std::string delays_text(const Delays& delays);

}  // namespace slipbench
