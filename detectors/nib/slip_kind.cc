#include "detectors/nib/slip_kind.h"

#include <cmath>

namespace slipbench {
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

Entry nib_slip_kind_entry() {
  return {
      .name = "nib_slip_kind",
      .summary = "No slip, linear slip or rotational slip, from the nib pad's spectra and the curl of its shear.",
      .law =
          "no slip: mean over 0 to 6 Hz of the spectra of D_FL and D_FR (nib_linear_slip) both within their bounds\n"
          "otherwise rotational with |curl| >= curl, linear below\n"
          "curl: (dF_y/dx - dF_x/dy) of F_S,i = (E - W, N - S) by least squares over the nine taxels, over the mean |F_S,i|; unit of length: the taxels' distance",
      .source = "Dynamically Reconfigurable Tactile Sensor for Robotic Manipulation, section IV; the bounds are not in the paper",
      .parameters = joined(
          nib::feature_specs(),
          {
              number_spec("fl", Quantity::none, "40", positive,
                          "Magnitude of the linear mode above which the pad slips [counts].",
                          "assumed: the noise at rest never reaches it, and the ramp of a pull seldom does"),
              number_spec("fr", Quantity::none, "40", positive,
                          "Magnitude of the rotational mode above which the pad slips [counts].",
                          "assumed: the noise at rest never reaches it, and the ramp of a pull seldom does"),
              number_spec("curl", Quantity::none, "0.93", positive_up_to(2.13), "|curl| from which on a slip is rotational.",
                          "assumed: half the curl of a rigid rotation about the centre taxel"),
          })};
}

std::unique_ptr<Detector> make_nib_slip_kind(const Parameters& parameters, const FrameSource& source) {
  return std::make_unique<nib::SlipKindDetector>(parameters, source);
}

}  // namespace slipbench
