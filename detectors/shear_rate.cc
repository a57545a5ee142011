#include "detectors/detector_kinds.h"

#include <algorithm>

#include "detectors/channel.h"

namespace slipbench {
namespace {

class ShearRate final : public Detector {
 public:
  ShearRate(const Parameters& parameters, const FrameSource& source)
      : force_(vector_channel(source, "force", "N", "shear_rate")),
        window_(parameters.number("window"), 2 * force_.units, source, "shear_rate"),
        loading_(parameters.number("loading") / parameters.number("window")),
        following_(parameters.number("following")),
        release_(parameters.number("release")),
        least_(parameters.number("least_friction")),
        touch_(parameters.number("touch")),
        loads_(2 * force_.units),
        units_(force_.units) {}

  const SlipEstimate& update(const SensorFrame& frame) override {
    for (std::size_t i = 0; i < units_.size(); ++i) {
      const UnitForce force = force_at(frame, force_, i);
      loads_[2 * i] = force.tangential;
      loads_[2 * i + 1] = force.normal >= touch_ ? force.tangential / force.normal : std::numeric_limits<double>::quiet_NaN();
    }
    const std::span<const double> rates = window_.rates(loads_);
    UnitCounts counts;
    for (std::size_t i = 0; i < units_.size(); ++i) {
      const UnitForce force = force_at(frame, force_, i);
      if (!(force.normal >= touch_)) {
        units_[i] = {};
        continue;
      }
      follow(units_[i], force, rates[2 * i], rates[2 * i + 1] > 0.0);
      ++counts.touching;
      if (units_[i].slips) ++counts.slipping;
    }
    return estimate_ = estimate_of(counts, frame.time);
  }

 private:
  struct Unit {
    double peak = 0.0;   // N/s, largest rate of shear towards the cone since loading began
    double ratio = 0.0;  // f_t/f_n when slip was found
    bool slips = false;
  };

  // `nearer`: f_t/f_n has grown over the window. It does not grow if the shear comes from a closing
  // grip.
  void follow(Unit& unit, const UnitForce& force, double rate, bool nearer) const {
    if (nearer) unit.peak = std::max(unit.peak, rate);
    if (unit.peak >= loading_ && rate >= following_ * unit.peak) {
      unit.slips = false;
    } else if (unit.slips) {
      if (force.tangential < release_ * unit.ratio * force.normal) unit = {};
    } else if (unit.peak >= loading_) {
      if (force.tangential >= least_ * force.normal) {
        unit.slips = true;
        unit.ratio = force.tangential / force.normal;
      } else {
        unit = {};
      }
    }
  }

  ChannelPlace force_;
  Window window_;
  double loading_;  // N/s
  double following_, release_, least_, touch_;
  std::vector<double> loads_;  // [units][f_t N, f_t/f_n]; the ratio is NaN without touch
  std::vector<Unit> units_;
  SlipEstimate estimate_;
};

}  // namespace

DetectorKind shear_rate_detector() {
  return {
      {.name = "shear_rate",
       .summary = "Shear rate: a unit slips when its shear force no longer grows as it did; no training.",
       .law =
           "r = change of f_t over window / window, of the units with f_n >= touch\n"
           "p: largest r since the unit's loading began, while f_t/f_n grew too; a unit counts as loaded once p >= loading / window\n"
           "slip: a loaded unit slips once r < following p. With f_t < least_friction f_n it does not slip: its loading has ended, p = 0.\n"
           "stick: a slipping unit sticks again when r >= following p, or when f_t/f_n < release times its value when the slip was found; the latter ends its loading, p = 0\n"
           "non-slip: no unit slips; incipient: some slip; gross: all slip; stuck fraction: share of the touching units that do not slip\n"
           "On a surface at constant speed a slip is reported (1 - following) window after its onset. A load that stops growing is classified as slip until a firmer grip lowers f_t/f_n.",
       .source =
           "A sticking unit is a spring, df_t/dt = k_t v; a slipping one carries f_t = mu_k f_n <= mu_s f_n: its shear stays or drops. Coulomb's law gives the release. The figures: assumed",
       .parameters =
           {window_spec(),
            number_spec("loading", Quantity::force, "20 mN", positive,
                        "Increase of f_t over one window above which a unit counts as loaded; several times the noise of 2 mN.",
                        "assumed"),
            number_spec("following", Quantity::none, "0.5", positive_up_to(1.0),
                        "Share of the largest shear rate below which a unit slips.", "assumed"),
            number_spec("release", Quantity::none, "0.9", positive_up_to(1.0),
                        "A slipping unit sticks again when f_t/f_n falls below this share of its value when the slip was found.",
                        "assumed"),
            least_friction_spec(), touch_spec()}},
      created<ShearRate>,
      nullptr,
      FrameSpacing::evened};
}

}  // namespace slipbench
