#include "tools/benchmark/entrants.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "detectors/hd/memory_files.h"
#include "detectors/network/engine.h"
#include "sim/api/detector.h"
#include "sim/api/motion.h"
#include "sim/core/math.h"
#include "sim/core/math/rotation.h"
#include "sim/motion/motion_catalogue.h"
#include "tools/dataset/record/encoder.h"
#include "tools/eval/evaluate.h"
#include "tools/eval/replay.h"
#include "tools/eval/yardsticks.h"
#include "tools/files/project/project_file.h"
#include "tools/files/reject.h"
#include "tools/registry/program_catalogues.h"

namespace slipbench::benchmark {
namespace {

namespace fs = std::filesystem;

// Detectors of the catalogue that need a file of the user's.
constexpr std::array<const char*, 2> of_a_file{"network", "plugin"};
// Networks that ship, and the type of sensor that each reads.
struct ShippedNetwork {
  const char *name, *path, *sensor;
};
constexpr std::array<ShippedNetwork, 13> shipped_networks{
    {{"papillarray_slip", "scenes/learn/papillarray_slip.onnx", "papillarray"},
     {"papillarray_grasp", "scenes/learn/papillarray_grasp.onnx", "papillarray"},
     {"piezo_slip", "scenes/learn/piezo_slip.onnx", "piezo_skin"},
     {"piezo_grasp", "scenes/learn/piezo_grasp.onnx", "piezo_skin"},
     {"nib_slip", "scenes/learn/nib_slip.onnx", "nib_pad"},
     {"nib_grasp", "scenes/learn/nib_grasp.onnx", "nib_pad"},
     {"biotac_grasp", "scenes/learn/biotac_grasp.onnx", "biotac_sp"},
     {"taxels_slip", "scenes/learn/taxels_slip.onnx", "taxels"},
     {"taxels_grasp", "scenes/learn/taxels_grasp.onnx", "taxels"},
     {"magnetic_skin_slip", "scenes/learn/magnetic_skin_slip.onnx", "magnetic_skin"},
     {"magnetic_skin_grasp", "scenes/learn/magnetic_skin_grasp.onnx", "magnetic_skin"},
     {"gel_slip", "scenes/learn/gel_slip.onnx", "gel_markers"},
     {"gel_grasp", "scenes/learn/gel_grasp.onnx", "gel_markers"}}};
constexpr const char* no_engine = "OpenVINO, which runs networks, is missing; see slipbench doctor";

std::string file_digest(const std::string& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) return file_sha256(path);
  std::vector<std::string> files;
  const fs::directory_iterator entries(path, error);
  if (error) reject("{}: cannot be read: {}", path, error.message());
  for (const fs::directory_entry& entry : entries) {
    if (entry.is_regular_file(error)) files.push_back(entry.path().string());
  }
  std::ranges::sort(files);
  std::string text;
  for (const std::string& file : files) text += fs::path(file).filename().string() + " " + file_sha256(file) + "\n";
  return text_sha256(text);
}

class Control final : public Detector {
 public:
  explicit Control(const Parameters& parameters)
      : from_(parameters.number("from")), until_(parameters.number("until")), once_(parameters.flag("once")) {}

  const SlipEstimate& update(const SensorFrame& frame) override {
    estimate_.time = frame.time;
    const bool reports = frame.time >= from_ && frame.time < until_;
    estimate_.state = reports ? PadState::gross : PadState::non_slip;
    if (reports && once_) until_ = frame.time;
    return estimate_;
  }

 private:
  double from_, until_;
  bool once_;
  SlipEstimate estimate_;
};

Entry control_entry() {
  constexpr Range time{0.0, never, false, true};
  const std::string source = "free: a clock";
  return {control_type,
          "Reports slip between two fixed times, whatever the sensor measures.",
          "",
          "none: a negative control",
          {number_spec("from", Quantity::time, "0 s", time, "Time at which slip is first reported.", source),
           number_spec("until", Quantity::time, "inf", time, "Time at which slip is no longer reported.", source),
           flag_spec("once", "false", "Reports slip in one sample only.", source)}};
}

// Returns how long a stage moves sideways or turns [s].
double way_time(const Parameters& motion) {
  const double travel = motion.number("travel") * static_cast<double>(motion.integer("strokes"));
  return std::min(motion.number("stop"), motion.number("speed") > 0.0 ? travel / motion.number("speed") : never);
}

}  // namespace

std::string file_of(const DetectorScene& detector) {
  const auto& values = detector.parameters.values();
  if (values.contains("memories")) return hd::memories_folder(detector.parameters.path("memories"));
  for (const char* key : {"model", "library"}) {
    if (values.contains(key)) return detector.parameters.path(key);
  }
  return "";
}

