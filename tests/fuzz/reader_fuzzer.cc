// Arbitrary bytes are files that a reader of foreign files accepts, or give an InputError; anything
// else is a crash. SLIPBENCH_READER in the environment names the reader. An input is all of its
// files in order, separated by lines "====".
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "detectors/hd/memory_files.h"
#include "sim/api/sensor.h"
#include "sim/core/error.h"
#include "sim/mujoco/mjcf.h"
#include "tools/benchmark/benchmark.h"
#include "tools/benchmark/submission.h"
#include "tools/dataset/content_check.h"
#include "tools/dataset/record/encoder.h"
#include "tools/dataset/stored_trials.h"
#include "tools/formats/import/source_table.h"
#include "tools/learning_data/samples.h"
#include "tools/registry/sensor_catalogue.h"

namespace {

using namespace slipbench;
namespace fs = std::filesystem;

using Texts = std::vector<std::string>;

struct Reader {
  std::string name;
  Texts files;  // that it reads
  std::function<void(const Texts& paths, const Texts& texts)> read;
};

void read_mjcf(const Texts& paths, const Texts& texts) {
  check_mjcf(paths[0]);
  static_cast<void>(placed_message(paths[0], texts[2]));
}

// Without slipbench-reader, which a fuzzer cannot observe.
void read_dataset(const Texts& paths, const Texts&) {
  const std::optional<FileAbout> about = file_about(paths[0]);
  const DatasetReader reader(paths[0]);
  static_cast<void>(reader.mask("train"));
  ContentCheck check(reader);
  for (const std::size_t trial : reader.trials()) {
    static_cast<void>(reader.read_trial(trial));
    check.add(trial);
  }
  check.finish();
  if (about && about->header.part) static_cast<void>(stored_trials(paths[0]));
}

// Texts that come from HDF5, which few changes to a whole file reach.
void read_dataset_texts(const Texts&, const Texts& texts) {
  static_cast<void>(parse_failures("fuzz.h5", texts[0]));
  static_cast<void>(parse_files("fuzz.h5", texts[1]));
  static_cast<void>(parse_shard("fuzz.h5", texts[2], 100));
  static_cast<void>(outcome_json(parse_outcome(texts[3])));
}

void read_submission(const Texts&, const Texts& texts) {
  using namespace benchmark;
  const Json submitted = parse_submission(texts[0], "fuzz.json");
  const Json request = request_json(parse_request(submitted.at("asked"), "fuzz.json"));
  // Accepted text is written again and must be equal.
  if (request_json(parse_request(request, "fuzz.json")) != request) throw std::logic_error(request.dump());
  static_cast<void>(difference(texts[0], submitted, {{"asked", request}, {"sets", {{1, 2.5}, "three"}}}));
  static_cast<void>(difference(texts[0], submitted, submitted));
}

// Published memories have no model.txt.
void read_memories(const Texts& paths, const Texts& texts) {
  if (texts[0].empty()) fs::remove(paths[0]);
  const hd::SavedModel saved = hd::load(fs::path(paths[0]).parent_path().string(), hd::Model{});
  hd::check(saved.model, saved.memories, true);
}

// Accepted recordings can be stored.
template <void (*read)(const SourceFile&, const AddRecording&)>
void import_by(const Texts& paths, const Texts&) {
  static TrialEncoder encoder;
  const SourceFile file{paths[0], fs::path(paths[0]).filename().string()};
  read(file, [](const TrialRecord& record, std::size_t) { static_cast<void>(encoder.encode(record)); });
}

const std::vector<Reader> readers{
    {"mjcf", {"model.xml", "part.xml", "message"}, &read_mjcf},
    {"dataset", {"fuzz.h5"}, &read_dataset},
    {"dataset-texts", {"failed", "files", "sweep_shard", "outcome"}, &read_dataset_texts},
    {"submission", {"board.json"}, &read_submission},
    {"memories", {"model.txt", "AM.hex", "CIM.hex", "CM.hex", "IM.hex"}, &read_memories},
    {"bts3v2", {"bts3v2_palm_down.csv"}, &import_by<&read_bts3v2>},
    {"biotacsp-dos", {"n/box1.csv"}, &import_by<&read_biotacsp_dos>},
    {"papillarray-csv", {"log.csv"}, &import_by<&read_papillarray_csv>},
    {"training-csv", {"rotation/demo_3-v_4.0-slip.csv"}, &import_by<&read_training_csv>},
};

const Reader& chosen() {
  const char* const name = std::getenv("SLIPBENCH_READER");
  for (const Reader& reader : readers) {
    if (name != nullptr && reader.name == name) return reader;
  }
  throw std::invalid_argument("SLIPBENCH_READER names no reader of tests/fuzz/reader_fuzzer.cc");
}

// A folder of this process alone.
const fs::path folder = fs::temp_directory_path() / fmt::format("slipbench-fuzz-{}", ::getpid());

// A sensor with the channels of imported ones.
struct StandIn final : Sensor {
  [[nodiscard]] const PadLayout& layout() const override { return pad; }
  [[nodiscard]] double rate() const override { return 1000.0; }
  [[nodiscard]] const std::vector<Channel>& channels() const override { return held; }
  const SensorFrame& measure(const ContactFrame&) override { return frame; }
  [[nodiscard]] PadState paper_label(const ContactFrame&, bool) const override { return PadState::no_contact; }

