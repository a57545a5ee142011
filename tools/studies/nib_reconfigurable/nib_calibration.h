// Calibration of the nib pad: what it reads under known loads, and a polynomial that gives the loads back.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "sim/core/contact_frame.h"
#include "sim/core/pad_layout.h"
#include "sim/core/random.h"
#include "sim/scene/scene.h"

namespace slipbench::reproduce {

inline constexpr Eigen::Index si_count = 36;       // capacitances of an image
inline constexpr Eigen::Index wrench_size = 6;     // Fx, Fy, Fz [N], Mx, My, Mz [N m]
inline constexpr std::size_t averaged_images = 5;  // what si is averaged over, and the reference with it

// What the object does to the pad, in its frame P and about its origin: compression is positive.
using PadWrench = Eigen::Matrix<double, 1, wrench_size>;
PadWrench wrench_on_pad(const PadLayout& layout, const ContactFrame& truth);

// A recording of a calibration: a row an image, or one of several images, from the motion's start on.
struct CalibrationRecording {
  Eigen::MatrixXd si;        // [n,36] counts above the mean of the images before the motion's start
  Eigen::MatrixXd wrench;    // [n,6] at the instant at which the image is complete
  Eigen::MatrixXd averaged;  // [n,6] mean over the last averaged_images of these

  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(si.rows()); }
};

// Runs trial number `trial` of a scene with a nib pad and the motion `wander`, and keeps every `every`-th image. Throws
// InputError as a trial does.
CalibrationRecording record_calibration(const Scene& scene, std::uint64_t trial, Eigen::Index every = 1);

// Recordings one after the other.
CalibrationRecording joined(std::span<const CalibrationRecording> recordings);

// Rows of a recording that teach, that choose the ridge, and that judge.
struct CalibrationSplit {
  std::vector<Eigen::Index> fit, choose, test;
};

enum class SplitKind {
  random,         // rows drawn without order: neighbours of a test row, 30 ms away, may teach
  chronological,  // the last fifth judges, of the rest the last quarter chooses
};

// `fit`, `choose` and `test` rows out of `rows`, no row twice. Throws std::invalid_argument when there are too few.
CalibrationSplit split_rows(std::size_t rows, std::size_t fit, std::size_t choose, std::size_t test, SplitKind kind,
                            RandomStream& stream);

// y = b + sum a_i x_i + sum_{i<=j} a_ij x_i x_j of every component, by least squares with a ridge: columns are scaled to mean 0
// and standard deviation 1 first, b is not held back. Of 36 inputs it has 703 coefficients a component, 3,000 rows hardly fix all
// of them: the ridge is the one, of a row of powers of ten, that is best on rows that did not teach; then all teach.
class QuadraticFit {
 public:
  // x: [n,inputs], y: [n,components]. Rows of `teach` and `choose` are used, no others.
  QuadraticFit(const Eigen::MatrixXd& x, const Eigen::MatrixXd& y, std::span<const Eigen::Index> teach,
               std::span<const Eigen::Index> choose);

  [[nodiscard]] Eigen::MatrixXd predict(const Eigen::MatrixXd& x) const;
  // The chosen ridge of each component, over the number of rows.
  [[nodiscard]] const std::vector<double>& ridge() const { return ridge_; }

 private:
  struct Columns;
  Eigen::RowVectorXd x_mean_, x_scale_, column_mean_, column_scale_, y_mean_;
  Eigen::MatrixXd coefficients_;  // [columns, components]
  std::vector<double> ridge_;
};

// Root mean square of each component's error over the rows.
PadWrench rms_error(const Eigen::MatrixXd& predicted, const Eigen::MatrixXd& truth);

// The rows `which` of a matrix.
Eigen::MatrixXd rows_of(const Eigen::MatrixXd& matrix, std::span<const Eigen::Index> which);

}  // namespace slipbench::reproduce
