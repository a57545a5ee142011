// What Table III of the nib pad's paper simulates, a box that is turned up and released, and what the trials of a cell come to.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "tools/studies/grid.h"
#include "tools/studies/nib_reconfigurable/turn_loss.h"

namespace slipbench::reproduce {

inline constexpr const char* reorient_scene = "scenes/nib_pad/reorient.yaml";
inline constexpr std::size_t published_runs = 11;

struct ReorientCell {
  std::string name, text;
  std::optional<std::size_t> published;  // successes of published_runs; empty: a change of ours
  std::vector<Override> overrides;

  // With `draws` trials.
  [[nodiscard]] GridCell grid(std::size_t draws) const { return {name, reorient_scene, overrides, {}, draws}; }
};

// The cells that `only` names, all where it is empty. Throws InputError for a name that no cell has.
std::vector<ReorientCell> reorient_cells(const std::vector<std::string>& only);

struct ReorientRun {
  bool standing = false, dropped = false;
  double tilt = 0.0, least_tilt = 0.0;  // rad, at the end and ever
  double most_force = 0.0;              // N
  Turn turn;
};
using ReorientRuns = std::vector<ReorientRun>;

// The trials of each cell. Throws InputError and Interrupted as run_grid does.
std::vector<ReorientRuns> run_reorientations(const std::vector<ReorientCell>& cells, std::size_t trials,
                                             const ReproduceOptions& options);

struct ReorientSummary {
  std::size_t runs = 0, standing = 0, turned_up = 0, dropped = 0;
  std::array<std::size_t, turn_ends> ends{};                                                  // runs of each TurnEnd
  double tilt = 0.0, least_tilt = 0.0, most_force = 0.0, released_tilt = 0.0, held_by = 0.0;  // medians; rad, N; NaN of none
};
ReorientSummary summary_of(const ReorientRuns& runs);

}  // namespace slipbench::reproduce
