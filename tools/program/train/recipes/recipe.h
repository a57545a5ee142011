// Recipes: published networks with what they eat, what they are taught and how.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "detectors/network/description.h"
#include "tools/program/train/network/examples.h"
#include "tools/program/train/network/network.h"

namespace slipbench::train {

struct Recipe {
  std::string name;     // "piezo_fft_gru"
  std::string summary;  // one line
  std::string source;   // paper, section, table
  std::string assumed;  // what the paper does not print, and what was chosen
  network::Input input;
  Scaling scaling = Scaling::standard;
  NetworkShape network;
  std::size_t members = 1;  // networks whose probabilities are averaged, with seeds one after the other
  ClassRule classes = ClassRule::slip;
  LabelRule labels = LabelRule::micro;
  Split split = Split::trial;
  std::size_t at_most = 0;  // ExampleOptions::at_most
  std::size_t turned = 0;   // ExampleOptions::turned
  TrainingOptions training;
};

// All, by paper. To add one: a file in tools/program/train/recipes and its line in published.cc.
const std::vector<Recipe>& recipes();
// Throws InputError for an unknown name, with the nearest one.
const Recipe& find_recipe(std::string_view name);

// The layers in words: "GRU 32, GRU 32, linear 2".
std::string layers_text(const Layers& layers);

// The recipes of each sensor's papers, for the catalogue, and what they begin with.

// A recipe that says who it is and what it eats: `channels` of a sensor at `rate` [Hz].
Recipe begun_recipe(const std::string& name, const std::string& summary, const std::string& source, const std::string& sensor,
                    double rate, const std::vector<network::ChannelPick>& channels);
// A recipe that is no paper's, for scenes/learn: slip while a part slips, 100 times a second.
Recipe slip_recipe(const std::string& name, const std::string& summary, const std::string& sensor, double rate,
                   const std::vector<network::ChannelPick>& channels);
// `more` behind `layers`.
void append(Layers& layers, const Layers& more);

std::vector<Recipe> nib_recipes();
std::vector<Recipe> piezo_recipes();
std::vector<Recipe> papillarray_recipes();
std::vector<Recipe> myrmex_recipes();
std::vector<Recipe> biotac_recipes();

}  // namespace slipbench::train
