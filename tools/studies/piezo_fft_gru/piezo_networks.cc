#include "tools/studies/piezo_fft_gru/piezo_networks.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/core/pad_state.h"
#include "tools/base/files/reject.h"
#include "tools/program/train/recipes/recipe.h"

namespace slipbench::reproduce {
namespace {

using train::LabelRule;

constexpr std::size_t epochs = 200;        // published
constexpr double shown = 0.8, kept = 0.8;  // shares: of the recordings that are learnt from, and of these that do not validate

// But for the steps, which the number of recordings decides.
train::TrainingOptions published_training() {
  return {.batch = 32, .clip = 128, .optimiser = train::Optimiser::rmsprop, .learning_rate = 8e-4};
}

void check_folds(const std::vector<PiezoRecording>& recordings) {
  const auto refuse_below = [](auto count, const char* what) {
    if (static_cast<std::size_t>(count) >= fold_count) return;
    reject("{} {} make no {} folds; allowed: {} or more", count, what, fold_count, fold_count);
  };
  const auto slips = [](const std::vector<std::uint8_t>& label) { return std::ranges::find(label, 1) != label.end(); };
  refuse_below(std::ranges::count(recordings, false, &PiezoRecording::motors_only), "recordings with contact");
  refuse_below(std::ranges::count_if(recordings, [&](const auto& one) { return slips(one.inputs.front().truth); }),
               "recordings that slip by the true label");
  refuse_below(std::ranges::count_if(recordings, [&](const auto& one) { return slips(one.inputs.front().paper); }),
               "recordings that slip by the position label");
}

// `before` copies of the first frame before, `after` of the last one behind; their labels are masked.
train::FrameSequence padded(const train::FrameSequence& sequence, std::size_t inputs, std::size_t before, std::size_t after) {
  train::FrameSequence whole;
  const auto width = static_cast<std::ptrdiff_t>(inputs);
  for (std::size_t k = 0; k < before; ++k)
    whole.features.insert(whole.features.end(), sequence.features.begin(), sequence.features.begin() + width);
  whole.features.insert(whole.features.end(), sequence.features.begin(), sequence.features.end());
  for (std::size_t k = 0; k < after; ++k)
    whole.features.insert(whole.features.end(), sequence.features.end() - width, sequence.features.end());
  whole.label.assign(before + after, train::masked);
  whole.label.insert(whole.label.end(), sequence.label.begin(), sequence.label.end());
  return whole;
}

// The calls of one fold one after the other, as a child process hands them over; and each recording's.
std::vector<std::uint8_t> joined(const train::Calls& calls) {
  std::vector<std::uint8_t> all;
  for (const std::vector<std::uint8_t>& one : calls) all.insert(all.end(), one.begin(), one.end());
  return all;
}
train::Calls split(const std::vector<std::uint8_t>& all, const std::vector<train::FoldExample>& examples,
                   const std::vector<std::size_t>& fold_of, std::size_t fold) {
  train::Calls calls(examples.size());
  auto next = all.begin();
  for (std::size_t i = 0; i < examples.size(); ++i) {
    if (fold_of[i] != fold) continue;
    const auto end = next + static_cast<std::ptrdiff_t>(examples[i].frames.label.size());
    calls[i].assign(next, end);
    next = end;
  }
  return calls;
}

Confusion all_of(const GroupCounts& fold) {
  Confusion all = fold[with_slip];
  add(all, fold[motors_alone]);
  return all;
}

template <class Of>
MeanSd over(const std::vector<GroupCounts>& folds, Of&& of) {
  std::vector<double> values;
  for (const GroupCounts& fold : folds) values.push_back(of(fold));
  return mean_sd(values);
}

template <class Of>
NetworkFigures figures_over(const std::vector<GroupCounts>& folds, Of&& counts) {
  return {over(folds, [&](const GroupCounts& fold) { return 100.0 * balanced_slip_accuracy(counts(fold)); }),
          over(folds, [&](const GroupCounts& fold) { return f1_of_slip(counts(fold)); })};
}

constexpr const char* level_path = "motion.vibration";

// A tip is its friction, stiffness, shape and effects: all that the sweep varies but the motion.
std::string tip_of(const Json& swept) {
  std::string tip;
  for (const auto& [path, value] : swept.items()) {
    if (!path.starts_with("motion.")) tip += fmt::format("{}{}={}", tip.empty() ? "" : " ", path, value.dump());
  }
  return tip;
}

// NaN: was not swept, or is no number.
double swept_number(const Json& swept, const char* path) {
  const auto found = swept.find(path);
  return found != swept.end() && found->is_number() ? found->get<double>() : std::numeric_limits<double>::quiet_NaN();
}

// Sum of the speeds along the axes of what moves at time t [m/s].
double bench_speed(const TrialRecord& record, double t) {
  const auto row = std::ranges::upper_bound(record.body_time, t) - record.body_time.begin() - 1;
  double speed = 0.0;
  if (row < 0) return speed;
  for (const BodyRecord& body : record.bodies) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      speed += std::abs(double{body.velocity[6 * static_cast<std::size_t>(row) + axis]});
  }
  return speed;
}

// [T, told.values()]
std::vector<float> told_features(const PiezoRecording& recording, const Told& told) {
  std::vector<float> features;
  for (std::size_t k = 0; k < recording.time.size(); ++k) {
    if (told.time) features.push_back(static_cast<float>(recording.time[k]));
    if (told.contact) features.push_back(recording.contact[k]);
    if (told.motors) features.push_back(recording.motors[k]);
    if (told.kind) features.push_back(recording.motors_only ? 1.0F : 0.0F);
  }
  return features;
}

}  // namespace

