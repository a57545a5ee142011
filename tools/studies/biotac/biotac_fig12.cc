// Fig. 12 of the paper: the GCN by its graph.
#include <fmt/format.h>

#include "tools/studies/biotac/biotac_stability.h"
#include "tools/studies/grid.h"

namespace slipbench::reproduce {

Result biotac_fig12(const ReproduceOptions& options) {
  using namespace biotac;
  std::vector<std::size_t> neighbours{0, 2, 8, 23};
  if (options.full) {
    neighbours.clear();
    for (std::size_t k = 0; k < electrodes; ++k) neighbours.push_back(k);
  }
  const GraspSets grasps = grasps_for(options);
  std::vector<std::pair<StabilityNetwork, std::vector<std::string>>> networks;
  for (const std::size_t k : neighbours) {
    const std::string text = k == 0 ? "drawn by hand" : fmt::format("{} nearest", k);
    networks.push_back({gcn(nearest_graph(k), fmt::format("k{}", k), "GCN, " + text), {fmt::format("{}", k), text}});
  }
  Result result = compare(options, grasps, {"k", "graph"}, networks);
  result.tables.front().title = "Fig. 12: the GCN by its graph";
  result.title = "Tactile graphs of a BioTac SP: held or lost";
  result.source = fmt::format("Fig. 12 of {}. Accuracy in %.", paper);
  result.remarks.insert(
      result.remarks.begin(),
      "The paper draws its curve and prints no number: best with the graph drawn by hand, and falling with k. It does not say "
      "whether its folds are by sample or by object.");
  return result;
}

}  // namespace slipbench::reproduce
