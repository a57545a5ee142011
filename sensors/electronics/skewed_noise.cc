#include <array>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "sensors/electronics/part_kind.h"
#include "sim/core/error.h"
#include "sim/core/math.h"
#include "sim/core/parameters.h"
#include "sim/core/quantity.h"

namespace slipbench {
namespace {

class SkewedNoise final : public ElectronicsStage {
 public:
  SkewedNoise(const Parameters& parameters, const SignalModel& model, RandomStream stream)
      : tail_share_(parameters.number("tail_share")),
        tail_(parameters.number("tail")),
        spike_share_(parameters.number("spike_share")),
        spike_min_(parameters.vector("spike")[0]),
        spike_max_(parameters.vector("spike")[1]),
        source_(model.source),
        draws_(model.sources),
        stream_(stream) {
    for (const double sd : model.noise_sd) sd_.push_back(parameters.number("scale") * sd);
  }

  void apply(std::span<float> values, double /*time*/) override {
    stream_.seek(static_cast<std::uint64_t>(memory_[0]));
    for (double& n : draws_) n = stream_.normal() + tail_share_ * tail_;
    const std::size_t pairs = (draws_.size() + 1) / 2;
    memory_[0] += static_cast<double>(pairs);
    stream_.seek(static_cast<std::uint64_t>(memory_[0]));
    for (double& n : draws_) {
      // One uniform number decides whether there is a tail or a spike and how deep it is: below the
      // share it is again uniformly distributed.
      const double tail = stream_.uniform(), spike = stream_.uniform();
      if (tail < tail_share_) n += tail_ * math::log1p(-tail / tail_share_);
      if (spike < spike_share_) n -= spike_min_ + (spike_max_ - spike_min_) * spike / spike_share_;
    }
    memory_[0] += static_cast<double>(draws_.size());
    for (std::size_t v = 0; v < sd_.size(); ++v) values[v] = static_cast<float>(values[v] + sd_[v] * draws_[source_[v]]);
  }

  [[nodiscard]] std::span<double> memory() override { return memory_; }

 private:
  double tail_share_, tail_, spike_share_, spike_min_, spike_max_;
  std::vector<std::size_t> source_;  // [V]
  std::vector<double> sd_;           // [V] in the value's unit
  std::vector<double> draws_;        // of each source, for the last sample
  std::array<double, 1> memory_{};   // number of pairs drawn from the stream
  RandomStream stream_;
};

void check_spike(const Parameters& parameters, const SignalModel& /*model*/, const std::string& path) {
  const std::vector<double>& spike = parameters.vector("spike");
  if (spike[0] <= spike[1]) return;
  throw SceneValueError(path + ".spike", "[" + format_number(spike[0]) + ", " + format_number(spike[1]) +
                                             "] has the largest depth first; expected [smallest, largest]");
}

}  // namespace

PartKind skewed_noise_part() {
  // Covers the whole range of a 12-bit converter with a noise of a few counts: 4095/3.1 is 1321.
  constexpr Range depth{0.0, 1000.0};
  const std::string fitted =
      "fitted to the readings of 44 BioTac SP recordings of a touch (yayaneath/BioTacSP-DoS), against 3.1 counts";
  return {.entry = {.name = "skewed_noise",
                    .summary = "Skewed noise: white noise with a tail and rare spikes towards lower readings.",
                    .law = "y = x + scale*sd*(z + p_t m - t - s)\n"
                           "z: standard normal; t: with probability p_t = tail_share exponential of mean m = tail, else 0;\n"
                           "s: with probability spike_share uniform in spike, else 0. The spikes alone shift the mean; sd is\n"
                           "that of the normal part. Drawn anew for each source and sample.",
                    .source = "the form is fitted to BioTac SP readings: skewness -2, and none above +18 counts",
                    .parameters = {scale_parameter(),
                                   number_spec("tail_share", Quantity::none, "0.1", fraction,
                                               "Share of the samples that are in the tail.", fitted),
                                   number_spec("tail", Quantity::none, "1.29", depth,
                                               "Mean depth of the tail, in sd of the normal part.", fitted + ": 4 counts"),
                                   number_spec("spike_share", Quantity::none, "0.0075", fraction,
                                               "Share of the samples that are in a spike.", fitted),
                                   vector_spec(2, "spike", Quantity::none, "[3.2, 11.6]", depth,
                                               "Smallest and largest depth of a spike, in sd of the normal part.",
                                               fitted + ": 10 to 36 counts")}},
          .drawn_per = DrawnPer::trial,
          .make = made<SkewedNoise>,
          .check = &check_spike};
}

}  // namespace slipbench
