#include "tools/studies/nib_reconfigurable/nib_calibration.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <stdexcept>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "sim/simulation/stage_simulation.h"
#include "tools/program/catalogue/sensor_catalogue.h"

namespace slipbench::reproduce {
namespace {

constexpr std::array<double, 9> ridges{1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0};

// All inputs, then all products of two.
Eigen::MatrixXd quadratic_terms(const Eigen::MatrixXd& x) {
  const Eigen::Index n = x.cols();
  Eigen::MatrixXd terms(x.rows(), n + n * (n + 1) / 2);
  terms.leftCols(n) = x;
  Eigen::Index column = n;
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = i; j < n; ++j) terms.col(column++) = x.col(i).cwiseProduct(x.col(j));
  }
  return terms;
}

Eigen::RowVectorXd scale_of(const Eigen::MatrixXd& x, const Eigen::RowVectorXd& mean) {
  const Eigen::RowVectorXd sd = ((x.rowwise() - mean).colwise().squaredNorm() / static_cast<double>(x.rows())).cwiseSqrt();
  return sd.unaryExpr([](double value) { return value > 0.0 ? value : 1.0; });  // what never changes teaches nothing
}

Eigen::MatrixXd scaled(const Eigen::MatrixXd& x, const Eigen::RowVectorXd& mean, const Eigen::RowVectorXd& scale) {
  return ((x.rowwise() - mean).array().rowwise() / scale.array()).matrix();
}

// The mean of each row and of those before it, `count` in all.
Eigen::MatrixXd running_mean(const Eigen::MatrixXd& rows, std::size_t count) {
  Eigen::MatrixXd means(rows.rows(), rows.cols());
  for (Eigen::Index row = 0; row < rows.rows(); ++row) {
    const Eigen::Index taken = std::min(row + 1, static_cast<Eigen::Index>(count));
    means.row(row) = rows.middleRows(row + 1 - taken, taken).colwise().mean();
  }
  return means;
}

// Shuffles and keeps the first `count`.
std::vector<Eigen::Index> draw(std::vector<Eigen::Index> rows, std::size_t count, RandomStream& stream) {
  if (rows.size() < count) throw std::invalid_argument("split_rows: too few rows");
  for (std::size_t i = 0; i < count; ++i) std::swap(rows[i], rows[i + stream.integer(rows.size() - i)]);
  rows.resize(count);
  return rows;
}

std::vector<Eigen::Index> range(std::size_t first, std::size_t end) {
  std::vector<Eigen::Index> rows(end - first);
  std::iota(rows.begin(), rows.end(), static_cast<Eigen::Index>(first));
  return rows;
}

}  // namespace

PadWrench wrench_on_pad(const PadLayout& layout, const ContactFrame& truth) {
  PadWrench wrench = PadWrench::Zero();
  for (std::size_t unit = 0; unit < layout.units.size(); ++unit) {
    const auto column = static_cast<Eigen::Index>(unit);
    const Eigen::Vector3d force = truth.force.col(column);
    const Eigen::Vector3d place = layout.elements[layout.units[unit].first].tip + truth.displacement.col(column).matrix();
    wrench.head<3>() += force.transpose();
    wrench.tail<3>() += place.cross(force).transpose();
  }
  return wrench;
}

CalibrationRecording record_calibration(const Scene& scene, std::uint64_t trial, Eigen::Index every) {
  const std::unique_ptr<Sensor> sensor = make_sensor(scene.sensors.front(), scene.seed, trial);
  const PadLayout* const pad = &sensor->layout();
  const double rate = sensor->rate() * static_cast<double>(sensor->scans());
  StageSimulation simulation(scene, {&pad, 1}, {&rate, 1}, trial);
  const std::size_t readings_an_image = sensor->scans() * sensor->channels().front().every;

  std::vector<double> time, si;
  std::vector<double> wrench;
  std::size_t readings = 0;
  for (std::size_t tick = 0; tick < simulation.ticks(0); ++tick) {
    simulation.step();
    if (tick % simulation.stride(0) != 0) continue;
    const ContactFrame& truth = simulation.contact(0);
    const SensorFrame& frame = sensor->measure(truth);
    if (++readings % readings_an_image != 0) continue;
    time.push_back(truth.time);
    si.insert(si.end(), frame.values.begin(), frame.values.begin() + si_count);
    const PadWrench now = wrench_on_pad(*pad, truth);
    wrench.insert(wrench.end(), now.begin(), now.end());
  }
  const auto images = static_cast<Eigen::Index>(time.size());
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Eigen::MatrixXd all_si = Eigen::Map<const Rows>(si.data(), images, si_count);
  const Eigen::MatrixXd all_wrenches = Eigen::Map<const Rows>(wrench.data(), images, wrench_size);
  const Eigen::MatrixXd averaged = running_mean(all_wrenches, averaged_images);

  const Eigen::Index untouched = std::ranges::lower_bound(time, scene.motion.parameters.number("start")) - time.begin();
  const Eigen::RowVectorXd rest = all_si.topRows(untouched).colwise().mean();
  std::vector<Eigen::Index> kept;
  for (Eigen::Index image = untouched; image < images; image += every) kept.push_back(image);
  return {rows_of(all_si, kept).rowwise() - rest, rows_of(all_wrenches, kept), rows_of(averaged, kept)};
}

