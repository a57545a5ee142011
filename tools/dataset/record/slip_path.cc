#include "tools/dataset/record/slip_path.h"

#include <cstdint>

#include "sim/api/contact_frame.h"

namespace slipbench {

std::vector<double> slip_path(const LabelRecord& labels, std::size_t rows) {
  const std::size_t units = labels.units();
  if (units == 0 || labels.slip_distance.size() != rows * units) return {};
  std::vector<double> paths;
  double path = 0.0;
  for (std::size_t row = 0; row < rows; ++row) {
    double sum = 0.0, touching = 0.0;
    for (std::size_t k = row * units; k < (row + 1) * units; ++k) {
      if (labels.unit_state[k] == static_cast<std::uint8_t>(UnitState::detached)) continue;
      sum +=
          static_cast<double>(labels.slip_distance[k]) - (row == 0 ? 0.0 : static_cast<double>(labels.slip_distance[k - units]));
      ++touching;
    }
    if (touching > 0.0) path += sum / touching;
    paths.push_back(path);
  }
  return paths;
}

}  // namespace slipbench
