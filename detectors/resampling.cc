#include "detectors/resampling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "sim/core/counted.h"
#include "sim/core/error.h"
#include "sim/core/quantity.h"
#include "sim/core/readable_quantity.h"

namespace slipbench {
namespace {

// "2.7", "1.02": 1 % is a difference.
std::string times_text(double ratio) {
  const double digits = ratio < 2.0 ? 100.0 : 10.0;
  return format_number(std::round(digits * ratio) / digits);
}
std::string hertz(double rate) { return readable_quantity(rate, Quantity::frequency); }
std::string seconds(double time) { return readable_quantity(time, Quantity::time); }

constexpr double most_frames = 1e6;  // of a detector in one step of its sensor

void check_length(double step, double rate, const std::string& sensor) {
  if (step * rate <= most_frames) return;
  throw InputError(sensor + "a step of " + seconds(step) + " holds more than a million frames at " + hertz(rate) +
                   "; cut the recording there");
}

constexpr const char* interpolating = "--resample of `detect` and `eval`";

// At least half of all pairs of steps are not longer than two of these, so some step is no gap.
double typical_step(std::span<const double> times) {
  if (times.size() < 3) return times.back() - times.front();
  std::vector<double> pairs;
  for (std::size_t k = 2; k < times.size(); ++k) pairs.push_back(times[k] - times[k - 2]);
  const auto middle = pairs.begin() + static_cast<std::ptrdiff_t>(pairs.size() / 2);
  std::ranges::nth_element(pairs, middle);
  return 0.5 * *middle;
}

std::string percent(double share) { return format_number(std::round(100.0 * share)) + " %"; }

// "but the network reads 100 Hz or more, "
std::string reading(const std::string& reader, double least, double rate) {
  return "but " + reader + " reads " + hertz(least) + (least < rate ? " or more, " : ", ");
}

// Adds up the time in stretches that are slower than the detector needs.
class Stretches {
 public:
  // `least`: rate that the detector needs [Hz].
  explicit Stretches(double least) : least_(least) {}

  void add(double step) {
    duration_ += step;
    if (++steps_ < stretch_steps) return;
    const double rate = static_cast<double>(steps_) / duration_;
    slowest_ = std::min(slowest_, rate);
    if (rate < (1.0 - other_rate) * least_) slow_ += duration_;
    steps_ = 0;
    duration_ = 0.0;
  }
  [[nodiscard]] double slowest() const { return slowest_; }  // Hz; infinite: no stretch is complete
  [[nodiscard]] double slow() const { return slow_; }        // s

 private:
  double least_;
  std::size_t steps_ = 0;
  double duration_ = 0.0;
  double slowest_ = std::numeric_limits<double>::infinity(), slow_ = 0.0;
};

// Counts the gaps in frames of `period` [s], and looks for slow stretches between them. `least`:
// rate that the detector needs [Hz].
void count_gaps(const FrameSource& source, double period, double least, const std::string& reader, Resampling& resampling) {
  const std::span<const double> times = source.uneven_times;
  const bool any = source.interpolate;
  const std::string sensor = "sensor " + quote(source.sensor) + ": ";
  const double longest = std::max(longest_gap, longest_gap_frames * period);
  double together = 0.0;
  Stretches stretches(least);
  for (std::size_t k = 1; k < times.size(); ++k) {
    const double step = times[k] - times[k - 1];
    if (step <= gap_frames * period) {
      stretches.add(step);
      continue;
    }
    check_length(step, 1.0 / period, sensor);
    if (step > longest) resampling.made_up = true;
    if (step > longest && !any) {
      throw InputError(sensor + "a step of " + seconds(step) + ", " + seconds(times[k - 1] - times.front()) +
                       " after the first sample, is longer than " + seconds(longest) +
                       ", the longest gap that is bridged; cut the recording there, or interpolate across it with " +
                       interpolating + " or with `import --rate`");
    }
    ++resampling.gaps;
    resampling.largest_gap = std::max(resampling.largest_gap, step);
    together += step;
  }
  const double duration = times.back() - times.front(), share = together / duration, slow = stretches.slow() / duration;
  if (share > largest_gap_share) resampling.made_up = true;
  if (share > largest_gap_share && !any) {
    throw InputError(sensor + "its samples are not evenly spaced: " + counted(resampling.gaps, "gap") + " of more than " +
                     seconds(gap_frames * period) + " are " + percent(share) + " of the recording; allowed: " +
                     percent(largest_gap_share) + "; interpolate with " + interpolating + " or with `import --rate`");
  }
  if (stretches.slowest() < (1.0 - other_rate) / resampling.step) resampling.slowest = stretches.slowest();
  if (slow > largest_gap_share) resampling.made_up = true;
  if (slow > largest_gap_share && !any) {
    throw InputError(sensor + "its rate of " + hertz(1.0 / resampling.step) + " falls to " + hertz(stretches.slowest()) + ", " +
                     reading(reader, least, resampling.wanted) + "which " + percent(slow) +
                     " of the recording do not reach; allowed: " + percent(largest_gap_share) + "; interpolate with " +
                     interpolating + " or with `import --rate`");
  }
}

class Resampled final : public Detector {
 public:
  Resampled(std::unique_ptr<Detector> detector, const Resampling& resampling, const FrameSource& source, std::string notice)
      : detector_(std::move(detector)), about_(resampling), notice_(std::move(notice)) {
    for (const Channel& channel : source.channels) held_.resize(held_.size() + channel.size(), channel.every != 1);
    for (Sample& sample : latest_) sample.values.resize(held_.size());
    made_.resize(held_.size());
  }

