// Binary hypervectors. A bit stands for one entry of a bipolar vector: 1 is +1, 0 is -1.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "detectors/hd/model.h"
#include "sim/api/pad_state.h"

namespace slipbench::hd {

// D bits, packed: bit i is bit i % 64 of word i / 64; bits beyond D in the last word are 0.
class Hypervector {
 public:
  Hypervector() = default;
  explicit Hypervector(std::size_t dimension) : dimension_(dimension), words_((dimension + 63) / 64) {}

  [[nodiscard]] std::size_t dimension() const { return dimension_; }
  [[nodiscard]] const std::vector<std::uint64_t>& words() const { return words_; }
  std::vector<std::uint64_t>& words() { return words_; }

  [[nodiscard]] bool bit(std::size_t i) const { return (words_[i / 64] >> (i % 64) & 1) != 0; }
  void set(std::size_t i, bool value) {
    const std::uint64_t mask = std::uint64_t{1} << (i % 64);
    words_[i / 64] = value ? words_[i / 64] | mask : words_[i / 64] & ~mask;
  }

  bool operator==(const Hypervector&) const = default;

 private:
  std::size_t dimension_ = 0;
  std::vector<std::uint64_t> words_;
};

// Binding, the product of bipolar vectors: XNOR. It is its own inverse. Both vectors must have one
// dimension.
Hypervector bind(const Hypervector& a, const Hypervector& b);

// Permutation rho: bit i of the result is bit i + 1 of `a`, and the last bit is bit 0: a rotation
// to the right in hexadecimal notation.
Hypervector rotate(const Hypervector& a);

// Number of different bits. Both vectors must have one dimension.
std::size_t hamming(const Hypervector& a, const Hypervector& b);

// Returns ceil(D / 4) hexadecimal digits, the most significant first: the first digit holds bits
// D-1, D-2, ... $readmemh reads this format.
std::string to_hex(const Hypervector& a);
// Parses the digits of to_hex(). Throws InputError for a wrong length, a wrong character or a bit
// beyond D; the message has no file and line.
Hypervector from_hex(std::string_view text, std::size_t dimension);

// The four memories of a classifier: three random ones and a trained one.
struct Memories {
  std::vector<Hypervector> item;         // IM: pillars 0 to 8, then the graphs of corners, edges and centre
  std::vector<Hypervector> level;        // CIM: of the feature, 0 to 20
  std::vector<Hypervector> context;      // CM: of the compression, 0 to 3
  std::vector<Hypervector> associative;  // AM: prototypes of non-slip, incipient, gross; empty before training

  bool operator==(const Memories&) const = default;
};

// Generates IM, CIM and CM as in the paper (section III.B.1), from separate random streams keyed by
// `seed`:
// - IM: random vectors with floor(D/2) ones each,
// - CIM, CM: vectors between two orthogonal ends. Row 0 is random with floor(D/2) ones; row l
//   differs from it in the first floor(l floor(D/2) / (rows - 1)) bits of an order drawn once. For
//   D = 1000: 25 bits per level, and contexts at 0, 166, 333 and 500 bits (the published ones are
//   at 0, 166, 332 and 498).
// Throws InputError if the model's dimension or window is out of range.
Memories generate(const Model& model, std::uint64_t seed);

// Throws InputError unless `memories` have the rows and the dimension of `model`. `trained`:
// requires the associative memory.
void check(const Model& model, const Memories& memories, bool trained);

// Training: prototypes are majorities of the query vectors of their class.

// Sums of the bipolar vectors EC = GST * CV of each class: P_k = [sum EC] (paper, section III.B.3).
class Prototypes {
 public:
  // Reads only `model` and the context memory, and keeps copies. Throws InputError if they do not
  // fit together.
  Prototypes(const Model& model, const Memories& memories);

  // Adds the query vector of a frame `times` times, or subtracts it if negative. `state`: any class
  // but no_contact. Without context-driven training CV is left out. Throws std::out_of_range for
  // no_contact or an unknown context.
  void add(const Hypervector& query, std::uint8_t context, PadState state, std::int64_t times = 1);

  // Returns the associative memory: each bit is the majority of its class, ties by the model's rule
  // (an unseen class has only ties).
  [[nodiscard]] std::vector<Hypervector> bundle() const;

 private:
  Model model_;
  std::vector<Hypervector> context_;
  std::array<std::vector<std::int64_t>, class_count> sums_;  // of each bit
};

}  // namespace slipbench::hd
