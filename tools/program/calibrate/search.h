// From recordings to the parameters that fit them best, and how well they are known.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "tools/program/calibrate/disturbances.h"
#include "tools/program/calibrate/model.h"

namespace slipbench::calibrate {

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

}  // namespace slipbench::calibrate
