// The graphs of the tables of grasp stability.
#pragma once

#include <cstddef>
#include <vector>

namespace slipbench::reproduce::biotac {

// The adjacency in which a node is the mean of itself and its k nearest, by the electrodes' places on the core; 0: drawn_graph(). Directed, as the
// paper's. [electrodes, electrodes]
std::vector<double> nearest_graph(std::size_t k);

}  // namespace slipbench::reproduce::biotac
