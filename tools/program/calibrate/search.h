// From recordings to the parameters that fit them best, and how well they are known.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "tools/program/calibrate/disturbances.h"
#include "tools/program/calibrate/model.h"

namespace slipbench::calibrate {

// Recordings, the scene that is to resemble them, and what tells how far it is.
struct Problem {
  const Model* model;
  const Disturbances* disturbances;
  std::vector<std::vector<double>> edges;  // of each recording, bin_edges()
  Waves real;
  std::size_t jobs = 1;
  const std::atomic<bool>* interrupt = nullptr;

  // What the scene reads in a recording.
  [[nodiscard]] Eigen::MatrixXd wave(const Eigen::VectorXd& places, std::size_t recording) const;
  // Distance::squared, and what holds a parameter that the recordings say nothing of at the scene's own value: a Gaussian prior around it as wide as
  // the bounds, sd (max - min)/sqrt(12).
  [[nodiscard]] double cost(const Waves& ideal, const Eigen::VectorXd& places) const;
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

// Half of a 95 % interval over its sd.
inline constexpr double half_interval = 1.96;
// A parameter is determined where that half takes less of the bounds.
inline constexpr double widest_known = 0.25;

}  // namespace slipbench::calibrate
