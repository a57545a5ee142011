#include "tools/benchmark/benchmark.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "sim/core/process/interrupted.h"
#include "sim/core/quantity.h"
#include "tools/benchmark/control.h"
#include "tools/benchmark/entrants.h"
#include "tools/benchmark/known_signal.h"
#include "tools/benchmark/protocol.h"
#include "tools/benchmark/submission.h"
#include "tools/dataset/checked_dataset.h"
#include "tools/dataset/content_check.h"
#include "tools/dataset/reader.h"
#include "tools/dataset/record/encoder.h"
#include "tools/doctor/doctor.h"
#include "tools/eval/metrics.h"
#include "tools/eval/replay.h"
#include "tools/eval/yardsticks.h"
#include "tools/files/given_once.h"
#include "tools/files/project/project_file.h"
#include "tools/files/reject.h"
#include "tools/learning_data/label_rules.h"
#include "tools/registry/program_catalogues.h"
#include "tools/report/report_summary.h"
#include "tools/statistics/descriptive.h"
#include "tools/trial/run_trial.h"
#include "tools/trial/sweep/run_sweep.h"
#include "tools/trial/trial_run.h"
#include "tools/workers/ordered_workers.h"

namespace slipbench::benchmark {
namespace {

constexpr std::size_t most_groups = 6;

// Open recordings: slip counts from the first part of a unit on; samples that stick again after a
// slip are not judged, since the label rules that detectors are trained with disagree there. Loops:
// a firmer grip is expected to end the report of slip.
LabelRule rule_of(Track track) {
  constexpr std::array rules{LabelRule::masked, LabelRule::micro, LabelRule::recorded};
  return rules.at(static_cast<std::size_t>(track));
}

// The result of an entrant in one trial, or why it could not be judged.
struct Answer {
  eval::Judgement judgement;
  WindowCounts windows;  // of a real recording
  std::optional<GraspOutcome> grasp;
  std::string failure;
  std::vector<Answer> at;  // of a yardstick that chooses its threshold: with each of threshold_factors()
};

// An entrant with the sensor that it reads in a set of trials.
struct EntrantResults {
  const Entrant* entrant = nullptr;
  std::size_t sensor = 0;   // index into the trial's sensors
  std::string sensor_name;  // as the scene names it
  std::vector<Answer> answers{};
  std::vector<double> thresholds{};  // of a yardstick that chose them on the other half of the trials
};

struct OmittedDetector {
  std::string detector, why;
  bool reads_another = false;  // it reads a sensor that the set does not have
};

// A set of trials and its results.
struct Board {
  TestSet test_set{};
  std::vector<EntrantResults> entries{};
  std::vector<OmittedDetector> left_out{};
  std::vector<std::string> params{};  // JSON for each trial
  std::vector<std::string> digests{};
  std::string sensor{};
  std::vector<GraspOutcome> untightened{};  // outcome of each grasp without tightening
};

DetectorScene detector_of(const EntrantResults& entry) {
  DetectorScene detector = entry.entrant->detector;
  detector.sensor = entry.sensor;
  return detector;
}

// Returns an entrant's control in a trial. `scene`: that of the trial, one of `test_set`; both nullptr
// for a recording of a real sensor, whose motion no entrant knows.
Control control_of(const Entrant& entrant, const TestSet* test_set, const Scene* scene) {
  return entrant.knows_motion ? motion_known(*test_set, *scene) : entrant.control;
}

// The answers of a yardstick with another threshold, `factor` times its own.
eval::Replayed with_factor(eval::Replayed replayed, double factor) {
  const double least = factor / (1.0 + factor);
  PadState state = PadState::no_contact;
  for (std::size_t row = 0; row < replayed.seen.size(); ++row) {
    if (const double value = replayed.probability[row]; !std::isnan(value))
      state = value >= least ? PadState::gross : PadState::non_slip;
    replayed.seen[row] = state;
  }
  std::ranges::fill(replayed.probability, std::numeric_limits<double>::quiet_NaN());
  return replayed;
}

// An alarm less than a sample period before the slip is early only in recordings of a real sensor,
// for which `test_set` is nullptr.
eval::Judgement judged(const TestSet* test_set, std::size_t trial, const eval::Truth& truth, const eval::Replayed& replayed) {
  return eval::judged(trial, truth, replayed, test_set != nullptr ? truth.period : 0.0);
}

// The same trial on a surface on which nothing slips, simulated on first use.
class TrialWithoutSlip {
 public:
  explicit TrialWithoutSlip(std::function<TrialRecord()> simulate) : simulate_(std::move(simulate)) {}
  const TrialRecord& record() {
    if (!record_) record_ = simulate_();
    return *record_;
  }

