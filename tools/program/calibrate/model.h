// The scene as a function of what is fitted: from places between bounds to what its sensors read.
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
#include "tools/base/record/json.h"
#include "tools/base/record/trial_record.h"

namespace slipbench::calibrate {

// What is to be fitted: a key of the scene and where its value may lie.

// The recordings' clock against the scene's: the one key that is none of the scene.
inline constexpr const char* lag_key = "lag";

struct FitKey {
  std::string path;                    // "motion.tilt.0"
  double min = 0.0, max = 1.0;         // SI, min < max
  bool logarithmic = false;            // draw: log_uniform, so min is above 0
  bool each = false;                   // every recording has a value of its own
  Quantity quantity = Quantity::none;  // as the units of the bounds tell

  // The value at `place`, 0 at min and 1 at max; and the place of a value, which may lie outside.
  [[nodiscard]] double value(double place) const;
  [[nodiscard]] double place(double value) const;
  // A value of this key with its unit.
  [[nodiscard]] std::string text(double value, int digits = 4) const;
};

// Reads "KEY: {min: .., max: .., draw: uniform or log_uniform, each: true or false}", a YAML map of one key or several; draw and each may be left
// out. Throws InputError: what was found, what is allowed.
std::vector<FitKey> parse_fit_keys(const std::string& text);

// The scene file with what was fitted in it.

// YAML: at its head what was fitted and how well it is known, then `file` with the values of `result` (calibrate.h) in it. A key of every
// recording is drawn by the sweep, with the centre and scatter that were found.
std::string fitted_scene(const SceneFile& file, const std::vector<FitKey>& keys, const Json& result);

// Whose disturbances a simulated recording has.
enum class Readings {
  ideal,  // none that is drawn: scanning and conversion remain
  read,   // those that the scene says
};

// What a trial of the scene stands for.
enum class Trials {
  recordings,  // one recording each: what its sweep draws would be unknown
  groups,      // a cell of the grid a group of recordings, of which the trials are draws
};

// The parameters are all keys in their order; a key with `each` stands there once for every recording, one after the other.
class Model {
 public:
  // `file`: with what the command line sets. `catalogues` must outlive the model. Throws InputError for a scene that cannot be read, a key that the
  // scene does not have or takes no number, a sweep that draws what is not fitted, and two keys of the same path.
  // With Trials::groups also for a key that single recordings have a value of.
  Model(const SceneFile& file, const Catalogues& catalogues, std::vector<FitKey> keys, std::uint64_t seed,
        Trials kind = Trials::recordings);

  // Trials of the scene's sweep, of which recording r is trial r; and how many there are of each cell of its grid.
  [[nodiscard]] std::size_t trials() const { return trials_; }
  [[nodiscard]] std::size_t draws() const { return draws_; }
  // With one trial, of which all recordings are repetitions. Throws InputError where the scene has neither one trial nor `count`.
  void use_recordings(std::size_t count);
  [[nodiscard]] std::size_t recordings() const { return recordings_; }

  [[nodiscard]] const std::vector<FitKey>& keys() const { return keys_; }
  [[nodiscard]] std::size_t parameters() const;
  // The key of a parameter, and of which recording it is (empty: of all).
  [[nodiscard]] std::size_t key_of(std::size_t parameter) const;
  [[nodiscard]] std::optional<std::size_t> recording_of(std::size_t parameter) const;
  // The parameter of a key in a recording.
  [[nodiscard]] std::size_t parameter_of(std::size_t key, std::size_t recording) const;

  // Where the scene itself stands: the place of its own value where that is between the bounds, else the middle. By key.
  [[nodiscard]] const Eigen::VectorXd& own_places() const { return own_; }
  // A place for every key, as places of all parameters.
  [[nodiscard]] Eigen::VectorXd spread(const Eigen::VectorXd& by_key) const;

  // What the sensors read in a recording. `places`: of all parameters, each within 0 and 1. `seed`: of the draws; `again`:
  // another number for the same recording once more by the same device. Throws InputError with the values that the scene refuses, and Interrupted.
  [[nodiscard]] std::vector<SensorRecord> simulate(const Eigen::VectorXd& places, std::size_t recording, Readings readings,
                                                   std::uint64_t seed, const std::atomic<bool>* interrupt,
                                                   std::size_t again = 0) const;
  // The same with Trials::groups, as the scene's electronics read it. `device`: of all random numbers but the sweep's draws, which are of `seed`.
  [[nodiscard]] std::vector<SensorRecord> simulate_drawn(const Eigen::VectorXd& places, std::size_t trial, std::uint64_t seed,
                                                         std::uint64_t device, const std::atomic<bool>* interrupt) const;
  // How much later than the scene's the recording's clock is [s].
  [[nodiscard]] double lag(const Eigen::VectorXd& places, std::size_t recording) const;

  [[nodiscard]] std::uint64_t seed() const { return seed_; }

 private:
  [[nodiscard]] double value(const Eigen::VectorXd& places, std::size_t key, std::size_t recording) const;
  // Puts the values of a recording into the scene; returns them for messages.
  std::string apply(SceneFile& file, const Eigen::VectorXd& places, std::size_t recording) const;

  std::vector<SceneFile> files_;  // a trial each, without a sweep; with Trials::groups one, with it
  const Catalogues* catalogues_;
  std::vector<FitKey> keys_;
  Eigen::VectorXd own_;
  std::uint64_t seed_;
  std::size_t trials_ = 1, draws_ = 1;
  std::size_t recordings_;
};

// The seed of draw `number` of all that is called `what`.
std::uint64_t seed_of(std::uint64_t seed, std::uint64_t number, const std::string& what);

}  // namespace slipbench::calibrate
