#include <memory>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "detectors/hd/memory_files.h"
#include "detectors/hd/shipped_memories.h"
#include "detectors/hd/words.h"
#include "sim/core/error.h"
#include "tools/program/catalogue/hd_engine_catalogue.h"
#include "tools/program/cli/commands.h"
#include "tools/program/cli/hd_vectors.h"

namespace slipbench {

namespace {

// The classifier as its folder has it, but for what the options replace.
hd::SavedModel load_model(const Options& options) {
  std::optional<hd::Model> unnamed;
  if (options.hd_compat) unnamed.emplace();
  try {
    hd::SavedModel saved = hd::load(hd::memories_folder(options.memories), unnamed);
    if (options.hd_compat) saved.model.compat = *options.hd_compat;
    if (options.hd_ties) saved.model.ties = *options.hd_ties;
    return saved;
  } catch (const hd::UnnamedModelError& error) {
    throw InputError(fmt::format("{}, or --encoder {}", error.what(), fmt::join(hd::names_of(hd::compat_words), " or ")));
  }
}

}  // namespace

int hd_replay_command(const Options& options) {
  const hd::SavedModel saved = load_model(options);
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
