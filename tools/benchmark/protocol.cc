#include "tools/benchmark/protocol.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/core/error.h"
#include "sim/scene/parser.h"
#include "tools/benchmark/known_signal.h"
#include "tools/dataset/record/encoder.h"
#include "tools/files/project/project_file.h"

namespace slipbench::benchmark {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

struct Controls {
  double clock, time;                                     // s
  double speed = none, speed_time = none, travel = none;  // as in TestSet
};

// The sets of one sensor.
struct SensorSets {
  std::string type;
  std::vector<std::string> open, loop;  // readers
  std::string mover;
  Controls inside, outside;
  std::vector<std::string> disturbed = {};  // readers in the disturbed scenes, which all sensors share
};

Protocol slip_3() {
  const std::string folder = "scenes/benchmark/slip-3/";
  const std::vector<SensorSets> sensors{
      {"papillarray",
       {"pad", "slow"},
       {"pad", "fast"},
       "",
       {1.26, 0.09, 0.002724, 0.08, 0.0002665},
       {1.22, 0.03, 0.01246, 0.02, 5.68e-05},
       {"pad", "fast"}},
      {"piezo_skin",
       {"pad"},
       {"skin"},
       "",
       {1.44, 1.03, 0.0004786, 1.02, 0.0004102},
       {1.26, 0.07, 0.0008887, 0.06, 0.0002059},
       {"skin"}},
      {"nib_pad", {"pad"}, {"skin"}, "pull", {1.28, 0.28, 11.26, 0.08, 1.171}, {1.2, 0.19, 14.87, 0.04, 0.8373}, {"nibs"}},
      {"myrmex",
       {"left"},
       {"skin"},
       "apart",
       {1.44, 0.49, 0.02574, 0.2, 0.006339},
       {1.26, 0.2, 0.04526, 0.12, 0.006385},
       {"foam"}},
      {"biotac_sp", {"pad"}, {"skin"}, "", {1.22, 0.03, 0.02596, 0, 2.351e-05}, {1.2, 0.02, 0.02013, 0, 3.216e-05}, {"finger"}},
      {"magnetic_skin",
       {"pad"},
       {"skin"},
       "",
       {1.16, 0.13, 0.03342, 0, 0.000288},
       {1.1, 0.02, 0.02493, 0, 3.159e-05},
       {"magnets"}},
      {"gel_markers", {"pad"}, {"skin"}, "", {1.16, 1, 0.02302, 0, 0.000107}, {1.08, 0.01, 0.02495, 0, 3.278e-05}, {"gel"}},
      {"taxels",
       {"pad"},
       {"skin"},
       "",
       {1.12, 0.08, 0.004368, 0.06, 0.0002271},
       {1.12, 0.03, 0.01618, 0.02, 6.216e-05},
       {"taxels"}},
  };
  constexpr Controls in_loop{none, 0.04};
  Protocol protocol{.name = "slip-3", .held_out = {}};
  const auto add = [&](TestSet test_set, const std::string& scene, Controls controls) {
    test_set.scene = folder + scene + ".yaml";
    test_set.clock = controls.clock;
    test_set.time = controls.time;
    test_set.speed = controls.speed;
    test_set.speed_time = controls.speed_time;
    test_set.travel = controls.travel;
    protocol.held_out.push_back(std::move(test_set));
  };
  for (const SensorSets& sensor : sensors) {
    TestSet open{.track = Track::open, .sensor = sensor.type, .readers = sensor.open, .mover = sensor.mover, .domain = "inside"};
    add(open, "open_" + sensor.type, sensor.inside);
    open.domain = "outside";
    add(open, "outside_" + sensor.type, sensor.outside);
  }
  for (const std::string disturbance : {"hand", "grip", "load", "motor", "knock"}) {
    for (const SensorSets& sensor : sensors) {
      add({.track = Track::open,
           .sensor = sensor.type,
           .readers = sensor.disturbed,
           .domain = "disturbed",
           .disturbance = disturbance},
          disturbance, {none, none});
    }
  }
  for (const SensorSets& sensor : sensors) {
    add({.track = Track::loop, .sensor = sensor.type, .readers = sensor.loop}, "loop_" + sensor.type, in_loop);
  }
  return protocol;
}

// Returns the digests of a scene and of its model.
std::string scene_digest(const std::string& scene) {
  const std::string path = project_file(scene);
  std::string digest = scene + " " + file_sha256(path);
  const SceneFile file = SceneFile::load(path);
  if (const YamlNode* model = file.root().find("model")) {
    digest += " " + file_sha256((std::filesystem::path(path).parent_path() / model->text).string());
  }
  return digest + "\n";
}

constexpr double seconds_a_minute = 60.0;

// Returns the part without its credit.
Part alarms_of(const eval::Judgement& judgement) {
  Part part;
  part.alarms = static_cast<double>(judgement.stick_alarms + judgement.air_alarms);
  part.quiet = judgement.stick_time + judgement.air_time;
  for (const PadState state : {PadState::no_contact, PadState::non_slip}) {
    part.still += static_cast<double>(samples_in(judgement.frames, state));
    for (const PadState slip : {PadState::incipient, PadState::gross})
      part.said += static_cast<double>(samples_in(judgement.frames, state, slip));
  }
  return part;
}

double share(double part, double whole) { return whole > 0.0 ? part / whole : 0.0; }

}  // namespace

