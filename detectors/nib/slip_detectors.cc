#include "detectors/nib/slip_detectors.h"

#include <algorithm>
#include <cmath>

#include "detectors/detector_kinds.h"

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
  bool forces_;   // F_S/F_N is a ratio of newtons; false: of counts
  SlipEstimate estimate_;
};

}  // namespace

bool FlagCounter::update(double time, double magnitude, double ratio) {
  if (magnitude > settings_.threshold) {
    ++count_;
    last_flag_ = time;
  }
  if (count_ > 0 && time - last_flag_ > settings_.patience) --count_;
  // A limit of at least 1 requires at least one flag.
  detected_ = detected_ || count_ >= std::max(1.0, settings_.most - settings_.weight * ratio);
  return detected_;
}

}  // namespace nib

DetectorKind nib_linear_slip_detector() {
  return {
      {.name = "nib_linear_slip",
       .summary =
           "Algorithm 1 of the nib pad's paper: counts flags of the linear mode's spectrum and compares them with a limit that falls with shear over normal force.",
       .law =
           "D = C_N - C_S; magnitude: mean over 0 to 6 Hz of |FFT((D - line of least squares) Hamming)|, not normalised [counts]\n"
           "a spectrum above threshold: counter + 1; no such spectrum for longer than patience: counter - 1, down to 0\n"
           "slip: counter >= max(1, counter_max - weight |F_S,y|/F_N), F_S,y: sum of N - S, F_N: sum of W + N + E + S\n"
           "After slip the class stays gross while the pad touches.",
       .source = "Dynamically Reconfigurable Tactile Sensor for Robotic Manipulation, sections IV-B and V, Algorithm 1",
       .parameters = joined(
           nib::feature_specs(),
           {number_spec("threshold", Quantity::none, "25", positive,
                        "SLIP_THRES: magnitude above which a spectrum raises a flag [counts].",
                        "assumed: not in the paper; one of a thousand spectra of a pad at rest exceeds it by noise"),
            number_spec("counter_max", Quantity::none, "9", positive, "M, the counter's limit without shear.",
                        "paper, section V"),
            number_spec("weight", Quantity::none, "10", non_negative, "alpha, by which the limit falls with the ratio F_S,y/F_N.",
                        "paper, section V"),
            number_spec("patience", Quantity::time, "0.5 s", non_negative,
                        "TIME_THRES: time without a flag after which the counter falls.",
                        "assumed: not in the paper; one window"),
            number_spec("start", Quantity::time, "0 s", non_negative,
                        "Time from which on flags count, after the load has been applied.",
                        "assumed: the paper runs the algorithm while the normal force falls"),
            choice_spec(
                "ratio", "counts", {"forces", "counts"},
                "Quantities of the ratio F_S,y/F_N: forces: newtons by normal_gain and shear_gain; counts: raw changes of capacitance.",
                "paper: equation 4 takes F_S,i and F_N,i, which equations 1 and 2 define by sums and differences of capacitances")})},
      created<nib::LinearSlip>,
      nullptr,
      FrameSpacing::evened,
      {"FFTW"}};
}

namespace nib {
namespace {

class SlipKindDetector final : public Detector {
 public:
  SlipKindDetector(const Parameters& p, const FrameSource& source)
      : bounds_{p.number("fl"), p.number("fr"), p.number("curl")}, reader_(p, source, "nib_slip_kind") {}

  const SlipEstimate& update(const SensorFrame& frame) override {
    reader_.update(frame);
    estimate_.time = frame.time;
    estimate_.state = PadState::no_contact;
    SlipKind kind = SlipKind::none;
    if (reader_.touching()) {
      kind = slip_kind(reader_.features(), bounds_);
      estimate_.state = kind == SlipKind::none ? PadState::non_slip : PadState::gross;
    }
    reader_.hand_on(estimate_.features);
    estimate_.features.push_back(static_cast<double>(kind));
    return estimate_;
  }
  [[nodiscard]] const std::vector<Feature>& features() const override {
    static const std::vector<Feature> all = [] {
      std::vector<Feature> features = handed_on();
      features.push_back({"kind", ""});
      return features;
    }();
    return all;
  }

 private:
  KindBounds bounds_;
  FeatureReader reader_;
  SlipEstimate estimate_;
};

}  // namespace

SlipKind slip_kind(const Features& features, const KindBounds& bounds) {
  if (features.fl <= bounds.fl && features.fr <= bounds.fr) return SlipKind::none;
  return std::abs(features.curl) >= bounds.curl ? SlipKind::rotational : SlipKind::linear;
}

}  // namespace nib

DetectorKind nib_slip_kind_detector() {
  return {
      {.name = "nib_slip_kind",
       .summary = "No slip, linear slip or rotational slip, from the nib pad's spectra and the curl of its shear.",
       .law =
           "no slip: mean over 0 to 6 Hz of the spectra of D_FL and D_FR (nib_linear_slip) both within their bounds\n"
           "otherwise rotational if |curl| >= parameter curl, else linear\n"
           "curl: (dF_y/dx - dF_x/dy) of F_S,i = (E - W, N - S) by least squares over the nine taxels, over the mean |F_S,i|; unit of length: the taxels' distance",
       .source =
           "Dynamically Reconfigurable Tactile Sensor for Robotic Manipulation, section IV; the bounds are not in the paper",
       .parameters = joined(
           nib::feature_specs(),
           {number_spec("fl", Quantity::none, "40", positive, "Magnitude of the linear mode above which the pad slips [counts].",
                        "assumed: the noise at rest never reaches it, and the ramp of a pull seldom does"),
            number_spec("fr", Quantity::none, "40", positive,
                        "Magnitude of the rotational mode above which the pad slips [counts].",
                        "assumed: the noise at rest never reaches it, and the ramp of a pull seldom does"),
            number_spec("curl", Quantity::none, "0.93", positive_up_to(2.13), "|curl| above which a slip is rotational.",
                        "assumed: half the curl of a rigid rotation about the centre taxel")})},
      created<nib::SlipKindDetector>,
      nullptr,
      FrameSpacing::evened,
      {"FFTW"}};
}

}  // namespace slipbench
