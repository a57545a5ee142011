// `fidelity: articulated` and `mujoco_contact`: a scene of prescribed motion with MuJoCo's own bodies, joints and contacts for
// the elements.
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "sim/core/contact_frame.h"
#include "sim/core/pad_layout.h"
#include "sim/scene/scene.h"
#include "sim/simulation/simulation.h"

namespace slipbench {

// The same scene, the same truth and bodies as StageSimulation's, from an ArticulatedStage a pad.
class ArticulatedSimulation final : public Simulation {
 public:
  // As StageSimulation's. Throws SceneValueError as that does, and for what articulated pads cannot have: effects, and a kinetic friction
  // that is not the static one.
  ArticulatedSimulation(const Scene& scene, std::span<const PadLayout* const> pads, std::span<const double> output_rates,
                        std::uint64_t trial);
  ~ArticulatedSimulation() override;

  [[nodiscard]] std::size_t ticks(std::size_t pad) const override;
  [[nodiscard]] double time_step(std::size_t pad) const override;
  [[nodiscard]] std::size_t stride(std::size_t pad) const override;
  void step() override;
  [[nodiscard]] std::span<const std::size_t> stepped() const override;
  [[nodiscard]] const ContactFrame& contact(std::size_t pad) const override;
  // "pad" and "surface".
  [[nodiscard]] const std::vector<NamedBody>& bodies() const override;
  [[nodiscard]] bool rotating() const override;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace slipbench
