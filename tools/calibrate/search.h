// The scene as a function of the fitted keys, from their places between the bounds to the sensors'
// readings; and the search for the places that fit best.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>

#include "sim/core/quantity.h"
#include "sim/scene/catalogues.h"
#include "sim/scene/parser.h"
#include "tools/calibrate/recordings.h"
#include "tools/dataset/record/json.h"

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
  // Expands one place per key to the places of all parameters.
  [[nodiscard]] Eigen::VectorXd spread(const Eigen::VectorXd& by_key) const;

  // Returns the sensors' readings in a recording. `places`: of all parameters, each from 0 to 1.
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

// Effects of a sensor's electronics on its readings, and how much of the difference between two
// recordings they explain.

// Model of a reading y of one component of a channel, the same for every unit:
//   y = s + gain (s - s_begin) + sum of coupling (s' - s'_begin) + offset + remainder
// s is the ideal reading, s_begin its first value, s' runs over the unit's other components. Gain
// and couplings are drawn once per device, the offset once per recording.
struct Disturbance {
  double gain_sd = 0.0;       // relative
  double coupling_sd = 0.0;   // dimensionless, since all components of a channel have one unit
  double offset_sd = 0.0;     // in the channel's unit
  double remainder_sd = 1.0;  // of the mean of a stretch, in the channel's unit; the sensor's repeatability
};

// The columns of several recordings, [recording](bins, columns).
using Waves = std::vector<Eigen::MatrixXd>;

// Distance between recordings and simulated ones after subtracting possible effects of the
// electronics.
struct Distance {
  Eigen::VectorXd
      residual;  // of all stretches by recording and column, over remainder_sd; then offsets, gains and couplings over their sds
  std::vector<Eigen::Index>
      group;                      // of each entry of `residual`; entries of one group may be correlated (a column of a recording)
  Waves explained;                // the simulated recordings with the best gains, couplings and offsets
  Eigen::VectorXd gain;           // by column
  Eigen::MatrixXd offset;         // by recording and column
  double squared = 0.0;           // residual' residual
  bool possible = true;           // false: the scene refuses too many trials to compare any; `squared` is then very large
  Eigen::Index compared = 0;      // number of entries of `residual` that are of recordings
  double compared_squared = 0.0;  // sum of squares of those
};

class Disturbances {
 public:
  // Estimates the disturbances from pairs of readings of a scene with and without its electronics,
  // where each pair is another device. `floor`: the least remainder of a component, as a share of
  // its range over all recordings.
  Disturbances(const Columns& columns, const std::vector<Waves>& read, const std::vector<Waves>& ideal, double floor);

  [[nodiscard]] const Columns& columns() const { return columns_; }
  // Ordered by channel, then by component.
  [[nodiscard]] const std::vector<Disturbance>& by_component() const { return disturbances_; }

  // Returns the best linear fit of `read` by `ideal` under these disturbances: ridge regression
  // with a Gaussian prior of each sd, the linear part of a variable projection (Golub and Pereyra
  // 1973). The gains of a component have the mean 1 over its units, weighted by the units' signal
  // energy: a gain common to all units cannot be distinguished from the sensor's stiffness or
  // sensitivity.
  [[nodiscard]] Distance distance(const Waves& read, const Waves& ideal) const;

  // Returns, by column, the common gain: a device's changes from its first value, divided by it,
  // have gains with the mean 1.
  [[nodiscard]] Eigen::VectorXd common_gain(const Waves& read, const Waves& ideal) const;

 private:
  Columns columns_;
  std::vector<Disturbance> disturbances_;
};

// Recordings, the scene that is fitted to them, and the distance between both.
struct Problem {
  const Model* model = nullptr;
  std::size_t jobs = 1;
  const std::atomic<bool>* interrupt = nullptr;

  Problem(const Model* fitted, std::size_t threads, const std::atomic<bool>* stop)
      : model(fitted), jobs(threads), interrupt(stop) {}
  Problem(const Problem&) = delete;
  Problem& operator=(const Problem&) = delete;
  virtual ~Problem() = default;

  // Returns the values of a simulated recording that are compared.
  [[nodiscard]] virtual Eigen::MatrixXd wave(const Eigen::VectorXd& places, std::size_t recording) const = 0;
  // Returns the distance of simulated recordings from the real ones.
  [[nodiscard]] virtual Distance distance(const Waves& simulated) const = 0;
  // Returns S, whose columns are independent contributions to the random scatter of the gradient of
  // Distance::squared/2: the gradient's covariance is S S'. `slopes`: d residual/d places.
  [[nodiscard]] virtual Eigen::MatrixXd scores(const Distance& distance, const Eigen::MatrixXd& slopes) const = 0;
  // Step to either side of a slope's central difference, as a share of the bounds.
  [[nodiscard]] virtual double difference() const = 0;
  // Evaluations of a start's global and local search, each times the number of keys plus one.
  struct Evaluations {
    std::size_t global, local;
  };
  [[nodiscard]] virtual Evaluations evaluations() const = 0;

