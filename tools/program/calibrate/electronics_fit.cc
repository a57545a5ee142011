#include "tools/program/calibrate/electronics_fit.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Cholesky>

#include "sim/core/process/interrupted.h"
#include "tools/base/workers/ordered_workers.h"

namespace slipbench::calibrate {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t devices = 6;  // simulated for each set of values, always the same
constexpr std::size_t evaluations_a_key = 30;
constexpr double difference_of_size = 0.05;  // of the bounds, to either side
constexpr double place_prior = 12.0;         // 1 over the variance of a place between the bounds
constexpr double least_variance = 1e-4;      // of a logarithm: 1 %

class Sizes {
 public:
  Sizes(const Model& model, const CurveProblem& problem, const VectorXd& real) : model_(model), problem_(problem), real_(real) {
    for (std::size_t d = 0; d < devices; ++d) seeds_.push_back(seed_of(model.seed(), d, "sizes"));
  }

  // A column a device.
  [[nodiscard]] MatrixXd of_devices(const VectorXd& places) const {
    OrderedWorkers<VectorXd> workers(
        devices, std::min(problem_.jobs, devices), [&] { return [&](std::size_t d) { return of_device(places, seeds_[d]); }; },
        problem_.interrupt);
    MatrixXd sizes(real_.size(), static_cast<Index>(devices));
    Index column = 0;
    while (std::optional<VectorXd> size = workers.next()) sizes.col(column++) = *size;
    if (problem_.interrupt != nullptr && problem_.interrupt->load()) throw Interrupted();
    return sizes;
  }

  // What can be compared, and with which weight.
  void weigh(const VectorXd& places) {
    const MatrixXd sizes = of_devices(places);
    const VectorXd mean = sizes.rowwise().mean();
    weight_ = VectorXd::Zero(real_.size());
    for (Index i = 0; i < real_.size(); ++i) {
      if (!std::isfinite(mean(i)) || !std::isfinite(real_(i))) continue;
      const double variance = (sizes.row(i).array() - mean(i)).square().sum() / static_cast<double>(devices - 1);
      // The real device is one draw, the simulated mean one of six.
      weight_(i) = 1.0 / (variance * (1.0 + 1.0 / static_cast<double>(devices)) + least_variance);
    }
  }

  // Real against simulated, in standard deviations.
  [[nodiscard]] VectorXd residual(const VectorXd& places) const {
    const VectorXd mean = of_devices(places).rowwise().mean();
    VectorXd residual = VectorXd::Zero(real_.size());
    for (Index i = 0; i < real_.size(); ++i) {
      if (weight_(i) > 0.0) residual(i) = std::sqrt(weight_(i)) * (real_(i) - std::max(mean(i), real_(i) - lost));
    }
    return residual;
  }

 private:
  // A disturbance that is switched off has a logarithm of minus infinity.
  static constexpr double lost = 20.0;

  [[nodiscard]] VectorXd of_device(const VectorXd& places, std::uint64_t seed) const {
    const Columns& columns = problem_.disturbances->columns();
    Waves read, ideal;
    VectorXd squares = VectorXd::Zero(static_cast<Index>(columns.count));
    for (std::size_t r = 0; r < model_.recordings(); ++r) {
      const auto sensors = model_.simulate(places, r, Readings::read, seed, problem_.interrupt);
      read.push_back(bin_means(sensors, Side::scene, columns, problem_.edges[r], 0.0));
      squares += roughness(sensors, Side::scene, columns).cwiseAbs2();
      ideal.push_back(bin_means(model_.simulate(places, r, Readings::ideal, seed, problem_.interrupt), Side::scene, columns,
                                problem_.edges[r], 0.0));
    }
    const VectorXd rough = (squares / static_cast<double>(model_.recordings())).cwiseSqrt();
    return disturbance_sizes(columns, read, problem_.disturbances->distance(read, ideal), rough);
  }

  const Model& model_;
  const CurveProblem& problem_;
  const VectorXd& real_;
  std::vector<std::uint64_t> seeds_;
  VectorXd weight_;
};

double log_rms(double squares, double count) { return 0.5 * std::log(squares / count); }

}  // namespace

bool of_electronics(const FitKey& key) { return key.path.find(".electronics.") != std::string::npos; }

VectorXd disturbance_sizes(const Columns& columns, const Waves& read, const Distance& distance, const VectorXd& rough) {
  std::vector<double> sizes;
  for (const ChannelPlace& place : columns.channels) {
    for (std::size_t k = 0; k < place.components; ++k) {
      double gains = 0.0, offsets = 0.0, rest = 0.0, rows = 0.0, steps = 0.0;
      for (std::size_t unit = 0; unit < place.units; ++unit) {
        const auto column = static_cast<Index>(place.column(unit, k));
        gains += std::pow(distance.gain(column) - 1.0, 2);
        offsets += distance.offset.col(column).squaredNorm();
        steps += rough(column) * rough(column);
        for (std::size_t r = 0; r < read.size(); ++r) {
          rest += (read[r].col(column) - distance.explained[r].col(column)).squaredNorm();
          rows += static_cast<double>(read[r].rows());
        }
      }
      const auto units = static_cast<double>(place.units);
      for (const double size : {log_rms(gains, units), log_rms(offsets, units * static_cast<double>(read.size())),
                                log_rms(rest, rows), log_rms(steps, units)})
        sizes.push_back(size);
    }
  }
  return Eigen::Map<const VectorXd>(sizes.data(), static_cast<Index>(sizes.size()));
}

ElectronicsFit fit_electronics(const Model& model, const CurveProblem& problem, const VectorXd& sizes_of_real) {
  const VectorXd& own = model.own_places();
  Sizes sizes(model, problem, sizes_of_real);
  sizes.weigh(own);
  ElectronicsFit fit{.places = own, .known = {}};
  const auto cost = [&](const VectorXd& places) {
    return sizes.residual(places).squaredNorm() + place_prior * (places - own).squaredNorm();
  };
  minimise(fit.places, cost, 0.2, 1e-3, evaluations_a_key * static_cast<std::size_t>(own.size()));
  MatrixXd curvature = place_prior * MatrixXd::Identity(own.size(), own.size());
  MatrixXd slopes(sizes_of_real.size(), own.size());
  for (Index p = 0; p < own.size(); ++p) {
    VectorXd up = fit.places, down = fit.places;
    up(p) = std::min(1.0, up(p) + difference_of_size);
    down(p) = std::max(0.0, down(p) - difference_of_size);
    slopes.col(p) = (sizes.residual(up) - sizes.residual(down)) / (up(p) - down(p));
  }
  curvature += slopes.transpose() * slopes;
  const MatrixXd covariance = curvature.llt().solve(MatrixXd::Identity(own.size(), own.size()));
  for (Index p = 0; p < own.size(); ++p) {
    const double sd = std::sqrt(covariance(p, p));
    fit.known.push_back({.sd = sd, .determined = half_interval * sd < widest_known, .profile = {}});
  }
  return fit;
}

}  // namespace slipbench::calibrate
