// Electronics that disturb a sensor's ideal readings: a chain of opt-in parts. Parts that a scene
// does not name cost nothing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sim/core/parameters.h"

namespace slipbench {

// Crosstalk between two values of a sample: `to` gains c times `from`, with c uniform in [-limit,
// limit].
struct Coupling {
  std::size_t to;
  std::size_t from;
  double limit;  // unit of `to` over unit of `from`
};

// Range of a value's converter, or of its valid readings, in the value's unit.
struct ConverterRange {
  double lowest;   // at code 0
  double highest;  // at the last code
};

// Magnitudes of a sensor's disturbances. V values a sample, in the order of SensorFrame::values.
// Values computed from one another share a source: noise, offset and drift are drawn once per
// source and scaled for each of its values.
struct SignalModel {
  double rate = 0.0;                // samples a second [Hz]
  std::size_t sources = 0;          // number of independent sources
  std::vector<std::size_t> source;  // [V] source that each value follows
  std::vector<double> noise_sd;     // [V] standard deviation of the noise, in the value's unit
  std::vector<double> offset_sd;    // [V] standard deviation of the offset, in the value's unit
  std::vector<double> drift_sd;     // [V] standard deviation of the drift's slope, in the value's unit over s
  std::vector<double> gain_sd;      // [V] standard deviation of the gain about 1; 0: no gain error
  std::vector<Coupling> couplings;
  std::vector<ConverterRange> converter = {};  // [V]; empty: the sensor has no part `quantisation`
  std::vector<ConverterRange> valid = {};      // [V] where the maker states an accuracy; empty: no part `valid_range`
  std::vector<std::size_t> range_flag = {};    // [V] index of the flag that a value beyond `valid` raises; empty: no flags
  std::vector<double> scan_share = {};         // [V] share of the scan left after the value; empty: in order of index
};

// Keys of the random streams of a sensor's electronics.
struct ElectronicsKey {
  std::uint64_t seed = 0;    // of the dataset
  std::uint64_t trial = 0;   // keys what differs between recordings: noise, offset, drift
  std::uint64_t device = 0;  // keys what belongs to the device: gain, coupling
  std::string sensor_name;   // the scene's name for the sensor
};

// One part of the chain, made for a sensor.
class ElectronicsStage {
 public:
  virtual ~ElectronicsStage() = default;

  // Changes a sample in place. Called once per sample, in order of time. `time` [s].
  virtual void apply(std::span<float> values, double time) = 0;
  // State carried from one sample to the next (Sensor::memory). Empty: stateless.
  [[nodiscard]] virtual std::span<double> memory() { return {}; }
  // Number of samples with a value beyond the part's range (Sensor::saturated).
  [[nodiscard]] virtual std::uint64_t saturated() const { return 0; }
  // One value per flag of SignalModel::range_flag: 1 if a value of the last sample was beyond its
  // range, else 0. The span keeps its address as long as the part exists. Empty: the part raises no
  // flags.
  [[nodiscard]] virtual std::span<const float> range_flags() const { return {}; }
  // True if apply() must also be called between samples, at every tick of the simulation.
  [[nodiscard]] virtual bool works_between_samples() const { return false; }
};

// The parts of one sensor, applied in the order of their list. Empty: ideal.
class Electronics {
 public:
  // Throws SceneValueError for an unknown part, a part listed twice, a part that works between
  // samples but is not the first one, and parameters that conflict with each other or with the
  // sensor.
  Electronics(const std::vector<Named>& parts, const SignalModel& model, const ElectronicsKey& key);

  void apply(std::span<float> values, double time) {
    for (const auto& stage : stages_) stage->apply(values, time);
  }

  // True if the first part works between samples, so that feel() must be called at every tick
  // (Sensor::feels_every_tick).
  [[nodiscard]] bool feels_every_tick() const { return !stages_.empty() && stages_.front()->works_between_samples(); }
  // Passes the undisturbed values between two samples to the first part, which changes them.
  // Requires feels_every_tick(). `time` [s].
  void feel(std::span<float> values, double time) { stages_.front()->apply(values, time); }

  // Returns the parts' memories, for Sensor::memory.
  [[nodiscard]] std::vector<std::span<double>> memory() const;

  // Number of samples with a value beyond a part's range, for Sensor::saturated. The converter
  // clips such a value; valid_range only counts it.
  [[nodiscard]] std::uint64_t saturated() const;

  // The flags of the part that raises flags (ElectronicsStage::range_flags); empty: no part does.
  [[nodiscard]] std::span<const float> range_flags() const;

 private:
  std::vector<std::unique_ptr<ElectronicsStage>> stages_;
};

// True if a part of the electronics draws random numbers, per recording or per device. Throws
// std::logic_error for an unknown part.
bool draws_numbers(const std::string& part);

// One part of a sensor's electronics, as the sensor declares it.
struct PartFigures {
  // A default that differs from the part's own.
  struct Default {
    std::string parameter, text, source;
  };
  std::string part;
  std::string source;  // source of its figures in the SignalModel
  std::vector<Default> defaults = {};
  std::vector<ParameterSpec> parameters = {};  // further ones, with which the sensor fills its SignalModel
};

// Returns the parts of a sensor in the order of `figures`, which is also their order in `typical`.
// The source of a part is the sensor's source followed by the part's own; the defaults and further
// parameters are those of the sensor. `device`: its name in the source, "PapillArray". Throws
// std::logic_error for an unknown part or parameter.
std::vector<Entry> electronics_of(const std::string& device, const std::vector<PartFigures>& figures);

}  // namespace slipbench
