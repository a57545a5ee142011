// Recordings to be fitted, and their values that are compared: the mean of every channel over short
// stretches of time.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "tools/base/record/trial_record.h"

namespace slipbench {
struct ImportFormat;
}

namespace slipbench::calibrate {

// The sensors' data of one recording: SensorRecords without labels.
struct RawRecording {
  std::string name;  // for people: "logs/a.csv", "demo_3 of stage.h5"
  std::vector<SensorRecord> sensors;
  std::string params = "{}";  // TrialRecord::params: what is known of it, such as its class
};

// Reads recordings. `paths`: datasets, whose trials are the recordings in their order, or, with
// `format`, sources as for `slipbench import`. Throws InputError for unreadable paths, no
// recording, a path given twice, values that are not finite, and samples that are not
// evenly_spaced().
std::vector<RawRecording> read_recordings(const std::vector<std::string>& paths, const ImportFormat* format);

// One array of a sensor among the columns that are compared: units times components, a column each, components fastest.
struct ChannelPlace {
  std::string sensor;               // the scene's name
  std::string channel, unit;        // "force", "N"
  std::vector<std::string> names;   // of the components: "FX", "FY", "FZ"; one empty name where a unit has one value
  std::size_t units = 0;            // 9
  std::size_t components = 0;       // 3
  std::size_t first = 0;            // its first column
  std::size_t recorded_sensor = 0;  // which sensor of a recording
  std::size_t scene_sensor = 0;     // which of the scene

  [[nodiscard]] std::size_t column(std::size_t of_unit, std::size_t component) const {
    return first + of_unit * components + component;
  }
};

struct Columns {
  std::vector<ChannelPlace> channels;
  std::size_t count = 0;
};

// The arrays that both have. A recording's sensor is the simulated one of the same name, or the only one of its type. Throws InputError where
// they share none, or where an array's shape differs.
Columns shared_columns(const RawRecording& real, const std::vector<SensorRecord>& simulated);

// Throws InputError with both recordings' names where they are not compared in the same arrays.
void check_same_columns(const std::string& name, const Columns& columns, const std::string& first_name, const Columns& first);

// How much longer or shorter than its trial a recording may be. Where the motion is known, what one has and the other lacks is not compared: a
// stage's log that is stopped by hand ends within some percent. Where the motion is unknown, all are compared by their last part (groups.cc).
inline constexpr double most_longer_curves = 1.1, most_longer_groups = 2.0;

// Throws InputError with both figures where a compared sensor lasts more than `most_longer` times as long as in the scene or the other way round, not counting
// `lag` [s], or where a channel has another rate than in the scene (same_rate()).
void check_same_sampling(const RawRecording& real, const std::vector<SensorRecord>& simulated, const Columns& columns,
                         double most_longer, double lag);

// Whose sensors are read: in a recording they may stand in another order than in the scene.
enum class Side { real, scene };

// The samples of an array: [T, units times components], and the mean time from one to the next [s].
struct Samples {
  Eigen::MatrixXd values;
  double step = 0.0;
};
Samples samples_of(const std::vector<SensorRecord>& sensors, Side side, const ChannelPlace& place);

// The ends of the stretches in which a recording is compared [s, of the scene's clock; the recording's first sample has the time of the first
// simulated one]: all alike, as many as there are samples but no more than `most`.
inline constexpr std::size_t most_bins = 200;
std::vector<double> bin_edges(const RawRecording& real, const std::vector<SensorRecord>& simulated);

// The mean of every column in every stretch, of the straight lines between samples: [bins, columns]. Before its first sample and after its last
// one an array stands still. `shift`: what is added to the sensors' times [s].
Eigen::MatrixXd bin_means(const std::vector<SensorRecord>& sensors, Side side, const Columns& columns,
                          const std::vector<double>& edges, double shift);

// By column the RMS of the steps from sample to sample, over the square root of two: of white noise its standard deviation.
Eigen::VectorXd roughness(const std::vector<SensorRecord>& sensors, Side side, const Columns& columns);

// Root mean square of each entry over the values, at least one.
Eigen::VectorXd rms_over(const std::vector<Eigen::VectorXd>& values);

}  // namespace slipbench::calibrate
