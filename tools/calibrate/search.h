// The search for the places of the fitted keys that fit recordings best.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "tools/calibrate/disturbances.h"
#include "tools/calibrate/model.h"
#include "tools/calibrate/recordings.h"

namespace slipbench::calibrate {

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
  std::function<void(std::size_t done, std::size_t total)>
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

// Minimises `cost` over `places`, each from -reach to 1 + reach, with NLopt, and returns the least cost: with
// Subplex if `first_step` is given, else with CRS2. Ends once no place moves by more than
// `tolerance`, or after `evaluations`. Throws what `cost` throws.
double minimise(Eigen::VectorXd& places, const std::function<double(const Eigen::VectorXd&)>& cost,
                std::optional<double> first_step, double tolerance, std::size_t evaluations, const Eigen::VectorXd& reach);

// Half-width of a 95 % interval over the sd.
inline constexpr double half_interval = 1.96;
// A parameter is determined if that half-width is a smaller share of the bounds.
inline constexpr double widest_known = 0.25;
// True if a place is at a bound, which then limits the search and the interval.
[[nodiscard]] bool at_lower_bound(double place);
[[nodiscard]] bool at_upper_bound(double place);

// Keys of a sensor's electronics (the scale of its noise, of its gains, ...), by how much they
// disturb.

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

}  // namespace slipbench::calibrate
