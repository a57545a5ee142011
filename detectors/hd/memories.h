// Binary hypervectors. A bit stands for one entry of a bipolar vector: 1 is +1, 0 is -1.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "detectors/hd/model.h"
#include "sim/core/pad_state.h"

namespace slipbench::hd {

// D bits, packed: bit i is bit i % 64 of word i / 64; the bits of the last word beyond D are 0.
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

// Binding, the product of bipolar vectors: XNOR. Its own inverse. Both of one dimension.
Hypervector bind(const Hypervector& a, const Hypervector& b);

// Permutation rho: bit i of the result is bit i + 1 of `a`, and the last is bit 0: a rotation to the right as hex is written.
Hypervector rotate(const Hypervector& a);

// Bits that differ. Both of one dimension.
std::size_t hamming(const Hypervector& a, const Hypervector& b);

// Hexadecimal, ceil(D / 4) digits, the most significant first: the first digit holds bits D-1, D-2, ... This is what $readmemh reads.
std::string to_hex(const Hypervector& a);
// The reverse. Throws InputError: what is wrong with the text (length, a character, a bit beyond D), without file and line.
Hypervector from_hex(std::string_view text, std::size_t dimension);

// The four memories of a classifier: three made by chance, one by training.
struct Memories {
  std::vector<Hypervector> item;         // IM: pillars 0 to 8, then the graphs of corners, edges and centre
  std::vector<Hypervector> level;        // CIM: of the feature, 0 to 20
  std::vector<Hypervector> context;      // CM: of the compression, 0 to 3
  std::vector<Hypervector> associative;  // AM: prototypes of non-slip, incipient, gross; empty before training

  bool operator==(const Memories&) const = default;
};

// IM, CIM and CM as the paper has them (section III.B.1), from random streams of their own keyed by `seed`:
// - IM: random vectors with floor(D/2) ones each,
// - CIM, CM: two orthogonal ends and a straight way between them. Row 0 is random with floor(D/2) ones; row l differs from it in the
//   first floor(l floor(D/2) / (rows - 1)) bits of an order drawn once. For D = 1000: 25 bits a level, and contexts at 0, 166, 333 and 500
//   bits (the published ones lie at 0, 166, 332 and 498).
// Throws InputError when the model's dimension or window are out of range.
Memories generate(const Model& model, std::uint64_t seed);

// Throws InputError unless `memories` have the rows and the dimension of `model`. `trained`: the associative memory must be there.
void check(const Model& model, const Memories& memories, bool trained);

// Training: prototypes are majorities of the query vectors of their class.

// Sums of the bipolar vectors EC = GST * CV of each class: P_k = [sum EC] (paper, section III.B.3).
class Prototypes {
 public:
  // Only `model` and the context memory are looked at, and only now. Throws InputError when they do not fit together.
  Prototypes(const Model& model, const Memories& memories);

  // Adds the query vector of a frame `times` times, or takes it away where that is negative. `state`: any class but no_contact. Without
  // context-driven training CV is left out. Throws std::out_of_range for no_contact or a context that does not exist.
  void add(const Hypervector& query, std::uint8_t context, PadState state, std::int64_t times = 1);

  // The associative memory: a bit is that of most vectors of its class, ties by the model's rule (an unseen class is all ties).
  [[nodiscard]] std::vector<Hypervector> bundle() const;

 private:
  Model model_;
  std::vector<Hypervector> context_;
  std::array<std::vector<std::int64_t>, class_count> sums_;  // of each bit
};

}  // namespace slipbench::hd
