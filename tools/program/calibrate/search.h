// The scene as a function of what is fitted, from places between bounds to what its sensors read; and the search for what fits best.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>

#include "sim/core/quantity.h"
#include "sim/scene/catalogues.h"
#include "sim/scene/parser.h"
#include "tools/base/record/json.h"
#include "tools/program/calibrate/recordings.h"

namespace slipbench::calibrate {

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

// What a sensor's electronics do to its readings, and how much of the difference between two recordings they explain.

// What one component of a channel is taken for, in every unit alike. Read as: y = s + gain (s - s_begin) + coupling * (the same of the unit's
// other components) + offset + remainder, with a gain and couplings a device, an offset a recording.
struct Disturbance {
  double gain_sd = 0.0;       // relative
  double coupling_sd = 0.0;   // unit of the component over unit of the channel, which is one
  double offset_sd = 0.0;     // in the channel's unit
  double remainder_sd = 1.0;  // of the mean of a stretch, in the channel's unit: the sensor's repeatability
};

// The columns of several recordings, [recording](bins, columns).
using Waves = std::vector<Eigen::MatrixXd>;

// How far recordings are from simulated ones once what electronics may do is taken off.
struct Distance {
  Eigen::VectorXd
      residual;  // of all stretches by recording and column in remainder_sd; then what gains, couplings and offsets take, in their sds
  std::vector<Eigen::Index> group;  // of each entry of `residual`: which of them may hang together (a column of a recording)
  Waves explained;                  // the simulated recordings with the gains, couplings and offsets that fit best
  Eigen::VectorXd gain;             // by column
  Eigen::MatrixXd offset;           // by recording and column
  double squared = 0.0;             // residual' residual
  bool possible = true;       // false: the scene refuses so much that there is nothing to compare; `squared` is then very large
  Eigen::Index compared = 0;  // how many of `residual` are of recordings
  double compared_squared = 0.0;  // sum of squares of those
};

class Disturbances {
 public:
  // Learns them from pairs of what a scene reads with its electronics and without; each pair is a device of its own. `floor`: the least
  // remainder of a component, as a share of its range over all recordings.
  Disturbances(const Columns& columns, const std::vector<Waves>& read, const std::vector<Waves>& ideal, double floor);

  [[nodiscard]] const Columns& columns() const { return columns_; }
  // In the order of channels and, in each, of components.
  [[nodiscard]] const std::vector<Disturbance>& by_component() const { return disturbances_; }

  // The best linear fit of `read` by `ideal` under these disturbances (ridge regression: a Gaussian prior of each sd; McCulloch and others call the
  // whole variable projection, Golub and Pereyra 1973). The gains of a component have the mean 1 over its units, weighted by what these carry: what
  // all units share is the sensor's stiffness or sensitivity, which no recording tells from a common gain.
  [[nodiscard]] Distance distance(const Waves& read, const Waves& ideal) const;

  // By column what a device's departures from where it begins are to be divided by for its gains to have that mean.
  [[nodiscard]] Eigen::VectorXd common_gain(const Waves& read, const Waves& ideal) const;

 private:
  Columns columns_;
  std::vector<Disturbance> disturbances_;
};

// Recordings, the scene that is to resemble them, and what tells how far it is.
struct Problem {
  const Model* model = nullptr;
  std::size_t jobs = 1;
  const std::atomic<bool>* interrupt = nullptr;

  Problem(const Model* fitted, std::size_t threads, const std::atomic<bool>* stop)
      : model(fitted), jobs(threads), interrupt(stop) {}
  Problem(const Problem&) = delete;
  Problem& operator=(const Problem&) = delete;
  virtual ~Problem() = default;

  // What is compared of a simulated recording.
  [[nodiscard]] virtual Eigen::MatrixXd wave(const Eigen::VectorXd& places, std::size_t recording) const = 0;
  // How far simulated recordings are from the real ones.
  [[nodiscard]] virtual Distance distance(const Waves& simulated) const = 0;
  // How the gradient of Distance::squared/2 scatters by chance: columns of which each is independent of the others, and whose squares' sum is its
  // covariance. `slopes`: of the residual by the places.
  [[nodiscard]] virtual Eigen::MatrixXd scores(const Distance& distance, const Eigen::MatrixXd& slopes) const = 0;
  // Half of the step of a slope, of the bounds.
  [[nodiscard]] virtual double difference() const = 0;
  // Evaluations of a start's global and local search, for one more than there are keys.
  struct Evaluations {
    std::size_t global, local;
  };
  [[nodiscard]] virtual Evaluations evaluations() const = 0;

