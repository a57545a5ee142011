#include "tools/program/commands/detectors/detector_commands.h"

#include <memory>

#include <fmt/format.h>

#include "detectors/hd/memory_files.h"
#include "detectors/hd/words.h"
#include "sim/core/error.h"
#include "tools/program/catalogue/detector_catalogue.h"
#include "tools/program/cli/arguments.h"
#include "tools/program/cli/terminal.h"

namespace slipbench {
namespace {

// The classifier as its folder has it, but for what the options replace.
hd::SavedModel load_model(const HdReplayCommand& command) {
  std::optional<hd::Model> unnamed;
  if (command.compat) unnamed.emplace();
  try {
    hd::SavedModel saved = hd::load(hd::memories_folder(command.memories), unnamed);
    if (command.compat) saved.model.compat = *command.compat;
    if (command.ties) saved.model.ties = *command.ties;
    return saved;
  } catch (const hd::UnnamedModelError& error) {
    throw InputError(fmt::format("{}, or --encoder {}", error.what(), fmt::join(hd::names_of(hd::compat_words), " or ")));
  }
}

}  // namespace

void HdCommand::declare(Arguments& arguments) {
  arguments.about("hd", "Work with the hyperdimensional classifier", R"(
Its memories are a folder of hex files, as detectors/hd/README.md explains.)");
  arguments.command(replay);
}

int HdCommand::run() { throw InputError("hd: no command given; commands: replay"); }

void HdReplayCommand::declare(Arguments& arguments) {
  arguments.about("replay", "Classify quantised input step by step", R"(
Prints step,class,d1,d2,d3 as CSV: class 1 non-slip, 2 incipient, 3 gross, and the Hamming distances of the three; from the first step
on whose window is full. VECTORS.csv has the columns n (step), L0 to L8 (levels, 0 to 20) and ctx (context, 0 to 3); others are left alone.

DIR holds AM.hex, CIM.hex, CM.hex, IM.hex and model.txt. Without model.txt, as the published memories are, --encoder must be given and
ties go to one; with it, --encoder and --ties replace what it says. cl_gst_hd, where no folder has that name, is the classifier
that ships with the program.

Examples:
  slipbench hd replay vectors.csv --memories published --encoder published_core --ties one
  slipbench hd replay vectors.csv --memories published --encoder paper --ties zero --engine reference)");
  arguments.text("VECTORS", vectors, "Quantised input (CSV)").required();
  arguments.text("--memories DIR", memories, "Folder of the classifier, or cl_gst_hd").required();
  arguments.word("--encoder NAME", compat, "Whose bundle: {}", hd::compat_words);
  arguments.word("--ties NAME", ties, "A bundle that sums to zero becomes {}", hd::ties_words);
  arguments.text("--engine NAME", engine, fmt::format("{} (default: kernel)", fmt::join(hd_engine_names(), " or ")));
}

int HdReplayCommand::run() {
  const hd::SavedModel saved = load_model(*this);
  const std::vector<HdVector> frames = read_hd_vectors(vectors);
  const std::unique_ptr<hd::Engine> classifier = make_hd_engine(engine, saved.model, saved.memories);

  Json steps = Json::array();
  if (!json) fmt::print("step,class,d1,d2,d3\n");
  for (const HdVector& vector : frames) {
    const hd::Decision decision = classifier->update(vector.frame);
    if (decision.state == PadState::no_contact) continue;  // the window is not full yet
    const int state = static_cast<int>(decision.state);
    if (json) {
      steps.push_back({{"step", vector.step}, {"class", state}, {"distances", decision.distance}});
    } else {
      fmt::print("{},{},{}\n", vector.step, state, fmt::join(decision.distance, ","));
    }
  }
  if (json) print_json({{"steps", steps}});
  return exit_good;
}

}  // namespace slipbench
