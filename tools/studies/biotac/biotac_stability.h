// What the tables of grasp stability share: grasps, networks, folds.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "tools/studies/biotac/biotac_learning.h"

namespace slipbench::reproduce::biotac {

inline constexpr std::size_t stability_folds = 5;

// A network and how it is shown a grasp.
struct StabilityNetwork {
  Network network;
  std::function<train::FoldExample(const Grasp&)> shown;
};

// Logistic regression and a plain network of 128 units on the 72 counts; `more`: times as many steps as usual.
StabilityNetwork logistic_regression();
StabilityNetwork plain_network(std::size_t more = 1);
// The paper's: an image network of `units`, and a graph network by an adjacency.
StabilityNetwork cnn(const train::biotac::ImageLayout& layout, std::size_t units);
StabilityNetwork gcn(const std::vector<double>& adjacency, std::string name, std::string text);

// The adjacency in which a node is the mean of itself and its k nearest, by the electrodes' places on the core; 0: drawn_graph(). Directed, as the
// paper's. [electrodes, electrodes]
std::vector<double> nearest_graph(std::size_t k);

// As a network is shown them.
enum class FoldsBy { sample, object };
Set set_of(const std::vector<Grasp>& grasps, const StabilityNetwork& network, FoldsBy by, std::uint64_t seed);

// What a study of stability is made with.
struct GraspSets {
  std::vector<Grasp> real, synthetic;  // real: empty without --real
};
// Those that the options name, or fresh ones: `usual` draws of each of nine cells, 0: as many as the scene says. `kept`: those that the
// study is about. Throws InputError and Interrupted, and InputError where --trials and --data are both given or --data is imported.
GraspSets grasps_for(
    const ReproduceOptions& options, std::size_t usual = 0,
    const std::function<bool(const Grasp&)>& kept = [](const Grasp&) { return true; });

// A table in which networks are compared on all data that there are, five folds by sample and five by object: a row begins with the cells that stand
// beside its network here. Figures, setup and the remark about --real are filled in.
Result compare(const ReproduceOptions& options, const GraspSets& grasps, const std::vector<std::string>& head,
               const std::vector<std::pair<StabilityNetwork, std::vector<std::string>>>& networks);

// How the grasps were got, and what is said of all these tables.
std::vector<std::string> stability_setup(const ReproduceOptions& options, const GraspSets& grasps);

}  // namespace slipbench::reproduce::biotac
