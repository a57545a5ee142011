// Two articulated pads hold a free box: the weight, the creep and the force at which it drops.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "sim/mujoco/articulated.h"
#include "sim/mujoco/mujoco_call.h"
#include "tests/oracle/pads.h"

namespace slipbench {
namespace {

constexpr double dt = 1e-3, g = 9.81, mass = 0.1;  // kg

// A free box between two pads on slides, pushed together by a force each; gravity grows to g once they hold it.
class Grip {
 public:
  Grip(double k_n, double k_t, double mu) {
    pad_ = oracle::nine_pillars(1, k_n, k_t);
    // A fiftieth of the heights (4 and 9 um): unequal loads, and yet all press. On the middle ones alone the box would swing.
    for (Element& element : pad_.elements) element.tip.z() *= 0.02;
    // Bare springs ring for seconds: dashpots that damp the box on its eighteen pillars at ratio 0.2.
    for (Element& element : pad_.elements) element.c_tangential = 0.4 * std::sqrt(mass * 18.0 * k_t) / 18.0;
    const SpecPointer spec(mj_makeSpec());
    const ArticulatedSettings settings;
    set_articulated_options(spec.get(), settings, dt);
    mju_zero3(spec->option.gravity);
    mjsBody* world = mjs_findBody(spec.get(), "world");
    mjsBody* box = mjs_addBody(world, nullptr);  // before the pads
    mjs_setName(box->element, "box");
    mjs_addFreeJoint(box);
    mjsGeom* geom = mjs_addGeom(box, nullptr);
    mjs_setName(geom->element, "box");
    geom->type = mjGEOM_BOX;
    std::fill(std::begin(geom->size), std::end(geom->size), half);
    geom->mass = mass;
    geom->contype = geom->conaffinity = 0;
    const std::string touched = "box";
    for (const int side : {-1, 1}) {
      mjsBody* finger = mjs_addBody(world, nullptr);
      finger->mass = 0.05;
      finger->explicitinertial = 1;
      std::fill(std::begin(finger->inertia), std::end(finger->inertia), 1e-4);
      finger->gravcomp = 1.0;
      finger->pos[0] = side * half;
      mjsJoint* slide = mjs_addJoint(finger, nullptr);
      mjs_setName(slide->element, name(side));
      slide->type = mjJNT_SLIDE;
      slide->axis[0] = 1.0;
      slide->axis[2] = 0.0;
      slide->damping[0] = 20.0;
      Pose pose;  // +Z of the pad points away from the box
      pose.rotation = turned(side);
      add_articulated_pad(spec.get(), finger, pose, pad_, {&touched, 1}, {mu, mu}, settings, dt, name(side));
    }
    model_.reset(mj_compile(spec.get(), nullptr));
    EXPECT_NE(model_, nullptr) << mjs_getError(spec.get());
    data_.reset(mj_makeData(model_.get()));
    contact_ = std::make_unique<ArticulatedContact>(model_.get(), name(1), pad_, settings);
    for (const int side : {-1, 1}) {
      dof_[side > 0 ? 1 : 0] = model_->jnt_dofadr[mj_name2id(model_.get(), mjOBJ_JOINT, name(side))];
    }
  }

  // Moves the box out of the middle by `y` [m] and turns it about the fingers' axis by `angle` [rad].
  void perturb(double y, double angle) {
    data_->qpos[1] = y;
    data_->qpos[3] = std::cos(angle / 2.0);
    data_->qpos[4] = std::sin(angle / 2.0);
  }

  // Runs until `end` [s] with the fingers pushed together by `force` [N] each: full after 0.2 s, gravity from 0.3 s to 0.8 s.
  void run(double force, double end) {
    for (; time_ < end - 0.5 * dt; time_ += dt) {
      const double push = force * std::min(1.0, time_ / 0.2);
      data_->qfrc_applied[dof_[0]] = push;
      data_->qfrc_applied[dof_[1]] = -push;
      model_->opt.gravity[2] = -g * std::clamp((time_ - 0.3) / 0.5, 0.0, 1.0);
      mj_step(model_.get(), data_.get());
      contact_->read(model_.get(), data_.get(), time_ + dt, dt);
    }
    for (const mjWarningStat& warning : data_->warning) EXPECT_EQ(warning.number, 0);
  }

  [[nodiscard]] double height() const { return data_->qpos[2]; }
  [[nodiscard]] const ContactFrame& frame() const { return contact_->frame(); }
  // What the box pulls the pad down with [N].
  [[nodiscard]] double share_of_weight() const { return -(turned(1) * frame().force.rowwise().sum().matrix()).z(); }

 private:
  static constexpr double half = 0.02;  // m
  static const char* name(int side) { return side < 0 ? "left" : "right"; }
  static Eigen::Matrix3d turned(int side) {
    return Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), Eigen::Vector3d(side, 0.0, 0.0)).toRotationMatrix();
  }

  PadLayout pad_;
  ModelPointer model_;
  DataPointer data_;
  std::unique_ptr<ArticulatedContact> contact_;
  std::array<int, 2> dof_{};
  double time_ = 0.0;
};

TEST(ArticulatedGrip, ABoxDropsJustUnderTheLeastForceAndHoldsJustOverIt) {
  // Two pads carry m g by 2 mu F at most, whatever the shares of the pillars: F = m g/(2 mu). Under it the box falls at g (1 -
  // F/F_least), 0.2 % of g for 0.2 %: 1.6 mm in 0.4 s, and faster still. Over it nothing moves once it hangs. Bar: 0.5 %.
  for (const double mu : {0.2, 0.5, 1.0}) {
    const double least = mass * g / (2.0 * mu);
    Grip under(3000.0, 500.0, mu), over(3000.0, 500.0, mu);
    for (Grip* grip : {&under, &over}) grip->run((grip == &under ? 0.998 : 1.002) * least, 1.2);
    const double under_before = under.height(), over_before = over.height();
    under.run(0.998 * least, 1.6);
    over.run(1.002 * least, 1.6);
    EXPECT_LT(under.height() - under_before, -0.5 * 0.002 * g * 0.4 * 0.4) << mu;
    EXPECT_EQ(under.frame().state, PadState::gross) << mu;
    EXPECT_GT(over.height() - over_before, -0.5e-6) << mu;
    EXPECT_NE(over.frame().state, PadState::gross) << mu;
  }
}

TEST(ArticulatedGrip, AHeldBoxDoesNotCreepAndItsWeightIsCarried) {
  // At 1.2 times the least force, in the middle and out of it: the pads carry half the weight each, and the box hangs still. Bar:
  // 0.5 um/s.
  for (const double k_t : {500.0, 3900.0}) {
    for (const double off : {0.0, 0.13e-3}) {
      Grip grip(k_t > 1000.0 ? 7100.0 : 3000.0, k_t, 0.5);
      grip.perturb(off, off > 0.0 ? 4e-3 : 0.0);
      grip.run(1.2 * mass * g, 2.0);
      const double before = grip.height();
      grip.run(1.2 * mass * g, 4.0);
      EXPECT_LT(std::abs(grip.height() - before) / 2.0, 0.05e-6) << k_t << ' ' << off;
      EXPECT_NEAR(grip.share_of_weight(), 0.5 * mass * g, 1e-4 * mass * g) << k_t << ' ' << off;
    }
  }
}

}  // namespace
}  // namespace slipbench
