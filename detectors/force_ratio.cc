#include "detectors/force_ratio.h"

#include "detectors/channel.h"

namespace slipbench {
namespace {

class ForceRatio final : public Detector {
 public:
  ForceRatio(const Parameters& parameters, const FrameSource& source)
      : force_(vector_channel(source, "force", "force_ratio")),
        ratio_(parameters.number("ratio")),
        touch_(parameters.number("touch")) {}

  const SlipEstimate& update(const SensorFrame& frame) override {
    std::size_t touching = 0;
    std::size_t slipping = 0;
    for (std::size_t unit = 0; unit < force_.units; ++unit) {
      const float* const force = frame.values.data() + force_.first + 3 * unit;
      const double x = force[0];
      const double y = force[1];
      const double normal = force[2];
      if (normal < touch_) continue;
      ++touching;
      if (x * x + y * y > ratio_ * ratio_ * normal * normal) ++slipping;
    }
    estimate_.time = frame.time;
    estimate_.state = touching == 0          ? PadState::no_contact
                      : slipping == 0        ? PadState::non_slip
                      : slipping == touching ? PadState::gross
                                             : PadState::incipient;
    return estimate_;
  }

 private:
  ChannelPlace force_;
  double ratio_;
  double touch_;
  SlipEstimate estimate_;
};

}  // namespace

Entry force_ratio_entry() {
  return {.name = "force_ratio",
          .summary = "threshold on each unit's ratio of tangential to normal force; no training",
          .law =
              "a unit with f_n >= touch slips when f_t > ratio f_n\n"
              "no contact: no unit touches; non-slip: none of those that touch slips; incipient: some do; gross: all do",
          .source =
              "Coulomb's law: a unit that sticks has f_t <= mu_s f_n, one that slips f_t = mu_k f_n. Below mu_k the ratio warns "
              "early; above it nothing that slips is seen for long",
          .parameters = {{.name = "ratio",
                          .type = ParameterType::number,
                          .quantity = Quantity::none,
                          .default_text = "0.4",
                          .range = positive,
                          .choices = {},
                          .size = 1,
                          .doc = "Ratio f_t/f_n above which a unit counts as slipping.",
                          .source = "assumed: 0.8 of the friction coefficient 0.5 of stage.yaml"},
                         {.name = "touch",
                          .type = ParameterType::number,
                          .quantity = Quantity::force,
                          .default_text = "0.05 N",
                          .range = positive,
                          .choices = {},
                          .size = 1,
                          .doc = "Normal force from which on a unit counts as touching.",
                          .source = "the force resolution of the PapillArray: less is noise, whose ratio means nothing"}}};
}

std::unique_ptr<Detector> make_force_ratio(const Parameters& parameters, const FrameSource& source) {
  return std::make_unique<ForceRatio>(parameters, source);
}

}  // namespace slipbench