 private:
  std::function<TrialRecord()> simulate_;
  std::optional<TrialRecord> record_;
};

// Returns the oracle's answers: slip from its first instant on, as long as it lasts.
eval::Replayed as_true(const eval::Truth& truth) {
  eval::Replayed seen;
  seen.seen = truth.state;
  seen.seen_since = truth.time;
  for (std::size_t row = 0; row < truth.time.size(); ++row) {
    if (!slips(truth.state[row]) || !(truth.time[row] >= truth.first_slip)) continue;
    seen.seen_since[row] = truth.first_slip;
    break;
  }
  seen.stuck_fraction.assign(truth.time.size(), std::numeric_limits<double>::quiet_NaN());
  seen.probability = seen.stuck_fraction;
  return seen;
}

// Measures use the truth, so they have no rank.
bool is_measure(const Entrant& entrant) { return entrant.kind == Kind::oracle || entrant.kind == Kind::known_signal; }

// Disturbed recordings have no ranks: never to report slip has the best specificity.
bool is_ranked(const Entrant& entrant, const TestSet& test_set) { return !is_measure(entrant) && test_set.disturbance.empty(); }

// `slipless`: the same trial without slip; nullptr if no entrant needs it.
Answer recorded_answer(const EntrantResults& entry, const TestSet* test_set, const Scene* scene, const TrialRecord& record,
                       LabelRule rule, TrialWithoutSlip* slipless = nullptr) {
  Answer answer;
  try {
    const double from = test_set == nullptr ? -never : judged_from(*test_set, *scene);
    const eval::Truth truth = eval::truth_of(scene, record, record.sensors[entry.sensor], rule, from);
    const auto replayed = [&] {
      if (is_measure(*entry.entrant)) {
        const eval::Replayed oracle = as_true(truth);
        if (counts_as_none(judged(test_set, record.trial, truth, oracle))) return no_reports(truth);
        return entry.entrant->kind == Kind::oracle ? oracle : signal_known(record, slipless->record(), entry.sensor, truth);
      }
      if (entry.entrant->kind == Kind::control)
        return eval::replay(make_detector(control_of(*entry.entrant, test_set, scene)), record.sensors, entry.sensor);
      return eval::replay(detector_of(entry), record.sensors, entry.sensor, record.seed, record.trial);
    };
    const eval::Replayed answers = replayed();
    answer.judgement = judged(test_set, record.trial, truth, answers);
    if (test_set == nullptr) answer.windows = window_counts(truth, answers);
    if (!entry.entrant->chooses_threshold) return answer;
    for (const double factor : threshold_factors()) {
      const eval::Replayed other = with_factor(answers, factor);
      answer.at.emplace_back().judgement = judged(test_set, record.trial, truth, other);
      if (test_set == nullptr) answer.at.back().windows = window_counts(truth, other);
    }
  } catch (const InputError& error) {
    answer.failure = fmt::format("trial {}: {}", record.trial, error.what());
  }
  return answer;
}

// Runs a grasp with this detector in the loop.
Answer grasp_answer(const EntrantResults& entry, const TestSet& test_set, Scene scene, std::size_t trial) {
  Answer answer;
  try {
    TrialRun::Replacements replacements;
    if (entry.entrant->kind == Kind::control) {
      replacements.detector = make_detector(control_of(*entry.entrant, &test_set, &scene));
      scene.detector->sensor = entry.sensor;
    } else {
      scene.detector = detector_of(entry);
    }
    TrialRun loop(scene, trial, Recording::full, max_record_bytes, nullptr, std::move(replacements));
    loop.run();
    const TrialRecord record = loop.finish().record;
    const SensorRecord& sensor = record.sensors[entry.sensor];
    eval::Replayed seen;
    for (const std::uint8_t code : record.control->detector_class) seen.seen.push_back(static_cast<PadState>(code));
    seen.seen_since = sensor.time;
    seen.stuck_fraction.assign(sensor.time.size(), std::numeric_limits<double>::quiet_NaN());
    seen.probability = seen.stuck_fraction;
    answer.judgement = judged(&test_set, trial, eval::truth_of(&scene, record, sensor, rule_of(Track::loop)), seen);
    answer.grasp = record.outcome.grasp;
  } catch (const InputError& error) {
    answer.failure = fmt::format("trial {}: {}", trial, error.what());
  }
  return answer;
}

// Replaces a file's path, which differs between installations, by its name.
std::string without_folder(std::string text, const std::string& file) {
  const std::string name = std::filesystem::path(file).filename().string();
  for (std::size_t at = file.empty() ? std::string::npos : text.find(file); at != std::string::npos;
       at = text.find(file, at + name.size())) {
    text.replace(at, file.size(), name);
  }
  return text;
}

// Gives each entrant the first sensor that it can read; the others are left out with the reason.
void add_entries(Board& board, const std::vector<const Entrant*>& entrants, const TrialRecord& first,
                 const std::vector<std::size_t>& readers) {
  for (const Entrant* entrant : entrants) {
    std::string why;
    bool added = false;
    for (const std::size_t sensor : readers) {
      const EntrantResults entry{entrant, sensor, first.sensors[sensor].name};
      if (!is_measure(*entrant) && entrant->kind != Kind::control) {
        try {
          eval::replay(detector_of(entry), first.sensors, sensor, first.seed, first.trial);
        } catch (const InputError& error) {
          if (why.empty()) why = without_folder(error.what(), file_of(entrant->detector));
          continue;
        }
      }
      board.entries.push_back(entry);
      added = true;
      break;
    }
    const bool reads_another = entrant->kind == Kind::shipped && entrant->reads != first.sensors[readers.front()].type;
    if (!added) board.left_out.push_back({entrant->name, why, reads_another});
  }
}

// Leaves out entrants that could not be judged in some trial, or were trained on one.
void remove_unfit_entries(Board& board) {
  const auto unfit = [&board](const EntrantResults& entry) {
    std::string why;
    for (const Answer& answer : entry.answers) {
      if (why.empty()) why = answer.failure;
    }
    std::size_t known = 0;
    for (const std::string& digest : board.digests) known += entry.entrant->sha256_seen.count(digest);
    why = without_folder(why, file_of(entry.entrant->detector));
    if (known > 0) why = fmt::format("was trained on {} of the {} trials", known, board.digests.size());
    if (!why.empty()) board.left_out.push_back({entry.entrant->name, why});
    return !why.empty();
  };
  std::erase_if(board.entries, unfit);
}

std::vector<Part> parts_of(const Board& board, const EntrantResults& entry) {
  std::vector<Part> parts;
  for (std::size_t k = 0; k < entry.answers.size(); ++k) {
    const Answer& answer = entry.answers[k];
    parts.push_back(answer.grasp ? grasp_part(answer.judgement, *answer.grasp, board.untightened[k])
                                 : recording_part(answer.judgement, board.test_set));
  }
  return parts;
}

// False for disturbed recordings of which all slip, and for recordings of a real sensor whose onsets
// are all unknown, which cannot earn credit.
bool has_score(const Score& score, const TestSet& test_set) {
  if (!test_set.disturbance.empty()) return score.judged > 0;
  return test_set.track != Track::transfer || score.credited > 0;
}

// Index of the threshold with the greatest score of the trials that `uses` selects, or with the
// greatest balanced accuracy of their samples if these have no score; among equal ones the greatest
// threshold.
std::size_t best_factor(const Board& board, const EntrantResults& entry, const std::function<bool(std::size_t)>& uses) {
  const std::size_t factors = threshold_factors().size();
  std::size_t best = 0;
  double greatest = -std::numeric_limits<double>::infinity();
  for (std::size_t place = 0; place < factors; ++place) {
    std::vector<Part> parts;
    Confusion frames{};
    for (std::size_t k = 0; k < entry.answers.size(); ++k) {
      if (!uses(k)) continue;
      const eval::Judgement& judgement = entry.answers[k].at[place].judgement;
      parts.push_back(recording_part(judgement, board.test_set));
      add(frames, judgement.frames);
    }
    const Score score = score_of(parts, board.test_set);
    const double value = has_score(score, board.test_set) ? score.value : balanced_slip_accuracy(frames);
    if (value > greatest) best = place;
    greatest = std::max(greatest, value);
  }
  return best;
}

// Gives each yardstick that chooses its threshold the one that is best on the other half of the
// trials; pairs of trials alternate, since they share a motion. If a half has no slip that can earn
// credit, one threshold is chosen on all trials. Returns the best of them with the threshold that is
// best on all trials; nullopt without a yardstick that chooses.
std::optional<Entrant> choose_thresholds(Board& board) {
  const std::vector<double> factors = threshold_factors();
  std::optional<Entrant> best;
  double best_score = -std::numeric_limits<double>::infinity();
  for (EntrantResults& entry : board.entries) {
    if (!entry.entrant->chooses_threshold) continue;
    const auto half = [](std::size_t trial) { return trial / 2 % 2; };
    const auto has_credit = [&](std::size_t wanted) {
      for (std::size_t k = 0; k < entry.answers.size(); ++k) {
        if (half(k) == wanted && recording_part(entry.answers[k].judgement, board.test_set).credited) return true;
      }
      return false;
    };
    // A half without slip would choose never to report it.
    const bool by_halves = has_credit(0) && has_credit(1);
    const double whole =
        eval::default_threshold(entry.entrant->detector) * factors[best_factor(board, entry, [](std::size_t) { return true; })];
    std::array<std::size_t, 2> place{};
    for (const std::size_t own : {0U, 1U}) {
      place.at(own) = best_factor(board, entry, [&](std::size_t trial) { return !by_halves || half(trial) != own; });
      if (own == 0 || by_halves)
        entry.thresholds.push_back(eval::default_threshold(entry.entrant->detector) * factors[place.at(own)]);
    }
    for (std::size_t k = 0; k < entry.answers.size(); ++k) {
      Answer& answer = entry.answers[k];
      Answer chosen = std::move(answer.at[place.at(half(k))]);
      // The area under the curve does not depend on the threshold.
      chosen.judgement.positives = std::move(answer.judgement.positives);
      chosen.judgement.negatives = std::move(answer.judgement.negatives);
      chosen.judgement.twin = std::move(answer.judgement.twin);
      answer = std::move(chosen);
    }
    const double score = score_of(parts_of(board, entry), board.test_set).value;
    if (score > best_score) best = with_threshold(*entry.entrant, whole);
    best_score = std::max(score, best_score);
  }
  return best;
}

Json grasps_json(const EntrantResults& entry) {
  std::size_t dropped = 0, not_lifted = 0;
  std::vector<double> force, slip;
  for (const Answer& answer : entry.answers) {
    const GraspOutcome& grasp = *answer.grasp;
    dropped += grasp.dropped ? 1U : 0U;
    not_lifted += grasp.not_lifted() ? 1U : 0U;
    if (!grasp.held()) continue;
    force.push_back(grasp.max_grip_force / grasp.ideal_grip_force);
    slip.push_back(grasp.slip_translation);
  }
  const Interval share = clopper_pearson(dropped + not_lifted, entry.answers.size());
  return {{"trials", entry.answers.size()},
          {"dropped", dropped},
          {"not_lifted", not_lifted},
          {"low", share.low},
          {"high", share.high},
          {"force_ratio", or_null(median(force))},
          {"slip_m", or_null(median(slip))}};
}

Json windows_json(const EntrantResults& entry) {
  WindowCounts sum;
  for (const Answer& answer : entry.answers) sum.add(answer.windows);
  const auto share = [](std::size_t part, std::size_t whole) {
    return whole == 0 ? Json(nullptr) : Json(static_cast<double>(part) / static_cast<double>(whole));
  };
  return {{"length_s", window_length},
          {"slipping", sum.slipping},
          {"sticking", sum.sticking},
          {"recall", share(sum.detected, sum.slipping)},
          {"specificity", share(sum.unreported, sum.sticking)}};
}

Json row_json(const Board& board, const EntrantResults& entry) {
  const std::vector<Part> parts = parts_of(board, entry);
  const Score score = score_of(parts, board.test_set);
  const Interval interval = score_interval(parts, board.test_set);
  std::vector<eval::Judgement> judgements;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const eval::Judgement& judgement = entry.answers[k].judgement;
    // A slip that earns nothing is neither missed nor seen late.
    const bool too_small =
        !entry.answers[k].grasp && !parts[k].credited && judgement.onset_known && !std::isnan(judgement.slip_time);
    if (parts[k].judged && !too_small) judgements.push_back(judgement);
  }
  const bool scored = has_score(score, board.test_set);
  Json row = {{"rank", nullptr},
              {"detector", entry.entrant->name},
              {"kind", kind_word(entry.entrant->kind)},
              {"sensor", entry.sensor_name},
              {"parameters", entry.entrant->parameters},
              {"sha256", entry.entrant->sha256},
              {"score",
               {{"value", scored ? Json(score.value) : Json(nullptr)},
                {"low", scored ? or_null(interval.low) : Json(nullptr)},
                {"high", scored ? or_null(interval.high) : Json(nullptr)}}},
              {"credit", board.test_set.track != Track::transfer || scored ? Json(score.credit) : Json(nullptr)},
              {"false_alarms_per_minute", score.alarms_per_minute},
              {"reported_share", score.reported_share},
              {"figures", eval::summary_json(eval::summarised(judgements))}};
  if (!entry.thresholds.empty()) row["thresholds"] = entry.thresholds;
  if (board.test_set.track == Track::open) row["false_share"] = score.false_share;
  if (board.test_set.track == Track::loop) row["needless"] = score.needless;
  if (!board.test_set.disturbance.empty()) {
    row["specificity"] = scored ? Json(score.specificity) : Json(nullptr);
    row["judged"] = score.judged;
  }
  if (entry.answers.front().grasp) row["grasps"] = grasps_json(entry);
  if (board.test_set.track == Track::transfer) row["windows"] = windows_json(entry);
  return row;
}

// Returns a swept value as a scene writes it: "2 mm/s".
std::string value_text(const std::string& path, const Json& drawn) {
  const Json plain = report::plain_value(path, drawn);
  if (plain.contains("text")) return plain.at("text").get<std::string>();
  const double value = plain.at("value").is_null() ? std::numeric_limits<double>::infinity() : plain.at("value").get<double>();
  const std::string unit = plain.at("unit").get<std::string>();
  return format_quantity(value, unit.empty() ? Quantity::none : quantity_of("1 " + unit));
}

// Returns the scores by each parameter that the grid varies: values that repeat and are not lists
// or maps.
Json groups_json(const Board& board) {
  using Groups = std::vector<std::pair<std::string, std::vector<std::size_t>>>;  // in the order of the grid
  std::map<std::string, Groups> by;
  for (std::size_t k = 0; k < board.params.size(); ++k) {
    const Json params = Json::parse(board.params[k]);
    for (const auto& [path, value] : params.items()) {
      if (!value.is_primitive()) continue;
      const std::string text = value_text(path, value);
      Groups& groups = by[path];
      auto group = std::ranges::find(groups, text, &Groups::value_type::first);
      if (group == groups.end()) group = groups.insert(group, {text, {}});
      group->second.push_back(k);
    }
  }
  Json json = Json::array();
  for (const auto& [path, groups] : by) {
    if (groups.size() < 2 || groups.size() > most_groups) continue;
    Json list = Json::array();
    for (const auto& [name, trials] : groups) {
      Json scores = Json::array();
      for (const EntrantResults& entry : board.entries) {
        const std::vector<Part> all = parts_of(board, entry);
        std::vector<Part> of_group;
        for (const std::size_t k : trials) of_group.push_back(all[k]);
        const Score score = score_of(of_group, board.test_set);
        scores.push_back(score.judged > 0 ? Json(score.value) : Json(nullptr));
      }
      list.push_back({{"name", name}, {"trials", trials.size()}, {"scores", std::move(scores)}});
    }
    json.push_back({{"by", path}, {"groups", std::move(list)}});
  }
  return json;
}

// The best yardstick of each type of sensor, with the threshold chosen on its first open recordings.
using Yardsticks = std::map<std::string, Entrant>;

// Adds rows, left_out and by to the description of a set.
Json board_json(Json json, Board board, Yardsticks& yardsticks) {
  remove_unfit_entries(board);
  if (std::optional<Entrant> best = choose_thresholds(board)) yardsticks.try_emplace(board.test_set.sensor, std::move(*best));
  const auto value = [&board](const EntrantResults& entry) { return score_of(parts_of(board, entry), board.test_set).value; };
  std::ranges::stable_sort(board.entries, [&](const EntrantResults& a, const EntrantResults& b) {
    return std::pair(-value(a), a.entrant->name) < std::pair(-value(b), b.entrant->name);
  });
  json["rows"] = Json::array();
  std::size_t place = 0, rank = 0;
  double last = std::numeric_limits<double>::infinity();
  for (const EntrantResults& entry : board.entries) {
    Json row = row_json(board, entry);
    if (is_ranked(*entry.entrant, board.test_set) && !row.at("score").at("value").is_null()) {
      ++place;
      if (value(entry) < last) rank = place;  // equal scores share a rank
      last = value(entry);
      row["rank"] = rank;
    }
    json["rows"].push_back(std::move(row));
  }
  json["left_out"] = Json::array();
  for (const OmittedDetector& one : board.left_out)
    json["left_out"].push_back({{"detector", one.detector}, {"why", one.why}, {"reads_another", one.reads_another}});
  json["by"] = board.params.empty() ? Json::array() : groups_json(board);
  return json;
}

// Returns the trials to judge: all (`wanted` = 0), or some spread evenly over the plan.
std::vector<std::size_t> chosen_trials(std::size_t planned, std::size_t wanted) {
  const std::size_t count = wanted == 0 ? planned : std::min(wanted, planned);
  std::vector<std::size_t> trials;
  for (std::size_t k = 0; k < count; ++k) trials.push_back(k * planned / count);
  return trials;
}

std::vector<std::size_t> places_of(const std::vector<std::string>& names, const TrialRecord& record) {
  std::vector<std::size_t> places;
  for (const std::string& name : names) {
    const auto found = std::ranges::find(record.sensors, name, &SensorRecord::name);
    places.push_back(static_cast<std::size_t>(found - record.sensors.begin()));
  }
  return places;
}

// Does `count` pieces of work on options.jobs threads and passes the results on in order.
template <class Result>
void in_order(std::size_t count, const Options& options, const std::function<Result(std::size_t)>& work,
              const std::function<void(Result&&)>& take) {
  const std::size_t threads =
      std::min(count, options.jobs > 0 ? options.jobs : std::max<std::size_t>(1, std::thread::hardware_concurrency()));
  OrderedWorkers<Result> workers(
      count, threads, [&work] { return work; }, options.interrupt);
  for (std::size_t k = 0; k < count; ++k) {
    std::optional<Result> result = workers.next();
    if (!result) throw Interrupted();
    take(std::move(*result));
  }
}

// The simulated trials of the sets that share a scene.
struct TestSetTrials {
  // `protocol`: all sensors that some set of it reads are recorded, so that a recording's digest
  // does not depend on which sensors are judged.
  TestSetTrials(const TestSet& first, std::size_t request, const Protocol& protocol, const Catalogues& catalogues)
      : read(read_sweep(sweep_of(first), catalogues)), numbers(chosen_trials(read.planned.plan.size(), request)) {
    for (const TestSet& test_set : protocol.held_out) {
      if (test_set.scene == first.scene) readers.insert(test_set.readers.begin(), test_set.readers.end());
    }
    // A part of the pairs has one recording with slip, one without, and so on.
    if (request > 0 && request < plan().size() && first.track == Track::open && first.disturbance.empty()) {
      for (std::size_t k = 0; k < numbers.size(); ++k) numbers[k] ^= (k + 1) % 2;
    }
  }