NetworkRow row_of(const char* name, const char* text, const char* recipe, double f1, double accuracy) {
  const train::Recipe& published = train::find_recipe(recipe);
  return {.name = name, .text = text, .shape = published.network, .training = published.training, .f1 = f1, .accuracy = accuracy};
}
NetworkRow mlp_32() { return row_of("mlp_32", "FFT, MLP 32", "piezo_mlp", 0.7913, 88.76); }
NetworkRow gru_32() { return row_of("gru_32", "FFT, GRU 32", "piezo_fft_gru", 0.9781, 98.70); }

train::Validation StudySize::training(const NetworkRow& row, std::uint64_t seed) const {
  train::Validation validation{row.shape, full ? published_training() : row.training};
  validation.training.seed = seed;
  if (!full) return validation;
  const auto epoch = static_cast<std::size_t>(shown * kept * static_cast<double>(recordings)) / validation.training.batch;
  validation.training.validate_every = std::max<std::size_t>(epoch, 1);
  validation.training.steps = epochs * validation.training.validate_every;
  validation.validated = 1.0 - kept;
  return validation;
}

StudySize size_of(const ReproduceOptions& options, std::size_t usual) {
  if (!train::networks_available()) static_cast<void>(train::network_libraries());  // says what is missing before anything is run
  if (!options.data.empty() && options.trials != 0)
    throw InputError("reproduce: --trials is for recordings that are made; allowed: --data alone");
  StudySize size{options.trials != 0 ? options.trials : options.full ? published_recordings : usual, options.full};
  if (size.recordings < 2 * fold_count || size.recordings % 2 != 0) {
    reject(
        "reproduce: --trials {}: half of the recordings of a level have contact, and {} folds need one each; allowed: even numbers, {} or more",
        size.recordings, fold_count, 2 * fold_count);
  }
  return size;
}

std::vector<PiezoRecording> recordings_for(const ReproduceOptions& options, const StudySize& size,
                                           const std::vector<double>& levels, const std::vector<network::Input>& inputs,
                                           Motors motors) {
  std::vector<PiezoRecording> recordings = options.data.empty() ? run_recordings(levels, size.recordings, inputs, options, motors)
                                                                : read_recordings(options.data, inputs);
  check_folds(recordings);
  return recordings;
}

std::vector<train::FoldExample> examples_of(const std::vector<PiezoRecording>& recordings, const NetworkRow& row,
                                            LabelRule rule) {
  std::vector<train::FoldExample> examples;
  const std::size_t before = train::history_of(row.shape) - 1 - row.later;
  for (const PiezoRecording& recording : recordings) {
    train::FrameSequence frames = recording.inputs[row.input].by(rule);
    if (row.told.values() > 0) frames.features = told_features(recording, row.told);
    examples.push_back({padded(frames, row.shape.inputs, before, row.later), recording.motors_only ? motors_alone : with_slip});
  }
  return examples;
}

std::vector<std::size_t> groups_of(const std::vector<PiezoRecording>& recordings) {
  std::vector<std::size_t> groups;
  for (const PiezoRecording& recording : recordings) groups.push_back(recording.motors_only ? motors_alone : with_slip);
  return groups;
}

