// A classifier at work. Three engines compute the same to the last bit: the reference reads like the equations, the kernel is fast, and the
// core in rtl/ is hardware.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "detectors/hd/features.h"
#include "detectors/hd/memories.h"
#include "detectors/hd/model.h"
#include "sim/core/pad_state.h"

namespace slipbench::hd {

// The class nearest to the last N frames; the higher class where two are equally near.
struct Decision {
  PadState state = PadState::no_contact;              // no_contact until N frames have been seen; distances are 0 until then
  std::array<std::uint16_t, class_count> distance{};  // Hamming distances of non-slip, incipient, gross

  bool operator==(const Decision&) const = default;
};

// Throws std::out_of_range for a level or context that does not exist: what memories hold nothing of.
void check(const Frame& frame);

class Engine {
 public:
  virtual ~Engine() = default;

  // Takes the next frame. Throws std::out_of_range for a level or context that does not exist.
  virtual Decision update(const Frame& frame) = 0;

  // Forgets the frames seen.
  virtual void reset() = 0;
};

// Frames to query vectors (eq. 1-4): all of a classifier but its prototypes. Training needs no more.
class Encoder {
 public:
  virtual ~Encoder() = default;

  // Takes the next frame and gives GST of the last N, or nullptr until N have been seen. Valid until the next call. Throws as
  // Engine::update() does.
  virtual const Hypervector* encode(const Frame& frame) = 0;

  // Forgets the frames seen.
  virtual void reset() = 0;
};

// Instruction sets that the kernel is compiled for.
enum class KernelPath : std::uint8_t { portable, avx2, avx512 };

// Those that this machine can run, slowest first.
std::vector<KernelPath> kernel_paths();

// Eq. 1-5 on plain vectors of numbers, frame by frame over the whole window. Throws InputError when the memories do not fit the model.
std::unique_ptr<Engine> make_reference(const Model& model, const Memories& memories);
std::unique_ptr<Encoder> make_reference_encoder(const Model& model, const Memories& memories);

// The same, fast (kernel.cc says how). `path` is the fastest of the machine unless it is given. Throws InputError as above, and
// for a path that the machine cannot run.
std::unique_ptr<Engine> make_kernel(const Model& model, const Memories& memories);
std::unique_ptr<Engine> make_kernel(const Model& model, const Memories& memories, KernelPath path);
std::unique_ptr<Encoder> make_kernel_encoder(const Model& model, const Memories& memories);
std::unique_ptr<Encoder> make_kernel_encoder(const Model& model, const Memories& memories, KernelPath path);

}  // namespace slipbench::hd
