// Table 1 of the paper: layouts of the tactile image.
#include <array>

#include <fmt/format.h>

#include "tools/studies/biotac/biotac_stability.h"

namespace slipbench::reproduce {
Result biotac_table1(const ReproduceOptions& options) {
  using namespace biotac;
  constexpr std::array<const char*, 3> published{"90.9 +- 1.5", "89.6 +- 1.7", "89.7 +- 1.3"};
  const GraspSets grasps = grasps_for(options, 0, [](const Grasp& grasp) { return std::string(palms[grasp.palm].text) != "45"; });
  std::vector<std::pair<StabilityNetwork, std::vector<std::string>>> networks;
  for (std::size_t i = 0; i < published.size(); ++i) {
    const train::biotac::ImageLayout& layout = train::biotac::image_layouts().at(i);
    StabilityNetwork network = cnn(layout, 128);
    network.network.name = layout.name;
    networks.push_back({network, {fmt::format("{} ({} x {})", layout.name, layout.rows, layout.columns), published.at(i)}});
  }
  networks.push_back({plain_network(), {"no image: MLP 128", "-"}});
  Result result = compare(options, grasps, {"image", "paper, by sample"}, networks);
  result.tables.front().title = "Table 1: 32 filters, 128 units";
  result.title = "Layouts of the tactile image of a BioTac SP: held or lost";
  result.source = fmt::format("Table 1 of {}. Accuracy in %.", paper);
  result.remarks.insert(
      result.remarks.begin(),
      "Palms 0 and 90 alone, as in the paper, whose 2,549 grasps are those of the public set. It deals them out by sample, so that a network has seen the object that judges it.");
  return result;
}

}  // namespace slipbench::reproduce