NetworkFigures on_slip(const std::vector<GroupCounts>& folds) {
  return figures_over(folds, [](const GroupCounts& fold) { return fold[with_slip]; });
}
NetworkFigures on_all(const std::vector<GroupCounts>& folds) { return figures_over(folds, all_of); }
MeanSd motors_right(const std::vector<GroupCounts>& folds) {
  return over(folds, [](const GroupCounts& fold) {
    const Confusion& motors = fold[motors_alone];
    const auto right = static_cast<double>(samples_in(motors, PadState::non_slip, PadState::non_slip));
    return 100.0 * right / static_cast<double>(samples_in(motors, PadState::non_slip));
  });
}

std::string cell(const MeanSd& percent) {
  if (std::isnan(percent.mean)) return "-";
  return std::isnan(percent.sd) ? fmt::format("{:.1f}", percent.mean) : fmt::format("{:.1f} +- {:.1f}", percent.mean, percent.sd);
}
std::string cell(const NetworkFigures& figures) {
  return std::isnan(figures.accuracy.mean) ? "-" : fmt::format("{}, {:.3f}", cell(figures.accuracy), figures.f1.mean);
}

Json json_of(const NetworkFigures& figures) {
  return {{"balanced_accuracy", figures.accuracy.mean / 100.0},
          {"balanced_accuracy_sd", figures.accuracy.sd / 100.0},
          {"f1", figures.f1.mean},
          {"f1_sd", figures.f1.sd}};
}
Json json_of(const std::vector<GroupCounts>& folds) {
  return {{"on_slip_and_noise", json_of(on_all(folds))},
          {"on_slip", json_of(on_slip(folds))},
          {"motors_right", motors_right(folds).mean / 100.0}};
}

std::string paper_cell(const NetworkRow& row) {
  return std::isnan(row.accuracy) ? "-" : fmt::format("{:.1f}, {:.3f}", row.accuracy, row.f1);
}

const char* label_name(LabelRule rule) { return rule == LabelRule::micro ? "true" : "position"; }

std::vector<std::string> setup_lines(const ReproduceOptions& options, const StudySize& size, std::size_t recordings) {
  return {
      options.data.empty()
          ? fmt::format("{} recordings of scenes/piezo_skin/dataset.yaml (paper: {}), half with contact, seed {}.", recordings,
                        published_recordings, options.seed.value_or(1))
          : fmt::format("{} recordings of {}.", recordings, options.data),
      "Frames of 20 ms every 10 ms, log power in bins of 50 Hz, standardised on the recordings that are learnt.",
      fmt::format(
          "{} folds by recording; mean and standard deviation of the folds. {}", fold_count,
          size.full
              ? "200 epochs of 32 clips of 128 frames a step by RMSProp; a fifth of the recordings learnt from chooses the state."
              : "Learnt as the recipes say (`slipbench describe piezo_fft_gru`); the last state is judged."),
      "Labels: position, that the bench's 100 Hz position has changed since its last reading; true, that a part of the contact slips."};
}

std::size_t Validations::queue(const std::vector<PiezoRecording>& recordings, const std::vector<std::size_t>& fold_of,
                               const NetworkRow& row, LabelRule rule, bool slip_alone) {
  train::Validation validation = size_.training(row, options_.seed.value_or(1));
  if (slip_alone) validation.learns = [](std::size_t group) { return group == with_slip; };
  const auto examples = std::make_shared<const std::vector<train::FoldExample>>(examples_of(recordings, row, rule));
  const std::size_t count = *std::ranges::max_element(fold_of) + 1;
  for (std::size_t fold = 0; fold < count; ++fold)
    tasks_.push_back(
        {results_.size(), examples, fold_of, fold, validation, fmt::format("{}, {} label", row.text, label_name(rule))});
  results_.push_back({{}, train::Calls(recordings.size())});
  return results_.size() - 1;
}

std::size_t Validations::queue_folds(const std::vector<PiezoRecording>& recordings, const NetworkRow& row, LabelRule rule,
                                     bool slip_alone) {
  return queue(recordings, train::folds(groups_of(recordings), fold_count, options_.seed.value_or(1)), row, rule, slip_alone);
}