  PadLayout pad;
  std::vector<Channel> held{{"force", "N", {9, 3}, {}}, {"displacement", "m", {9, 3}, {}}, {"electrodes", "counts", {24}, {}}};
  SensorFrame frame;
};

Texts numbered_columns(std::size_t count) {
  Texts names;
  while (names.size() < count) names.push_back(fmt::format("c{}", names.size()));
  return names;
}

}  // namespace

// Replaces the program's catalogues, formats and protocols. The first two would bring everything
// that is simulated, minutes of build time. Columns have their numbers as names, which leaves more
// of an input for the rest. A protocol's digest covers all of its scenes: it takes a third of a
// second, and no file of the corpus could contain it.
namespace slipbench {

Catalogues pad_catalogues() {
  Catalogues catalogues;
  catalogues.sensors = {{"papillarray", "", "", "", {}}, {"biotac_sp", "", "", "", {}}};
  return catalogues;
}
std::unique_ptr<Sensor> make_sensor(const SensorScene&, std::uint64_t, std::uint64_t) { return std::make_unique<StandIn>(); }
Texts vendor_log_columns(std::size_t sensors) { return numbered_columns(1 + 81 * sensors); }
Texts grasp_columns() { return numbered_columns(2 + grasp_fingers.size() * finger_electrodes); }

namespace benchmark {
Protocol find_protocol(std::string_view name, std::string_view subject) {
  if (name != default_protocol) throw InputError(std::string(subject) + ": unknown protocol " + quote(name));
  return {default_protocol, {}};
}
std::string protocol_sha256(const Protocol&) { return "its digest"; }
}  // namespace benchmark

}  // namespace slipbench

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  for (const std::string& file : chosen().files) fs::create_directories((folder / file).parent_path());
  std::atexit([] { fs::remove_all(folder); });
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Reader& reader = chosen();
  constexpr std::string_view parting = "\n====\n";
  std::string_view left(reinterpret_cast<const char*>(data), size);
  Texts paths, texts;
  for (const std::string& file : reader.files) {
    const std::size_t end = reader.files.size() == 1 ? std::string_view::npos : left.find(parting);
    texts.emplace_back(left.substr(0, end));
    left = end == std::string_view::npos ? "" : left.substr(end + parting.size());
    paths.push_back((folder / file).string());
    std::ofstream(paths.back(), std::ios::binary) << texts.back();
  }
  try {
    reader.read(paths, texts);
  } catch (const InputError&) {
    // The expected answer to bad input.
  }
  return 0;
}
