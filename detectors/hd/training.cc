#include "detectors/hd/training.h"

#include <cassert>
#include <stdexcept>

namespace slipbench::hd {
namespace {

std::size_t class_of(PadState state) {
  if (state == PadState::no_contact) throw std::out_of_range("hd training: no_contact is no class");
  return static_cast<std::size_t>(state) - 1;
}

}  // namespace

Prototypes::Prototypes(const Model& model, const Memories& memories) : model_(model), context_(memories.context) {
  check(model, memories, false);
  for (std::vector<std::uint32_t>& ones : ones_) ones.resize(model.dimension);
}

void Prototypes::add(const Hypervector& query, std::uint8_t context, PadState state) {
  const std::size_t k = class_of(state);
  const Hypervector encoded = model_.context_driven ? bind(query, context_.at(context)) : query;
  assert(encoded.dimension() == model_.dimension);
  for (std::size_t i = 0; i < model_.dimension; ++i) ones_[k][i] += encoded.bit(i) ? 1U : 0U;
  ++samples_[k];
}

void Prototypes::add(const Prototypes& other) {
  assert(model_ == other.model_);
  for (std::size_t k = 0; k < class_count; ++k) {
    samples_[k] += other.samples_[k];
    for (std::size_t i = 0; i < model_.dimension; ++i) ones_[k][i] += other.ones_[k][i];
  }
}

std::size_t Prototypes::samples(PadState state) const { return samples_[class_of(state)]; }

std::vector<Hypervector> Prototypes::bundle() const {
  std::vector<Hypervector> memory;
  for (std::size_t k = 0; k < class_count; ++k) {
    Hypervector prototype(model_.dimension);
    for (std::size_t i = 0; i < model_.dimension; ++i) {
      const std::size_t twice = std::size_t{2} * ones_[k][i];
      prototype.set(i, twice > samples_[k] || (twice == samples_[k] && model_.ties == Ties::one));
    }
    memory.push_back(std::move(prototype));
  }
  return memory;
}

}  // namespace slipbench::hd