  // Returns Distance::squared plus a Gaussian prior around the scene's own values with the sd of
  // the bounds, (max - min)/sqrt(12). The prior keeps a parameter that the recordings do not
  // determine at the scene's value.
  [[nodiscard]] double cost(const Waves& simulated, const Eigen::VectorXd& places) const;
};

// Compares curves in time, after subtracting possible effects of the electronics.
struct CurveProblem : Problem {
  const Disturbances* disturbances = nullptr;
  std::vector<std::vector<double>> edges;  // of each recording, bin_edges()
  Waves real;

  using Problem::Problem;
  [[nodiscard]] Eigen::MatrixXd wave(const Eigen::VectorXd& places, std::size_t recording) const override;
  [[nodiscard]] Distance distance(const Waves& simulated) const override;
  // Residuals of one column of a recording are correlated: noise is red, and model errors last for
  // a while.
  [[nodiscard]] Eigen::MatrixXd scores(const Distance& distance, const Eigen::MatrixXd& slopes) const override;
  [[nodiscard]] double difference() const override { return 0.004; }
  [[nodiscard]] Evaluations evaluations() const override { return {60, 25}; }
};

struct SearchOptions {
  std::size_t starts = 4;
  std::function<void(std::size_t done, std::size_t of)>
      progress;  // simulated recordings; called from the calling thread; may be empty
};

// End of one start's global and local search, by key.
struct Start {
  Eigen::VectorXd places;
  double cost = 0.0;
  std::size_t evaluations = 0;
};

// How well a parameter is known. Places: 0 at min, 1 at max.
struct Known {
  double sd = 0.0;  // of its place
  bool determined =
      false;  // the 95 % interval is narrower than half of the bounds, and the profile rises by a chi-square of 0.95 on both sides
  // Places around the fit, and the rise of the cost over `scale` with the parameter there and all
  // others at the values that the covariance then predicts.
  std::vector<std::pair<double, double>> profile;
};

struct Solution {
  std::vector<Start> starts;
  Eigen::VectorXd places;  // of all parameters
  double cost = 0.0;
  double scale = 1.0;          // the residuals' variance against the sensor's repeatability, at least 1
  Eigen::MatrixXd covariance;  // of the places
  std::vector<Known> known;    // by parameter
  Waves ideal;                 // the ideal readings there
  Distance distance;
};

// Returns the best fit; bit-identical for any number of threads. Throws Interrupted, and InputError
// as Model::simulate.
Solution search(const Problem& problem, const SearchOptions& options);

// Minimises `cost` over `places`, each from 0 to 1, with NLopt, and returns the least cost: with
// Subplex if `first_step` is given, else with CRS2. Ends once no place moves by more than
// `tolerance`, or after `evaluations`. Throws what `cost` throws.
double minimise(Eigen::VectorXd& places, const std::function<double(const Eigen::VectorXd&)>& cost,
                std::optional<double> first_step, double tolerance, std::size_t evaluations);

// Half-width of a 95 % interval over the sd.
inline constexpr double half_interval = 1.96;
// A parameter is determined if that half-width is a smaller share of the bounds.
inline constexpr double widest_known = 0.25;
// True if a place is at a bound, which then limits the search and the interval.
[[nodiscard]] bool at_lower_bound(double place);
[[nodiscard]] bool at_upper_bound(double place);

// Keys of a sensor's electronics (the scale of its noise, of its gains, ...), by how much they disturb.

// True for a key of the electronics, which curves without noise do not show.
bool of_electronics(const FitKey& key);

// Returns the sizes of the recordings' disturbances, four per component: scatter of the gains, of
// the offsets, remainder of the curves, and roughness; natural logarithms of RMS values, minus
// infinity for no disturbance.
Eigen::VectorXd disturbance_sizes(const Columns& columns, const Waves& read, const Distance& distance,
                                  const Eigen::VectorXd& rough);

struct ElectronicsFit {
  Eigen::VectorXd places;
  std::vector<Known> known;  // without profiles
};

// Returns the places at which simulated devices have disturbances as large as the real one's: least
// squares of `sizes`, weighted by their variance between devices. `model`: of keys of the
// electronics only, on the fitted scene. `problem`: provides the edges and disturbances.
ElectronicsFit fit_electronics(const Model& model, const CurveProblem& problem, const Eigen::VectorXd& sizes);

// Recordings whose motion is unknown. Groups of them are compared by the means over a group.

// A group is the recordings whose label (TrialRecord::params) has the same value. The k-th value is
// the k-th cell of the scene's grid.
struct Groups {
  std::string label;                // "class"
  std::vector<std::string> values;  // "n", "e"; different ones
};

// Parses "class=n,e,s". Throws InputError with the text found and the form allowed.
Groups parse_groups(const std::string& text);

// One statistic, computed for every value of an array.
struct Statistic {
  std::size_t channel = 0;  // of Columns
  std::string name;         // "level", "trend", or the length of a band: "20 ms"
  std::string unit;         // of the channel; "ln": a natural logarithm
  std::size_t first = 0;    // column of the array's first value among all figures
};

