#include <memory>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "detectors/hd/memory_files.h"
#include "tools/catalogue/engines.h"
#include "tools/cli/commands.h"
#include "tools/cli/hd_vectors.h"

namespace slipbench {

int hd_replay_command(const Options& options) {
  std::optional<hd::Model> unnamed;
  if (options.hd_compat) unnamed.emplace();
  hd::SavedModel saved = hd::load(options.memories, unnamed);
  if (options.hd_compat) saved.model.compat = *options.hd_compat;
  if (options.hd_ties) saved.model.ties = *options.hd_ties;
  const std::vector<HdVector> vectors = read_hd_vectors(options.vectors);
  const std::unique_ptr<hd::Engine> engine = make_hd_engine(options.engine, saved.model, saved.memories);

  nlohmann::ordered_json steps = nlohmann::ordered_json::array();
  if (!options.json) fmt::print("step,class,d1,d2,d3\n");
  for (const HdVector& vector : vectors) {
    const hd::Decision decision = engine->update(vector.frame);
    if (decision.state == PadState::no_contact) continue;  // the window is not full yet
    const int state = static_cast<int>(decision.state);
    if (options.json) {
      steps.push_back({{"step", vector.step}, {"class", state}, {"distances", decision.distance}});
    } else {
      fmt::print("{},{},{}\n", vector.step, state, fmt::join(decision.distance, ","));
    }
  }
  if (options.json) fmt::print("{}\n", nlohmann::ordered_json{{"steps", steps}}.dump());
  return exit_good;
}

}  // namespace slipbench
