#include "tools/calibrate/search.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>

#include <Eigen/Cholesky>
#include <nlopt.hpp>

#include "sim/core/math.h"
#include "sim/core/process/interrupted.h"
#include "sim/core/random.h"
#include "tools/workers/ordered_workers.h"

namespace slipbench::calibrate {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// 1 over the variance of a place that is uniform between the bounds.
constexpr double prior_weight = 12.0;

constexpr int most_steps = 8;
constexpr double small_step = 1e-6;        // of the bounds: the fit has arrived
constexpr double bound_width = 0.005;      // of the bounds
constexpr double circle_reach = 1.0;       // turns beyond both bounds of an angle over its whole circle
constexpr double chi_square_of_95 = 3.84;  // with one degree of freedom

// A profile reaches three times as far as the 95 % interval.
constexpr std::size_t profile_points = 13;
constexpr double profile_reach = 3.0;

class Searcher {
 public:
  Searcher(const Problem& problem, const SearchOptions& options) : problem_(problem), options_(options) {
    const std::size_t keys = model().keys().size();
    const auto recordings = model().recordings();
    const auto places = static_cast<Index>(model().parameters());
    low_ = VectorXd::Zero(places);
    high_ = VectorXd::Ones(places);
    for (std::size_t p = 0; p < model().parameters(); ++p) {
      if (!model().circular(p)) continue;
      low_(static_cast<Index>(p)) = -circle_reach;
      high_(static_cast<Index>(p)) = 1.0 + circle_reach;
    }
    total_ = options.starts * (problem.evaluations().global + problem.evaluations().local) * (keys + 1) * recordings +
             (std::size_t{4} * 2 * model().parameters() + profile_points * keys) * recordings;
  }

  Solution run() {
    Solution solution;
    solution.starts = in_order<Start>(options_.starts, [&](std::size_t k) { return start(k); });
    const auto best = std::ranges::min_element(solution.starts, {}, &Start::cost);
    descend(model().spread(best->places), solution);
    estimate_uncertainty(solution);
    if (options_.progress) options_.progress(total_, total_);
    return solution;
  }

 private:
  struct Task {
    VectorXd places;
    std::size_t recording;
  };

  [[nodiscard]] const Model& model() const { return *problem_.model; }

  // Returns the results of `work` for 0 to `count` - 1, computed by several threads; reports the
  // progress meanwhile.
  template <class Result, class Work>
  std::vector<Result> in_order(std::size_t count, const Work& work) {
    OrderedWorkers<Result> workers(
        count, std::min(problem_.jobs, std::max<std::size_t>(1, count)), [&] { return work; }, problem_.interrupt);
    std::vector<Result> results;
    while (results.size() < count) {
      while (!workers.ready_until(std::chrono::steady_clock::now() + std::chrono::milliseconds(100))) report_progress();
      report_progress();
      std::optional<Result> result = workers.next();
      end_if(problem_.interrupt);
      results.push_back(std::move(*result));
    }
    return results;
  }
  void report_progress() const {
    if (options_.progress) options_.progress(std::min(done_.load(), total_), total_);
  }

  MatrixXd wave(const VectorXd& places, std::size_t recording) {
    MatrixXd result = problem_.wave(places, recording);
    ++done_;
    return result;
  }

  std::vector<MatrixXd> simulated(const std::vector<Task>& tasks) {
    return in_order<MatrixXd>(tasks.size(), [&](std::size_t k) { return wave(tasks[k].places, tasks[k].recording); });
  }

  std::vector<Task> all_recordings(const VectorXd& places) const {
    std::vector<Task> tasks;
    for (std::size_t r = 0; r < model().recordings(); ++r) tasks.push_back({places, r});
    return tasks;
  }

  // Runs a global and a local search from one point. A start runs in one thread, and each thread
  // has its own NLopt generator.
  Start start(std::size_t number) {
    const std::size_t keys = model().keys().size();
    RandomStream stream(model().seed(), number, "calibrate.start");
    Start result{.places = model().own_places()};
    if (number > 0) {
      for (double& place : result.places) place = stream.uniform();
    }
    const auto cost = [&](const VectorXd& places) {
      ++result.evaluations;
      const VectorXd all = model().spread(places);
      Waves waves;
      for (std::size_t r = 0; r < model().recordings(); ++r) waves.push_back(wave(all, r));
      return problem_.cost(waves, all);
    };
    nlopt::srand(static_cast<unsigned long>(stream.integer(1U << 31U)));
    VectorXd reach = VectorXd::Zero(static_cast<Index>(keys));
    minimise(result.places, cost, {}, small_step, problem_.evaluations().global * (keys + 1), reach);
    for (std::size_t key = 0; key < keys; ++key) {
      if (model().keys()[key].circular()) reach(static_cast<Index>(key)) = circle_reach;
    }
    result.cost = minimise(result.places, cost, 0.02, small_step, problem_.evaluations().local * (keys + 1), reach);
    return result;
  }

