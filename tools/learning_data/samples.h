// Access to recorded samples, shared by the export formats.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/api/pad_state.h"
#include "sim/api/sensor_frame.h"
#include "tools/dataset/reader.h"
#include "tools/dataset/record/trial_record.h"
#include "tools/learning_data/label_rules.h"

namespace slipbench {

// Names of a trial's sensors, or only the requested ones, in the trial's order. Throws InputError
// if the trial has no recording or no sensor of such a name.
std::vector<std::string> chosen_sensors(const DatasetReader& reader, std::size_t trial, const std::vector<std::string>& asked);

// Times closer than this [s] are equal, since k/rate and the like are rounded.
inline constexpr double time_rounding = 1e-9;

// Index of the latest of ascending `times` [s] at or before `time`; empty if there is none.
std::optional<std::size_t> latest_row(std::span<const double> times, double time);

// A sensor's readings and labels at instants 1/`rate` apart [Hz], from the first at which all its
// channels have a value to its last sample. Each value is the latest at or before the instant,
// neither filtered nor interpolated, and no channel keeps its own time stamps. Events keep their
// times. Throws InputError, naming the trial, for a rate above the sensor's and if fewer than two
// rows would remain.
SensorRecord at_rate(SensorRecord sensor, double rate, std::size_t trial);

// Speed above which a tip slides by the rules paper and has_slipped, as a camera sees it.
inline constexpr double default_label_speed = 1e-4;  // m/s

// A recorded sensor's samples in order, as measured.
class RecordedSamples {
 public:
  // `sensor` must outlive this object. Throws InputError for a channel whose number of values does
  // not match its rows and shape.
  explicit RecordedSamples(const SensorRecord& sensor);

  [[nodiscard]] SensorSource source() const { return {sensor_->name, sensor_->type, sensor_->rate, channels_}; }
  [[nodiscard]] const std::vector<Channel>& channels() const { return channels_; }
  [[nodiscard]] bool ended() const { return next_ == sensor_->time.size(); }
  [[nodiscard]] double time() const { return sensor_->time[next_]; }  // s, of the next sample

  // Returns the next sample. A slower channel holds its latest complete row, or its first row
  // before that.
  SensorFrame take();

 private:
  const SensorRecord* sensor_;
  std::vector<Channel> channels_;
  std::vector<float> values_;
  std::size_t next_ = 0;
};

// Commanded motion of a trial's pad.

// Distance of a corner pillar from the centre [m], where a PapillArray's rotation is given as a
// speed.
inline constexpr double corner_radius = 9.9e-3;

struct CommandedMotion {
  double speed = 0.0;        // m/s, motion.speed
  double rotation = 0.0;     // rad/s, motion.rotation
  double compression = 0.0;  // m, motion.compression
};

// Values from the sweep, else from the overrides and the scene in the dataset, else the motion's
// defaults. Throws InputError if the scene is unreadable or its motion lacks these values.
CommandedMotion commanded_motion(const DatasetReader& reader, std::size_t trial);

// One number of the motion from the same sources; empty if this kind of motion has none of that
// name. Throws InputError as commanded_motion().
std::optional<double> commanded_number(const DatasetReader& reader, std::size_t trial, const std::string& name);

// A word of the scene, such as that at "surface.material", as swept or written; "" if neither.
// Throws InputError if the scene is unreadable.
std::string commanded_word(const DatasetReader& reader, std::size_t trial, const std::string& path);

inline constexpr std::size_t pillars = 9;
inline constexpr std::size_t middle_pillar = 4;

// Columns of the vendor's log of `sensors` sensors, in its manual's order: T_us, S0_P0_DX, ...
std::vector<std::string> vendor_log_columns(std::size_t sensors);

// Columns of a bts3v2 file, which has one row per grasp with three BioTac SP: object, slipped,
// ff_biotac_1, ...
inline constexpr std::array<const char*, 3> grasp_fingers{"ff", "mf", "th"};
inline constexpr std::size_t finger_electrodes = 24;
std::vector<std::string> grasp_columns();

// The truth about the pillars of a PapillArray, sample by sample.
class PillarLabels {
 public:
  // Arrays as in LabelRecord, which must outlive this object: `unit_state` [T,9], `slip_velocity`
  // [T,9,2] m/s, `force` [T,9,3] N. `rule`: one of LabelUse::pillars. `label_speed` [m/s]: for the
  // rules that need it. Throws InputError if an array has another size.
  PillarLabels(std::span<const std::uint8_t> unit_state, std::span<const float> slip_velocity, std::span<const float> force,
               LabelRule rule, double label_speed);

  [[nodiscard]] std::size_t size() const { return unit_state_.size() / pillars; }
  [[nodiscard]] bool touching(std::size_t row, std::size_t pillar) const { return state(row, pillar) != UnitState::detached; }
  // True by the chosen rule.
  [[nodiscard]] bool slipping(std::size_t row, std::size_t pillar) const;
  // State of the pad: none, some or all of the touching pillars slip by that rule. `turning`: true
  // if the motion turns the pad; then the centre pillar, which stays in place, is ignored.
  [[nodiscard]] PadState pad_state(std::size_t row, bool turning) const;
  // True tangential force [N].
  [[nodiscard]] double tangential_force(std::size_t row, std::size_t pillar) const;

 private:
  [[nodiscard]] UnitState state(std::size_t row, std::size_t pillar) const {
    return static_cast<UnitState>(unit_state_[row * pillars + pillar]);
  }
  // True if the tip of a touching pillar slides faster than the threshold in this sample.
  [[nodiscard]] bool fast(std::size_t row, std::size_t pillar) const;

  std::span<const std::uint8_t> unit_state_;
  std::span<const float> slip_velocity_, force_;
  LabelRule rule_;
  double label_speed_;
  std::vector<std::uint8_t> has_slipped_;  // [T,9] 1: fast now or earlier, and in contact since; empty for other rules
};

// One PapillArray's samples: force and displacement of every pillar, and the truth.
class PapillarraySamples : public PillarLabels {
 public:
  // `record` must outlive this object; the others as for PillarLabels. Throws InputError if the
  // sensor is not a PapillArray with nine pillars.
  PapillarraySamples(const SensorRecord& record, LabelRule rule, double label_speed);

  [[nodiscard]] double time(std::size_t row) const { return record_->time[row]; }  // s
  [[nodiscard]] std::array<float, 3> force(std::size_t row, std::size_t pillar) const {
    return triple(*force_, row, pillar);
  }                                                                                             // N
  [[nodiscard]] std::array<float, 3> displacement(std::size_t row, std::size_t pillar) const {  // m
    return triple(*displacement_, row, pillar);
  }
  // Undeformed tip in the pad frame [m].
  [[nodiscard]] std::array<double, 3> tip(std::size_t pillar) const;

 private:
  static std::array<float, 3> triple(const std::vector<float>& values, std::size_t row, std::size_t pillar) {
    const float* first = values.data() + (row * pillars + pillar) * 3;
    return {first[0], first[1], first[2]};
  }

  const SensorRecord* record_;
  const std::vector<float>* force_ = nullptr;
  const std::vector<float>* displacement_ = nullptr;
};

// Names of the PapillArrays among a trial's sensors.
std::vector<std::string> papillarrays_of(const DatasetReader& reader, std::size_t trial);

}  // namespace slipbench
