#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <limits>
#include <memory>
#include <string_view>

#include <fmt/format.h>

#include "detectors/hd/memory_files.h"
#include "detectors/hd/words.h"
#include "sim/core/choice.h"
#include "sim/core/counted.h"
#include "sim/core/process/regular_file.h"
#include "tools/cli/arguments.h"
#include "tools/cli/commands/detectors/detector_commands.h"
#include "tools/cli/terminal.h"
#include "tools/files/reject.h"
#include "tools/registry/program_catalogues.h"

namespace slipbench {
namespace {

// Returns the classifier of the folder, with the settings that the options override.
hd::SavedModel load_model(const HdReplayCommand& command) {
  std::optional<hd::Model> unnamed;
  if (command.compat) unnamed.emplace();
  try {
    hd::SavedModel saved = hd::load(hd::memories_folder(command.memories), unnamed);
    if (command.compat) saved.model.compat = *command.compat;
    if (command.ties) saved.model.ties = *command.ties;
    return saved;
  } catch (const hd::UnnamedModelError& error) {
    reject("{}, or --encoder {}", error.what(), fmt::join(choice_names(hd::compat_words), " or "));
  }
}

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  for (std::size_t from = 0;;) {
    const std::size_t comma = line.find(',', from);
    cells.push_back(line.substr(from, comma - from));
    if (comma == std::string_view::npos) return cells;
    from = comma + 1;
  }
}

// A column to read: its index, and its largest allowed number.
struct Column {
  std::string name;
  std::uint64_t max;
  std::size_t index = 0;
};

std::vector<Column> needed_columns() {
  std::vector<Column> columns{{"n", std::numeric_limits<std::uint64_t>::max()}};
  for (std::size_t p = 0; p < hd::pillar_count; ++p) columns.push_back({fmt::format("L{}", p), hd::level_count - 1});
  columns.push_back({"ctx", hd::context_count - 1});
  return columns;
}

}  // namespace

void HdCommand::declare(Arguments& arguments) {
  arguments.about("hd", "Work with the hyperdimensional classifier", R"(
The memories of a classifier are a folder of hex files; detectors/hd/README.md explains them.)");
  arguments.command(replay);
}

int HdCommand::run() { throw InputError("hd: no command given; commands: replay"); }

void HdReplayCommand::declare(Arguments& arguments) {
  arguments.about("replay", "Classify quantised input step by step", R"(
Prints step,class,d1,d2,d3 as CSV, from the first step with a full window: class 1 non-slip,
2 incipient, 3 gross, and the Hamming distances to the three prototypes. VECTORS.csv has the columns
n (step), L0 to L8 (levels, 0 to 20) and ctx (context, 0 to 3); other columns are ignored.

DIR contains AM.hex, CIM.hex, CM.hex, IM.hex and model.txt. Published memories have no model.txt;
they need --encoder, and ties default to one. With model.txt, --encoder and --ties override it.
cl_gst_hd and learn_gst_hd are included classifiers; a folder of the same name is ./cl_gst_hd.

Examples:
  slipbench hd replay vectors.csv --memories published --encoder published_core --ties one
  slipbench hd replay vectors.csv --memories published --encoder paper --ties zero --engine reference)");
  arguments.input("VECTORS", vectors, "Quantised input (CSV)", ".csv").required();
  arguments.text("--memories DIR", memories, "Folder of the classifier, or cl_gst_hd or learn_gst_hd").required();
  arguments.word("--encoder NAME", compat, "Bundling: {}", hd::compat_words);
  arguments.word("--ties NAME", ties, "Bit of a bundle whose sum is zero: {}", hd::ties_words);
  arguments.text("--engine NAME", engine, fmt::format("{} (default: kernel)", fmt::join(hd_engine_names(), " or ")));
}

int HdReplayCommand::run() {
  const hd::SavedModel saved = load_model(*this);
  const std::vector<HdVector> frames = read_hd_vectors(vectors);
  const std::unique_ptr<hd::Engine> classifier = make_hd_engine(engine, saved.model, saved.memories);

  Json steps = Json::array();
  if (!json) print_text("step,class,d1,d2,d3\n");
  for (const HdVector& vector : frames) {
    const hd::Decision decision = classifier->update(vector.frame);
    if (decision.state == PadState::no_contact) continue;  // the window is not full yet
    const int state = static_cast<int>(decision.state);
    if (json) {
      steps.push_back({{"step", vector.step}, {"class", state}, {"distances", decision.distance}});
    } else {
      print_text("{},{},{}\n", vector.step, state, fmt::join(decision.distance, ","));
    }
  }
  if (json) print_json({{"steps", steps}});
  return exit_good;
}

std::vector<HdVector> read_hd_vectors(const std::string& file) {
  check_regular_file(file);
  std::ifstream stream(file);
  std::string line;
  if (!stream) reject("{}: {}", file, std::strerror(errno));
  if (!std::getline(stream, line)) reject("{}:1: the file is empty; expected the columns n, L0 to L8, ctx", file);

  std::vector<Column> columns = needed_columns();
  const std::vector<std::string_view> names = cells_of(line);
  const std::size_t width = names.size();
  for (Column& column : columns) {
    const auto count = std::ranges::count(names, column.name);
    if (count != 1) {
      reject("{}:1: {} column {}; expected n, L0 to L8, ctx", file, count == 0 ? "no" : "more than one", quote(column.name));
    }
    column.index = static_cast<std::size_t>(std::ranges::find(names, column.name) - names.begin());
  }

  std::vector<HdVector> vectors;
  for (std::size_t number = 2; std::getline(stream, line); ++number) {
    const std::vector<std::string_view> cells = cells_of(line);
    if (cells.size() != width) reject("{}:{}: {}, but the header has {}", file, number, counted(cells.size(), "cell"), width);
    std::array<std::uint64_t, 1 + hd::pillar_count + 1> values{};
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const std::string_view cell = cells[columns[i].index];
      const auto [stop, status] = std::from_chars(cell.data(), cell.data() + cell.size(), values[i]);
      if (status != std::errc{} || stop != cell.data() + cell.size() || values[i] > columns[i].max) {
        reject("{}:{}: {} is {}; allowed: a whole number from 0 to {}", file, number, columns[i].name, quote(cell),
               columns[i].max);
      }
    }
    HdVector vector{values[0], {}};
    for (std::size_t p = 0; p < hd::pillar_count; ++p) vector.frame.level[p] = static_cast<std::uint8_t>(values[1 + p]);
    vector.frame.context = static_cast<std::uint8_t>(values.back());
    if (!vectors.empty() && vector.step != vectors.back().step + 1) {
      reject("{}:{}: step {} follows step {}; steps must have no gaps", file, number, vector.step, vectors.back().step);
    }
    vectors.push_back(vector);
  }
  if (stream.bad()) reject("{}: {}", file, std::strerror(errno));
  return vectors;
}

}  // namespace slipbench
