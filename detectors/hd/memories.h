// The four memories of a classifier: three made by chance, one by training.
#pragma once

#include <cstdint>
#include <vector>

#include "detectors/hd/hypervector.h"
#include "detectors/hd/model.h"

namespace slipbench::hd {

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

}  // namespace slipbench::hd
