// The bench itself: a scene's pads, surface and motion, stepped in time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sim/core/contact_frame.h"
#include "sim/core/pad_layout.h"
#include "sim/core/pose.h"
#include "sim/scene/scene.h"

namespace slipbench {

// A body whose pose is recorded under truth/<name>.
struct NamedBody {
  std::string name;
  BodyState state;
};

// Runs one trial of a scene. Every pad follows the scene's motion against the scene's surface; no dynamics are solved, since nothing
// is free to move.
class Testbench {
 public:
  // `pads`: one layout a sensor of the scene, in the scene's order. `output_rates` [Hz]: the sensors' rates, in the same order.
  // `trial` keys the effects' random streams. Throws InputError when a sensor's rate does not divide the step rate, when the
  // scene's fidelity is not available, or when the step is too long for an effect.
  Testbench(const Scene& scene, std::span<const PadLayout* const> pads, std::span<const double> output_rates,
            std::uint64_t trial);
  ~Testbench();
  Testbench(Testbench&&) noexcept;
  Testbench& operator=(Testbench&&) noexcept;

  [[nodiscard]] std::size_t ticks() const;                  // duration / time_step
  [[nodiscard]] double time_step() const;                   // s
  [[nodiscard]] std::size_t stride(std::size_t pad) const;  // ticks between samples of this pad's sensor

  // Advances to the next tick. The first call evaluates t = 0; call k (from 0) evaluates t = k * time_step.
  void step();

  // Truth at the tick last stepped to.
  [[nodiscard]] const ContactFrame& contact(std::size_t pad) const;
  // All bodies at that tick: "pad" (one: all sensors ride on the same stage) and "surface".
  [[nodiscard]] const std::vector<NamedBody>& bodies() const;
  // Whether the scene's motion turns the pad.
  [[nodiscard]] bool rotating() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// The catalogues of everything in sim/ that a scene may name (materials, surfaces, motions, effects). Sensors and electronics are
// added by whoever composes the program.
struct Catalogues;
void add_sim_catalogues(Catalogues& catalogues);

}  // namespace slipbench
