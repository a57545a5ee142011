// Pads that are bodies, joints and contacts of MuJoCo (articulated.h).
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <mujoco/mujoco.h>
#include <Eigen/Core>

#include "sim/mujoco/articulated/articulated.h"
#include "sim/mujoco/modes/dynamic_pads.h"
#include "sim/mujoco/modes/dynamic_setup.h"
#include "sim/mujoco/mujoco_call.h"
#include "sim/stage/step_plan.h"

namespace slipbench {

struct ArticulatedPlan {
  ModelPointer model;
  StepPlan steps;
};

// Builds the model and plans its steps. The pads' joints and contacts are implicit: only the recipe
// limits the step. With a contact set by the user, who chooses its step, only the springs of a hand
// limit it, since the scene does not set these.
ArticulatedPlan plan_articulated(const DynamicSetup& setup);

// The truth of a tick is that at the end of the step to it.
class ArticulatedPads final : public DynamicPads {
 public:
  // `world` must have the step's data and outlive the object, and so must the layouts.
  ArticulatedPads(DynamicWorld& world, const DynamicSetup& setup);

  // Settles the tips that are inside the touched surface at the start.
  void begin() override;
  void take_tick(std::size_t tick, RunWatch& watch) override;
  [[nodiscard]] const ContactFrame& truth(std::size_t pad, FramePart part) const override;
  [[nodiscard]] double normal_force(std::size_t pad) const override;
  [[nodiscard]] std::vector<int> sites() const override;
  [[nodiscard]] WatchSettings watch_settings(const WatchLimits& limits) const override;
  [[nodiscard]] bool is_part(int body) const override;
  void find_force(Eigen::VectorXd& force) const override;

 private:
  struct Pad {
    std::unique_ptr<ArticulatedContact> pillars;
    int site;
    std::string sensor;  // its name
    const PadLayout* layout;
  };

  bool indent_tips(const mjModel* held, mjData* settled) const;
  void step(std::size_t from, RunWatch& watch);
  void refuse_other_contacts(double time) const;
  void refuse_overcompressed(double time) const;

  DynamicWorld& world_;
  bool own_contact_;  // set by the scene, with any other contacts and any step
  bool runge_kutta_;  // a step leaves the data at its end
  std::vector<Pad> pads_;
};

}  // namespace slipbench