std::string_view track_name(Track track) {
  constexpr std::array words{"open recordings", "closed loop", "transfer"};
  return words.at(static_cast<std::size_t>(track));
}

const std::vector<Protocol>& protocols() {
  static const std::vector<Protocol> all{slip_3()};
  return all;
}

const Protocol& find_protocol(std::string_view name, std::string_view subject) {
  std::vector<std::string> names;
  for (const Protocol& protocol : protocols()) {
    if (protocol.name == name) return protocol;
    names.push_back(protocol.name);
  }
  throw InputError(std::string(subject) + ": unknown protocol " + quote(name) + allowed_names(name, names));
}

std::string protocol_sha256(const Protocol& protocol) {
  std::string text = fmt::format("{} {} {} {}\n", protocol.name, half_delay, alarm_limit, worst_force_ratio);
  std::set<std::string> scenes;
  for (const TestSet& test_set : protocol.held_out) {
    text += fmt::format("{} {} {} {} {} {} {}\n", track_name(test_set.track), test_set.sensor, test_set.scene,
                        fmt::join(test_set.readers, ","), test_set.mover, test_set.clock, test_set.time);
    // true: alarms less than a sample period before the slip are tolerated.
    text += fmt::format("{} {} {}\n", test_set.domain, true, test_set.track == Track::loop);
    text += fmt::format("{} {} {} {} {} {} {} {}\n", half_slip_distance, least_slip_distance, window_length,
                        known_signal_deviations, test_set.disturbance, test_set.speed, test_set.speed_time, test_set.travel);
    scenes.insert(test_set.scene);
  }
  for (const std::string& scene : scenes) text += scene_digest(scene);
  return text_sha256(text);
}

Part recording_part(const eval::Judgement& judgement, const TestSet& test_set) {
  Part part = alarms_of(judgement);
  const bool slips = !std::isnan(judgement.slip_time);
  const bool by_distance = test_set.track != Track::transfer;
  part.credited = slips && !(by_distance && judgement.whole_slip_distance < least_slip_distance);
  part.judged = test_set.disturbance.empty() || !slips;
  part.silent = std::isnan(judgement.alarm_time);
  if (part.credited && judgement.detection == Detection::seen) {
    part.credit = by_distance ? distance_credit(judgement.slip_distance) : half_delay / (half_delay + judgement.delay);
  }
  return part;
}

