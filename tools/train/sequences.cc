#include "tools/train/sequences.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <stdexcept>

#include <fmt/format.h>

#include "sim/core/math.h"
#include "sim/core/random.h"
#include "tools/dataset/checked_dataset.h"
#include "tools/dataset/content_check.h"
#include "tools/dataset/reader.h"
#include "tools/dataset/record/slip_path.h"
#include "tools/dataset/record/trial_record.h"
#include "tools/files/reject.h"
#include "tools/learning_data/samples.h"

namespace slipbench {

namespace {

// Slower speeds [m/s] are float32 rounding.
constexpr double at_rest = 1e-6;

// Samples of the sensor per frame.
std::size_t stride_of(const SensorRecord& sensor, const std::string& subject) {
  const double ratio = sensor.rate / detector_rate;
  if (!(ratio >= 1.0) || ratio != std::floor(ratio)) {
    reject("{}: sensor {} samples at {} Hz; allowed: a multiple of {} Hz, the rate of the detector", subject, sensor.name,
           sensor.rate, detector_rate);
  }
  return static_cast<std::size_t>(ratio);
}

// The earliest slip of any pillar; NaN without slip.
double onset_of(const LabelRecord& labels, LabelRule rule) {
  const std::vector<double>& times = about_rule(rule).whole_unit ? labels.onset_time : labels.micro_onset_time;
  double earliest = std::numeric_limits<double>::quiet_NaN();
  for (const double time : times) earliest = std::fmin(earliest, time);
  return earliest;
}

bool moves(const BodyRecord& pad, std::size_t row) {
  const float* velocity = pad.velocity.data() + 6 * row;
  return math::hypot(velocity[0], velocity[1]) + corner_radius * std::abs(velocity[5]) > at_rest;
}

std::string chosen_sensor(const DatasetReader& reader, std::size_t trial, const std::string& wanted, const std::string& subject) {
  const std::vector<std::string> names = papillarrays_of(reader, trial);
  if (wanted.empty() && names.size() == 1) return names.front();
  if (std::ranges::find(names, wanted) != names.end()) return wanted;
  reject("{}: {}; allowed: {}", subject,
         wanted.empty() ? "has several PapillArrays; choose one with --sensor" : fmt::format("no PapillArray '{}'", wanted),
         fmt::join(names, ", "));
}

Sequence sequence_of(const TrialRecord& record, const std::string& sensor_name, const CommandedMotion& motion,
                     const SequenceOptions& options, const std::string& subject) {
  const SensorRecord& sensor = *std::ranges::find(record.sensors, sensor_name, &SensorRecord::name);
  const auto pad = std::ranges::find(record.bodies, "pad", &BodyRecord::name);
  if (pad == record.bodies.end()) throw InputError(subject + ": has no truth/pad, which contains the motion of the pad");
  const PapillarraySamples samples(sensor, options.labels, default_label_speed);
  const std::size_t stride = stride_of(sensor, subject);
  const std::vector<PadState> states = states_by(sensor, options.labels, motion.rotation != 0.0, LabelUse::pillars);

  Sequence sequence;
  sequence.trial = record.trial;
  sequence.motion = motion;
  sequence.onset = onset_of(sensor.labels, options.labels);
  const std::vector<double> path = slip_path(sensor.labels, sensor.time.size());
  for (std::size_t row = 0; row < samples.size(); row += stride) {
    sequence.time.push_back(samples.time(row));
    if (!path.empty()) sequence.path.push_back(path[row]);
    Displacements& frame = sequence.displacements.emplace_back();
    for (std::size_t p = 0; p < pillars; ++p) {
      const std::array<float, 3> displacement = samples.displacement(row, p);
      std::copy(displacement.begin(), displacement.end(), frame.begin() + static_cast<std::ptrdiff_t>(3 * p));
    }
    sequence.label.push_back(states[row]);
    // The bodies have the samples of the fastest sensor; takes the last one not after the frame.
    const auto after = std::upper_bound(record.body_time.begin(), record.body_time.end(), samples.time(row));
    if (after == record.body_time.begin()) throw InputError(subject + ": truth/pad begins after its sensor");
    sequence.moving.push_back(moves(*pad, static_cast<std::size_t>(after - record.body_time.begin()) - 1) ? 1 : 0);
  }
  return sequence;
}

// Upper limits of the bands of compression [m], with a margin for the rounding of decimal
// fractions.
constexpr std::array<double, 3> compression_bands{0.75e-3 + 1e-9, 1e-3 + 1e-9, 1.125e-3 + 1e-9};

// Octaves below this [mm/s] are one condition, a pad at rest.
constexpr int slowest_octave = -10;

}  // namespace

TrainingData read_sequences(const std::string& dataset_path, const SequenceOptions& options) {
  const DatasetReader reader = whole_dataset(dataset_path);
  reader.check_truth("training of the hyperdimensional detector");
  const auto subject_of = [&reader](std::size_t trial) {
    return fmt::format("{}: trial {}", reader.files()[reader.file_of(trial)], trial);
  };
  const std::size_t first = reader.trials().front();
  TrainingData data{.command = reader.header().command,
                    .sensor = chosen_sensor(reader, first, options.sensor, subject_of(first)),
                    .sequences = {}};
  std::map<std::size_t, std::string> part_of = reader.split();
  for_each_trial(reader, [&](const TrialRecord& record) {
    const std::string subject = subject_of(record.trial);
    const std::string sensor = chosen_sensor(reader, record.trial, options.sensor, subject);
    const CommandedMotion motion = record.outcome.grasp ? CommandedMotion{} : commanded_motion(reader, record.trial);
    Sequence& sequence = data.sequences.emplace_back(sequence_of(record, sensor, motion, options, subject));
    sequence.sha256 = trial_identity(reader, record.trial);
    if (!part_of.empty()) sequence.part = part_of[record.trial];
  });
  return data;
}

std::size_t condition_of(const CommandedMotion& motion) {
  const auto band = static_cast<std::size_t>(
      std::lower_bound(compression_bands.begin(), compression_bands.end(), motion.compression) - compression_bands.begin());
  const double speed = 1e3 * std::max(std::abs(motion.speed), corner_radius * std::abs(motion.rotation));
  const int octave = speed > 0.0 ? std::max(slowest_octave, static_cast<int>(std::lround(math::log2(speed)))) : slowest_octave;
  return static_cast<std::size_t>(octave - slowest_octave) * (compression_bands.size() + 1) + band;
}

std::size_t BootstrapDraw::training_size() const { return std::accumulate(times.begin(), times.end(), std::size_t{0}); }

std::size_t BootstrapDraw::distinct() const { return times.size() - static_cast<std::size_t>(std::ranges::count(times, 0U)); }

BootstrapDraw bootstrap(std::span<const std::size_t> conditions, std::uint64_t seed, std::size_t draw) {
  std::map<std::size_t, std::vector<std::size_t>> members;
  for (std::size_t item = 0; item < conditions.size(); ++item) members[conditions[item]].push_back(item);
  BootstrapDraw result{std::vector<std::uint32_t>(conditions.size(), 0)};
  RandomStream random(seed, draw, "bootstrap");
  for (const auto& [condition, items] : members) {
    for (std::size_t i = 0; i < items.size(); ++i) ++result.times[items[random.integer(items.size())]];
  }
  return result;
}

void Delays::add(std::span<const double> time, std::span<const PadState> called, double onset) {
  ++sequences;
  const auto alarm = std::ranges::find_if(called, [](PadState state) { return slips(state); });
  TrialOutcome outcome;
  if (alarm != called.end()) {
    const double first = time[static_cast<std::size_t>(alarm - called.begin())];
    (first >= onset ? outcome.detection_time : outcome.false_alarm_time) = first;  // a false alarm without onset
  }
  settle_detection(outcome, !std::isnan(onset));
  if (!std::isnan(onset)) ++slipping;
  switch (*outcome.detection) {
    case Detection::quiet: break;
    case Detection::false_alarm: ++false_alarms; break;
    case Detection::early: ++early; break;
    case Detection::seen: delay.push_back(outcome.detection_time - onset); break;
    case Detection::missed: ++missed; break;
  }
}

void Delays::add(const Delays& other) {
  delay.insert(delay.end(), other.delay.begin(), other.delay.end());
  early += other.early;
  missed += other.missed;
  false_alarms += other.false_alarms;
  slipping += other.slipping;
  sequences += other.sequences;
}

}  // namespace slipbench
