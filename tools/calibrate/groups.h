// Recordings whose motion is unknown. Groups of them are compared by the means over a group.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "tools/calibrate/disturbances.h"
#include "tools/calibrate/model.h"
#include "tools/calibrate/recordings.h"
#include "tools/calibrate/search.h"
#include "tools/dataset/record/json.h"

namespace slipbench::calibrate {

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
