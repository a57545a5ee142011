#include "tools/calibrate/disturbances.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "sim/core/math.h"

namespace slipbench::calibrate {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// A gain or coupling with less scatter than this is ignored; rounding of float32 is below it.
constexpr double none_below = 1e-5;

// The regression of one column.
struct Regression {
  std::vector<Index> regressors;  // columns of the simulated recordings: its own for the gain, then the unit's others
  VectorXd prior;                 // sd of each coefficient
  double weight = 1.0;            // 1 over remainder_sd^2
  double offset_sd = 0.0;
  VectorXd coefficients;
  MatrixXd covariance;
  double energy = 0.0;  // sum of squared deviations from the column's mean over all recordings
};

// Returns the share of a recording's mean that its offset explains.
double offset_share(const Regression& regression, Index bins) {
  const double data = regression.weight * static_cast<double>(bins) * regression.offset_sd * regression.offset_sd;
  return data / (1.0 + data);
}

// Returns a column minus its first value. Without this, a gain of counts far above zero would also
// act as an offset.
VectorXd departure(const MatrixXd& wave, Index column) { return wave.col(column).array() - wave(0, column); }

// <x, y> without the share of the means that the offset explains.
template <class X, class Y>
double product(const X& x, const Y& y, double share) {
  return x.dot(y) - share * x.sum() * y.mean();
}

void solve(Regression& regression, Index column, const Waves& read, const Waves& ideal) {
  const auto count = static_cast<Index>(regression.regressors.size());
  MatrixXd normal = MatrixXd::Zero(count, count);
  VectorXd right = VectorXd::Zero(count);
  for (std::size_t r = 0; r < read.size(); ++r) {
    const MatrixXd& s = ideal[r];
    const double share = offset_share(regression, s.rows());
    const VectorXd difference = read[r].col(column) - s.col(column);
    regression.energy += product(s.col(column), s.col(column), 1.0);
    for (Index i = 0; i < count; ++i) {
      const VectorXd x = departure(s, regression.regressors[static_cast<std::size_t>(i)]);
      right(i) += regression.weight * product(x, difference, share);
      for (Index j = 0; j <= i; ++j)
        normal(i, j) += regression.weight * product(x, departure(s, regression.regressors[static_cast<std::size_t>(j)]), share);
    }
  }
  for (Index i = 0; i < count; ++i) normal(i, i) += 1.0 / (regression.prior(i) * regression.prior(i));
  const MatrixXd full = normal.selfadjointView<Eigen::Lower>();
  regression.covariance = full.llt().solve(MatrixXd::Identity(count, count));
  regression.coefficients = regression.covariance * right;
}

// The regressions of all columns.
std::vector<Regression> solved(const Columns& columns, const std::vector<Disturbance>& disturbances, const Waves& read,
                               const Waves& ideal) {
  std::vector<Regression> result(columns.count);
  std::size_t component = 0;
  for (const ChannelPlace& place : columns.channels) {
    for (std::size_t k = 0; k < place.components; ++k, ++component) {
      const Disturbance& disturbance = disturbances[component];
      for (std::size_t unit = 0; unit < place.units; ++unit) {
        const std::size_t column = place.column(unit, k);
        Regression& regression = result[column];
        regression.weight = 1.0 / (disturbance.remainder_sd * disturbance.remainder_sd);
        regression.offset_sd = disturbance.offset_sd;
        std::vector<double> prior;
        if (disturbance.gain_sd > none_below) {
          regression.regressors.push_back(static_cast<Index>(column));
          prior.push_back(disturbance.gain_sd);
        }
        for (std::size_t other = 0; disturbance.coupling_sd > none_below && other < place.components; ++other) {
          if (other == k) continue;
          regression.regressors.push_back(static_cast<Index>(place.column(unit, other)));
          prior.push_back(disturbance.coupling_sd);
        }
        regression.prior = Eigen::Map<const VectorXd>(prior.data(), static_cast<Index>(prior.size()));
        solve(regression, static_cast<Index>(column), read, ideal);
      }
    }
  }
  return result;
}

bool has_gain(const Regression& regression, std::size_t column) {
  return !regression.regressors.empty() && regression.regressors.front() == static_cast<Index>(column);
}

// Mean of a component's gains minus 1 over its units, weighted by their energy, and its variance.
struct CommonGain {
  double mean = 0.0, variance = 0.0;
  VectorXd weights;
};
CommonGain common_of(const std::vector<Regression>& fits, const ChannelPlace& place, std::size_t k) {
  CommonGain common{.weights = VectorXd::Zero(static_cast<Index>(place.units))};
  double all = 0.0;
  for (std::size_t unit = 0; unit < place.units; ++unit) all += fits[place.column(unit, k)].energy;
  for (std::size_t unit = 0; all > 0.0 && unit < place.units; ++unit) {
    const Regression& regression = fits[place.column(unit, k)];
    if (!has_gain(regression, place.column(unit, k))) continue;
    const double weight = regression.energy / all;
    common.weights(static_cast<Index>(unit)) = weight;
    common.mean += weight * regression.coefficients(0);
    common.variance += weight * weight * regression.covariance(0, 0);
  }
  return common;
}

// Sets the mean of each component's gains to 1 and the other coefficients to their best values
// under that condition.
void centre_gains(const Columns& columns, std::vector<Regression>& fits) {
  for (const ChannelPlace& place : columns.channels) {
    for (std::size_t k = 0; k < place.components; ++k) {
      const CommonGain common = common_of(fits, place, k);
      if (!(common.variance > 0.0)) continue;
      for (std::size_t unit = 0; unit < place.units; ++unit) {
        Regression& regression = fits[place.column(unit, k)];
        const double weight = common.weights(static_cast<Index>(unit));
        if (weight > 0.0) regression.coefficients -= common.mean / common.variance * weight * regression.covariance.col(0);
      }
    }
  }
}

Distance distance_of(const Columns& columns, const std::vector<Regression>& fits, const Waves& read, const Waves& ideal) {
  const auto count = static_cast<Index>(columns.count), recordings = static_cast<Index>(read.size());
  Distance distance;
  distance.explained = ideal;
  distance.gain = VectorXd::Ones(count);
  distance.offset = MatrixXd::Zero(recordings, count);
  std::vector<double> priors;
  Index entries = 0;
  for (const MatrixXd& wave : read) entries += wave.size();
  VectorXd residual(entries);
  Index at = 0, group = 0;
  distance.group.reserve(static_cast<std::size_t>(entries));
  for (std::size_t r = 0; r < read.size(); ++r) {
    for (std::size_t c = 0; c < columns.count; ++c, ++group) {
      const Regression& regression = fits[c];
      const auto column = static_cast<Index>(c);
      VectorXd fit = ideal[r].col(column);
      for (std::size_t i = 0; i < regression.regressors.size(); ++i)
        fit += regression.coefficients(static_cast<Index>(i)) * departure(ideal[r], regression.regressors[i]);
      const double offset = offset_share(regression, fit.size()) * (read[r].col(column) - fit).mean();
      fit.array() += offset;
      distance.offset(static_cast<Index>(r), column) = offset;
      distance.explained[r].col(column) = fit;
      residual.segment(at, fit.size()) = std::sqrt(regression.weight) * (read[r].col(column) - fit);
      at += fit.size();
      distance.group.insert(distance.group.end(), static_cast<std::size_t>(fit.size()), group);
      if (regression.offset_sd > 0.0) priors.push_back(offset / regression.offset_sd);
    }
  }
  for (std::size_t c = 0; c < columns.count; ++c) {
    const Regression& regression = fits[c];
    if (has_gain(regression, c)) distance.gain(static_cast<Index>(c)) = 1.0 + regression.coefficients(0);
    for (Index i = 0; i < regression.coefficients.size(); ++i) priors.push_back(regression.coefficients(i) / regression.prior(i));
  }
  distance.residual.resize(entries + static_cast<Index>(priors.size()));
  distance.residual.head(entries) = residual;
  for (std::size_t i = 0; i < priors.size(); ++i) {
    distance.residual(entries + static_cast<Index>(i)) = priors[i];
    distance.group.push_back(group++);
  }
  distance.squared = distance.residual.squaredNorm();
  distance.compared = entries;
  distance.compared_squared = residual.squaredNorm();
  return distance;
}

double range_of(const ChannelPlace& place, std::size_t k, const std::vector<Waves>& waves) {
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const Waves& recordings : waves) {
    for (const MatrixXd& wave : recordings) {
      for (std::size_t unit = 0; unit < place.units; ++unit) {
        const auto column = wave.col(static_cast<Index>(place.column(unit, k)));
        least = std::min(least, column.minCoeff());
        most = std::max(most, column.maxCoeff());
      }
    }
  }
  return most - least;
}

