// Slip from how unequally a gel's markers move under the object: two published rules.
#include <map>

#include <Eigen/Core>

#include "detectors/channel.h"
#include "detectors/detector_kinds.h"
#include "sim/core/math.h"

namespace slipbench {
namespace {

using Markers = Eigen::Ref<const Eigen::Array2Xd>;  // x and y of each
// Rules: the class from the positions [px] and motions [m] of the touching markers, at least one.

// Small-angle rotation; `turn` includes the conversion from pixels to metres.
SlipEstimate by_deviation(const Markers& places, const Markers& moves, const Parameters& parameters) {
  const Eigen::Array2Xd p = places.colwise() - places.rowwise().mean(), u = moves.colwise() - moves.rowwise().mean();
  const double spread = p.square().sum(), limit = parameters.number("deviation");
  const double turn = spread > 0.0 ? (p.row(0) * u.row(1) - p.row(1) * u.row(0)).sum() / spread : 0.0;
  const auto off = (u.row(0) + turn * p.row(1)).square() + (u.row(1) - turn * p.row(0)).square() >= limit * limit;
  return estimate_of({static_cast<std::size_t>(off.size()), static_cast<std::size_t>(off.count())}, 0.0);
}

SlipEstimate by_entropy(const Markers& /*places*/, const Markers& moves, const Parameters& parameters) {
  std::map<double, double> shares;  // of the bins
  for (const auto& move : moves.colwise())
    shares[std::floor(move.matrix().norm() / parameters.number("bin"))] += 1.0 / static_cast<double>(moves.cols());
  double entropy = 0.0;
  for (const auto& [bin, share] : shares) entropy -= share * math::log2(share);
  return {.state = entropy < parameters.number("entropy") ? PadState::non_slip : PadState::incipient};
}

// Uses the markers that are pressed in. A marker's motion is measured from the frame in which it
// began to touch.
template <SlipEstimate rule(const Markers& places, const Markers& moves, const Parameters& parameters)>
class MarkerDetector final : public Detector {
 public:
  MarkerDetector(const Parameters& parameters, const FrameSource& source)
      : parameters_(parameters),
        displacement_(vector_channel(source, "displacement", "m", "a detector of markers")),
        pixel_(vector_channel(source, "pixel", "px", "a detector of markers", 2)),
        touches_(displacement_.units, false),
        began_(2, displacement_.units),
        places_(began_),
        moves_(began_) {}

  const SlipEstimate& update(const SensorFrame& frame) override {
    const double touch = parameters_.number("touch");
    Eigen::Index count = 0;
    for (std::size_t i = 0; i < touches_.size(); ++i) {
      const auto u = vector_at(frame, displacement_, i);
      const Eigen::Array2d now(u[0], u[1]);
      auto began = began_.col(static_cast<Eigen::Index>(i));
      if (!touches_[i]) began = now;
      touches_[i] = double{u[2]} >= touch;
      if (!touches_[i]) continue;
      const float* const pixel = &frame.values[pixel_.first + 2 * i];
      places_.col(count) = Eigen::Array2d(pixel[0], -pixel[1]);
      moves_.col(count++) = now - began;
    }
    estimate_ = count > 0 ? rule(places_.leftCols(count), moves_.leftCols(count), parameters_) : SlipEstimate{};
    estimate_.time = frame.time;
    return estimate_;
  }

 private:
  Parameters parameters_;
  ChannelPlace displacement_, pixel_;
  std::vector<bool> touches_;
  Eigen::Array2Xd began_;           // m, of all markers
  Eigen::Array2Xd places_, moves_;  // of the touching ones
  SlipEstimate estimate_;
};

ParameterSpec indentation_spec() {
  return number_spec("touch", Quantity::length, "0.1 mm", positive, "Indentation above which a marker counts as touching.",
                     "assumed: several times the noise of a height map");
}

}  // namespace

DetectorKind marker_deviation_detector() {
  return {
      {.name = "marker_deviation",
       .summary = "Markers of a gel whose motion deviates from the rigid motion of the others slip; no training.",
       .law =
           "u_i: motion of a marker since it began to touch; least squares over those that touch: u_i = shift + turn z x p_i\n"
           "a marker slips when it deviates from that motion by `deviation` or more; non-slip: no marker slips; incipient: some do; gross: all do\n"
           "If all markers slide, one may stay near the mean motion, so some slides of the whole pad are classified as incipient.",
       .source =
           "S. Dong, D. Ma, E. Donlon, A. Rodriguez, Maintaining grasps within slipping bounds by monitoring incipient slip, ICRA 2019. The figures: assumed",
       .parameters = {number_spec("deviation", Quantity::length, "50 um", positive,
                                  "Deviation from the rigid motion above which a marker slips; several times the noise of 6 um.",
                                  "assumed"),
                      indentation_spec()}},
      created<MarkerDetector<by_deviation>>,
      nullptr,
      FrameSpacing::any};
}

DetectorKind marker_entropy_detector() {
  return {
      {.name = "marker_entropy",
       .summary = "Entropy of the distances that the markers of a gel have moved; no training.",
       .law =
           "H = -sum p_k log2 p_k, p_k: share of the touching markers whose motion since they began to touch lies in bin k\n"
           "incipient: H >= entropy; else non-slip. If all markers slide, their motions still differ, so it never reports gross slip.",
       .source =
           "W. Yuan, R. Li, M. A. Srinivasan, E. H. Adelson, Measurement of shear and slip with a GelSight tactile sensor, ICRA 2015. The figures: assumed",
       .parameters = {number_spec("bin", Quantity::length, "30 um", positive, "Width of a bin; several times the noise of 6 um.",
                                  "assumed"),
                      number_spec("entropy", Quantity::none, "2", positive, "Entropy in bits above which the pad slips.",
                                  "assumed"),
                      indentation_spec()}},
      created<MarkerDetector<by_entropy>>,
      nullptr,
      FrameSpacing::any};
}

}  // namespace slipbench