std::string kind_word(Kind kind) {
  constexpr std::array words{"shipped", "given", "yardstick", "control", "known signal", "oracle"};
  return words.at(static_cast<std::size_t>(kind));
}

Entrant given_entrant(const std::string& word, const std::vector<Override>& parameters) {
  Entrant entrant{.name = word, .kind = Kind::given, .detector = eval::chosen_detector(word, parameters)};
  std::string identity = entrant.detector.type;
  for (const Override& change : parameters) {
    entrant.parameters[change.path] = change.value;
    identity += "\n" + change.path + "=" + change.value;
  }
  entrant.sha256_seen = eval::seen_trials(entrant.detector, eval::training_of(entrant.detector));
  if (const std::string file = file_of(entrant.detector); !file.empty()) identity += "\n" + file_digest(file);
  entrant.sha256 = text_sha256(identity);
  return entrant;
}

std::vector<Entrant> shipped_entrants() {
  std::vector<Entrant> entrants;
  const auto add = [&entrants](const std::string& word, const std::string& name, const std::string& reads = "") {
    Entrant entrant = given_entrant(word, {});
    entrant.name = name;
    entrant.kind = Kind::shipped;
    entrant.reads = reads;
    entrants.push_back(std::move(entrant));
  };
  const std::vector<DetectorScene> yardsticks = eval::yardsticks();
  for (const Entry& entry : detector_entries()) {
    const bool asks_for_a_file = std::ranges::find(of_a_file, entry.name) != of_a_file.end();
    const bool is_yardstick = std::ranges::find(yardsticks, entry.name, &DetectorScene::type) != yardsticks.end();
    if (!asks_for_a_file && !is_yardstick && entry.name != oracle_type && entry.name != control_type) add(entry.name, entry.name);
  }
  add("learn_gst_hd", "gst_hd, learn_gst_hd");
  if (network::engine_available()) {
    for (const ShippedNetwork& network : shipped_networks) add(project_file(network.path), network.name, network.sensor);
  }
  return entrants;
}

std::vector<Entrant> yardstick_entrants() {
  std::vector<Entrant> entrants;
  for (const DetectorScene& detector : eval::yardsticks()) {
    entrants.push_back(given_entrant(detector.type, {}));
    entrants.back().kind = Kind::yardstick;
    entrants.back().chooses_threshold = true;
  }
  return entrants;
}

std::vector<double> threshold_factors() {
  constexpr int decades_above = 4, decades_below = 8, steps = 4;
  std::vector<double> factors;
  for (int k = steps * decades_above; k >= -steps * decades_below; --k)
    factors.push_back(math::exp(std::numbers::ln10 * k / steps));
  return factors;
}

Entrant with_threshold(const Entrant& yardstick, double threshold) {
  Entrant set = yardstick;
  set.detector = eval::with_yardstick_threshold(yardstick.detector, threshold);
  set.parameters[eval::yardstick_threshold] = fmt::format("{:.6g}", threshold);
  set.chooses_threshold = false;
  return set;
}

std::vector<Missing> missing_entrants() {
  std::vector<Missing> missing;
  if (network::engine_available()) return missing;
  for (const ShippedNetwork& network : shipped_networks) missing.push_back({network.name, network.sensor, no_engine});
  return missing;
}

std::vector<Entrant> control_entrants() {
  const auto control = [](const char* name, double from, SideInformation side_information) {
    return Entrant{.name = name,
                   .kind = Kind::control,
                   .detector = control_of(from, never),
                   .side_information = side_information,
                   .sha256 = text_sha256(name)};
  };
  return {control("always slip", 0.0, SideInformation::nothing),
          control(never_slip, never, SideInformation::nothing),
          control("clock", never, SideInformation::clock),
          control("motion known", never, SideInformation::motion),
          control("motion known, timed", never, SideInformation::motion_and_time),
          control("motion and speed known", never, SideInformation::speed),
          control("travel known", never, SideInformation::travel)};
}

bool has_side_information(const Entrant& entrant, const TestSet& test_set) {
  switch (entrant.side_information) {
    case SideInformation::clock: return !std::isnan(test_set.clock);
    case SideInformation::motion_and_time: return !std::isnan(test_set.time);
    case SideInformation::speed: return !std::isnan(test_set.speed);
    case SideInformation::travel: return !std::isnan(test_set.travel);
    case SideInformation::nothing:
    case SideInformation::motion: break;
  }
  return true;
}

