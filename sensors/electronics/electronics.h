// What a sensor's electronics add to its ideal readings: a chain of parts, each opt-in, none of which costs anything when not
// named.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sim/core/parameters.h"

namespace slipbench {

// Crosstalk between two values of a sample: `to` gains c times `from`, with c uniform in [-limit, limit].
struct Coupling {
  std::size_t to;
  std::size_t from;
  double limit;  // unit of `to` over unit of `from`
};

// The span of a value's converter, or the range in which its readings are valid, in the value's unit.
struct ConverterRange {
  double lowest;   // of code 0
  double highest;  // of the last code
};

// How large the disturbances of a sensor are. V values a sample, in the order of SensorFrame::values. Values that are computed
// from one another share a source: noise, offset and drift are drawn once a source and scaled for each of its values.
struct SignalModel {
  double rate = 0.0;                // samples a second [Hz]
  std::size_t sources = 0;          // number of independent sources
  std::vector<std::size_t> source;  // [V] which source each value follows
  std::vector<double> noise_sd;     // [V] standard deviation of the noise, in the value's unit
  std::vector<double> offset_sd;    // [V] standard deviation of the offset, in the value's unit
  std::vector<double> drift_sd;     // [V] standard deviation of the drift's slope, in the value's unit over s
  std::vector<double> gain_sd;      // [V] standard deviation of the gain about 1; 0: the value has no gain error
  std::vector<Coupling> couplings;
  std::vector<ConverterRange> converter = {};  // [V]; empty: the sensor has no part `quantisation`
  std::vector<ConverterRange> valid = {};  // [V] where the maker states an accuracy; empty: the sensor has no part `valid_range`
  std::vector<std::size_t> range_flag = {};  // [V] flag that a value beyond `valid` raises, from 0 on; empty: no flags
  std::vector<double> scan_share = {};  // [V] of the scan that is left after the value; empty: one after the other, by number
};

// What keys the random streams of a sensor's electronics.
struct ElectronicsKey {
  std::uint64_t seed = 0;    // of the dataset
  std::uint64_t trial = 0;   // keys what differs from one recording to the next: noise, offset, drift
  std::uint64_t device = 0;  // keys what belongs to the device: gain, coupling
  std::string sensor_name;   // the scene's name for the sensor
};

// One part at work.
class ElectronicsStage {
 public:
  virtual ~ElectronicsStage() = default;

  // Changes a sample in place. Called once a sample, in order of time. `time` [s].
  virtual void apply(std::span<float> values, double time) = 0;
  // What the part carries from one sample to the next (Sensor::memory). Empty: nothing.
  [[nodiscard]] virtual std::span<double> memory() { return {}; }
  // Samples in which a value was beyond the part's range (Sensor::saturated).
  [[nodiscard]] virtual std::uint64_t saturated() const { return 0; }
  // Per flag of SignalModel::range_flag: 1 if a value of the last sample was beyond its range, else 0. The span stays where it is as long as the
  // part lives. Empty: the part raises no flags.
  [[nodiscard]] virtual std::span<const float> range_flags() const { return {}; }
  // True if apply() must also be called between samples, at every tick of the simulation.
  [[nodiscard]] virtual bool works_between_samples() const { return false; }
};

// The parts of one sensor, applied in the order in which they are listed. Empty: ideal.
class Electronics {
 public:
  // Throws SceneValueError for an unknown part, a part that is listed twice, a part that works between samples and is not the first one, and
  // parameters that do not go together or with the sensor.
  Electronics(const std::vector<Named>& parts, const SignalModel& model, const ElectronicsKey& key);

  void apply(std::span<float> values, double time) {
    for (const auto& stage : stages_) stage->apply(values, time);
  }

  // True if the first part works between samples, so that feel() must be called at every tick there (Sensor::feels_every_tick).
  [[nodiscard]] bool feels_every_tick() const { return !stages_.empty() && stages_.front()->works_between_samples(); }
  // Hands the first part the undisturbed values between two samples, which it changes. Only where feels_every_tick(). `time` [s].
  void feel(std::span<float> values, double time) { stages_.front()->apply(values, time); }

  // The parts' memories, for Sensor::memory.
  [[nodiscard]] std::vector<std::span<double>> memory() const;

  // Samples in which a part found a value beyond its range, for Sensor::saturated: cut off by the converter, or only counted by valid_range.
  [[nodiscard]] std::uint64_t saturated() const;

  // The flags of the part that raises some (ElectronicsStage::range_flags); empty: no part does.
  [[nodiscard]] std::span<const float> range_flags() const;

 private:
  std::vector<std::unique_ptr<ElectronicsStage>> stages_;
};

// Whether a part of the electronics draws random numbers, of a recording or of a device. Throws std::logic_error where there is no such part.
bool draws_numbers(const std::string& part);

// What a sensor says of one part of its electronics.
struct PartFigures {
  // A default in which the sensor differs from the part's own.
  struct Default {
    std::string parameter, text, source;
  };
  std::string part;
  std::string source;  // where its figures in the SignalModel come from
  std::vector<Default> defaults = {};
  std::vector<ParameterSpec> parameters = {};  // further ones, by which the sensor fills its SignalModel
};

// The parts that a sensor has, in the order of `figures`, which is the one in which they are applied as `typical`: each with the
// sensor's source before the part's own, with the sensor's defaults, and with its further parameters. `device`: what it is called in the source, "PapillArray".
// Throws std::logic_error for a part or a parameter that there is not.
std::vector<Entry> electronics_of(const std::string& device, const std::vector<PartFigures>& figures);

}  // namespace slipbench
