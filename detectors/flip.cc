#include "detectors/flip.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "sim/core/random.h"

namespace slipbench {
namespace {

// A class in contact and its stuck fraction.
struct ContactClass {
  PadState state;
  double stuck_fraction;
};
constexpr std::array<ContactClass, 3> classes{{{PadState::non_slip, 1.0}, {PadState::incipient, 0.5}, {PadState::gross, 0.0}}};

class Flipped final : public Detector {
 public:
  Flipped(std::unique_ptr<Detector> detector, double probability, const FrameSource& source)
      : detector_(std::move(detector)), probability_(probability), stream_(source.seed, source.trial, "detector.flip") {
    reported_.time = std::numeric_limits<double>::quiet_NaN();  // no estimate yet
  }

  const SlipEstimate& update(const SensorFrame& frame) override {
    const SlipEstimate& right = detector_->update(frame);
    if (right.state == PadState::no_contact) return right;
    if (right.time != reported_.time) {
      reported_ = right;
      const double draw = stream_.uniform();
      if (draw < probability_) replace(draw < 0.5 * probability_ ? 1 : 2);
    }
    return reported_;
  }

  [[nodiscard]] const std::vector<Feature>& features() const override { return detector_->features(); }
  [[nodiscard]] SampleListener* listener() override { return detector_->listener(); }
  [[nodiscard]] std::string notice() const override { return detector_->notice(); }
  void finish() override { detector_->finish(); }

 private:
  // Replaces the class by the one `further` places after it, cyclically.
  void replace(std::size_t further) {
    std::size_t place = 0;
    while (classes[place].state != reported_.state) ++place;
    const ContactClass& other = classes[(place + further) % classes.size()];
    reported_.state = other.state;
    if (!std::isnan(reported_.stuck_fraction)) reported_.stuck_fraction = other.stuck_fraction;
  }

  std::unique_ptr<Detector> detector_;
  double probability_;
  RandomStream stream_;
  SlipEstimate reported_;
};

}  // namespace

ParameterSpec flip_spec() {
  return number_spec("flip", Quantity::none, "0", fraction,
                     "Probability with which a new class in contact is replaced by one of the other two; 0: never.",
                     "set for each scene, to test a loop with a detector that errs with this probability");
}

std::unique_ptr<Detector> with_flips(std::unique_ptr<Detector> detector, double probability, const FrameSource& source) {
  if (probability == 0.0) return detector;
  return std::make_unique<Flipped>(std::move(detector), probability, source);
}

}  // namespace slipbench