  // The place of parameter `p` from which its slope is computed.
  [[nodiscard]] double beside(const VectorXd& at, Index p, double side) const {
    return std::clamp(at(p) + side * problem_.difference(), low_(p), high_(p));
  }

  // Returns d residual/d places from differences to those sides that the scene does not refuse.
  MatrixXd jacobian(const VectorXd& at, const Waves& ideal) {
    const std::size_t recordings = model().recordings();
    std::vector<Task> tasks;
    for (Index p = 0; p < at.size(); ++p) {
      for (const double side : {1.0, -1.0}) {
        VectorXd places = at;
        places(p) = beside(at, p, side);
        const std::optional<std::size_t> only = model().recording_of(static_cast<std::size_t>(p));
        for (std::size_t r = only.value_or(0); r < (only ? *only + 1 : recordings); ++r) tasks.push_back({places, r});
      }
    }
    const std::vector<MatrixXd> found = simulated(tasks);
    const VectorXd here = problem_.distance(ideal).residual;
    MatrixXd slopes;
    std::size_t task = 0;
    for (Index p = 0; p < at.size(); ++p) {
      const std::size_t changed = model().recording_of(static_cast<std::size_t>(p)) ? 1 : recordings;
      VectorXd slope = VectorXd::Zero(here.size());
      double apart = 0.0;
      for (const double side : {1.0, -1.0}) {
        Waves waves = ideal;
        for (std::size_t k = 0; k < changed; ++k, ++task) waves[tasks[task].recording] = found[task];
        const Distance distance = problem_.distance(waves);
        slope += side * (distance.possible ? distance.residual : here);
        if (distance.possible) apart += std::abs(beside(at, p, side) - at(p));
      }
      if (apart > 0.0) slope /= apart;
      if (slopes.size() == 0) slopes.resize(slope.size(), at.size());
      slopes.col(p) = slope;
    }
    return slopes;
  }

  // Takes steps of Levenberg and Marquardt from the best start's end; only these fit the parameters
  // of single recordings separately.
  void descend(VectorXd at, Solution& solution) {
    solution.ideal = simulated(all_recordings(at));
    solution.cost = problem_.cost(solution.ideal, at);
    double damping = 1e-3;
    for (int step = 0; step <= most_steps; ++step) {
      solution.distance = problem_.distance(solution.ideal);
      slopes_ = jacobian(at, solution.ideal);
      if (step == most_steps) break;
      const MatrixXd curvature = slopes_.transpose() * slopes_ + prior_weight * MatrixXd::Identity(at.size(), at.size());
      const VectorXd gradient = slopes_.transpose() * solution.distance.residual + prior_weight * model().from_own(at);
      bool lower = false;
      double length = 0.0;
      for (int attempt = 0; attempt < 4 && !lower; ++attempt) {
        MatrixXd damped = curvature;
        damped.diagonal() *= 1.0 + damping;
        const VectorXd there = (at - damped.llt().solve(gradient)).cwiseMax(low_).cwiseMin(high_);
        length = (there - at).cwiseAbs().maxCoeff();
        if (length < small_step) break;
        const Waves waves = simulated(all_recordings(there));
        const double cost = problem_.cost(waves, there);
        lower = cost < solution.cost;
        damping = lower ? 0.1 * damping : 30.0 * damping;
        if (!lower) continue;
        at = there;
        solution.ideal = waves;
        solution.cost = cost;
      }
      if (!lower) break;
    }
    for (Index p = 0; p < at.size(); ++p) {
      if (model().circular(static_cast<std::size_t>(p))) at(p) -= std::floor(at(p));
    }
    solution.places = at;
  }

  // Derives the parameters' uncertainty from the residuals.
  void estimate_uncertainty(Solution& solution) {
    const Index count = solution.places.size();
    const Index entries = solution.distance.compared;
    solution.scale = std::max(1.0, solution.distance.compared_squared / static_cast<double>(entries));

    // Residuals are correlated, so the covariance is the sandwich of Huber and White, from the
    // scatter of the gradient; but never less than the covariance of independent residuals.
    const MatrixXd prior = prior_weight * MatrixXd::Identity(count, count);
    const MatrixXd inverse =
        (slopes_.transpose() * slopes_ / solution.scale + prior).llt().solve(MatrixXd::Identity(count, count));
    const MatrixXd scores = problem_.scores(solution.distance, slopes_);
    const MatrixXd meat = scores * scores.transpose() / (solution.scale * solution.scale) + prior;
    const MatrixXd sandwich = inverse * meat * inverse;
    const VectorXd wider = (sandwich.diagonal().array() / inverse.diagonal().array()).sqrt().max(1.0);
    solution.covariance = wider.asDiagonal() * inverse * wider.asDiagonal();

    for (Index p = 0; p < count; ++p) {
      Known known{.sd = std::sqrt(solution.covariance(p, p)), .profile = {}};
      known.determined = half_interval * known.sd < widest_known;
      if (!model().recording_of(static_cast<std::size_t>(p))) {
        profile(solution, p, known);
        known.determined = known.determined && rises(known, solution.places(p), model().circular(static_cast<std::size_t>(p)));
      }
      solution.known.push_back(std::move(known));
    }
  }

