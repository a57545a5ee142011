#include <stdexcept>
#include <variant>

#include "tools/program/train/network/network.h"

namespace slipbench::train {

std::size_t parameter_count(const NetworkShape& shape) {
  std::size_t count = 0;
  Shape frame{shape.inputs};
  for (const Layer& layer : shape.layers) {
    for (const Parameter& parameter : parameters_of(layer, frame)) count += parameter.running ? 0 : extent_of(parameter.shape);
    frame = shape_after(layer, frame);
  }
  return count;
}

std::size_t class_count(const NetworkShape& shape) {
  Shape frame{shape.inputs};
  for (const Layer& layer : shape.layers) frame = shape_after(layer, frame);
  if (frame.size() != 1) throw std::invalid_argument("what the last layer gives is no list of classes");
  return frame[0];
}

std::size_t history_of(const NetworkShape& shape) {
  std::size_t frames = 1;
  for (const Layer& layer : shape.layers) {
    if (const auto* conv = std::get_if<Conv1d>(&layer)) frames += conv->kernel - 1;
  }
  for (const Layer& layer : shape.layers) {
    if (const auto* last = std::get_if<Last>(&layer)) frames = last->frames;
  }
  return frames;
}

bool carries_state(const NetworkShape& shape) {
  bool recurrent = false;
  for (const Layer& layer : shape.layers) {
    if (std::holds_alternative<Last>(layer)) return false;
    recurrent = recurrent || std::holds_alternative<Gru>(layer) || std::holds_alternative<Lstm>(layer) ||
                std::holds_alternative<ConvLstm>(layer);
  }
  return recurrent;
}

}  // namespace slipbench::train
