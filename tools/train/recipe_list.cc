#include "tools/train/recipe_list.h"

#include <algorithm>
#include <array>

#include "tools/files/reject.h"

namespace slipbench::train {
namespace {

constexpr std::array all{
    RecipeLine{"piezo_mlp", "Single spectra of 20 ms through four layers of 32"},
    RecipeLine{"piezo_mlp_128", "Single spectra of 20 ms through four layers of 128"},
    RecipeLine{"piezo_tcn", "The latest 29 spectra through four causal convolutions of 128, kernel 8"},
    RecipeLine{"piezo_fft_gru", "Spectra of 20 ms, one after the other, through four GRUs of 32"},
    RecipeLine{"piezo_raw_gru", "The signal at 100 Hz through four GRUs of 32"},
    RecipeLine{"piezo_slip", "The level of the signal, its changes and its spectrum in 20 ms, through two GRUs at 100 Hz"},
    RecipeLine{"piezo_force",
               "How the force on the skin continues or breaks off over 5 to 160 ms, and its spectrum, through a GRU at 200 Hz"},
    RecipeLine{"piezo_grasp", "Level of the signal and its changes over 2 to 100 ms, through two GRUs at 100 Hz"},
    RecipeLine{"papillarray_gru", "Tangential forces of the eight outer pillars, 40 ms at a time, through a GRU"},
    RecipeLine{"papillarray_gru5", "Five networks of papillarray_gru, whose probabilities are averaged in one graph"},
    RecipeLine{"grasp_gru", "Forces and displacements of all nine pillars at 100 Hz through a GRU: slip in a grasp"},
    RecipeLine{"slip_gru", "Any sensor: axes of each unit, their ratio and rates through shared weights, pooled, through a GRU"},
    RecipeLine{"papillarray_slip", "Departure of the pillars from a rigid motion over 10 to 300 ms, through a GRU at 100 Hz"},
    RecipeLine{
        "taxels_slip",
        "Departure of the forces of a grid of 4 x 4 taxels from a rigid motion over 10 to 300 ms, through a GRU at 100 Hz"},
    RecipeLine{"skin_slip",
               "Departure of a magnetic skin's readings from a common change over 0.1 to 0.6 s, through a GRU at 33 Hz"},
    RecipeLine{"myrmex_net1", "Spectra of 12 x 12 taxels through one convolution and 512 units"},
    RecipeLine{"myrmex_net2", "Spectra of 12 x 12 taxels through two convolutions and 512 units"},
    RecipeLine{"myrmex_net3", "Spectra of 12 x 12 taxels through two convolutions and 1024 units"},
    RecipeLine{"nib_slip", "Size and direction of the change of all electrodes over 0.1 and 0.3 s, through a GRU at 100 Hz"},
    RecipeLine{"nib_rigid", "Departure of a nib pad's taxels from a rigid motion over 30 to 600 ms, through a GRU at 100 Hz"},
    RecipeLine{"gel_slip", "Departure of a gel's markers from a rigid motion, at 25 Hz, through a GRU"},
    RecipeLine{"biotac_cnn", "The electrodes as an image of 12 x 11 through a convolution of 32 and 1024 units"},
    RecipeLine{"biotac_gcn", "The electrodes as a graph through convolutions of 8, 8, 16, 16, 32 units"},
    RecipeLine{"biotac_lstm", "Five rows at 100 Hz through five LSTMs of 32; direction of slip, seven classes"},
    RecipeLine{"biotac_convlstm",
               "Five images of 12 x 11 at 100 Hz through convolutional LSTMs; direction of slip, seven classes"},
    RecipeLine{
        "biotac_gru",
        "Change and drift of each electrode over 0.1, 0.2 and 0.5 s, through a GRU at 20 Hz; direction of slip, seven classes"},
    RecipeLine{"biotac_slip",
               "Size and course of the changes of the electrodes over 0.1 to 0.5 s, in any order, through a GRU at 20 Hz"},
    RecipeLine{"biotac_grasp",
               "Signed changes of each electrode and the pressure over 20 to 300 ms, through two GRUs at 100 Hz"}};

}  // namespace

std::span<const RecipeLine> recipe_list() { return all; }

std::vector<std::string> recipe_names() {
  std::vector<std::string> names;
  for (const RecipeLine& recipe : all) names.emplace_back(recipe.name);
  return names;
}

bool is_recipe(const std::string& name) { return std::ranges::find(all, name, &RecipeLine::name) != all.end(); }

void check_recipe(const std::string& name) {
  if (is_recipe(name)) return;
  if (name == "gst_hd") reject("train: the memories of gst_hd are trained by `slipbench train-hd`");
  reject("train: unknown recipe {}{}", quote(name), allowed_names(name, recipe_names()));
}

}  // namespace slipbench::train