// RMS of weighted values.
struct WeightedSquares {
  double sum = 0.0, weight = 0.0;
  void add(double value, double with) {
    sum += with * value * value;
    weight += with;
  }
  [[nodiscard]] double rms() const { return weight > 0.0 ? std::sqrt(sum / weight) : 0.0; }
};

}  // namespace

Disturbances::Disturbances(const Columns& columns, const std::vector<Waves>& read, const std::vector<Waves>& ideal, double floor)
    : columns_(columns) {
  std::vector<double> ranges;
  for (const ChannelPlace& place : columns.channels) {
    for (std::size_t k = 0; k < place.components; ++k) {
      const double range = range_of(place, k, ideal);
      ranges.push_back(range > 0.0 ? range : 1.0);
      // A prior so wide that the estimate equals the disturbance that the recording has.
      disturbances_.push_back({.gain_sd = 1.0,
                               .coupling_sd = place.components > 1 ? 1.0 : 0.0,
                               .offset_sd = 10.0 * ranges.back(),
                               .remainder_sd = floor * ranges.back()});
    }
  }
  std::vector<WeightedSquares> gains(ranges.size()), couplings(ranges.size()), offsets(ranges.size()), remainders(ranges.size());
  for (std::size_t pair = 0; pair < read.size(); ++pair) {
    const std::vector<Regression> fits = solved(columns, disturbances_, read[pair], ideal[pair]);
    const Distance distance = distance_of(columns, fits, read[pair], ideal[pair]);
    std::size_t component = 0;
    for (const ChannelPlace& place : columns.channels) {
      for (std::size_t k = 0; k < place.components; ++k, ++component) {
        for (std::size_t unit = 0; unit < place.units; ++unit) {
          const std::size_t c = place.column(unit, k);
          const Regression& regression = fits[c];
          gains[component].add(regression.coefficients(0), regression.energy);
          for (Index i = 1; i < regression.coefficients.size(); ++i) {
            const auto other = static_cast<std::size_t>(regression.regressors[static_cast<std::size_t>(i)]);
            couplings[component].add(regression.coefficients(i), fits[other].energy);
          }
          for (std::size_t r = 0; r < read[pair].size(); ++r) {
            const auto column = static_cast<Index>(c);
            offsets[component].add(distance.offset(static_cast<Index>(r), column), 1.0);
            const VectorXd rest = read[pair][r].col(column) - distance.explained[r].col(column);
            remainders[component].add(std::sqrt(rest.squaredNorm() / static_cast<double>(rest.size())), 1.0);
          }
        }
      }
    }
  }
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const double least = floor * ranges[i];
    disturbances_[i] = {.gain_sd = gains[i].rms(),
                        .coupling_sd = couplings[i].rms(),
                        .offset_sd = offsets[i].rms() > none_below * ranges[i] ? offsets[i].rms() : 0.0,
                        .remainder_sd = math::hypot(remainders[i].rms(), least)};
  }
}

Distance Disturbances::distance(const Waves& read, const Waves& ideal) const {
  std::vector<Regression> fits = solved(columns_, disturbances_, read, ideal);
  centre_gains(columns_, fits);
  return distance_of(columns_, fits, read, ideal);
}

VectorXd Disturbances::common_gain(const Waves& read, const Waves& ideal) const {
  const std::vector<Regression> fits = solved(columns_, disturbances_, read, ideal);
  VectorXd common = VectorXd::Ones(static_cast<Index>(columns_.count));
  for (const ChannelPlace& place : columns_.channels) {
    for (std::size_t k = 0; k < place.components; ++k) {
      const double mean = common_of(fits, place, k).mean;
      for (std::size_t unit = 0; unit < place.units; ++unit) common(static_cast<Index>(place.column(unit, k))) += mean;
    }
  }
  return common;
}

}  // namespace slipbench::calibrate
