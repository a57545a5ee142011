#include "detectors/nib/linear_slip.h"

#include <algorithm>
#include <cmath>

#include "detectors/nib/features.h"

namespace slipbench {
namespace nib {
namespace {

class LinearSlip final : public Detector {
 public:
  LinearSlip(const Parameters& p, const FrameSource& source)
      : settings_{p.number("threshold"), p.number("counter_max"), p.number("weight"), p.number("patience")},
        counter_(settings_),
        reader_(p, source, "nib_linear_slip"),
        start_(p.number("start")),
        forces_(p.choice("ratio") == "forces") {}

  const SlipEstimate& update(const SensorFrame& frame) override {
    const bool due = reader_.update(frame);
    estimate_.time = frame.time;
    reader_.hand_on(estimate_.features);
    if (!reader_.touching()) {
      counter_ = FlagCounter(settings_);
      estimate_.state = PadState::no_contact;
      return estimate_;
    }
    if (estimate_.state == PadState::no_contact) estimate_.state = PadState::non_slip;
    if (!due || frame.time < start_) return estimate_;
    const Features& read = reader_.features();
    const double ratio = forces_ ? reader_.shear_force().y() / reader_.normal_force() : read.shear.y() / read.normal;
    if (counter_.update(frame.time, read.fl, std::abs(ratio))) estimate_.state = PadState::gross;
    return estimate_;
  }
  [[nodiscard]] const std::vector<Feature>& features() const override { return handed_on(); }

 private:
  FlagCounter::Settings settings_;
  FlagCounter counter_;
  FeatureReader reader_;
  double start_;  // s
  bool forces_;   // F_S/F_N is one of newtons, else of counts
  SlipEstimate estimate_;
};

}  // namespace

bool FlagCounter::update(double time, double magnitude, double ratio) {
  if (magnitude > settings_.threshold) {
    ++count_;
    last_flag_ = time;
  }
  if (count_ > 0 && time - last_flag_ > settings_.patience) --count_;
  // A counter that never was above 0 has seen nothing: the limit is a positive number.
  detected_ = detected_ || count_ >= std::max(1.0, settings_.most - settings_.weight * ratio);
  return detected_;
}

}  // namespace nib

Entry nib_linear_slip_entry() {
  return {
      .name = "nib_linear_slip",
      .summary =
          "Algorithm 1 of the nib pad's paper: it counts flags of the linear mode's spectrum against shear over normal force.",
      .law =
          "D = C_N - C_S; magnitude: mean over 0 to 6 Hz of |FFT((D - line of least squares) Hamming)|, not divided by anything [counts]\n"
          "a spectrum above threshold: counter + 1; none for longer than patience: counter - 1, down to 0\n"
          "slip: counter >= max(1, counter_max - weight |F_S,y|/F_N), F_S,y: sum of N - S, F_N: sum of W + N + E + S\n"
          "After slip the class stays gross while the pad touches.",
      .source = "Dynamically Reconfigurable Tactile Sensor for Robotic Manipulation, sections IV-B and V, Algorithm 1",
      .parameters = joined(
          nib::feature_specs(),
          {
              number_spec("threshold", Quantity::none, "25", positive,
                          "SLIP_THRES: magnitude above which a spectrum raises a flag [counts].",
                          "assumed: not in the paper; one of a thousand spectra of a pad at rest exceeds it by noise"),
              number_spec("counter_max", Quantity::none, "9", positive, "M, the counter's limit without shear.",
                          "paper, section V"),
              number_spec("weight", Quantity::none, "10", non_negative,
                          "alpha, by which the limit falls with the ratio F_S,y/F_N.", "paper, section V"),
              number_spec("patience", Quantity::time, "0.5 s", non_negative,
                          "TIME_THRES: time since the last flag after which the counter falls.",
                          "assumed: not in the paper; one window"),
              number_spec("start", Quantity::time, "0 s", non_negative,
                          "Time from which on flags count, after the load has been laid on.",
                          "assumed: the paper runs the algorithm while the normal force falls"),
              choice_spec(
                  "ratio", "counts", {"forces", "counts"},
                  "Kind of the ratio F_S,y/F_N: forces: newtons by normal_gain and shear_gain; counts: raw changes of capacitance.",
                  "paper: equation 4 takes F_S,i and F_N,i, which equations 1 and 2 define by sums and differences of capacitances"),
          })};
}

std::unique_ptr<Detector> make_nib_linear_slip(const Parameters& parameters, const FrameSource& source) {
  return std::make_unique<nib::LinearSlip>(parameters, source);
}

}  // namespace slipbench