  void profile(const Solution& solution, Index p, Known& known) {
    const VectorXd along = solution.covariance.col(p) / solution.covariance(p, p);
    std::vector<Task> tasks;
    for (std::size_t k = 0; k < profile_points; ++k) {
      const double way = profile_reach * (2.0 * static_cast<double>(k) / static_cast<double>(profile_points - 1) - 1.0);
      const double place = std::clamp(solution.places(p) + way * half_interval * known.sd, low_(p), high_(p));
      VectorXd places = (solution.places + (place - solution.places(p)) * along).cwiseMax(low_).cwiseMin(high_);
      places(p) = place;
      for (Task& task : all_recordings(places)) tasks.push_back(std::move(task));
    }
    const std::vector<MatrixXd> found = simulated(tasks);
    const std::size_t recordings = model().recordings();
    for (std::size_t k = 0; k < profile_points; ++k) {
      const Waves waves(found.begin() + static_cast<std::ptrdiff_t>(k * recordings),
                        found.begin() + static_cast<std::ptrdiff_t>((k + 1) * recordings));
      const VectorXd& places = tasks[k * recordings].places;
      known.profile.emplace_back(places(p), (problem_.cost(waves, places) - solution.cost) / solution.scale);
    }
  }

  // True if a profile rises enough on both sides of the fit; a side that ends at a bound is exempt,
  // but a circle has no bound.
  static bool rises(const Known& known, double place, bool circular) {
    double below = 0.0, above = 0.0;
    for (const auto& [at, rise] : known.profile) (at < place ? below : above) = std::max(at < place ? below : above, rise);
    const double half = half_interval * known.sd;
    return (below >= chi_square_of_95 || (!circular && (place < half || at_lower_bound(place)))) &&
           (above >= chi_square_of_95 || (!circular && (place > 1.0 - half || at_upper_bound(place))));
  }

  const Problem& problem_;
  const SearchOptions& options_;
  std::size_t total_ = 0;
  std::atomic<std::size_t> done_ = 0;
  MatrixXd slopes_;
  VectorXd low_, high_;  // ends of the places of all parameters
};

constexpr std::size_t devices = 6;  // simulated for each set of values, always the same
constexpr std::size_t evaluations_a_key = 30;
constexpr double difference_of_size = 0.05;  // of the bounds, to either side
constexpr double least_variance = 1e-4;      // of a logarithm: 1 %

class SizeResiduals {
 public:
  SizeResiduals(const Model& model, const CurveProblem& problem, const VectorXd& real)
      : model_(model), problem_(problem), real_(real) {
    for (std::size_t d = 0; d < devices; ++d) seeds_.push_back(seed_of(model.seed(), d, "sizes"));
  }

  // Returns one column per device.
  [[nodiscard]] MatrixXd of_devices(const VectorXd& places) const {
    OrderedWorkers<VectorXd> workers(
        devices, std::min(problem_.jobs, devices), [&] { return [&](std::size_t d) { return of_device(places, seeds_[d]); }; },
        problem_.interrupt);
    MatrixXd sizes(real_.size(), static_cast<Index>(devices));
    Index column = 0;
    while (std::optional<VectorXd> size = workers.next()) sizes.col(column++) = *size;
    end_if(problem_.interrupt);
    return sizes;
  }

  // Sets the weights of the sizes; 0 for those that cannot be compared.
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

  // Real minus simulated sizes, in standard deviations.
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
    std::vector<VectorXd> rough;
    for (std::size_t r = 0; r < model_.recordings(); ++r) {
      const auto sensors = model_.simulate(places, r, Readings::read, seed, problem_.interrupt);
      read.push_back(bin_means(sensors, Side::scene, columns, problem_.edges[r], 0.0));
      rough.push_back(roughness(sensors, Side::scene, columns));
      ideal.push_back(bin_means(model_.simulate(places, r, Readings::ideal, seed, problem_.interrupt), Side::scene, columns,
                                problem_.edges[r], 0.0));
    }
    return disturbance_sizes(columns, read, problem_.disturbances->distance(read, ideal), rms_over(rough));
  }