  const SlipEstimate& update(const SensorFrame& frame) override {
    if (taken_ == 0) first_ = frame.time;
    // The oldest of the three gets the new sample.
    std::rotate(latest_.begin(), latest_.begin() + 1, latest_.end());
    newest().at = about_.step > 0.0 ? (frame.time - first_) / about_.step : static_cast<double>(taken_);
    std::ranges::copy(frame.values, newest().values.begin());
    ++taken_;
    now_ = frame.time;
    for (double due = static_cast<double>(made_count_) * about_.stride; make(due);
         due = static_cast<double>(made_count_) * about_.stride) {
      ++made_count_;
    }
    return estimate_;
  }

  [[nodiscard]] const std::vector<Feature>& features() const override { return detector_->features(); }
  [[nodiscard]] SampleListener* listener() override { return detector_->listener(); }
  [[nodiscard]] std::string notice() const override {
    const std::string own = detector_->notice();
    return own.empty() ? notice_ : notice_ + "; " + own;
  }
  void finish() override { detector_->finish(); }

 private:
  struct Sample {
    double at = 0.0;  // steps from the first
    std::vector<float> values;
  };
  Sample& newest() { return latest_[2]; }

  // Passes on the frame that is due, in steps from the first sample. False: it needs later samples.
  bool make(double due) {
    const auto& [before, last, now] = latest_;
    // Stamps of a recording have jitter.
    const double same = about_.step > 0.0 ? 0.05 : 1e-6;
    if (due > now.at + same) return false;
    if (due >= now.at - same || taken_ == 1) {
      pass_on(now.values);
      return true;
    }
    if (due <= last.at) {  // waited for the sample after the nearest
      if (joined(last, now))
        move(last, due - last.at, before, now, before);
      else
        blend(before, last, due);
    } else {
      const bool has_slope = !about_.slow && joined(last, now);
      if (has_slope && due - last.at > 0.5 * (now.at - last.at)) return false;
      if (has_slope && taken_ > 2 && joined(before, last))
        move(last, due - last.at, before, now, last);
      else
        blend(last, now, due);
    }
    pass_on(made_);
    return true;
  }

  // No sample is missing between two samples.
  static bool joined(const Sample& a, const Sample& b) { return b.at - a.at <= gap_frames; }

  // `nearest`, moved by `steps` along the slope between its neighbours. `latest`: the last sample before
  // the new frame.
  void move(const Sample& nearest, double steps, const Sample& before, const Sample& after, const Sample& latest) {
    const double share = steps / (after.at - before.at);
    for (std::size_t v = 0; v < made_.size(); ++v) {
      made_[v] =
          held_[v] ? latest.values[v]
                   : static_cast<float>(double{nearest.values[v]} + share * (double{after.values[v]} - double{before.values[v]}));
    }
  }

  void blend(const Sample& before, const Sample& after, double due) {
    const double share = (due - before.at) / (after.at - before.at);
    for (std::size_t v = 0; v < made_.size(); ++v) {
      made_[v] = held_[v] ? before.values[v]
                          : static_cast<float>((1.0 - share) * double{before.values[v]} + share * double{after.values[v]});
    }
  }

