#include "tools/program/benchmark/protocol.h"

#include <filesystem>
#include <limits>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/scene/parser.h"
#include "tools/base/project/project_file.h"
#include "tools/base/record/encoder.h"

namespace slipbench::benchmark {
namespace {

constexpr const char* folder = "scenes/benchmark/slip-1/";

constexpr double none = std::numeric_limits<double>::quiet_NaN();

struct Controls {
  double clock, time;  // s
};

Held open_recordings(const std::string& sensor, std::vector<std::string> readers, Controls controls, std::string mover = "") {
  return {.track = Track::open,
          .sensor = sensor,
          .scene = folder + ("open_" + sensor + ".yaml"),
          .readers = std::move(readers),
          .mover = std::move(mover),
          .clock = controls.clock,
          .time = controls.time};
}

// All lifts begin at the same instant, so that a clock would know no less than who knows the motion.
Held closed_loop(const std::string& sensor, std::vector<std::string> readers) {
  return {.track = Track::loop,
          .sensor = sensor,
          .scene = folder + ("loop_" + sensor + ".yaml"),
          .readers = std::move(readers),
          .mover = "",
          .clock = none,
          .time = 0.16};
}

// The bytes of a scene, and of the model that it names.
std::string scene_digest(const std::string& scene) {
  const std::string path = project_file(scene);
  std::string digest = scene + " " + file_sha256(path);
  const SceneFile file = SceneFile::load(path);
  if (const YamlNode* model = file.root().find("model")) {
    digest += " " + file_sha256((std::filesystem::path(path).parent_path() / model->text).string());
  }
  return digest + "\n";
}

}  // namespace

std::string_view track_name(Track track) {
  switch (track) {
    case Track::open: return "open recordings";
    case Track::loop: return "closed loop";
    case Track::transfer: return "transfer";
  }
  return {};
}

const std::vector<Held>& held_out() {
  static const std::vector<Held> all{open_recordings("papillarray", {"pad", "slow"}, {3.9, 0.14}),
                                     open_recordings("piezo_skin", {"pad"}, {3.3, none}),
                                     open_recordings("nib_pad", {"pad"}, {5.3, 2.05}, "pull"),
                                     open_recordings("myrmex", {"left"}, {none, 5.3}, "apart"),
                                     open_recordings("biotac_sp", {"pad"}, {3.4, 0.08}),
                                     closed_loop("papillarray", {"pad", "fast"}),
                                     closed_loop("piezo_skin", {"skin"}),
                                     closed_loop("nib_pad", {"skin"}),
                                     closed_loop("myrmex", {"skin"}),
                                     closed_loop("biotac_sp", {"skin"})};
  return all;
}

const std::vector<Lesson>& lessons() {
  static const std::vector<Lesson> all{{"papillarray_gru", "papillarray", "scenes/benchmark/slip-1/learn_papillarray.yaml", 0},
                                       {"piezo_mlp", "piezo_skin", "scenes/piezo_skin/dataset.yaml", 100},
                                       {"piezo_fft_gru", "piezo_skin", "scenes/piezo_skin/dataset.yaml", 100},
                                       {"myrmex_net1", "myrmex", "scenes/myrmex/dataset.yaml", 0},
                                       {"biotac_lstm", "biotac_sp", "scenes/biotac_sp/slip.yaml", 3}};
  return all;
}

std::string protocol_sha256() {
  std::string text = fmt::format("{} {} {} {}\n", protocol_name, half_delay, alarm_limit, worst_force_ratio);
  std::set<std::string> scenes;
  for (const Held& held : held_out()) {
    text += fmt::format("{} {} {} {} {} {} {}\n", track_name(held.track), held.sensor, held.scene, fmt::join(held.readers, ","),
                        held.mover, held.clock, held.time);
    scenes.insert(held.scene);
  }
  for (const Lesson& lesson : lessons()) {
    text += fmt::format("{} {} {} {}\n", lesson.recipe, lesson.sensor, lesson.scene, lesson.trials);
    scenes.insert(lesson.scene);
  }
  for (const std::string& scene : scenes) text += scene_digest(scene);
  return text_sha256(text);
}

}  // namespace slipbench::benchmark
