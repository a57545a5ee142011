// What became of a box that the controller `reorient` was to turn up and put down.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "detectors/nib/features.h"
#include "sim/core/contact_frame.h"
#include "sim/core/detector.h"
#include "sim/core/pad_layout.h"
#include "sim/core/parameters.h"
#include "sim/core/random.h"
#include "sim/scene/scene.h"
#include "tools/base/record/trial_record.h"
#include "tools/base/statistics/descriptive.h"
#include "tools/studies/study_catalogue.h"

namespace slipbench::reproduce {

// How a trial ended. The phases are told apart by the arm: it rises while the grip is adjusted and the box turns, and goes sideways in the
// release.
enum class TurnEnd : std::size_t {
  standing,      // as TurnOutcome has it
  lost,          // before the release no pad touched it any more: the grip let go
  told_early,    // released below TargetPoint, where upright is told, and never nearer than `turned_up` to upright
  not_turned,    // the same at TargetPoint: it hung in the grip, or lay
  fell,          // released, nearer than that to upright at some time, and not upright in the end
  not_let_go,    // upright in the end, but a pad touches it or the table does not carry it
  not_released,  // the arm rose to the end of the trial
};
inline constexpr std::size_t turn_ends = 7;
inline constexpr std::array<const char*, turn_ends> turn_end_names{"standing", "lost",       "told_early",  "not_turned",
                                                                   "fell",     "not_let_go", "not_released"};

inline constexpr double turned_up = 0.349065850398865915;  // rad, 20 degrees

struct Turn {
  TurnEnd end = TurnEnd::standing;
  // At the release's beginning, NaN without one:
  double tilt;   // rad, of the box's own axis Y against the vertical
  double force;  // N, mean of both pads'
};

// `record`: a full one of a grasp whose arm is guided. `target`: the rise of TargetPoint [m]. Throws std::logic_error where the record has
// not what it takes: the outcome's turn, the bodies `arm` and `box`, and the loop's rows at the same times.
Turn turn_of(const TrialRecord& record, double target);

// A trial, and what the trials of a cell come to.
struct ReorientRun {
  bool standing = false, dropped = false;
  double tilt = 0.0, least_tilt = 0.0;  // rad, at the end and ever
  double most_force = 0.0;              // N
  Turn turn;
};
using ReorientRuns = std::vector<ReorientRun>;

struct ReorientSummary {
  std::size_t runs = 0, standing = 0, turned_up = 0, dropped = 0;
  std::array<std::size_t, turn_ends> ends{};                                                  // runs of each TurnEnd
  double tilt = 0.0, least_tilt = 0.0, most_force = 0.0, released_tilt = 0.0, held_by = 0.0;  // medians; rad, N; NaN of none
};
ReorientSummary summary_of(const ReorientRuns& runs);

// What Algorithm 1 makes of the slow releases of Table II of the nib pad's paper.

// What one run came to with one reading. NaN: nothing was detected before the slip was over.
struct ReleaseRun {
  std::string material;
  double required = 0.0;                                    // N, pull/mu_s
  double force = std::numeric_limits<double>::quiet_NaN();  // N, true, at the detection
  double way = std::numeric_limits<double>::quiet_NaN();    // m, slip at the detection

  [[nodiscard]] bool safe() const { return way < 6e-3; }  // a success in the paper
  [[nodiscard]] bool gross() const { return safe() && force < required; }
};

struct ReleaseSummary {
  std::size_t runs = 0, safe = 0, early = 0;
  MeanSd error, gross_error, slip;  // N, N, mm; of the safe ones
};
// Of the runs on a material; of all where it is empty.
ReleaseSummary summary_of(const std::vector<ReleaseRun>& runs, const std::string& material);

// Calibration of the nib pad: what it reads under known loads, and a polynomial that gives the loads back.

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

// A change of the scene's friction, of which everything else stays.
struct FrictionLaw {
  const char* name;
  const char* text;
  std::function<void(Scene&)> change;
};

// The scene's own law first.
const std::vector<FrictionLaw>& friction_laws();

// A trial on the nib pad's lever bench (scenes/nib_pad), as its figures are made of it.
class NibTrace {
 public:
  // `record`: full, of a scene with one nib pad and a recorded body "lever". Throws std::logic_error of any other.
  explicit NibTrace(const TrialRecord& record);

  [[nodiscard]] std::size_t size() const { return time_.size(); }
  [[nodiscard]] double time(std::size_t sample) const { return time_[sample]; }      // s
  [[nodiscard]] double normal(std::size_t sample) const { return normal_[sample]; }  // N, true, of all nibs
  [[nodiscard]] double lever(std::size_t sample) const { return lever_[sample]; }    // m, where the lever is, along the pull
  [[nodiscard]] const FrameSource& source() const { return source_; }

  // The first sample at or after `time` [s]; size() where there is none.
  [[nodiscard]] std::size_t at(double time) const;
  // The first sample from `from` on at which the lever has gone by `way` [m] since; empty: it never has.
  [[nodiscard]] std::optional<std::size_t> moved(std::size_t from, double way) const;

  // The sample as the sensor emitted it; of a slow channel, before its first row is complete, that row.
  [[nodiscard]] SensorFrame frame(std::size_t sample) const {
    return {time_[sample], std::span(frames_).subspan(sample * frame_size_, frame_size_)};
  }
  // The sample in which a detector that is fed all of them first says gross; empty: in none.
  [[nodiscard]] std::optional<std::size_t> detection(Detector& detector) const;

  // Features at the end of a window.
  struct Window {
    std::size_t sample;
    nib::Features features;
  };
  // Of all windows, with the parameters of nib::feature_specs().
  [[nodiscard]] std::vector<Window> windows(const Parameters& parameters) const;

 private:
  FrameSource source_;
  std::size_t frame_size_ = 0;
  std::vector<double> time_, normal_, lever_;
  std::vector<float> frames_;
};

// Where the nib pad's signal below 8 Hz comes from: its energy while the pad slips, under one friction law after the other.

// Of the difference of FL in the windows that lie within one slip.
struct Signature {
  bool wavy = false;                // the plate has waves
  double share = 0.0;               // of the energy above 0 Hz that is below 8 Hz
  double time = 0.0;                // s, that the slip takes
  double below = 0.0, above = 0.0;  // counts rms, below and above 8 Hz
};

// From when the lever has gone 0.3 mm beyond where it stood when the detector began to count, to 10 mm. Empty where that is
// shorter than a window, or the pad does not slip.
std::optional<Signature> signature_of(const Scene& scene, const NibTrace& trace);

// The table, without rows, and those of one law: in it and in `figures`, an array.
ResultTable signature_table();
void add_signatures(const char* law, const std::vector<std::optional<Signature>>& found, ResultTable& table, Json& figures);

}  // namespace slipbench::reproduce