Part grasp_part(const eval::Judgement& judgement, const GraspOutcome& grasp, const GraspOutcome& untightened) {
  Part part = alarms_of(judgement);
  part.credited = !untightened.held();
  if (!part.credited) {
    const double ratio = grasp.max_grip_force / untightened.max_grip_force;
    part.needless = std::clamp((ratio - 1.0) / (worst_force_ratio - 1.0), 0.0, 1.0);
  } else if (grasp.held()) {
    const double ratio = grasp.max_grip_force / grasp.ideal_grip_force;
    part.credit = std::clamp((worst_force_ratio - ratio) / (worst_force_ratio - 1.0), 0.0, 1.0);
  }
  return part;
}

Score score_of(std::span<const Part> parts, const TestSet& test_set) {
  Part sum;
  double credited = 0.0, judged = 0.0, silent = 0.0;
  for (const Part& part : parts) {
    if (!part.judged) continue;
    ++judged;
    silent += part.silent ? 1.0 : 0.0;
    sum.credit += part.credit;
    sum.needless += part.needless;
    credited += part.credited ? 1.0 : 0.0;
    sum.alarms += part.alarms;
    sum.quiet += part.quiet;
    sum.said += part.said;
    sum.still += part.still;
  }
  Score score;
  score.credit = share(sum.credit, credited);
  score.needless = share(sum.needless, judged - credited);
  score.alarms_per_minute = seconds_a_minute * share(sum.alarms, sum.quiet);
  score.said = share(sum.said, sum.still);
  score.specificity = share(silent, judged);
  score.judged = static_cast<std::size_t>(judged);
  // In a loop a false alarm already costs force.
  const double alarms = test_set.track == Track::loop ? 0.0 : score.alarms_per_minute;
  score.value = !test_set.disturbance.empty()
                    ? score.specificity
                    : recording_score(score.credit, alarms, score.said) - (test_set.track == Track::loop ? score.needless : 0.0);
  return score;
}

void WindowCounts::add(const WindowCounts& other) {
  slipping += other.slipping;
  detected += other.detected;
  sticking += other.sticking;
  silent += other.silent;
}

WindowCounts window_counts(const eval::Truth& truth, const eval::Replayed& replayed) {
  struct Window {
    bool slips = false, reported = false;
  };
  constexpr double rounding = 1e-6;  // of times at the border of a window
  std::map<long, Window> windows;
  for (std::size_t row = 0; row < truth.time.size(); ++row) {
    if (!truth.judges(row)) continue;
    const double place = (truth.time[row] - truth.time.front()) / window_length;
    Window& window = windows[std::lround(std::floor(place + rounding))];
    window.slips = window.slips || slips(truth.state[row]);
    window.reported = window.reported || slips(replayed.seen[row]);
  }
  WindowCounts counts;
  for (const auto& [place, window] : windows) {
    ++(window.slips ? counts.slipping : counts.sticking);
    counts.detected += window.slips && window.reported ? 1U : 0U;
    counts.silent += !window.slips && !window.reported ? 1U : 0U;
  }
  return counts;
}

Interval score_interval(std::span<const Part> parts, const TestSet& test_set) {
  if (!test_set.disturbance.empty()) {
    const auto judged = std::ranges::count_if(parts, &Part::judged);
    const auto silent = std::ranges::count_if(parts, [](const Part& part) { return part.judged && part.silent; });
    return clopper_pearson(static_cast<std::size_t>(silent), static_cast<std::size_t>(judged));
  }
  if (parts.size() < eval::fewest_experiments) return {none, none};
  return bootstrap_intervals(parts.size(), eval::bootstrap_draws, eval::bootstrap_seed,
                             [&](std::span<const std::size_t> drawn) {
                               std::vector<Part> some;
                               some.reserve(drawn.size());
                               for (const std::size_t k : drawn) some.push_back(parts[k]);
                               return std::vector<double>{score_of(some, test_set).value};
                             })
      .front();
}

}  // namespace slipbench::benchmark
