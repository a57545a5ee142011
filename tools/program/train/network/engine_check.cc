#include "tools/program/train/network/network.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "detectors/network/engine.h"
#include "sim/core/math.h"

namespace slipbench::train {
namespace {

double probability(std::span<const float> logits, std::size_t of) {
  double sum = 0.0;
  for (const float logit : logits) sum += math::exp(double{logit} - double{logits[of]});
  return 1.0 / sum;
}

}  // namespace

void check_engine(const std::string& path, std::span<const std::unique_ptr<Network>> members, const FrameSequence& sequence) {
  constexpr double allowed = 1e-5;
  const std::unique_ptr<network::Engine> engine = network::load_engine(path);
  const NetworkShape& shape = members.front()->shape();
  const std::size_t history = history_of(shape), classes = class_count(shape);
  std::vector<std::vector<float>> logits;
  for (const std::unique_ptr<Network>& member : members) logits.push_back(member->logits(sequence.features));
  engine->reset();
  for (std::size_t t = 0; t + history <= sequence.label.size(); ++t) {
    const std::span<const float> said =
        engine->run(std::span(sequence.features).subspan(t * shape.inputs, history * shape.inputs));
    for (std::size_t c = 0; c < classes; ++c) {
      double expected = double{logits[0][t * classes + c]};
      if (members.size() > 1) {
        expected = 0.0;
        for (const std::vector<float>& one : logits) expected += probability(std::span(one).subspan(t * classes, classes), c);
        expected /= static_cast<double>(members.size());
      }
      if (!(std::abs(double{said[c]} - expected) <= allowed * std::max(1.0, std::abs(expected)))) {
        throw std::logic_error(fmt::format("{}: frame {}, class {}: says {}, libtorch {}", path, t, c, said[c], expected));
      }
    }
  }
}

}  // namespace slipbench::train
