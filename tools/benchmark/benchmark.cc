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
#include "tools/files/given_once.h"
#include "tools/files/output_file.h"
#include "tools/files/project/project_file.h"
#include "tools/files/reject.h"
#include "tools/registry/program_catalogues.h"
#include "tools/report/report_summary.h"
#include "tools/statistics/descriptive.h"
#include "tools/trial/run_trial.h"
#include "tools/trial/sweep/run_sweep.h"
#include "tools/workers/ordered_workers.h"

namespace slipbench::benchmark {
namespace {

constexpr std::size_t most_groups = 6;

// Open recordings: slip counts from the first part of a unit on; samples that stick again after a slip are
// not judged, since the label rules that detectors are trained with disagree there. Loops: a firmer grip is
// expected to end the report of slip.
eval::TruthRule rule_of(Track track) {
  constexpr std::array rules{eval::TruthRule::masked, eval::TruthRule::micro, eval::TruthRule::recorded};
  return rules.at(static_cast<std::size_t>(track));
}

// The result of an entrant in one trial, or why it could not be judged.
struct Answer {
  eval::Judgement judgement;
  WindowCounts windows;  // of a real recording
  std::optional<GraspOutcome> grasp;
  std::string failure;
};

// An entrant with the sensor that it reads in a set of trials.
struct Seat {
  const Entrant* entrant = nullptr;
  std::size_t sensor = 0;   // index into the trial's sensors
  std::string sensor_name;  // as the scene names it
  std::vector<Answer> answers{};
};

struct LeftOut {
  std::string detector, why;
  bool reads_another = false;  // it reads a sensor that the set does not have
};

// A set of trials and its results.
struct Board {
  Held held{};
  std::vector<Seat> seats{};
  std::vector<LeftOut> left_out{};
  std::vector<std::string> params{};  // JSON for each trial
  std::vector<std::string> digests{};
  std::string sensor{};
  std::vector<GraspOutcome> untightened{};  // outcome of each grasp without tightening
};

DetectorScene told(const Entrant& entrant, const Held& held, const Scene& scene) {
  switch (entrant.told) {
    case Told::nothing: return entrant.detector;
    case Told::motion: return motion_known(scene, held.mover);
    case Told::clock:
    case Told::motion_and_time:
    case Told::speed:
    case Told::travel: return timed_control(entrant.told, held, scene);
  }
  return {};
}

// `scene`: that of the trial, one of `held`; both nullptr for a recording of a real sensor.
DetectorScene detector_for(const Seat& seat, const Held* held, const Scene* scene) {
  DetectorScene detector = scene == nullptr ? seat.entrant->detector : told(*seat.entrant, *held, *scene);
  detector.sensor = seat.sensor;
  return detector;
}

// `held`: nullptr for a recording of a real sensor.
eval::Judgement judged(const Held* held, std::size_t trial, const eval::Truth& truth, const eval::Replayed& replayed) {
  return eval::judged(trial, truth, replayed, held != nullptr && held->grace ? truth.period : 0.0);
}

// The same trial on a surface on which nothing slips, simulated on first use.
class Stuck {
 public:
  explicit Stuck(std::function<TrialRecord()> simulate) : simulate_(std::move(simulate)) {}
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
bool is_ranked(const Entrant& entrant, const Held& held) { return !is_measure(entrant) && held.disturbance.empty(); }

// `stuck`: the same trial without slip; nullptr if no entrant needs it.
Answer recorded_answer(const Seat& seat, const Held* held, const Scene* scene, const TrialRecord& record, eval::TruthRule rule,
                       Stuck* stuck = nullptr) {
  Answer answer;
  try {
    const double from = held == nullptr ? -never : judged_from(*held, *scene);
    const eval::Truth truth = eval::truth_of(scene, record, record.sensors[seat.sensor], rule, from);
    const auto replayed = [&] {
      if (seat.entrant->kind == Kind::oracle) return as_true(truth);
      if (seat.entrant->kind == Kind::known_signal)
        return std::isnan(truth.first_slip) ? silence(truth) : signal_known(record, stuck->record(), seat.sensor, truth);
      return eval::replay(detector_for(seat, held, scene), record.sensors, seat.sensor, record.seed, record.trial);
    };
    const eval::Replayed answers = replayed();
    answer.judgement = judged(held, record.trial, truth, answers);
    if (held == nullptr) answer.windows = window_counts(truth, answers);
  } catch (const InputError& error) {
    answer.failure = fmt::format("trial {}: {}", record.trial, error.what());
  }
  return answer;
}

// Runs a grasp with this detector in the loop.
Answer grasp_answer(const Seat& seat, const Held& held, Scene scene, std::size_t trial) {
  Answer answer;
  try {
    scene.detector = detector_for(seat, &held, &scene);
    const TrialRecord record = run_trial(scene, trial, Recording::full).record;
    const SensorRecord& sensor = record.sensors[seat.sensor];
    eval::Replayed seen;
    for (const std::uint8_t code : record.control->detector_class) seen.seen.push_back(static_cast<PadState>(code));
    seen.seen_since = sensor.time;
    seen.stuck_fraction.assign(sensor.time.size(), std::numeric_limits<double>::quiet_NaN());
    seen.probability = seen.stuck_fraction;
    answer.judgement = judged(&held, trial, eval::truth_of(&scene, record, sensor, rule_of(Track::loop)), seen);
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
void seat_all(Board& board, const std::vector<const Entrant*>& entrants, const TrialRecord& first,
              const std::vector<std::size_t>& readers) {
  for (const Entrant* entrant : entrants) {
    std::string why;
    bool seated = false;
    for (const std::size_t sensor : readers) {
      const Seat seat{entrant, sensor, first.sensors[sensor].name};
      if (!is_measure(*entrant)) {
        try {
          eval::replay(detector_for(seat, nullptr, nullptr), first.sensors, sensor, first.seed, first.trial);
        } catch (const InputError& error) {
          if (why.empty()) why = without_folder(error.what(), file_of(entrant->detector));
          continue;
        }
      }
      board.seats.push_back(seat);
      seated = true;
      break;
    }
    const bool reads_another = entrant->kind == Kind::shipped && entrant->reads != first.sensors[readers.front()].type;
    if (!seated) board.left_out.push_back({entrant->name, why, reads_another});
  }
}

// Leaves out entrants that could not be judged in some trial, or were trained on one.
void clear_seats(Board& board) {
  const auto unfit = [&board](const Seat& seat) {
    std::string why;
    for (const Answer& answer : seat.answers) {
      if (why.empty()) why = answer.failure;
    }
    std::size_t known = 0;
    for (const std::string& digest : board.digests) known += seat.entrant->sha256_seen.count(digest);
    why = without_folder(why, file_of(seat.entrant->detector));
    if (known > 0) why = fmt::format("was trained on {} of the {} trials", known, board.digests.size());
    if (!why.empty()) board.left_out.push_back({seat.entrant->name, why});
    return !why.empty();
  };
  std::erase_if(board.seats, unfit);
}

std::vector<Part> parts_of(const Board& board, const Seat& seat) {
  std::vector<Part> parts;
  for (std::size_t k = 0; k < seat.answers.size(); ++k) {
    const Answer& answer = seat.answers[k];
    parts.push_back(answer.grasp ? grasp_part(answer.judgement, *answer.grasp, board.untightened[k])
                                 : recording_part(answer.judgement, board.held));
  }
  return parts;
}

Json grasps_json(const Seat& seat) {
  std::size_t dropped = 0, not_lifted = 0;
  std::vector<double> force, slip;
  for (const Answer& answer : seat.answers) {
    const GraspOutcome& grasp = *answer.grasp;
    dropped += grasp.dropped ? 1U : 0U;
    not_lifted += grasp.not_lifted() ? 1U : 0U;
    if (!grasp.held()) continue;
    force.push_back(grasp.max_grip_force / grasp.ideal_grip_force);
    slip.push_back(grasp.slip_translation);
  }
  const Interval share = clopper_pearson(dropped + not_lifted, seat.answers.size());
  return {{"trials", seat.answers.size()},
          {"dropped", dropped},
          {"not_lifted", not_lifted},
          {"low", share.low},
          {"high", share.high},
          {"force_ratio", or_null(median(force))},
          {"slip_m", or_null(median(slip))}};
}

Json windows_json(const Seat& seat) {
  WindowCounts sum;
  for (const Answer& answer : seat.answers) sum.add(answer.windows);
  const auto share = [](std::size_t part, std::size_t whole) {
    return whole == 0 ? Json(nullptr) : Json(static_cast<double>(part) / static_cast<double>(whole));
  };
  return {{"length_s", window_length},
          {"slipping", sum.slipping},
          {"sticking", sum.sticking},
          {"recall", share(sum.detected, sum.slipping)},
          {"specificity", share(sum.silent, sum.sticking)}};
}

Json row_json(const Board& board, const Seat& seat) {
  const std::vector<Part> parts = parts_of(board, seat);
  const Score score = score_of(parts, board.held);
  const Interval interval = score_interval(parts, board.held);
  std::vector<eval::Judgement> judgements;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const eval::Judgement& judgement = seat.answers[k].judgement;
    // By slip-3 a slip that earns nothing is neither missed nor seen late.
    const bool too_small =
        board.held.by_distance && !seat.answers[k].grasp && !parts[k].credited && !std::isnan(judgement.slip_time);
    if (parts[k].judged && !too_small) judgements.push_back(judgement);
  }
  const bool has_score = board.held.disturbance.empty() || score.judged > 0;
  Json row = {{"rank", nullptr},
              {"detector", seat.entrant->name},
              {"kind", kind_word(seat.entrant->kind)},
              {"sensor", seat.sensor_name},
              {"parameters", seat.entrant->parameters},
              {"sha256", seat.entrant->sha256},
              {"score",
               {{"value", has_score ? Json(score.value) : Json(nullptr)},
                {"low", has_score ? or_null(interval.low) : Json(nullptr)},
                {"high", has_score ? or_null(interval.high) : Json(nullptr)}}},
              {"credit", score.credit},
              {"false_alarms_per_minute", score.alarms_per_minute},
              {"said", score.said},
              {"figures", eval::summary_json(eval::summarised(judgements))}};
  if (board.held.needless) row["needless"] = score.needless;
  if (!board.held.disturbance.empty()) {
    row["specificity"] = has_score ? Json(score.specificity) : Json(nullptr);
    row["judged"] = score.judged;
  }
  if (seat.answers.front().grasp) row["grasps"] = grasps_json(seat);
  if (board.held.track == Track::transfer) row["windows"] = windows_json(seat);
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

// Returns the scores by each parameter that the grid varies: values that repeat and are not lists or maps.
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
      for (const Seat& seat : board.seats) {
        const std::vector<Part> all = parts_of(board, seat);
        std::vector<Part> of_group;
        for (const std::size_t k : trials) of_group.push_back(all[k]);
        const Score score = score_of(of_group, board.held);
        scores.push_back(score.judged > 0 ? Json(score.value) : Json(nullptr));
      }
      list.push_back({{"name", name}, {"trials", trials.size()}, {"scores", std::move(scores)}});
    }
    json.push_back({{"by", path}, {"groups", std::move(list)}});
  }
  return json;
}

// Adds rows, left_out and by to the description of a set.
Json board_json(Json json, Board board) {
  clear_seats(board);
  const auto value = [&board](const Seat& seat) { return score_of(parts_of(board, seat), board.held).value; };
  std::ranges::stable_sort(board.seats, [&](const Seat& a, const Seat& b) {
    return std::pair(-value(a), a.entrant->name) < std::pair(-value(b), b.entrant->name);
  });
  json["rows"] = Json::array();
  std::size_t place = 0, rank = 0;
  double last = std::numeric_limits<double>::infinity();
  for (const Seat& seat : board.seats) {
    Json row = row_json(board, seat);
    if (is_ranked(*seat.entrant, board.held)) {
      ++place;
      if (value(seat) < last) rank = place;  // equal scores share a rank
      last = value(seat);
      row["rank"] = rank;
    }
    json["rows"].push_back(std::move(row));
  }
  json["left_out"] = Json::array();
  for (const LeftOut& one : board.left_out)
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
struct HeldTrials {
  // `protocol`: all sensors that some set of it reads are recorded, so that a recording's digest does not
  // depend on which sensors are judged.
  HeldTrials(const Held& first, std::size_t asked, const Protocol& protocol, const Catalogues& catalogues)
      : read(read_sweep(sweep_of(first), catalogues)), numbers(chosen_trials(read.planned.plan.size(), asked)) {
    for (const Held& held : protocol.held_out) {
      if (held.scene == first.scene) readers.insert(held.readers.begin(), held.readers.end());
    }
    // A part of the pairs of slip-3 has one with slip, one without, and so on.
    if (asked > 0 && asked < plan().size() && first.pulses() && first.disturbance.empty()) {
      for (std::size_t k = 0; k < numbers.size(); ++k) numbers[k] ^= (k + 1) % 2;
    }
  }

  static SweepOptions sweep_of(const Held& held) {
    SweepOptions sweep;
    sweep.scene_path = project_file(held.scene);
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
void judge_recordings(std::vector<Board>& boards, const HeldTrials& trials, const Options& options) {
  struct Judged {
    std::vector<std::vector<Answer>> answers;  // [board][seat]
    std::string params, digest;
  };
  in_order<Judged>(
      trials.numbers.size(), options,
      [&](std::size_t k) {
        const TrialRecord record = trials.recorded(trials.numbers[k]);
        const Scene scene = trials.plan().trial(trials.numbers[k]).scene;
        Judged judged{{}, record.params, hexadecimal(trial_digest(record))};
        Stuck stuck([&trials, k] { return trials.recorded(trials.numbers[k], true); });
        for (const Board& board : boards) {
          std::vector<Answer>& answers = judged.answers.emplace_back();
          for (const Seat& seat : board.seats)
            answers.push_back(recorded_answer(seat, &board.held, &scene, record, rule_of(board.held.track), &stuck));
        }
        return judged;
      },
      [&boards](Judged&& judged) {
        for (std::size_t b = 0; b < boards.size(); ++b) {
          for (std::size_t k = 0; k < boards[b].seats.size(); ++k)
            boards[b].seats[k].answers.push_back(std::move(judged.answers[b][k]));
          boards[b].params.push_back(judged.params);
          boards[b].digests.push_back(judged.digest);
        }
      });
}

// Runs the grasps of each detector, with it in the loop.
void judge_grasps(Board& board, const HeldTrials& trials, const Options& options) {
  for (const std::size_t number : trials.numbers) {
    board.params.push_back(params_json(trials.plan().trial(number).drawn));
    board.digests.push_back(text_sha256(fmt::format("{} {} {}", trials.read.seed, number, board.params.back())));
  }
  const std::size_t seats = board.seats.size();
  std::size_t done = 0;
  in_order<Answer>(
      trials.numbers.size() * seats, options,
      [&](std::size_t k) {
        const std::size_t number = trials.numbers[k / seats];
        return grasp_answer(board.seats[k % seats], board.held, trials.plan().trial(number).scene, number);
      },
      [&](Answer&& answer) { board.seats[done++ % seats].answers.push_back(std::move(answer)); });
  const auto tightens_never = [](const Seat& seat) { return seat.entrant->name == never_slip; };
  for (const Answer& answer : std::ranges::find_if(board.seats, tightens_never)->answers) {
    if (!answer.grasp) throw InputError(answer.failure);  // the grasp without tightening failed
    board.untightened.push_back(*answer.grasp);
  }
}

// Returns the entrants that can be judged on a set; nullptr: on recordings of a real sensor.
std::vector<const Entrant*> entering(const std::vector<Entrant>& entrants, const Held* held) {
  std::vector<const Entrant*> some;
  for (const Entrant& entrant : entrants) {
    // Before slip-3 open recordings have no oracle.
    if (entrant.kind == Kind::oracle && (held == nullptr || (held->track == Track::open && !held->by_distance))) continue;
    if (entrant.kind == Kind::known_signal &&
        (held == nullptr || !held->by_distance || held->track == Track::loop || !held->disturbance.empty()))
      continue;
    if (held == nullptr ? entrant.told != Told::nothing : !can_be_told(entrant, *held)) continue;
    if (entrant.reads.empty() || held == nullptr || entrant.reads == held->sensor) some.push_back(&entrant);
  }
  return some;
}

std::string set_name(const Held& held) {
  std::string name(track_name(held.track));
  for (const std::string& word : {held.sensor, held.domain, held.disturbance}) name += word.empty() ? "" : ", " + word;
  return name;
}

// Judges the sets that share the trials of one scene.
std::vector<Json> sets_json(std::span<const Held> sharing, const Protocol& protocol, const std::vector<Entrant>& entrants,
                            const Options& options, const Catalogues& catalogues) {
  const HeldTrials trials(sharing.front(), options.asked.trials, protocol, catalogues);
  const TrialRecord first = trials.recorded(trials.numbers.front());
  std::vector<Board> boards;
  for (const Held& held : sharing) {
    if (options.say) options.say(set_name(held));
    seat_all(boards.emplace_back(Board{.held = held}), entering(entrants, &held), first, places_of(held.readers, first));
  }
  if (sharing.front().track == Track::open)
    judge_recordings(boards, trials, options);
  else
    judge_grasps(boards.front(), trials, options);
  std::vector<Json> sets;
  for (Board& board : boards) {
    const Held held = board.held;
    std::string digests;
    for (const std::string& digest : board.digests) digests += digest + "\n";
    Json json = {{"track", track_name(held.track)},
                 {"sensor", held.sensor},
                 {"scene", held.scene},
                 {"trials", trials.numbers.size()},
                 {"data_sha256", text_sha256(digests)},
                 {"labels", eval::label_rule_name(rule_of(held.track))}};
    if (!held.domain.empty()) json["domain"] = held.domain;
    if (!held.disturbance.empty()) json["disturbance"] = held.disturbance;
    sets.push_back(board_json(std::move(json), std::move(board)));
  }
  return sets;
}

// Judges a dataset of real recordings.
Json transfer_json(const std::string& file, const std::vector<const Entrant*>& entrants, const Options& options) {
  if (options.say) options.say(fmt::format("transfer: {}", file));
  const DatasetReader reader = whole_dataset(file);
  Board board{.held = {.track = Track::transfer}};
  std::string digests;
  for (const std::size_t trial : chosen_trials(reader.trials().size(), 0)) {
    const std::size_t number = reader.trials()[trial];
    reader.check_recorded(number);
    const TrialRecord record = reader.read_trial(number);
    const SensorRecord& sensor = record.sensors.front();
    if (sensor.labels.truth)
      throw InputError(file + ": is a simulation; expected recordings of a real sensor, written by slipbench import");
    if (!options.asked.sensor.empty() && sensor.type != options.asked.sensor)
      reject("{}: has a {}, but --sensor is {}", file, sensor.type, options.asked.sensor);
    // Throws for a recording without labels.
    eval::label_states(sensor, rule_of(Track::transfer), false);
    board.sensor = sensor.type;
    if (board.digests.empty()) seat_all(board, entrants, record, {0});
    board.digests.push_back(trial_identity(reader, number));
    digests += board.digests.back() + "\n";
    for (Seat& seat : board.seats)
      seat.answers.push_back(recorded_answer(seat, nullptr, nullptr, record, rule_of(Track::transfer)));
  }
  Json json = {{"track", track_name(Track::transfer)},
               {"sensor", board.sensor},
               {"file", file},
               {"trials", board.digests.size()},
               {"data_sha256", text_sha256(digests)},
               {"labels", eval::label_rule_name(rule_of(Track::transfer))}};
  // The file may hold text that is not UTF-8.
  return Json::parse(board_json(std::move(json), std::move(board)).dump(-1, ' ', false, Json::error_handler_t::replace));
}

void check_sensor(const std::string& sensor, const Protocol& protocol) {
  std::set<std::string> known;
  for (const Held& held : protocol.held_out) known.insert(held.sensor);
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
std::vector<Entrant> known_entrants(const Asked& asked) {
  std::vector<Entrant> entrants;
  for (const std::string& word : asked.detectors) entrants.push_back(given_entrant(word, asked.parameters));
  register_control();  // not in the catalogue that users see
  for (Entrant& entrant : shipped_entrants()) {
    // The same detector given on the command line, perhaps with parameters, is listed beside it.
    const auto same = [&](const Entrant& one) { return one.name == entrant.name; };
    if (const auto given = std::ranges::find_if(entrants, same); given != entrants.end()) given->name += ", given";
    entrants.push_back(std::move(entrant));
  }
  for (Entrant& control : control_entrants()) entrants.push_back(std::move(control));
  check_names(entrants);
  return entrants;
}

Json protocol_json(const Protocol& protocol, const Asked& asked) {
  return {{"name", protocol.name},
          {"sha256", protocol_sha256(protocol)},
          {"half_delay_s", half_delay},
          {"alarms_per_minute", alarm_limit},
          {"force_ratio", worst_force_ratio},
          {"half_slip_distance_m", half_slip_distance},
          {"least_slip_distance_m", least_slip_distance},
          {"whole", asked.trials == 0 && !asked.untaught && asked.sensor.empty()}};
}

}  // namespace

Json benchmark(const Options& options) {
  const Asked& asked = options.asked;
  const Protocol& protocol = find_protocol(options.protocol, "benchmark");
  check_sensor(asked.sensor, protocol);
  check_given_once(asked.real, "dataset");
  std::vector<Entrant> entrants = known_entrants(asked);
  const ScratchFolder folder;
  Taught taught;
  if (!asked.untaught) {
    taught =
        teach(protocol.lessons,
              {.sensor = asked.sensor, .jobs = options.jobs, .interrupt = options.interrupt, .say = options.say}, folder.path());
    for (Entrant& entrant : taught.entrants) entrants.push_back(std::move(entrant));
  }
  entrants.push_back(oracle_entrant());
  entrants.push_back(known_signal_entrant());
  std::vector<Missing> missing = missing_entrants();
  missing.insert(missing.end(), taught.untaught.begin(), taught.untaught.end());
  const Catalogues catalogues = program_catalogues();
  Json transfer = Json::array();
  for (const std::string& file : asked.real) transfer.push_back(transfer_json(file, entering(entrants, nullptr), options));
  Json sets = Json::array();
  std::vector<Held> asked_for;
  std::ranges::copy_if(protocol.held_out, std::back_inserter(asked_for),
                       [&asked](const Held& held) { return asked.sensor.empty() || held.sensor == asked.sensor; });
  for (auto held = asked_for.begin(); held != asked_for.end();) {
    const auto next = std::find_if(held, asked_for.end(), [&held](const Held& other) { return other.scene != held->scene; });
    for (Json& set : sets_json({held, next}, protocol, entrants, options, catalogues)) {
      for (const Missing& one : missing) {
        if (set.at("sensor") == one.sensor)
          set["left_out"].push_back({{"detector", one.name}, {"why", one.why}, {"reads_another", false}});
      }
      sets.push_back(std::move(set));
    }
    held = next;
  }
  for (Json& set : transfer) sets.push_back(std::move(set));
  Json machine = environment_json();
  machine.erase("load");
  Json result = {{result_key, 1},      {"asked", asked_json(asked)}, {"protocol", protocol_json(protocol, asked)},
                 {"machine", machine}, {"learnt_from", taught.data}, {"sets", sets}};
  if (asked.real.empty())
    result["transfer"] = "no real recordings were given; give them with --real FILE.h5, written by slipbench import";
  return result;
}

}  // namespace slipbench::benchmark
