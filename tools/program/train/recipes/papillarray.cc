#include "tools/program/train/recipes/families.h"

namespace slipbench::train {
namespace {

Recipe grasp_gru() {
  Recipe grasp;
  grasp.name = "grasp_gru";
  grasp.summary = "Forces and displacements of all nine pillars at 100 Hz through a GRU: slip in a grasp";
  grasp.source = "none published: for scenes/grasp, where the published detector is nearly blind";
  grasp.assumed = "all of it; the label is the truth, so that a grip which holds again is no slip, and tightening ends";
  grasp.input.sensor = "papillarray";
  grasp.input.rate = 100.0;
  grasp.input.channels = {{"force", {}}, {"displacement", {}}};
  grasp.scaling = Scaling::standard;
  grasp.network = {54, {Linear{48}, Relu{}, Gru{48}, Linear{2}}};
  grasp.labels = LabelRule::micro;
  grasp.training = {.steps = 600, .batch = 32, .clip = 100, .optimiser = Optimiser::adam, .learning_rate = 3e-3};
  grasp.training.validate_every = 30;
  return grasp;
}

}  // namespace

std::vector<Recipe> papillarray_recipes() {
  Recipe one;
  one.name = "papillarray_gru";
  one.summary = "Tangential forces of the eight outer pillars, 40 ms at a time, through a GRU";
  one.source =
      "RedmondLabUCD/Incipient-Slip-Detection-PapillArray: its network, its median filter of 21 rows and its stacks of 40 rows at 1 kHz";
  one.assumed =
      "Adam, rate, steps and batch; weights of classes; the label latched until contact is lost, since after a brake true slip ends under "
      "full shear";
  one.input.sensor = "papillarray";
  one.input.rate = 1000.0;
  network::ChannelPick force{"force", {}};
  for (std::size_t pillar = 0; pillar < 9; ++pillar) {
    if (pillar == 4) continue;  // the centre one
    force.values.push_back(3 * pillar);
    force.values.push_back(3 * pillar + 1);
  }
  one.input.channels = {force};
  one.input.median = 21;
  one.input.window = 40;
  one.input.stride = 40;
  one.scaling = Scaling::common;
  one.network = {640,
                 {Linear{1024}, BatchNorm{}, Relu{}, Linear{128}, BatchNorm{}, Relu{}, Gru{128}, Linear{256}, BatchNorm{}, Relu{},
                  Linear{128}, BatchNorm{}, Relu{}, Linear{2}}};
  one.labels = LabelRule::latched;
  one.training = {.steps = 300, .batch = 64, .clip = 9, .optimiser = Optimiser::adam, .learning_rate = 1e-3};
  one.training.validate_every = 15;
  one.training.patience = 8;
  Recipe five = one;
  five.name = "papillarray_gru5";
  five.summary = "Five such networks, whose probabilities are averaged in one graph";
  five.members = 5;
  return {one, five, grasp_gru()};
}

}  // namespace slipbench::train
