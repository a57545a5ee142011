#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "sensors/electronics/part_kind.h"
#include "sim/core/math.h"

namespace slipbench {
namespace {

// White noise through two equal poles at w: the stationary process with autocorrelation
// exp(-w|tau|)*(1 + w|tau|). With the state (x, u = x'/w), both of variance 1 and uncorrelated at
// any one instant, a step of a = w*h is
//   [x; u] <- F [x; u] + G [z1; z2],   F = exp(-a) [1+a, a; -a, 1-a],   G G^T = I - F F^T (Cholesky).
// The step is exact: the statistics at the samples depend neither on the rate nor on the sample's
// number. With w = inf the noise is white.
class Noise final : public ElectronicsStage {
 public:
  Noise(const Parameters& parameters, const SignalModel& model, RandomStream stream)
      : memory_(2 * model.sources + 1), draws_(2 * model.sources), source_(model.source), stream_(stream) {
    for (const double sd : model.noise_sd) sd_.push_back(parameters.number("scale") * sd);

    const double w_h = 2.0 * std::numbers::pi * parameters.number("corner") / model.rate;
    const double decay = math::exp(-w_h);
    const double a = std::isinf(w_h) ? 0.0 : w_h;  // the state decays fully; avoids 0 times infinity
    xx_ = decay * (1.0 + a);
    xu_ = decay * a;
    uu_ = decay * (1.0 - a);
    const double variance_x = 1.0 - (xx_ * xx_ + xu_ * xu_);
    const double covariance = xu_ * (xx_ - uu_);
    const double variance_u = 1.0 - (xu_ * xu_ + uu_ * uu_);
    gx_ = std::sqrt(variance_x);
    gux_ = covariance / gx_;
    gu_ = std::sqrt(variance_u - gux_ * gux_);

    for (std::size_t v = 0; v < 2 * model.sources; ++v) memory_[v] = stream_.normal();
    pairs_drawn() = static_cast<double>(model.sources);
  }

  void apply(std::span<float> values, double /*time*/) override {
    for (std::size_t v = 0; v < sd_.size(); ++v) values[v] = static_cast<float>(values[v] + sd_[v] * memory_[2 * source_[v]]);
    stream_.seek(static_cast<std::uint64_t>(pairs_drawn()));
    stream_.normal(draws_);
    for (std::size_t s = 0; s < draws_.size(); s += 2) {
      double& x = memory_[s];
      double& u = memory_[s + 1];
      const double z1 = draws_[s], z2 = draws_[s + 1];
      const double x_next = xx_ * x + xu_ * u + gx_ * z1;
      u = -xu_ * x + uu_ * u + gux_ * z1 + gu_ * z2;
      x = x_next;
    }
    pairs_drawn() += 0.5 * static_cast<double>(draws_.size());
  }

  [[nodiscard]] std::span<double> memory() override { return memory_; }

 private:
  double& pairs_drawn() { return memory_.back(); }

  double xx_, xu_, uu_;              // F
  double gx_, gux_, gu_;             // G, lower triangle
  std::vector<double> memory_;       // x and u of each source, then the number of pairs drawn from the stream
  std::vector<double> draws_;        // of one call
  std::vector<std::size_t> source_;  // [V]
  std::vector<double> sd_;           // [V] in the value's unit
  RandomStream stream_;
};

}  // namespace

PartKind noise_part() {
  return {
      .entry = {.name = "noise",
                .summary = "Red noise: white noise through two equal poles.",
                .law = "y = x + scale*sd*n(t),  E[n(t) n(t+tau)] = exp(-w|tau|)*(1 + w|tau|),  w = 2 pi corner\n"
                       "power density of n (one-sided): 8/w / (1 + (f/corner)^2)^2 [1/Hz]\n"
                       "n: one process a source (values computed from one another share it), stationary from the first sample\n"
                       "and exact at every rate; sd: of the value's noise",
                .source = "spectrum of unloaded PapillArray pillars in public gripper recordings (Contactile_Data_Viz)",
                .parameters = {scale_parameter(),
                               // Far below 0.1 Hz rounding would swamp the covariance of a step.
                               number_spec("corner", Quantity::frequency, "16 Hz", {.min = 0.1, .infinite = true},
                                           "Frequency of the two equal poles; inf: white noise.",
                                           "fitted to the spectrum of 13 unloaded sections of PapillArray recordings")}},
      .drawn_per = DrawnPer::trial,
      .make = made<Noise>};
}

}  // namespace slipbench
