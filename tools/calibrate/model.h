// The scene as a function of the fitted keys, from their places between the bounds to the sensors'
// readings.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "sim/core/quantity.h"
#include "sim/scene/catalogues.h"
#include "sim/scene/parser.h"
#include "tools/dataset/record/json.h"
#include "tools/dataset/record/trial_record.h"

namespace slipbench::calibrate {

// Offset of the recordings' clock from the scene's; the only fit key that is not a key of the
// scene.
inline constexpr const char* lag_key = "lag";

struct FitKey {
  std::string path;                    // "motion.tilt.0"
  double min = 0.0, max = 1.0;         // SI, min < max
  bool logarithmic = false;            // draw: log_uniform, so min is above 0
  bool each = false;                   // every recording has its own value
  Quantity quantity = Quantity::none;  // that of the bounds' units

  // Converts a place (0 at min, 1 at max) to a value [SI] and back. A value beyond the bounds has a
  // place outside 0 to 1.
  [[nodiscard]] double value(double place) const;
  [[nodiscard]] double place(double value) const;
  // True if the bounds are a whole turn apart: an angle whose places 0 and 1 are the same. Its places
  // go on beyond both, so that an angle next to a bound has neighbours on both sides.
  [[nodiscard]] bool circular() const;
  // Formats a value of this key with its unit.
  [[nodiscard]] std::string text(double value, int digits = 4) const;
};

// Parses a YAML map of fit keys, "KEY: {min: .., max: .., draw: uniform or log_uniform, each: true
// or false}"; draw and each are optional. Throws InputError with the value found and those allowed.
std::vector<FitKey> parse_fit_keys(const std::string& text);

// Returns the fitted scene as YAML: comments with the fitted values and their intervals, then
// `file` with the values of `result` (calibrate.h). The sweep draws each key with `each` from the
// centre and scatter that were found.
std::string fitted_scene(const SceneFile& file, const std::vector<FitKey>& keys, const Json& result);

// Disturbances of a simulated recording.
enum class Readings {
  ideal,  // without drawn disturbances; scanning and conversion remain
  read,   // with those of the scene
};

// Meaning of a trial of the scene.
enum class Trials {
  recordings,  // one recording; the values drawn by a sweep would be unknown
  groups,      // a draw of a group of recordings; a group is a cell of the grid
};

// The parameters are the keys in their order; a key with `each` has one parameter per recording,
// one after the other.
class Model {
 public:
  // `file`: includes the settings of the command line. `catalogues` must outlive the model. Throws
  // InputError for an unreadable scene, a key that the scene does not have or that is not a number,
  // a sweep that draws a value that is not fitted, and two keys with the same path. With
  // Trials::groups also for a key with `each`, and for the lag.
  Model(const SceneFile& file, const Catalogues& catalogues, std::vector<FitKey> keys, std::uint64_t seed,
        Trials kind = Trials::recordings);

  // Number of trials of the scene's sweep, where recording r is trial r; and of trials in each cell
  // of its grid.
  [[nodiscard]] std::size_t trials() const { return trials_; }
  [[nodiscard]] std::size_t draws() const { return draws_; }
  // Sets the number of recordings. All are repetitions of the trial if the scene has only one.
  // Throws InputError unless the scene has one trial or `count`.
  void use_recordings(std::size_t count);
  [[nodiscard]] std::size_t recordings() const { return recordings_; }

  [[nodiscard]] const std::vector<FitKey>& keys() const { return keys_; }
  [[nodiscard]] std::size_t parameters() const;
  // Returns the key of a parameter, and the recording it belongs to (empty: all recordings).
  [[nodiscard]] std::size_t key_of(std::size_t parameter) const;
  [[nodiscard]] std::optional<std::size_t> recording_of(std::size_t parameter) const;
  // Returns the parameter of a key in a recording.
  [[nodiscard]] std::size_t parameter_of(std::size_t key, std::size_t recording) const;

  // Places of the scene's unfitted values, by key; 0.5 for a value outside the bounds.
  [[nodiscard]] const Eigen::VectorXd& own_places() const { return own_; }
  // True if the parameter's key is circular().
  [[nodiscard]] bool circular(std::size_t parameter) const { return keys_[key_of(parameter)].circular(); }
  // Distances of the places of all parameters from the scene's own, the short way round a circle.
  [[nodiscard]] Eigen::VectorXd from_own(const Eigen::VectorXd& places) const;
  // Expands one place per key to the places of all parameters.
  [[nodiscard]] Eigen::VectorXd spread(const Eigen::VectorXd& by_key) const;

  // Returns the sensors' readings in a recording. `places`: of all parameters, each from 0 to 1,
  // of a circular() key any.
  // `seed`: of the draws. `again`: another number repeats the recording with the same device and
  // other noise. Throws InputError with the values that the scene refuses, and Interrupted.
  [[nodiscard]] std::vector<SensorRecord> simulate(const Eigen::VectorXd& places, std::size_t recording, Readings readings,
                                                   std::uint64_t seed, const std::atomic<bool>* interrupt,
                                                   std::size_t again = 0) const;
  // The same with Trials::groups and the scene's electronics. `seed`: of the sweep's draws.
  // `device`: seed of all other random numbers.
  [[nodiscard]] std::vector<SensorRecord> simulate_drawn(const Eigen::VectorXd& places, std::size_t trial, std::uint64_t seed,
                                                         std::uint64_t device, const std::atomic<bool>* interrupt) const;
  // Returns by how much the recording's clock is later than the scene's [s].
  [[nodiscard]] double lag(const Eigen::VectorXd& places, std::size_t recording) const;

  [[nodiscard]] std::uint64_t seed() const { return seed_; }

 private:
  [[nodiscard]] double value(const Eigen::VectorXd& places, std::size_t key, std::size_t recording) const;
  // Puts the values of a recording into the scene. Returns them as text for messages.
  std::string apply(SceneFile& file, const Eigen::VectorXd& places, std::size_t recording) const;

  std::vector<SceneFile> files_;  // one per trial, without a sweep; with Trials::groups a single one with its sweep
  const Catalogues* catalogues_;
  std::vector<FitKey> keys_;
  Eigen::VectorXd own_;
  std::uint64_t seed_;
  std::size_t trials_ = 1, draws_ = 1;
  std::size_t recordings_;
};

// Returns the seed of draw `number` of the kind `what`.
std::uint64_t seed_of(std::uint64_t seed, std::uint64_t number, const std::string& what);

}  // namespace slipbench::calibrate