  // Distance::squared, and what holds a parameter that the recordings say nothing of at the scene's own value: a Gaussian prior around it as wide as
  // the bounds, sd (max - min)/sqrt(12).
  [[nodiscard]] double cost(const Waves& simulated, const Eigen::VectorXd& places) const;
};

// Curves in time, without what the electronics may have done.
struct CurveProblem : Problem {
  const Disturbances* disturbances = nullptr;
  std::vector<std::vector<double>> edges;  // of each recording, bin_edges()
  Waves real;

  using Problem::Problem;
  [[nodiscard]] Eigen::MatrixXd wave(const Eigen::VectorXd& places, std::size_t recording) const override;
  [[nodiscard]] Distance distance(const Waves& simulated) const override;
  // Residuals of one column of a recording hang together: noise is red, and a model is wrong for a while.
  [[nodiscard]] Eigen::MatrixXd scores(const Distance& distance, const Eigen::MatrixXd& slopes) const override;
  [[nodiscard]] double difference() const override { return 0.004; }
  [[nodiscard]] Evaluations evaluations() const override { return {60, 25}; }
};

struct SearchOptions {
  std::size_t starts = 4;
  std::function<void(std::size_t done, std::size_t of)>
      progress;  // simulated recordings; called from the calling thread; may be empty
};

// One start: where its global and local search ended. By key.
struct Start {
  Eigen::VectorXd places;
  double cost = 0.0;
  std::size_t evaluations = 0;
};

// How well a parameter is known. Places: 0 at min, 1 at max.
struct Known {
  double sd = 0.0;  // of its place
  bool determined =
      false;  // the 95 % interval takes less than half of the bounds, and the profile rises by a chi-square of 0.95 on both sides
  // Around the fit, by place the rise of the cost over `scale` where the parameter stands there and all others where the fit expects them.
  std::vector<std::pair<double, double>> profile;
};

struct Solution {
  std::vector<Start> starts;
  Eigen::VectorXd places;  // of all parameters
  double cost = 0.0;
  double scale = 1.0;          // the residuals' variance against the sensor's repeatability, at least 1
  Eigen::MatrixXd covariance;  // of the places
  std::vector<Known> known;    // by parameter
  Waves ideal;                 // what the scene reads there
  Distance distance;
};

// Throws Interrupted, and InputError as Model::simulate. The same, to the byte, whatever the number of threads.
Solution search(const Problem& problem, const SearchOptions& options);

// Moves `places`, each from 0 to 1, to where NLopt finds `cost` least, and returns that cost: by Subplex from steps of `first_step`, by CRS2 without
// one. Ends once no place moves by more than `tolerance`, or after so many `evaluations`. Throws what `cost` throws.
double minimise(Eigen::VectorXd& places, const std::function<double(const Eigen::VectorXd&)>& cost,
                std::optional<double> first_step, double tolerance, std::size_t evaluations);

// Half of a 95 % interval over its sd.
inline constexpr double half_interval = 1.96;
// A parameter is determined where that half takes less of the bounds.
inline constexpr double widest_known = 0.25;
// Whether a place is at one of its bounds, which is then what ends the search and the interval.
[[nodiscard]] bool at_lower_bound(double place);
[[nodiscard]] bool at_upper_bound(double place);

// Keys of a sensor's electronics (the scale of its noise, of its gains, ...), by how much they disturb.

// Whether a key is fitted here: curves without noise do not show it.
bool of_electronics(const FitKey& key);

// How much recordings are disturbed, by component one after the other: scatter of the gains, of the offsets, what remains of the curves, and the
// roughness; natural logarithms of RMS values. Minus infinity: none.
Eigen::VectorXd disturbance_sizes(const Columns& columns, const Waves& read, const Distance& distance,
                                  const Eigen::VectorXd& rough);

struct ElectronicsFit {
  Eigen::VectorXd places;
  std::vector<Known> known;  // without profiles
};

// The places at which simulated devices are disturbed as much as the real one: least squares of `sizes`, weighted by how much these differ from
// one device to the next. `model`: of such keys alone, on the fitted scene. `problem`: whose recordings, edges and disturbances count.
ElectronicsFit fit_electronics(const Model& model, const CurveProblem& problem, const Eigen::VectorXd& sizes);

// Recordings whose motion is unknown: groups of them, compared by what the recordings of a group have in common.

// Which recordings are a group: those whose label (TrialRecord::params) has the same value. The k-th value is the k-th cell of the scene's grid.
struct Groups {
  std::string label;                // "class"
  std::vector<std::string> values;  // "n", "e"; different ones
};

// Reads "class=n,e,s". Throws InputError: what was found, what is allowed.
Groups parse_groups(const std::string& text);

// One figure of every value of an array.
struct Statistic {
  std::size_t channel = 0;  // of Columns
  std::string name;         // "level", "trend", or the length of a band: "20 ms"
  std::string unit;         // of the channel; "ln": a natural logarithm
  std::size_t first = 0;    // where the array's values begin among all figures
};

// Of samples [T, values] the rows of figures: level (mean), trend (mean of the last half less that of the first), and by natural logarithm the deviations
// of Allan: the RMS of the steps between the means of stretches of 1, 2, 4, ... samples over the square root of two, as long as there are four of them.
// `floor`: by value, added to a deviation by squares.
Eigen::MatrixXd figures_of(const Eigen::MatrixXd& samples, const Eigen::RowVectorXd& floor);

// What is compared is the mean of each figure over the recordings of a group. It is divided by its scatter: of the real mean as recordings of a group
// scatter around it, of the simulated one as whole sets do that are simulated by other devices with other draws.
class GroupProblem : public Problem {
 public:
  // `recordings`: with labels that `groups` knows. `own`: places of the scene itself, where the sets are simulated. Throws InputError for recordings and
  // a scene that do not fit each other or the groups, and Interrupted. `fitted` must outlive it.
  GroupProblem(const Model* fitted, const Groups& groups, const std::vector<RawRecording>& recordings, const Eigen::VectorXd& own,
               std::size_t threads, const std::atomic<bool>* stop);

