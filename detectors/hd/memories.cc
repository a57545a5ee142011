#include "detectors/hd/memories.h"

#include <bit>
#include <cassert>
#include <stdexcept>
#include <utility>

#include "sim/core/counted.h"
#include "sim/core/error.h"
#include "sim/core/random.h"

namespace slipbench::hd {
namespace {

// Returns the value of a hexadecimal digit, or -1.
int digit_value(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::size_t class_of(PadState state) {
  if (state == PadState::no_contact) throw std::out_of_range("hd training: no_contact is not a class");
  return static_cast<std::size_t>(state) - 1;
}

// Returns a random vector with floor(D/2) ones.
Hypervector balanced(std::size_t dimension, RandomStream random) {
  Hypervector vector(dimension);
  const std::vector<std::size_t> order = shuffled(dimension, random);
  for (std::size_t i = 0; i < dimension / 2; ++i) vector.set(order[i], true);
  return vector;
}

// Returns `rows` vectors that change evenly between two orthogonal ends.
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
    throw InputError(std::string(name) + ": " + counted(memory.size(), "vector") + ", but the model has " + std::to_string(rows));
  }
  for (const Hypervector& vector : memory) {
    if (vector.dimension() != dimension) {
      throw InputError(std::string(name) + ": a vector of " + counted(vector.dimension(), "bit") + ", but the model has " +
                       std::to_string(dimension));
    }
  }
}

}  // namespace

Hypervector bind(const Hypervector& a, const Hypervector& b) {
  assert(a.dimension() == b.dimension());
  Hypervector bound(a.dimension());
  for (std::size_t i = 0; i < bound.words().size(); ++i) bound.words()[i] = ~(a.words()[i] ^ b.words()[i]);
  if (const std::size_t used = a.dimension() % 64; used != 0) bound.words().back() &= (std::uint64_t{1} << used) - 1;
  return bound;
}

Hypervector rotate(const Hypervector& a) {
  Hypervector rotated(a.dimension());
  for (std::size_t i = 0; i + 1 < a.dimension(); ++i) rotated.set(i, a.bit(i + 1));
  rotated.set(a.dimension() - 1, a.bit(0));
  return rotated;
}

std::size_t hamming(const Hypervector& a, const Hypervector& b) {
  assert(a.dimension() == b.dimension());
  std::size_t distance = 0;
  for (std::size_t i = 0; i < a.words().size(); ++i) {
    distance += static_cast<std::size_t>(std::popcount(a.words()[i] ^ b.words()[i]));
  }
  return distance;
}

std::string to_hex(const Hypervector& a) {
  std::string text;
  for (std::size_t digit = (a.dimension() + 3) / 4; digit-- > 0;) {
    text += "0123456789abcdef"[a.words()[digit / 16] >> (digit % 16 * 4) & 15];
  }
  return text;
}

Hypervector from_hex(std::string_view text, std::size_t dimension) {
  const std::size_t digits = (dimension + 3) / 4;
  if (text.size() != digits) {
    throw InputError(counted(text.size(), "digit") + ", but " + counted(dimension, "bit") + " need " + std::to_string(digits));
  }
  Hypervector vector(dimension);
  for (std::size_t column = 0; column < digits; ++column) {
    const int value = digit_value(text[column]);
    if (value < 0) {
      throw InputError(quote(text.substr(column, 1)) + " in column " + std::to_string(column + 1) +
                       " is not a hexadecimal digit");
    }
    const std::size_t digit = digits - 1 - column;
    if (column == 0 && dimension % 4 != 0 && value >> (dimension % 4) != 0) {
      throw InputError("the first digit has bits beyond the " + std::to_string(dimension) +
                       " of a vector: " + quote(text.substr(0, 1)));
    }
    vector.words()[digit / 16] |= static_cast<std::uint64_t>(value) << (digit % 16 * 4);
  }
  return vector;
}

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

Prototypes::Prototypes(const Model& model, const Memories& memories) : model_(model), context_(memories.context) {
  check(model, memories, false);
  for (std::vector<std::int64_t>& sums : sums_) sums.resize(model.dimension);
}

void Prototypes::add(const Hypervector& query, std::uint8_t context, PadState state, std::int64_t times) {
  std::vector<std::int64_t>& sums = sums_[class_of(state)];
  const Hypervector encoded = model_.context_driven ? bind(query, context_.at(context)) : query;
  assert(encoded.dimension() == model_.dimension);
  std::uint64_t word = 0;
  for (std::size_t i = 0; i < model_.dimension; ++i, word >>= 1) {
    if (i % 64 == 0) word = encoded.words()[i / 64];
    sums[i] += (word & 1) != 0 ? times : -times;
  }
}

std::vector<Hypervector> Prototypes::bundle() const {
  std::vector<Hypervector> memory;
  for (const std::vector<std::int64_t>& sums : sums_) {
    Hypervector& prototype = memory.emplace_back(model_.dimension);
    const std::int64_t above = model_.ties == Ties::one ? -1 : 0;
    for (std::size_t i = 0; i < sums.size(); ++i) prototype.words()[i / 64] |= std::uint64_t{sums[i] > above} << (i % 64);
  }
  return memory;
}

}  // namespace slipbench::hd
