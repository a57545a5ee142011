// Engines that run a classifier. Three give bit-identical results: the reference follows the
// equations, the kernel is fast, and the core in rtl/ is hardware.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "detectors/hd/features.h"
#include "detectors/hd/memories.h"
#include "detectors/hd/model.h"
#include "sim/api/pad_state.h"

namespace slipbench::hd {

// The class nearest to the last N frames; the higher class if two are equally near.
struct Decision {
  PadState state = PadState::no_contact;              // no_contact until N frames have been seen; distances are 0 until then
  std::array<std::uint16_t, class_count> distance{};  // Hamming distances of non-slip, incipient, gross

  bool operator==(const Decision&) const = default;
};

// Throws std::out_of_range for a level or context that the memories do not have.
void check(const Frame& frame);

class Engine {
 public:
  virtual ~Engine() = default;

  // Takes the next frame. Throws std::out_of_range for a level or context that does not exist.
  virtual Decision update(const Frame& frame) = 0;

  // Discards the frames seen.
  virtual void reset() = 0;
};

// Turns frames into query vectors (eq. 1-4): a classifier without its prototypes, as training needs
// it.
class Encoder {
 public:
  virtual ~Encoder() = default;

  // Takes the next frame. Returns GST of the last N frames, or nullptr until there are N. Valid
  // until the next call. Throws as Engine::update() does.
  virtual const Hypervector* encode(const Frame& frame) = 0;

  // Discards the frames seen.
  virtual void reset() = 0;
};

// Instruction sets that the kernel is compiled for.
enum class KernelPath : std::uint8_t { portable, avx2, avx512 };

// Returns the paths that this machine can run, slowest first.
std::vector<KernelPath> kernel_paths();

// Eq. 1-5 on plain vectors of numbers, frame by frame over the whole window. Throws InputError if
// the memories do not fit the model.
std::unique_ptr<Engine> make_reference(const Model& model, const Memories& memories);
std::unique_ptr<Encoder> make_reference_encoder(const Model& model, const Memories& memories);

// Fast implementations (see kernel.cc). `path` defaults to the machine's fastest. Throws InputError
// as above, and for a path that the machine cannot run.
std::unique_ptr<Engine> make_kernel(const Model& model, const Memories& memories);
std::unique_ptr<Engine> make_kernel(const Model& model, const Memories& memories, KernelPath path);
std::unique_ptr<Encoder> make_kernel_encoder(const Model& model, const Memories& memories);
std::unique_ptr<Encoder> make_kernel_encoder(const Model& model, const Memories& memories, KernelPath path);

}  // namespace slipbench::hd
