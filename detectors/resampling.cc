#include "detectors/resampling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "sim/core/counted.h"
#include "sim/core/error.h"
#include "sim/core/quantity.h"
#include "sim/core/readable_quantity.h"

namespace slipbench {
namespace {

// "2.7"
std::string times_text(double ratio) { return format_number(std::round(10.0 * ratio) / 10.0); }
std::string hertz(double rate) { return readable_quantity(rate, Quantity::frequency); }
std::string seconds(double time) { return readable_quantity(time, Quantity::time); }

constexpr double most_frames = 1e6;  // of a detector in one step of its sensor

void check_length(double step, double rate, const std::string& sensor) {
  if (step * rate <= most_frames) return;
  throw InputError(sensor + "a step of " + seconds(step) + " holds more than a million frames at " + hertz(rate) +
                   "; cut the recording there");
}

constexpr const char* interpolating = "--resample of `detect` and `eval`";

double median_step(std::span<const double> times) {
  std::vector<double> steps;
  for (std::size_t k = 1; k < times.size(); ++k) steps.push_back(times[k] - times[k - 1]);
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::ranges::nth_element(steps, middle);
  return *middle;
}

// Counts the gaps in frames of `period` [s].
void count_gaps(const FrameSource& source, double period, Resampling& resampling) {
  const std::span<const double> times = source.uneven_times;
  const bool any = source.interpolate;
  const std::string sensor = "sensor " + quote(source.sensor) + ": ";
  const double longest = std::max(longest_gap, longest_gap_frames * period);
  double together = 0.0;
  for (std::size_t k = 1; k < times.size(); ++k) {
    const double step = times[k] - times[k - 1];
    if (step <= gap_frames * period) continue;
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
  const double share = together / (times.back() - times.front());
  if (share > largest_gap_share) resampling.made_up = true;
  if (share > largest_gap_share && !any) {
    throw InputError(sensor + "its samples are not evenly spaced: " + counted(resampling.gaps, "gap") + " of more than " +
                     seconds(gap_frames * period) + " are " + std::to_string(std::lround(100.0 * share)) +
                     " % of the recording; allowed: " + std::to_string(std::lround(100.0 * largest_gap_share)) +
                     " %; interpolate with " + interpolating + " or with `import --rate`");
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
  [[nodiscard]] std::string notice() const override { return notice_; }
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
    } else if (about_.slow || !joined(last, now)) {
      blend(last, now, due);
    } else if (due - last.at > 0.5 * (now.at - last.at)) {
      return false;
    } else if (taken_ > 2 && joined(before, last)) {
      move(last, due - last.at, before, now, last);
    } else {
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
    const SlipEstimate& said = detector_->update({std::min(time, now_), values});
    if (said.time == said_) return;
    said_ = said.time;
    estimate_ = said;
    estimate_.time = now_;  // of the newest sample that it uses
  }

  std::unique_ptr<Detector> detector_;
  Resampling about_;
  std::string notice_;
  std::vector<bool> held_;                                  // by value: its channel is slower than the samples
  std::array<Sample, 3> latest_;                            // in order of time
  std::vector<float> made_;                                 // a new frame
  double first_ = 0.0, now_ = 0.0;                          // s, of the first and the newest sample
  std::size_t taken_ = 0, made_count_ = 0;                  // samples, new frames
  double said_ = -std::numeric_limits<double>::infinity();  // s, time of the detector's latest estimate
  SlipEstimate estimate_;
};

}  // namespace

Resampling resampling_of(const FrameSource& source, double rate, const std::string& reader, double least) {
  Resampling resampling{.wanted = rate};
  const bool even = source.uneven_times.size() < 2;
  if (!even) resampling.step = median_step(source.uneven_times);
  const double sampled = even ? source.rate : 1.0 / resampling.step;
  const double ratio = sampled / rate, whole = std::round(ratio);
  const bool multiple = whole >= 1.0 && std::abs(ratio - whole) <= equal_rates * whole;
  resampling.stride = multiple ? whole : ratio;
  resampling.rate = sampled / resampling.stride;
  resampling.slow = !multiple && ratio < 1.0;
  const double needed = least > 0.0 ? std::min(least, rate) : rate;
  resampling.made_up = resampling.slow && sampled < (1.0 - equal_rates) * needed;
  if (resampling.made_up && !source.interpolate) {
    throw InputError("sensor " + quote(source.sensor) + " has " + hertz(sampled) + ", but " + reader + " reads " + hertz(needed) +
                     (needed < rate ? " or more, " : ", ") + times_text(needed / sampled) + " times more; allowed: " +
                     hertz(needed) + " or more; " + interpolating + " interpolates a slower recording");
  }
  check_length(1.0 / sampled, resampling.rate, "sensor " + quote(source.sensor) + ": ");
  if (!even) count_gaps(source, std::max(1.0 / resampling.rate, resampling.step), resampling);
  return resampling;
}

std::string resampling_text(const Resampling& resampling, const FrameSource& source, const std::string& reader) {
  if (!resampling.needed()) return "";
  const std::string from = hertz(resampling.step > 0.0 ? 1.0 / resampling.step : source.rate), to = hertz(resampling.wanted);
  std::string text = resampling.stride == 1.0 ? "resampled evenly at " + to
                                              : (resampling.slow ? "interpolated from " : "resampled from ") + from + " to " + to;
  text += " for " + reader;
  if (resampling.gaps > 0)
    text += "; " + counted(resampling.gaps, "gap") + " of at most " + seconds(resampling.largest_gap) + " bridged";
  if (resampling.made_up) text += "; the figures are of interpolated data";
  return text;
}

std::unique_ptr<Detector> resampled(std::unique_ptr<Detector> detector, const Resampling& resampling, const FrameSource& source,
                                    std::string notice) {
  if (!resampling.needed()) return detector;
  return std::make_unique<Resampled>(std::move(detector), resampling, source, std::move(notice));
}

}  // namespace slipbench