void Validations::run() {
  static_cast<void>(train::network_libraries());  // loaded once, not by every child
  const std::vector<std::vector<std::uint8_t>> said = run_in_processes<std::uint8_t>(
      tasks_.size(), options_, [this](std::size_t k) { return tasks_[k].name; },
      [this](std::size_t k) {
        const FoldTask& task = tasks_[k];
        return joined(train::called_in_fold(*task.examples, task.fold_of, task.fold, task.validation));
      });
  for (std::size_t k = 0; k < tasks_.size(); ++k) {
    Outcome& outcome = results_[tasks_[k].of];
    train::Calls called = split(said[k], *tasks_[k].examples, tasks_[k].fold_of, tasks_[k].fold);
    const std::vector<Confusion> counts = train::counts_of(*tasks_[k].examples, called);
    std::ranges::copy(counts, outcome.folds.emplace_back().begin());
    for (std::size_t i = 0; i < called.size(); ++i) {
      if (!called[i].empty()) outcome.calls[i] = std::move(called[i]);
    }
  }
}

network::Input published_spectra() { return train::find_recipe("piezo_fft_gru").input; }

network::Input spectra_of(double low, double high) {
  network::Input input = published_spectra();
  input.low = low;
  input.high = high;
  return input;
}

network::Input signal_at_100_hz() { return train::find_recipe("piezo_raw_gru").input; }

PiezoRecording make_recording(const TrialRecord& record, const std::vector<network::Input>& inputs) {
  const auto sensor = std::ranges::find(record.sensors, "piezo_skin", &SensorRecord::type);
  if (sensor == record.sensors.end()) reject("trial {}: has no piezo_skin; allowed: a recording of one", record.trial);
  const Json swept = Json::parse(record.params);
  PiezoRecording recording;
  recording.level = swept_number(swept, level_path);
  recording.tip = tip_of(swept);
  recording.motors_only = std::ranges::all_of(sensor->labels.state, [](std::uint8_t state) { return state == 0; });
  const auto labelled = std::ranges::find_if(sensor->labels.state_paper, [](std::uint8_t state) { return slips(state); });
  if (labelled != sensor->labels.state_paper.end())
    recording.label_time = sensor->time[static_cast<std::size_t>(labelled - sensor->labels.state_paper.begin())];
  for (const network::Input& input : inputs) {
    const auto example_by = [&](train::LabelRule rule) {
      train::ExampleOptions how;
      how.input = input;
      how.labels = rule;
      return train::example_of(record, *sensor, how);
    };
    train::Example truth = example_by(train::LabelRule::micro);
    recording.inputs.push_back(
        {std::move(truth.frames.features), std::move(truth.frames.label), example_by(train::LabelRule::paper).frames.label});
    if (recording.inputs.size() > 1) continue;
    recording.slip_time = truth.onset;
    recording.time = truth.time;
    for (const PadState state : truth.truth) recording.contact.push_back(state != PadState::no_contact ? 1 : 0);
    const double idle_speed = swept_number(swept, "motion.idle_speed"), idle_start = swept_number(swept, "motion.idle_start");
    for (const double t : truth.time)
      recording.motors.push_back(static_cast<float>(bench_speed(record, t) + (t >= idle_start ? idle_speed : 0.0)));
  }
  return recording;
}

std::vector<PiezoRecording> run_recordings(const std::vector<double>& levels, std::size_t recordings,
                                           const std::vector<network::Input>& inputs, const ReproduceOptions& options,
                                           Motors motors) {
  const std::string swept = fmt::format("[{}]", fmt::join(levels, ", "));
  GridCell cell{.name = "recordings",
                .scene = piezo_bench_scene,
                .overrides = {{std::string("sweep.") + level_path, swept}},
                .draws = recordings / 2};
  if (motors == Motors::of_the_tip) {
    cell.name += ", no motor but the tip's";
    cell.overrides.push_back({"sweep.motion.idle_speed", "[0 mm/s]"});
  }
  return run_grid<PiezoRecording>({cell}, options, [&](const GridTrial& trial) { return make_recording(trial.record(), inputs); })
      .front();
}

std::vector<PiezoRecording> read_recordings(const std::string& path, const std::vector<network::Input>& inputs) {
  std::vector<PiezoRecording> recordings;
  with_trials(path, [&](const TrialRecord& record) { recordings.push_back(make_recording(record, inputs)); });
  return recordings;
}

}  // namespace slipbench::reproduce
