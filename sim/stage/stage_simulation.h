// A stage simulation: a scene's pads, surface and motion, stepped in time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sim/api/contact_frame.h"
#include "sim/api/pad_layout.h"
#include "sim/api/simulation.h"
#include "sim/scene/scene.h"

namespace slipbench {

// Runs one trial of a scene. Every pad follows the scene's motion against the scene's surface; no
// dynamics are solved, since no body is free to move. Pads do not influence each other: with
// `time_step: auto` each takes the longest step that divides its own sampling time and that its own
// effects allow. The motors shake each pad by its own force with the same random numbers (the level
// and the phases of their lines are alike for all; the noise is drawn once per step).
class StageSimulation final : public Simulation {
 public:
  // `pads`: one layout per sensor of the scene, in the scene's order. `output_rates` [Hz]: the
  // sensors' rates, in the same order. `trial` keys the effects' random streams. Throws InputError
  // if a sensor's rate does not divide the step rate or the step is too long for an effect, and
  // std::logic_error for a scene that needs another simulation (articulated pads, bodies).
  StageSimulation(const Scene& scene, std::span<const PadLayout* const> pads, std::span<const double> output_rates,
                  std::uint64_t trial);
  ~StageSimulation() override;
  StageSimulation(StageSimulation&&) noexcept;
  StageSimulation& operator=(StageSimulation&&) noexcept;

  [[nodiscard]] std::size_t ticks(std::size_t pad) const override;
  [[nodiscard]] double time_step(std::size_t pad) const override;
  [[nodiscard]] std::size_t stride(std::size_t pad) const override;
  void step() override;
  [[nodiscard]] std::span<const std::size_t> stepped() const override;
  [[nodiscard]] const ContactFrame& contact(std::size_t pad) const override { return contact_part(pad, FramePart::all); }
  [[nodiscard]] const ContactFrame& contact_part(std::size_t pad, FramePart part) const override;
  void disable_slip_angle() override;
  // "pad" (one, since all sensors ride on the same stage) and "surface".
  [[nodiscard]] const std::vector<NamedBody>& bodies() const override;
  [[nodiscard]] bool rotating() const override;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace slipbench
