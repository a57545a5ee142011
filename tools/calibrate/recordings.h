// Recordings to be fitted, and their values that are compared: the mean of every channel over short
// stretches of time.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "tools/dataset/record/trial_record.h"

namespace slipbench {
struct ImportFormat;
}

namespace slipbench::calibrate {

// The sensors' data of one recording: SensorRecords without labels.
struct RawRecording {
  std::string name;  // for people: "logs/a.csv", "demo_3 of stage.h5"
  std::vector<SensorRecord> sensors;
  std::string params = "{}";  // TrialRecord::params: known facts, such as its class
};

// Reads recordings. `paths`: datasets, whose trials are the recordings in their order, or, with
// `format`, sources as for `slipbench import`. Throws InputError for unreadable paths, no
// recording, a path given twice, values that are not finite, and samples that are not
// evenly_spaced().
std::vector<RawRecording> read_recordings(const std::vector<std::string>& paths, const ImportFormat* format);

// One array of a sensor among the columns that are compared: units times components, a column each,
// components fastest.
struct ChannelPlace {
  std::string sensor;               // the scene's name
  std::string channel, unit;        // "force", "N"
  std::vector<std::string> names;   // of the components: "FX", "FY", "FZ"; one empty name where a unit has one value
  std::size_t units = 0;            // 9
  std::size_t components = 0;       // 3
  std::size_t first = 0;            // its first column
  std::size_t recorded_sensor = 0;  // index of the sensor in a recording
  std::size_t scene_sensor = 0;     // index of the sensor in the scene

  [[nodiscard]] std::size_t column(std::size_t of_unit, std::size_t component) const {
    return first + of_unit * components + component;
  }
};

struct Columns {
  std::vector<ChannelPlace> channels;
  std::size_t count = 0;
};

// Returns the arrays that both have. A recording's sensor corresponds to the simulated one of the
// same name, or to the only one of its type. Throws InputError if they share no array or an array's
// shape differs.
Columns shared_columns(const RawRecording& real, const std::vector<SensorRecord>& simulated);

// Throws InputError with both recordings' names if their compared arrays differ.
void check_same_columns(const std::string& name, const Columns& columns, const std::string& first_name, const Columns& first);

// Largest ratio of durations between a recording and its trial. With a known motion, only the time
// that both have is compared; a stage's log that is stopped by hand ends within a few percent. With
// an unknown motion, the last parts of all recordings are compared (groups.cc).
inline constexpr double most_longer_curves = 1.1, most_longer_groups = 2.0;

// Throws InputError with both figures if, beyond `lag` [s], a compared sensor's data lasts more
// than `most_longer` times as long as in the scene or the other way round, or if a channel has
// another rate than in the scene (same_rate()).
void check_same_sampling(const RawRecording& real, const std::vector<SensorRecord>& simulated, const Columns& columns,
                         double most_longer, double lag);

// Source of the sensors' data; the order of sensors in a recording may differ from the scene's.
enum class Side { real, scene };

// The samples of an array [T, units times components], and their mean period [s].
struct Samples {
  Eigen::MatrixXd values;
  double step = 0.0;
};
Samples samples_of(const std::vector<SensorRecord>& sensors, Side side, const ChannelPlace& place);

// Returns the edges of the stretches in which a recording is compared [s], by the scene's clock,
// where the recording's first sample has the time of the first simulated one. The stretches have
// equal lengths; there is one per sample interval, but at most `most_bins`. Throws InputError for a
// single sample.
inline constexpr std::size_t most_bins = 200;
std::vector<double> bin_edges(const RawRecording& real, const std::vector<SensorRecord>& simulated);

// Returns the mean of every column in every stretch [bins, columns], with linear interpolation
// between samples and constant values before the first and after the last. `shift`: added to the
// sensors' times [s].
Eigen::MatrixXd bin_means(const std::vector<SensorRecord>& sensors, Side side, const Columns& columns,
                          const std::vector<double>& edges, double shift);

// Returns by column the RMS of the steps between samples over sqrt(2); for white noise, its
// standard deviation.
Eigen::VectorXd roughness(const std::vector<SensorRecord>& sensors, Side side, const Columns& columns);

// Root mean square of each entry over the values, at least one.
Eigen::VectorXd rms_over(const std::vector<Eigen::VectorXd>& values);

}  // namespace slipbench::calibrate