CalibrationRecording joined(std::span<const CalibrationRecording> recordings) {
  Eigen::Index rows = 0;
  for (const CalibrationRecording& one : recordings) rows += one.si.rows();
  CalibrationRecording all{Eigen::MatrixXd(rows, si_count), Eigen::MatrixXd(rows, wrench_size),
                           Eigen::MatrixXd(rows, wrench_size)};
  Eigen::Index row = 0;
  for (const CalibrationRecording& one : recordings) {
    all.si.middleRows(row, one.si.rows()) = one.si;
    all.wrench.middleRows(row, one.si.rows()) = one.wrench;
    all.averaged.middleRows(row, one.si.rows()) = one.averaged;
    row += one.si.rows();
  }
  return all;
}

CalibrationSplit split_rows(std::size_t rows, std::size_t fit, std::size_t choose, std::size_t test, SplitKind kind,
                            RandomStream& stream) {
  if (kind == SplitKind::chronological) {
    const std::size_t judged = rows - rows / 5, chosen = judged - judged / 4;
    return {draw(range(0, chosen), fit, stream), draw(range(chosen, judged), choose, stream),
            draw(range(judged, rows), test, stream)};
  }
  const std::vector<Eigen::Index> drawn = draw(range(0, rows), fit + choose + test, stream);
  const auto chosen = drawn.begin() + static_cast<std::ptrdiff_t>(fit), judged = chosen + static_cast<std::ptrdiff_t>(choose);
  return {{drawn.begin(), chosen}, {chosen, judged}, {judged, drawn.end()}};
}

// The columns of some rows, and what least squares needs of them.
struct QuadraticFit::Columns {
  Eigen::MatrixXd terms;  // scaled
  Eigen::MatrixXd gram;   // terms' terms / n, lower triangle
  Eigen::MatrixXd right;  // terms' (y - mean) / n

  [[nodiscard]] Eigen::MatrixXd solved(double ridge) const {
    Eigen::MatrixXd system = gram;
    system.diagonal().array() += ridge;
    return Eigen::LLT<Eigen::MatrixXd, Eigen::Lower>(system).solve(right);
  }
};

QuadraticFit::QuadraticFit(const Eigen::MatrixXd& x, const Eigen::MatrixXd& y, std::span<const Eigen::Index> teach,
                           std::span<const Eigen::Index> choose)
    : ridge_(static_cast<std::size_t>(y.cols()), ridges.front()) {
  const auto learn = [&](std::span<const Eigen::Index> rows) {
    const Eigen::MatrixXd inputs = rows_of(x, rows), outputs = rows_of(y, rows);
    x_mean_ = inputs.colwise().mean();
    x_scale_ = scale_of(inputs, x_mean_);
    Columns columns;
    columns.terms = quadratic_terms(scaled(inputs, x_mean_, x_scale_));
    column_mean_ = columns.terms.colwise().mean();
    column_scale_ = scale_of(columns.terms, column_mean_);
    columns.terms = scaled(columns.terms, column_mean_, column_scale_);
    y_mean_ = outputs.colwise().mean();
    const double share = 1.0 / static_cast<double>(rows.size());
    columns.gram = Eigen::MatrixXd::Zero(columns.terms.cols(), columns.terms.cols());
    columns.gram.selfadjointView<Eigen::Lower>().rankUpdate(columns.terms.transpose(), share);
    columns.right = share * (columns.terms.transpose() * (outputs.rowwise() - y_mean_));
    return columns;
  };

  const Columns first = learn(teach);
  const Eigen::MatrixXd inputs = rows_of(x, choose), outputs = rows_of(y, choose);
  std::vector<double> least(ridge_.size(), std::numeric_limits<double>::infinity());
  for (const double ridge : ridges) {
    coefficients_ = first.solved(ridge);
    const Eigen::RowVectorXd errors = (predict(inputs) - outputs).colwise().squaredNorm();
    for (std::size_t c = 0; c < least.size(); ++c) {
      if (errors[static_cast<Eigen::Index>(c)] >= least[c]) continue;
      least[c] = errors[static_cast<Eigen::Index>(c)];
      ridge_[c] = ridge;
    }
  }

  std::vector<Eigen::Index> both(teach.begin(), teach.end());
  both.insert(both.end(), choose.begin(), choose.end());
  const Columns all = learn(both);
  for (const double ridge : ridges) {
    if (std::ranges::find(ridge_, ridge) == ridge_.end()) continue;
    const Eigen::MatrixXd solved = all.solved(ridge);
    for (std::size_t c = 0; c < ridge_.size(); ++c) {
      const auto component = static_cast<Eigen::Index>(c);
      if (ridge_[c] == ridge) coefficients_.col(component) = solved.col(component);
    }
  }
}

Eigen::MatrixXd QuadraticFit::predict(const Eigen::MatrixXd& x) const {
  const Eigen::MatrixXd terms = scaled(quadratic_terms(scaled(x, x_mean_, x_scale_)), column_mean_, column_scale_);
  return (terms * coefficients_).rowwise() + y_mean_;
}

PadWrench rms_error(const Eigen::MatrixXd& predicted, const Eigen::MatrixXd& truth) {
  return ((predicted - truth).colwise().squaredNorm() / static_cast<double>(truth.rows())).cwiseSqrt();
}

Eigen::MatrixXd rows_of(const Eigen::MatrixXd& matrix, std::span<const Eigen::Index> which) {
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(which.size()), matrix.cols());
  for (std::size_t i = 0; i < which.size(); ++i) rows.row(static_cast<Eigen::Index>(i)) = matrix.row(which[i]);
  return rows;
}

}  // namespace slipbench::reproduce