  static SweepOptions sweep_of(const TestSet& test_set) {
    SweepOptions sweep;
    sweep.scene_path = project_file(test_set.scene);
    return sweep;
  }
  [[nodiscard]] const TrialPlan& plan() const { return read.planned.plan; }
  // Simulates a trial; `sticks`: on a surface on which nothing slips.
  [[nodiscard]] TrialRecord recorded(std::size_t number, bool sticks = false) const {
    TrialPlan::Trial planned = plan().trial(number);
    if (sticks) planned.scene = without_slip(planned.scene);
    // A sensor that follows another's contact, or is on a stage, does not change the others.
    const bool carries = planned.scene.dynamic();
    std::erase_if(planned.scene.sensors, [&](const SensorScene& sensor) {
      return !readers.contains(sensor.name) && !(carries && sensor.follows.empty());
    });
    TrialRecord record = run_trial(planned.scene, number, Recording::full).record;
    record.params = params_json(planned.drawn);
    return record;
  }

  ReadSweep read;
  std::vector<std::size_t> numbers;
  std::set<std::string> readers;  // names of the sensors that detectors may read
};

// Replays the same recordings to all detectors.
void judge_recordings(std::vector<Board>& boards, const TestSetTrials& trials, const Options& options) {
  struct Judged {
    std::vector<std::vector<Answer>> answers;  // [board][entry]
    std::string params, digest;
  };
  in_order<Judged>(
      trials.numbers.size(), options,
      [&](std::size_t k) {
        const TrialRecord record = trials.recorded(trials.numbers[k]);
        const Scene scene = trials.plan().trial(trials.numbers[k]).scene;
        Judged judged{{}, record.params, hexadecimal(trial_digest(record))};
        TrialWithoutSlip slipless([&trials, k] { return trials.recorded(trials.numbers[k], true); });
        for (const Board& board : boards) {
          std::vector<Answer>& answers = judged.answers.emplace_back();
          for (const EntrantResults& entry : board.entries)
            answers.push_back(recorded_answer(entry, &board.test_set, &scene, record, rule_of(board.test_set.track), &slipless));
        }
        return judged;
      },
      [&boards](Judged&& judged) {
        for (std::size_t b = 0; b < boards.size(); ++b) {
          for (std::size_t k = 0; k < boards[b].entries.size(); ++k)
            boards[b].entries[k].answers.push_back(std::move(judged.answers[b][k]));
          boards[b].params.push_back(judged.params);
          boards[b].digests.push_back(judged.digest);
        }
      });
}

// Runs the grasps of each detector, with it in the loop.
void judge_grasps(Board& board, const TestSetTrials& trials, const Options& options) {
  for (const std::size_t number : trials.numbers) {
    board.params.push_back(params_json(trials.plan().trial(number).drawn));
    board.digests.push_back(text_sha256(fmt::format("{} {} {}", trials.read.seed, number, board.params.back())));
  }
  const std::size_t entries = board.entries.size();
  std::size_t done = 0;
  in_order<Answer>(
      trials.numbers.size() * entries, options,
      [&](std::size_t k) {
        const std::size_t number = trials.numbers[k / entries];
        return grasp_answer(board.entries[k % entries], board.test_set, trials.plan().trial(number).scene, number);
      },
      [&](Answer&& answer) { board.entries[done++ % entries].answers.push_back(std::move(answer)); });
  const auto tightens_never = [](const EntrantResults& entry) { return entry.entrant->name == never_slip; };
  for (const Answer& answer : std::ranges::find_if(board.entries, tightens_never)->answers) {
    if (!answer.grasp) throw InputError(answer.failure);  // the grasp without tightening failed
    board.untightened.push_back(*answer.grasp);
  }
}

// Returns the entrants that can be judged on a set; nullptr: on recordings of a real sensor.
// `chosen`: a yardstick whose threshold is known enters instead of those that choose one.
std::vector<const Entrant*> entering(const std::vector<Entrant>& entrants, const TestSet* test_set, const Yardsticks& chosen) {
  std::vector<const Entrant*> some;
  const bool has_chosen = test_set != nullptr && chosen.contains(test_set->sensor);
  if (has_chosen) some.push_back(&chosen.at(test_set->sensor));
  for (const Entrant& entrant : entrants) {
    // Only open recordings can choose a threshold.
    if (entrant.chooses_threshold && test_set != nullptr &&
        (has_chosen || test_set->track == Track::loop || !test_set->disturbance.empty()))
      continue;
    if (is_measure(entrant) && test_set == nullptr) continue;
    if (entrant.kind == Kind::known_signal && (test_set->track == Track::loop || !test_set->disturbance.empty())) continue;
    if (entrant.knows_motion && test_set == nullptr) continue;
    if (entrant.reads.empty() || test_set == nullptr || entrant.reads == test_set->sensor) some.push_back(&entrant);
  }
  return some;
}

std::string set_name(const TestSet& test_set) {
  std::string name(track_name(test_set.track));
  for (const std::string& word : {test_set.sensor, test_set.domain, test_set.disturbance})
    name += word.empty() ? "" : ", " + word;
  return name;
}

// Judges the sets that share the trials of one scene.
std::vector<Json> sets_json(std::span<const TestSet> sharing, const Protocol& protocol, const std::vector<Entrant>& entrants,
                            Yardsticks& yardsticks, const Options& options, const Catalogues& catalogues) {
  const TestSetTrials trials(sharing.front(), options.request.trials, protocol, catalogues);
  const TrialRecord first = trials.recorded(trials.numbers.front());
  std::vector<Board> boards;
  for (const TestSet& test_set : sharing) {
    if (options.say) options.say(set_name(test_set));
    add_entries(boards.emplace_back(Board{.test_set = test_set}), entering(entrants, &test_set, yardsticks), first,
                places_of(test_set.readers, first));
  }
  if (sharing.front().track == Track::open)
    judge_recordings(boards, trials, options);
  else
    judge_grasps(boards.front(), trials, options);
  std::vector<Json> sets;
  for (Board& board : boards) {
    const TestSet test_set = board.test_set;
    std::string digests;
    for (const std::string& digest : board.digests) digests += digest + "\n";
    Json json = {{"track", track_name(test_set.track)},
                 {"sensor", test_set.sensor},
                 {"scene", test_set.scene},
                 {"trials", trials.numbers.size()},
                 {"data_sha256", text_sha256(digests)},
                 {"labels", label_rule_name(rule_of(test_set.track))}};
    if (!test_set.domain.empty()) json["domain"] = test_set.domain;
    if (!test_set.disturbance.empty()) json["disturbance"] = test_set.disturbance;
    sets.push_back(board_json(std::move(json), std::move(board), yardsticks));
  }
  return sets;
}

// Judges a dataset of real recordings.
Json transfer_json(const std::string& file, const std::vector<const Entrant*>& entrants, const Options& options) {
  if (options.say) options.say(fmt::format("transfer: {}", file));
  const DatasetReader reader = whole_dataset(file);
  Board board{.test_set = {.track = Track::transfer}};
  std::string digests;
  bool labelled = false;
  for (const std::size_t trial : chosen_trials(reader.trials().size(), 0)) {
    const std::size_t number = reader.trials()[trial];
    reader.check_recorded(number);
    const TrialRecord record = reader.read_trial(number);
    const SensorRecord& sensor = record.sensors.front();
    if (sensor.labels.truth)
      throw InputError(file + ": is a simulation; expected recordings of a real sensor, written by slipbench import");
    if (!options.request.sensor.empty() && sensor.type != options.request.sensor)
      reject("{}: has a {}, but --sensor is {}", file, sensor.type, options.request.sensor);
    // Throws for a recording without labels.
    const std::vector<PadState> states = eval::label_states(sensor, rule_of(Track::transfer), false);
    labelled = labelled || std::ranges::any_of(states, [](PadState state) { return state != unknown_state; });
    board.sensor = sensor.type;
    if (board.digests.empty()) add_entries(board, entrants, record, {0});
    board.digests.push_back(trial_identity(reader, number));
    digests += board.digests.back() + "\n";
    for (EntrantResults& entry : board.entries)
      entry.answers.push_back(recorded_answer(entry, nullptr, nullptr, record, rule_of(Track::transfer)));
  }
  if (!labelled) eval::reject_unlabelled(file);
  Json json = {{"track", track_name(Track::transfer)},
               {"sensor", board.sensor},
               {"file", file},
               {"trials", board.digests.size()},
               {"data_sha256", text_sha256(digests)},
               {"labels", label_rule_name(rule_of(Track::transfer))}};
  // The file may hold text that is not UTF-8.
  Yardsticks of_this_file;
  return Json::parse(
      board_json(std::move(json), std::move(board), of_this_file).dump(-1, ' ', false, Json::error_handler_t::replace));
}

void check_sensor(const std::string& sensor, const Protocol& protocol) {
  std::set<std::string> known;
  for (const TestSet& test_set : protocol.held_out) known.insert(test_set.sensor);
  const std::vector<std::string> names(known.begin(), known.end());
  if (!sensor.empty() && !known.contains(sensor))
    throw InputError("benchmark: unknown sensor " + quote(sensor) + allowed_names(sensor, names));
}

// Throws if two entrants have the same name.
void check_names(const std::vector<Entrant>& entrants) {
  std::set<std::string> names;
  for (const Entrant& entrant : entrants) {
    if (!names.insert(entrant.name).second) throw InputError("benchmark: " + quote(entrant.name) + " is given twice");
  }
}

// Returns the detectors of the command line, those that ship and the controls.
std::vector<Entrant> known_entrants(const BoardRequest& request) {
  std::vector<Entrant> entrants;
  for (const std::string& word : request.detectors) entrants.push_back(given_entrant(word, request.parameters));
  std::vector<Entrant> shipped = shipped_entrants();
  std::ranges::move(yardstick_entrants(), std::back_inserter(shipped));
  for (Entrant& entrant : shipped) {
    // The same detector given on the command line, perhaps with parameters, is listed beside it.
    const auto same = [&](const Entrant& one) { return one.name == entrant.name; };
    if (const auto given = std::ranges::find_if(entrants, same); given != entrants.end()) given->name += ", given";
    entrants.push_back(std::move(entrant));
  }
  for (Entrant& control : control_entrants()) entrants.push_back(std::move(control));
  check_names(entrants);
  return entrants;
}

Json protocol_json(const Protocol& protocol, const BoardRequest& request) {
  return {{"name", protocol.name},
          {"sha256", protocol_sha256(protocol)},
          {"real", protocol.real},
          {"half_delay_s", half_delay},
          {"force_ratio", worst_force_ratio},
          {"half_slip_distance_m", half_slip_distance},
          {"least_slip_distance_m", least_slip_distance},
          {"whole", request.trials == 0 && request.sensor.empty()}};
}

}  // namespace

