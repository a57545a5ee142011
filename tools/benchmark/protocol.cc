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
#include "tools/benchmark/protocol_file.h"
#include "tools/dataset/record/encoder.h"
#include "tools/files/project/project_file.h"

namespace slipbench::benchmark {
namespace {

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
  part.quiet_seconds = judgement.stick_time + judgement.air_time;
  for (const PadState state : {PadState::no_contact, PadState::non_slip}) {
    part.quiet_samples += static_cast<double>(samples_in(judgement.frames, state));
    for (const PadState slip : {PadState::incipient, PadState::gross})
      part.reported_samples += static_cast<double>(samples_in(judgement.frames, state, slip));
  }
  return part;
}

double share(double part, double whole) { return whole > 0.0 ? part / whole : 0.0; }

}  // namespace

std::string_view track_name(Track track) {
  constexpr std::array words{"open recordings", "closed loop", "transfer"};
  return words.at(static_cast<std::size_t>(track));
}

Protocol find_protocol(std::string_view name, std::string_view subject) {
  if (std::ranges::find(protocol_names, name) == protocol_names.end()) {
    const std::vector<std::string> names(protocol_names.begin(), protocol_names.end());
    throw InputError(std::string(subject) + ": unknown protocol " + quote(name) + allowed_names(name, names));
  }
  return read_protocol(std::string(name), SceneFile::load(project_file(fmt::format("tools/benchmark/{}.yaml", name))));
}

std::string protocol_sha256(const Protocol& protocol) {
  std::string text = fmt::format("{} {} {}\n", protocol.name, half_delay, worst_force_ratio);
  std::set<std::string> scenes;
  for (const TestSet& test_set : protocol.held_out) {
    text += fmt::format("{} {} {} {} {} {}\n", track_name(test_set.track), test_set.sensor, test_set.scene,
                        fmt::join(test_set.readers, ","), test_set.mover, test_set.time);
    // true: alarms less than a sample period before the slip are tolerated.
    text += fmt::format("{} {} {}\n", test_set.domain, true, test_set.track == Track::loop);
    text += fmt::format("{} {} {} {} {}\n", half_slip_distance, least_slip_distance, window_length, known_signal_deviations,
                        test_set.disturbance);
    scenes.insert(test_set.scene);
  }
  for (const std::string& scene : scenes) text += scene_digest(scene);
  return text_sha256(text);
}

bool counts_as_none(const eval::Judgement& judgement) {
  return std::isnan(judgement.slip_time) || judgement.whole_slip_distance < least_slip_distance;
}

Part recording_part(const eval::Judgement& judgement, const TestSet& test_set) {
  Part part = alarms_of(judgement);
  const bool slips = !std::isnan(judgement.slip_time);
  const bool by_distance = test_set.track != Track::transfer;
  part.slips = by_distance ? !counts_as_none(judgement) : slips;
  part.credited = part.slips && judgement.onset_known;
  part.judged = test_set.disturbance.empty() || !slips;
  part.no_alarm = std::isnan(judgement.alarm_time);
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
  double credited = 0.0, judged = 0.0, without_alarm = 0.0, without_slip = 0.0, reported = 0.0;
  for (const Part& part : parts) {
    if (!part.judged) continue;
    ++judged;
    without_alarm += part.no_alarm ? 1.0 : 0.0;
    without_slip += part.slips ? 0.0 : 1.0;
    reported += part.slips || part.no_alarm ? 0.0 : 1.0;
    sum.credit += part.credit;
    sum.needless += part.needless;
    credited += part.credited ? 1.0 : 0.0;
    sum.alarms += part.alarms;
    sum.quiet_seconds += part.quiet_seconds;
    sum.reported_samples += part.reported_samples;
    sum.quiet_samples += part.quiet_samples;
  }
  Score score;
  score.credit = share(sum.credit, credited);
  score.needless = share(sum.needless, judged - credited);
  score.alarms_per_minute = seconds_a_minute * share(sum.alarms, sum.quiet_seconds);
  score.false_share = share(reported, without_slip);
  score.reported_share = share(sum.reported_samples, sum.quiet_samples);
  score.specificity = share(without_alarm, judged);
  score.judged = static_cast<std::size_t>(judged);
  score.credited = static_cast<std::size_t>(credited);
  if (!test_set.disturbance.empty())
    score.value = score.specificity;
  else if (test_set.track == Track::open)
    score.value = recording_score(score.credit, score.false_share);
  else
    score.value = score.credit - score.reported_share - score.needless;
  return score;
}

void WindowCounts::add(const WindowCounts& other) {
  slipping += other.slipping;
  detected += other.detected;
  sticking += other.sticking;
  unreported += other.unreported;
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
    counts.unreported += !window.slips && !window.reported ? 1U : 0U;
  }
  return counts;
}

Interval score_interval(std::span<const Part> parts, const TestSet& test_set) {
  if (!test_set.disturbance.empty()) {
    const auto judged = std::ranges::count_if(parts, &Part::judged);
    const auto without_alarm = std::ranges::count_if(parts, [](const Part& part) { return part.judged && part.no_alarm; });
    return clopper_pearson(static_cast<std::size_t>(without_alarm), static_cast<std::size_t>(judged));
  }
  if (parts.size() < eval::fewest_experiments)
    return {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
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
