#include "tools/program/catalogue/oracle.h"

namespace slipbench {
namespace {

class Oracle final : public Detector {
 public:
  Oracle(double latency, const Simulation& simulation, std::size_t pad) : latency_(latency), simulation_(simulation), pad_(pad) {}

  const SlipEstimate& update(const SensorFrame& frame) override {
    const ContactFrame& truth = simulation_.contact(pad_);
    return estimate_ = {frame.time, latency_, truth.state, truth.stuck_fraction};
  }

 private:
  double latency_;
  const Simulation& simulation_;
  std::size_t pad_;
  SlipEstimate estimate_;
};

}  // namespace

Entry oracle_entry() {
  return {
      .name = std::string(oracle_type),
      .summary = "ORACLE, no detector: the true class of the pad, to tell a detector's faults from a controller's.",
      .law =
          "at each sample of the sensor: the true class by the rule strict (a pillar slips when all of it slips), and the true stuck fraction of the pad's elements",
      .source = "the simulation's own contact, which no detector sees",
      .parameters = {
          number_spec("latency", Quantity::time, "0 s", non_negative, "Time from the sample until the class is there.", "free")}};
}

std::unique_ptr<Detector> make_oracle(const Parameters& parameters, const Simulation& simulation, std::size_t pad) {
  return std::make_unique<Oracle>(parameters.number("latency"), simulation, pad);
}

}  // namespace slipbench
