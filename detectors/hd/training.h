// Single-pass training: prototypes are majorities of the query vectors of their class.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "detectors/hd/memories.h"
#include "detectors/hd/model.h"
#include "sim/core/pad_state.h"

namespace slipbench::hd {

// Sums of the bipolar vectors EC = GST * CV of each class: P_k = [sum EC] (paper, section III.B.3).
class Prototypes {
 public:
  // Only `model` and the context memory are looked at, and only now. Throws InputError when they do not fit together.
  Prototypes(const Model& model, const Memories& memories);

  // Adds the query vector of a frame. `state`: the truth, any but no_contact. Without context-driven training CV is left out.
  // Throws std::out_of_range for no_contact or a context that does not exist.
  void add(const Hypervector& query, std::uint8_t context, PadState state);

  // Adds what another has gathered for the same model, so that trials can be trained apart.
  void add(const Prototypes& other);

  // Query vectors of a class so far.
  [[nodiscard]] std::size_t samples(PadState state) const;

  // The associative memory: a bit is that of most vectors of its class, ties by the model's rule (an unseen class is all ties).
  [[nodiscard]] std::vector<Hypervector> bundle() const;

 private:
  Model model_;
  std::vector<Hypervector> context_;
  std::array<std::size_t, class_count> samples_{};
  std::array<std::vector<std::uint32_t>, class_count> ones_;  // of each bit
};

}  // namespace slipbench::hd