  void pass_on(const std::vector<float>& values) {
    const double time = first_ + static_cast<double>(made_count_) / about_.rate;
    const SlipEstimate& estimate = detector_->update({std::min(time, now_), values});
    if (estimate.time == estimated_at_) return;
    estimated_at_ = estimate.time;
    estimate_ = estimate;
    estimate_.time = now_;  // of the newest sample that it uses
  }

  std::unique_ptr<Detector> detector_;
  Resampling about_;
  std::string notice_;
  std::vector<bool> held_;                                          // by value: its channel is slower than the samples
  std::array<Sample, 3> latest_;                                    // in order of time
  std::vector<float> made_;                                         // a new frame
  double first_ = 0.0, now_ = 0.0;                                  // s, of the first and the newest sample
  std::size_t taken_ = 0, made_count_ = 0;                          // samples, new frames
  double estimated_at_ = -std::numeric_limits<double>::infinity();  // s, time of the detector's latest estimate
  SlipEstimate estimate_;
};

}  // namespace

double sampled_rate(std::span<const double> times) {
  const double longest = gap_frames * typical_step(times);
  double steps = 0.0, duration = 0.0;
  for (std::size_t k = 1; k < times.size(); ++k) {
    const double step = times[k] - times[k - 1];
    if (step > longest) continue;
    steps += 1.0;
    duration += step;
  }
  return steps / duration;
}

Resampling resampling_of(const FrameSource& source, double rate, const std::string& reader, double least) {
  Resampling resampling{.wanted = rate};
  const bool even = source.uneven_times.size() < 2;
  if (!even) resampling.step = 1.0 / sampled_rate(source.uneven_times);
  const double sampled = even ? source.rate : 1.0 / resampling.step;
  const double ratio = sampled / rate, whole = std::round(ratio);
  const bool multiple = whole >= 1.0 && std::abs(ratio - whole) <= equal_rates * whole;
  resampling.stride = multiple ? whole : ratio;
  resampling.rate = sampled / resampling.stride;
  resampling.slow = !multiple && ratio < 1.0;
  const double needed = least > 0.0 ? std::min(least, rate) : rate;
  resampling.made_up = resampling.slow && sampled < (1.0 - equal_rates) * needed;
  if (resampling.made_up && !source.interpolate) {
    throw InputError("sensor " + quote(source.sensor) + " has " + hertz(sampled) + ", " + reading(reader, needed, rate) +
                     times_text(needed / sampled) + " times as much; allowed: " + hertz(needed) + " or more; " + interpolating +
                     " interpolates a slower recording");
  }
  check_length(1.0 / sampled, resampling.rate, "sensor " + quote(source.sensor) + ": ");
  if (!even) count_gaps(source, std::max(1.0 / resampling.rate, resampling.step), needed, reader, resampling);
  return resampling;
}

Resampling even_resampling_of(const FrameSource& source, const std::string& reader) {
  constexpr double any_rate = std::numeric_limits<double>::min();
  return resampling_of(source, sampled_rate(source.uneven_times), reader, any_rate);
}

std::string resampling_text(const Resampling& resampling, const FrameSource& source, const std::string& reader) {
  if (!resampling.needed()) return "";
  const std::string from = hertz(resampling.step > 0.0 ? 1.0 / resampling.step : source.rate), to = hertz(resampling.wanted);
  std::string text = resampling.stride == 1.0 ? "resampled evenly at " + to
                                              : (resampling.slow ? "interpolated from " : "resampled from ") + from + " to " + to;
  text += " for " + reader;
  if (resampling.gaps > 0)
    text += "; " + counted(resampling.gaps, "gap") + " of at most " + seconds(resampling.largest_gap) + " bridged";
  if (resampling.slowest > 0.0) text += "; down to " + hertz(resampling.slowest) + " in places";
  if (resampling.made_up) text += "; the figures are of interpolated data";
  return text;
}

std::unique_ptr<Detector> resampled(std::unique_ptr<Detector> detector, const Resampling& resampling, const FrameSource& source,
                                    std::string notice) {
  if (!resampling.needed()) return detector;
  return std::make_unique<Resampled>(std::move(detector), resampling, source, std::move(notice));
}

}  // namespace slipbench