// Returns the figures of samples [T, values], one figure per row: level (mean), trend (mean of the
// second half minus that of the first), and natural logarithms of Allan deviations: the RMS of the
// steps between the means of stretches of 1, 2, 4, ... samples, over sqrt(2), as long as there are
// four stretches. `floor`: by value; a deviation d becomes sqrt(d^2 + floor^2).
Eigen::MatrixXd figures_of(const Eigen::MatrixXd& samples, const Eigen::RowVectorXd& floor);

// Compares the mean of each figure over the recordings of a group, real minus simulated, over its
// standard deviation. The variance of the real mean follows from the scatter within the groups,
// that of the simulated mean from whole sets that are simulated with other devices and draws.
class GroupProblem : public Problem {
 public:
  // `fitted`: must outlive the problem. `recordings`: with labels that are in `groups`. `own`:
  // places of the scene itself, at which the sets are simulated. Throws InputError for recordings
  // and a scene that do not fit each other or the groups, and Interrupted.
  GroupProblem(const Model* fitted, const Groups& groups, const std::vector<RawRecording>& recordings, const Eigen::VectorXd& own,
               std::size_t threads, const std::atomic<bool>* stop);

  [[nodiscard]] Eigen::MatrixXd wave(const Eigen::VectorXd& places, std::size_t trial) const override;  // a row of figures
  [[nodiscard]] Distance distance(const Waves& simulated) const override;
  [[nodiscard]] Eigen::MatrixXd scores(const Distance& distance, const Eigen::MatrixXd& slopes) const override;
  // Wider than for curves: counts are integers, so a mean of few recordings has steps.
  [[nodiscard]] double difference() const override { return 0.02; }
  // Fewer than for curves: means of draws are smooth and have few minima, and steps of Levenberg
  // and Marquardt follow.
  [[nodiscard]] Evaluations evaluations() const override { return {20, 10}; }

  // Returns for each group its name, the numbers of recordings, of trials and of draws that the
  // scene refused, and all its figures, real and simulated.
  [[nodiscard]] Json json(const Solution& solution) const;

 private:
  // Returns a row; within each channel all values of the first figure, then all of the second.
  [[nodiscard]] Eigen::RowVectorXd figures(const std::vector<SensorRecord>& sensors, Side side, const Columns& columns,
                                           const std::string& name) const;
  // Returns the figures of a simulated trial; NaN if the scene refuses the drawn values. Such a
  // trial is left out, as in a sweep.
  [[nodiscard]] Eigen::RowVectorXd trial_figures(const Eigen::VectorXd& places, std::size_t trial, std::uint64_t seed,
                                                 std::uint64_t device) const;
  // Returns the trials of a group that the scene has not refused.
  [[nodiscard]] std::vector<std::size_t> possible_trials(const Waves& simulated, std::size_t group) const;
  // Returns one row per group; not finite if all trials of a group are left out.
  [[nodiscard]] Eigen::MatrixXd simulated_means(const Waves& simulated) const;
  void lay_out(const std::vector<RawRecording>& recordings, const std::vector<SensorRecord>& scene);
  void read_real(const std::vector<RawRecording>& recordings);
  void learn_scatter(const Eigen::VectorXd& own);
  // Returns the variance of a recording around its group's mean, pooled over all groups, because a
  // group of four recordings is too small for an estimate.
  [[nodiscard]] Eigen::RowVectorXd recordings_variance() const;
  // Returns the groups' means in each simulated set.
  [[nodiscard]] std::vector<Eigen::MatrixXd> means_of_sets(const Eigen::VectorXd& own) const;
  // Excludes the bands of values that are constant in all recordings.
  void leave_out_unmoved_bands();

  Groups groups_;
  Columns columns_;                    // of the first recording; all recordings have its arrays
  std::vector<Columns> of_recording_;  // positions of these arrays in each recording
  std::vector<std::size_t> rows_;      // by channel: number of samples compared, counted from the end
  std::vector<Statistic> statistics_;
  Eigen::VectorXd floor_;              // by column: smallest band that is resolved
  std::vector<std::size_t> group_of_;  // of each real recording
  std::vector<std::size_t> sizes_;     // recordings of each group
  Eigen::MatrixXd real_;               // figures, a row a recording
  Eigen::MatrixXd real_means_;         // a row a group
  Eigen::MatrixXd scatter_;            // sd of real minus simulated means, a row a group; 0: not compared
  Eigen::MatrixXd chance_;             // independent columns of the residual's scatter: recordings, then simulated sets
};

// Simulates a session: all trials with one device, labelled with the groups' values. Throws
// InputError unless there is one value per cell.
std::vector<RawRecording> drawn_session(const Model& model, const Groups& groups, const Eigen::VectorXd& places,
                                        std::uint64_t seed, const std::atomic<bool>* interrupt);

}  // namespace slipbench::calibrate
