// Keys of a sensor's electronics (the scale of its noise, of its gains, ...), by how much they disturb.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "tools/program/calibrate/disturbances.h"
#include "tools/program/calibrate/model.h"
#include "tools/program/calibrate/search.h"

namespace slipbench::calibrate {

// Whether a key is fitted here: curves without noise do not show it.
bool of_electronics(const FitKey& key);

// How much recordings are disturbed, by component one after the other: scatter of the gains, of the offsets, what remains of the curves, and the
// roughness; natural logarithms of RMS values. Minus infinity: none.
Eigen::VectorXd disturbance_sizes(const Columns& columns, const Waves& read, const Distance& distance,
                                  const Eigen::VectorXd& rough);

struct ElectronicsFit {
  Eigen::VectorXd places;
  std::vector<Known> known;  // without profiles
};

// The places at which simulated devices are disturbed as much as the real one: least squares of `sizes`, weighted by how much these differ from
// one device to the next. `model`: of such keys alone, on the fitted scene. `problem`: whose recordings, edges and disturbances count.
ElectronicsFit fit_electronics(const Model& model, const CurveProblem& problem, const Eigen::VectorXd& sizes);

}  // namespace slipbench::calibrate