Entrant oracle_entrant() {
  Entrant oracle{.name = "oracle", .kind = Kind::oracle, .sha256 = text_sha256("oracle")};
  oracle.detector.type = oracle_type;
  for (const Entry& entry : detector_entries()) {
    if (entry.name == oracle_type) oracle.detector.parameters = defaults_of(entry.parameters);
  }
  return oracle;
}

Entrant known_signal_entrant() {
  return {.name = "signal known", .kind = Kind::known_signal, .sha256 = text_sha256("signal known")};
}

void register_control() {
  register_detector(control_entry(), [](const Parameters& parameters, const FrameSource& source) {
    static_cast<void>(source);
    return std::make_unique<Control>(parameters);
  });
}

DetectorScene control_of(double from, double until, bool once) {
  DetectorScene detector = eval::chosen_detector(control_type, {});
  detector.parameters.set("once", once);
  detector.parameters.set("from", from);
  detector.parameters.set("until", until);
  return detector;
}

DetectorScene motion_known(const Scene& scene, const std::string& mover) {
  const Parameters& motion = scene.motion.parameters;
  if (scene.grasp) return control_of(lift_times(motion).start, never);
  if (!mover.empty()) {
    const std::vector<ControlScene::Point>& points = std::ranges::find(scene.controls, mover, &ControlScene::actuator)->points;
    const auto moves = std::ranges::adjacent_find(points, std::ranges::not_equal_to{}, &ControlScene::Point::value);
    return control_of(moves == points.end() ? never : moves->time, never);
  }
  if (motion.number("speed") == 0.0 && motion.number("rotation") == 0.0) return control_of(never, never);
  return control_of(motion.number("start"), motion.number("start") + way_time(motion));
}

double HandMotion::passes(double distance) const {
  const auto first = std::ranges::find_if(travel, [distance](double way) { return way >= distance; });
  return first == travel.end() ? never : step * static_cast<double>(first - travel.begin());
}

HandMotion hand_motion(const Scene& scene, const std::string& mover) {
  HandMotion hand;
  hand.start = motion_known(scene, mover).parameters.number("from");
  std::function<double(double)> travel;
  if (mover.empty()) {
    const std::shared_ptr<const Motion> motion = stage_motion().create(scene.motion.parameters, {});
    const Pose begin = motion->pad_at(hand.start).pose;
    travel = [motion, begin](double time) {
      constexpr double arm = 0.01;  // m, where a turn is counted
      const Pose now = motion->pad_at(time).pose;
      const Eigen::Vector3d way = now.position - begin.position;
      return math::hypot(way.x(), way.y()) + arm * rotation_vector(now.rotation * begin.rotation.transpose()).norm();
    };
  } else {
    const std::vector<ControlScene::Point>& points = std::ranges::find(scene.controls, mover, &ControlScene::actuator)->points;
    travel = [&points](double time) {
      const auto next = std::ranges::upper_bound(points, time, {}, &ControlScene::Point::time);
      if (next == points.begin()) return 0.0;
      const ControlScene::Point& last = *std::prev(next);
      const double share = next == points.end() ? 0.0 : (time - last.time) / (next->time - last.time);
      return std::abs(last.value + share * ((next == points.end() ? last : *next).value - last.value) - points.front().value);
    };
  }
  for (double time = 0.0; time <= scene.duration; time = HandMotion::step * static_cast<double>(hand.travel.size())) {
    const double way = time < hand.start ? 0.0 : travel(time);
    if (!hand.travel.empty()) hand.top_speed = std::max(hand.top_speed, (way - hand.travel.back()) / HandMotion::step);
    hand.travel.push_back(way);
  }
  return hand;
}

DetectorScene timed_control(SideInformation side_information, const TestSet& test_set, const Scene& scene) {
  if (side_information == SideInformation::clock) return control_of(test_set.clock, never, true);
  if (side_information == SideInformation::motion_and_time) {
    const double from = motion_known(scene, test_set.mover).parameters.number("from");
    return scene.grasp ? control_of(from, from + test_set.time) : control_of(from + test_set.time, never, true);
  }
  const HandMotion hand = hand_motion(scene, test_set.mover);
  if (side_information == SideInformation::travel) return control_of(hand.passes(test_set.travel), never, true);
  return control_of(hand.top_speed >= test_set.speed ? hand.start + test_set.speed_time : never, never, true);
}

double judged_from(const TestSet& test_set, const Scene& scene) {
  if (!test_set.disturbance.empty()) return -never;
  return motion_known(scene, test_set.mover).parameters.number("from");
}

}  // namespace slipbench::benchmark