  [[nodiscard]] Eigen::MatrixXd wave(const Eigen::VectorXd& places, std::size_t trial) const override;  // a row of figures
  [[nodiscard]] Distance distance(const Waves& simulated) const override;
  [[nodiscard]] Eigen::MatrixXd scores(const Distance& distance, const Eigen::MatrixXd& slopes) const override;
  // Wider than of curves: counts are whole, and a mean of few recordings has steps.
  [[nodiscard]] double difference() const override { return 0.02; }
  // Fewer than of curves: means of draws are smooth and have few minima, and the steps of Levenberg and Marquardt go on from there.
  [[nodiscard]] Evaluations evaluations() const override { return {20, 10}; }

  // Of each group its name, how many recordings and trials it has, how many draws the scene has refused, and every figure of it, real and simulated.
  [[nodiscard]] Json json(const Solution& solution) const;

 private:
  // A row: of each channel all values of its first figure, then all of its second.
  [[nodiscard]] Eigen::RowVectorXd figures(const std::vector<SensorRecord>& sensors, Side side, const Columns& columns,
                                           const std::string& name) const;
  // Of a simulated trial; not finite where the scene refuses what was drawn: such a trial is left out, as a sweep leaves it out.
  [[nodiscard]] Eigen::RowVectorXd trial_figures(const Eigen::VectorXd& places, std::size_t trial, std::uint64_t seed,
                                                 std::uint64_t device) const;
  // The trials of a group that the scene has not refused.
  [[nodiscard]] std::vector<std::size_t> possible_trials(const Waves& simulated, std::size_t group) const;
  // A row a group; not finite where all its trials are left out.
  [[nodiscard]] Eigen::MatrixXd simulated_means(const Waves& simulated) const;
  void lay_out(const std::vector<RawRecording>& recordings, const std::vector<SensorRecord>& scene);
  void read_real(const std::vector<RawRecording>& recordings);
  void learn_scatter(const Eigen::VectorXd& own);
  // Of a recording around its group's mean: all groups' together, as one of four recordings tells its own badly.
  [[nodiscard]] Eigen::RowVectorXd recordings_variance() const;
  // The groups' means of each of the simulated sets.
  [[nodiscard]] std::vector<Eigen::MatrixXd> means_of_sets(const Eigen::VectorXd& own) const;
  // A value that no recording has moved has no bands.
  void leave_out_unmoved_bands();

  Groups groups_;
  Columns columns_;                    // of the first recording, whose arrays all have
  std::vector<Columns> of_recording_;  // the same arrays where each recording has them
  std::vector<std::size_t> rows_;      // by channel: how many samples, the last ones, are compared
  std::vector<Statistic> statistics_;
  Eigen::VectorXd floor_;              // by column: a band below it is none
  std::vector<std::size_t> group_of_;  // of each real recording
  std::vector<std::size_t> sizes_;     // recordings of each group
  Eigen::MatrixXd real_;               // figures, a row a recording
  Eigen::MatrixXd real_means_;         // a row a group
  Eigen::MatrixXd scatter_;            // sd of real less simulated means, a row a group; 0: not compared
  Eigen::MatrixXd chance_;             // of the residual, independent columns: recordings, and simulated sets
};

// What a set simulated as one real session would be: all trials by one device. Their labels are the groups' values. Throws InputError where
// these are not as many as cells.
std::vector<RawRecording> drawn_session(const Model& model, const Groups& groups, const Eigen::VectorXd& places,
                                        std::uint64_t seed, const std::atomic<bool>* interrupt);

}  // namespace slipbench::calibrate
