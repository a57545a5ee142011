#include "detectors/detector_kinds.h"

#include "detectors/channel.h"

namespace slipbench {
namespace {

class ForceRatio final : public Detector {
 public:
  ForceRatio(const Parameters& parameters, const FrameSource& source)
      : force_(vector_channel(source, "force", "N", "force_ratio")),
        ratio_(parameters.number("ratio")),
        touch_(parameters.number("touch")) {}

  const SlipEstimate& update(const SensorFrame& frame) override {
    UnitCounts units;
    for (std::size_t unit = 0; unit < force_.units; ++unit) {
      const UnitForce force = force_at(frame, force_, unit);
      if (!(force.normal >= touch_)) continue;
      ++units.touching;
      if (force.tangential > ratio_ * force.normal) ++units.slipping;
    }
    return estimate_ = estimate_of(units, frame.time);
  }

 private:
  ChannelPlace force_;
  double ratio_;
  double touch_;
  SlipEstimate estimate_;
};

}  // namespace

DetectorKind force_ratio_detector() {
  return {
      {.name = "force_ratio",
       .summary = "Threshold on each unit's ratio of tangential to normal force; no training.",
       .law = "a unit with f_n >= touch slips when f_t > ratio f_n\n"
              "no contact: no unit touches; non-slip: no touching unit slips; incipient: some slip; gross: all slip\n"
              "stuck fraction: share of the touching units that do not slip",
       .source =
           "Coulomb's law: a sticking unit has f_t <= mu_s f_n, a slipping one f_t = mu_k f_n. A threshold below mu_k warns early; a threshold above mu_k detects slip only briefly",
       .parameters = {number_spec("ratio", Quantity::none, "0.4", positive,
                                  "Ratio f_t/f_n above which a unit counts as slipping.",
                                  "assumed: 0.8 of the friction coefficient 0.5 of stage.yaml"),
                      touch_spec()}},
      created<ForceRatio>,
      nullptr,
      FrameSpacing::any};
}

}  // namespace slipbench
