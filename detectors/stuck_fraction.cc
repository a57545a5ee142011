#include "detectors/detector_kinds.h"

#include <algorithm>

#include "detectors/channel.h"
#include "sim/core/math.h"

namespace slipbench {
namespace {

class StuckFraction final : public Detector {
 public:
  StuckFraction(const Parameters& parameters, const FrameSource& source)
      : force_(vector_channel(source, "force", "N", "stuck_fraction")),
        displacement_(vector_channel(source, "displacement", "m", "stuck_fraction")),
        window_(parameters.number("window"), 2 * displacement_.units, source, "stuck_fraction"),
        moving_(parameters.number("moving_speed")),
        share_(parameters.number("stuck_share")),
        near_(parameters.number("friction_share")),
        least_(parameters.number("least_friction")),
        touch_(parameters.number("touch")),
        tips_(2 * displacement_.units),
        forces_(force_.units),
        speeds_(force_.units) {}

  const SlipEstimate& update(const SensorFrame& frame) override {
    const double fastest = measure(frame);
    // While something moves, units much slower than the fastest one count as slipping: the object
    // left them behind. At rest, units loaded like those that slipped last do.
    const bool moves = fastest >= moving_;
    UnitCounts counts;
    UnitForce sliding{0.0, 0.0};  // sum
    for (std::size_t i = 0; i < forces_.size(); ++i) {
      const UnitForce& force = forces_[i];
      if (!(force.normal >= touch_)) continue;
      ++counts.touching;
      if (force.tangential < least_ * force.normal) continue;
      if (!(moves ? speeds_[i] < share_ * fastest : force.tangential >= near_ * friction_ * force.normal)) continue;
      ++counts.slipping;
      sliding.normal += force.normal;
      sliding.tangential += force.tangential;
    }
    if (moves && counts.slipping > 0) friction_ = sliding.tangential / sliding.normal;
    return estimate_ = estimate_of(counts, frame.time);
  }

 private:
  // Reads forces and tips. Returns the speed of the fastest touching tip [m/s], 0 without contact.
  double measure(const SensorFrame& frame) {
    for (std::size_t i = 0; i < forces_.size(); ++i) {
      forces_[i] = force_at(frame, force_, i);
      const auto tip = vector_at(frame, displacement_, i);
      tips_[2 * i] = tip[0];
      tips_[2 * i + 1] = tip[1];
    }
    const std::span<const double> velocity = window_.rates(tips_);
    double fastest = 0.0;
    for (std::size_t i = 0; i < forces_.size(); ++i) {
      speeds_[i] = math::hypot(velocity[2 * i], velocity[2 * i + 1]);
      if (forces_[i].normal >= touch_) fastest = std::max(fastest, speeds_[i]);
    }
    return fastest;
  }

  ChannelPlace force_, displacement_;
  Window window_;
  double moving_, share_, near_, least_, touch_;
  std::vector<double> tips_;                                   // [units][x, y] m
  std::vector<UnitForce> forces_;                              // [units] N
  std::vector<double> speeds_;                                 // [units] m/s
  double friction_ = std::numeric_limits<double>::infinity();  // of the units that slid last; infinite: none has slid
  SlipEstimate estimate_;
};

}  // namespace

DetectorKind stuck_fraction_detector() {
  return {
      {.name = "stuck_fraction",
       .summary = "Share of the touching pillars that stick, from the speeds of their tips; no training.",
       .law =
           "v_i = |change of the tangential displacement over window| / window, of the pillars with f_n >= touch; V = max v_i\n"
           "V >= moving_speed: a pillar slips when v_i < stuck_share V; mu = sum f_t / sum f_n over the slipping pillars\n"
           "V < moving_speed: a pillar slips when f_t >= friction_share mu f_n; before a pillar has slipped, mu is unknown and all pillars stick\n"
           "f_t < least_friction f_n: a pillar sticks in any case\n"
           "non-slip: no pillar slips; incipient: some slip; gross: all slip; stuck fraction: share of the touching pillars that do not slip\n"
           "On a surface at constant speed v a slip is reported (1 - stuck_share) window after its onset, the slip of the last pillar (1 - moving_speed/v) window after.\n"
           "Limits: a pad that stops in a slide and stays loaded is classified as sliding. A pad whose pillars all slip at once is classified as at rest.",
       .source =
           "A sticking tip moves with the surface: its displacement changes at the surface's speed over the pad. A sliding tip keeps the displacement at which friction gave way, f_t = mu_k f_n. Friction measured on slipping pillars: HD-computing slip paper, section III. The figures: assumed",
       .parameters =
           {window_spec(),
            number_spec(
                "moving_speed", Quantity::speed, "0.5 mm/s", positive,
                "Speed of the fastest tip below which the speeds are not used; several times the noise of 1 um over 20 ms.",
                "assumed"),
            number_spec("stuck_share", Quantity::none, "0.5", positive_up_to(1.0),
                        "Share of the fastest tip's speed above which a pillar sticks.", "assumed"),
            number_spec("friction_share", Quantity::none, "0.9", positive_up_to(1.0),
                        "Share of the last measured friction above which a pillar slips while no tip moves.", "assumed"),
            least_friction_spec(), touch_spec()}},
      created<StuckFraction>,
      nullptr,
      FrameSpacing::evened};
}

}  // namespace slipbench
