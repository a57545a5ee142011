#include "detectors/hd/memories.h"

#include <cstddef>
#include <numeric>
#include <string>
#include <utility>

#include "sim/core/error.h"
#include "sim/core/random.h"

namespace slipbench::hd {
namespace {

// The numbers 0 to count - 1 in a random order (Fisher-Yates).
std::vector<std::size_t> shuffled(std::size_t count, RandomStream random) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t i = count; i > 1; --i) std::swap(order[i - 1], order[random.integer(i)]);
  return order;
}

// A random vector with floor(D/2) ones.
Hypervector balanced(std::size_t dimension, RandomStream random) {
  Hypervector vector(dimension);
  const std::vector<std::size_t> order = shuffled(dimension, random);
  for (std::size_t i = 0; i < dimension / 2; ++i) vector.set(order[i], true);
  return vector;
}

// `rows` vectors on a straight way between two orthogonal ends.
std::vector<Hypervector> continuum(std::size_t dimension, std::size_t rows, std::uint64_t seed, const std::string& stream) {
  std::vector<Hypervector> vectors{balanced(dimension, RandomStream(seed, 0, stream))};
  const std::vector<std::size_t> order = shuffled(dimension, RandomStream(seed, 1, stream));
  std::size_t flipped = 0;
  for (std::size_t row = 1; row < rows; ++row) {
    Hypervector next = vectors.back();
    for (; flipped < row * (dimension / 2) / (rows - 1); ++flipped) next.set(order[flipped], !next.bit(order[flipped]));
    vectors.push_back(std::move(next));
  }
  return vectors;
}

void check_rows(const char* name, const std::vector<Hypervector>& memory, std::size_t rows, std::size_t dimension) {
  if (memory.size() != rows) {
    throw InputError(std::string(name) + ": " + std::to_string(memory.size()) + " vectors; the model has " +
                     std::to_string(rows));
  }
  for (const Hypervector& vector : memory) {
    if (vector.dimension() != dimension) {
      throw InputError(std::string(name) + ": a vector of " + std::to_string(vector.dimension()) + " bits; the model has " +
                       std::to_string(dimension));
    }
  }
}

}  // namespace

void check(const Model& model) {
  const auto check_range = [](const char* name, std::size_t value, std::size_t min, std::size_t max) {
    if (value >= min && value <= max) return;
    throw InputError(std::string(name) + ": " + std::to_string(value) + "; allowed: " + std::to_string(min) + " to " +
                     std::to_string(max));
  };
  check_range("dimension", model.dimension, 8, 65535);
  check_range("window", model.window, 1, 1000);
}

Memories generate(const Model& model, std::uint64_t seed) {
  check(model);
  Memories memories;
  for (std::size_t row = 0; row < item_count; ++row) {
    memories.item.push_back(balanced(model.dimension, RandomStream(seed, row, "hd item memory")));
  }
  memories.level = continuum(model.dimension, level_count, seed, "hd level memory");
  memories.context = continuum(model.dimension, context_count, seed, "hd context memory");
  return memories;
}

void check(const Model& model, const Memories& memories, bool trained) {
  check(model);
  check_rows("item memory", memories.item, item_count, model.dimension);
  check_rows("level memory", memories.level, level_count, model.dimension);
  check_rows("context memory", memories.context, context_count, model.dimension);
  if (trained) check_rows("associative memory", memories.associative, class_count, model.dimension);
}

}  // namespace slipbench::hd
