// Recordings whose motion is unknown: groups of them, compared by what the recordings of a group have in common.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "tools/base/record/json.h"
#include "tools/program/calibrate/model.h"
#include "tools/program/calibrate/recordings.h"
#include "tools/program/calibrate/search.h"

namespace slipbench::calibrate {

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