  const Model& model_;
  const CurveProblem& problem_;
  const VectorXd& real_;
  std::vector<std::uint64_t> seeds_;
  VectorXd weight_;
};

double log_rms(double squares, double count) { return 0.5 * math::log(squares / count); }

}  // namespace

MatrixXd CurveProblem::wave(const VectorXd& places, std::size_t recording) const {
  const std::vector<SensorRecord> sensors = model->simulate(places, recording, Readings::ideal, model->seed(), interrupt);
  return bin_means(sensors, Side::scene, disturbances->columns(), edges[recording], model->lag(places, recording));
}

Distance CurveProblem::distance(const Waves& simulated) const { return disturbances->distance(real, simulated); }

MatrixXd CurveProblem::scores(const Distance& distance, const MatrixXd& slopes) const {
  const Index groups = distance.group.back() + 1;
  MatrixXd sums = MatrixXd::Zero(slopes.cols(), groups);
  for (Index i = 0; i < distance.residual.size(); ++i)
    sums.col(distance.group[static_cast<std::size_t>(i)]) += distance.residual(i) * slopes.row(i).transpose();
  return sums * std::sqrt(static_cast<double>(groups) / static_cast<double>(groups - 1));
}

double Problem::cost(const Waves& simulated, const VectorXd& places) const {
  double squared = distance(simulated).squared;
  for (const double away : model->from_own(places)) squared += prior_weight * away * away;
  return squared;
}

bool at_lower_bound(double place) { return place < bound_width; }
bool at_upper_bound(double place) { return place > 1.0 - bound_width; }

Solution search(const Problem& problem, const SearchOptions& options) { return Searcher(problem, options).run(); }

double minimise(VectorXd& places, const std::function<double(const VectorXd&)>& cost, std::optional<double> first_step,
                double tolerance, std::size_t evaluations, const VectorXd& reach) {
  std::exception_ptr error;
  const nlopt::vfunc objective = [](const std::vector<double>& at, std::vector<double>& /*gradient*/, void* data) {
    auto& [cost_of, thrown] = *static_cast<std::pair<const std::function<double(const VectorXd&)>&, std::exception_ptr&>*>(data);
    try {
      return cost_of(Eigen::Map<const VectorXd>(at.data(), static_cast<Index>(at.size())));
    } catch (...) {
      thrown = std::current_exception();
      throw nlopt::forced_stop();
    }
  };
  std::pair<const std::function<double(const VectorXd&)>&, std::exception_ptr&> objective_data(cost, error);
  nlopt::opt optimiser(first_step ? nlopt::LN_SBPLX : nlopt::GN_CRS2_LM, static_cast<unsigned>(places.size()));
  std::vector<double> low, high;
  for (const double beyond : reach) {
    low.push_back(-beyond);
    high.push_back(1.0 + beyond);
  }
  optimiser.set_lower_bounds(low);
  optimiser.set_upper_bounds(high);
  if (first_step) optimiser.set_initial_step(*first_step);
  optimiser.set_xtol_abs(tolerance);
  optimiser.set_maxeval(static_cast<int>(evaluations));
  optimiser.set_min_objective(objective, &objective_data);
  std::vector<double> at(places.begin(), places.end());
  double least = 0.0;
  try {
    optimiser.optimize(at, least);
  } catch (const nlopt::forced_stop&) {
    std::rethrow_exception(error);
  }
  places = Eigen::Map<const VectorXd>(at.data(), places.size());
  return least;
}

bool of_electronics(const FitKey& key) { return key.path.find(".electronics.") != std::string::npos; }

VectorXd disturbance_sizes(const Columns& columns, const Waves& read, const Distance& distance, const VectorXd& rough) {
  std::vector<double> sizes;
  for (const ChannelPlace& place : columns.channels) {
    for (std::size_t k = 0; k < place.components; ++k) {
      double gains = 0.0, offsets = 0.0, rest = 0.0, rows = 0.0, steps = 0.0;
      for (std::size_t unit = 0; unit < place.units; ++unit) {
        const auto column = static_cast<Index>(place.column(unit, k));
        const double change = distance.gain(column) - 1.0;
        gains += change * change;
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
  SizeResiduals sizes(model, problem, sizes_of_real);
  sizes.weigh(own);
  ElectronicsFit fit{.places = own, .known = {}};
  const auto cost = [&](const VectorXd& places) {
    return sizes.residual(places).squaredNorm() + prior_weight * (places - own).squaredNorm();
  };
  minimise(fit.places, cost, 0.2, 1e-3, evaluations_a_key * static_cast<std::size_t>(own.size()), VectorXd::Zero(own.size()));
  MatrixXd curvature = prior_weight * MatrixXd::Identity(own.size(), own.size());
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