Json benchmark(const Options& options) {
  const BoardRequest& request = options.request;
  const Protocol protocol = find_protocol(options.protocol, "benchmark");
  check_sensor(request.sensor, protocol);
  check_given_once(request.real, "dataset");
  std::vector<Entrant> entrants = known_entrants(request);
  entrants.push_back(oracle_entrant());
  entrants.push_back(known_signal_entrant());
  const std::vector<Missing> missing = missing_entrants();
  const Catalogues catalogues = program_catalogues();
  Json transfer = Json::array();
  for (const std::string& file : request.real) transfer.push_back(transfer_json(file, entering(entrants, nullptr, {}), options));
  Json sets = Json::array();
  Yardsticks yardsticks;
  std::vector<TestSet> requested_sets;
  std::ranges::copy_if(protocol.held_out, std::back_inserter(requested_sets), [&request](const TestSet& test_set) {
    return request.sensor.empty() || test_set.sensor == request.sensor;
  });
  for (auto test_set = requested_sets.begin(); test_set != requested_sets.end();) {
    const auto next = std::find_if(test_set, requested_sets.end(),
                                   [&test_set](const TestSet& other) { return other.scene != test_set->scene; });
    for (Json& set : sets_json({test_set, next}, protocol, entrants, yardsticks, options, catalogues)) {
      for (const Missing& one : missing) {
        if (set.at("sensor") == one.sensor)
          set["left_out"].push_back({{"detector", one.name}, {"why", one.why}, {"reads_another", false}});
      }
      sets.push_back(std::move(set));
    }
    test_set = next;
  }
  for (Json& set : transfer) sets.push_back(std::move(set));
  Json machine = environment_json();
  machine.erase("load");
  Json result = {{result_key, 1},
                 {"asked", request_json(request)},
                 {"protocol", protocol_json(protocol, request)},
                 {"machine", machine},
                 {"sets", sets}};
  if (request.real.empty())
    result["transfer"] = "no real recordings were given; give them with --real FILE.h5, written by slipbench import";
  return result;
}

}  // namespace slipbench::benchmark
