// Effect::memory holds all state that effects carry between steps.
#include <gtest/gtest.h>

#include "tests/sim/contact/same_field.h"
#include "tests/sim/effects/effect_rig.h"

namespace slipbench::testing_effects::state_test {
namespace {

// Saves a field with these effects in the middle, loads it into a new field and into one with
// another past, and compares their further steps.
void expect_to_go_on_alike(const std::vector<Wanted>& effects, const std::string& name) {
  int slid = 0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    RandomStream draw(seed, 0, "effect state");
    PadLayout pad = testing_field::random_pad(draw, 40, seed % 2 == 1);
    if (const FieldEffects made = installed(pad, effects); made.tip || made.skin) {  // these exclude dashpots
      for (Element& element : pad.elements) element.c_normal = element.c_tangential = 0.0;
    }
    const Friction friction = testing_field::random_friction(draw);
    const testing_field::RandomMotion motion(draw, Pose{}), elsewhere(draw, Pose{});
    const auto step = [](Field& field, const testing_field::RandomMotion& path, int tick) {
      const Pose pose = path.at(tick * 1e-3), next = path.at(tick * 1e-3 + 1e-6);
      const Twist twist{(next.position - pose.position) / 1e-6, {0.0, 0.0, 0.0}};
      field.step(pose, 1e-3, tick % 3 == 0 ? nullptr : &twist);  // with a velocity and with the step's mean
    };
    Field lasting = field_with(pad, friction, effects), fresh = field_with(pad, friction, effects),
          used = field_with(pad, friction, effects);
    std::vector<double> state(lasting.state_size());
    lasting.save_state(state);
    EXPECT_EQ(state, std::vector<double>(state.size())) << name << ": zeros stand for a field that was never stepped";
    for (int tick = 0; tick < 120; ++tick) {
      step(lasting, motion, tick);
      step(used, elsewhere, tick);
    }
    lasting.save_state(state);
    fresh.load_state(state);
    used.load_state(state);
    for (int tick = 120; tick < 240; ++tick) {
      for (Field* field : {&lasting, &fresh, &used}) step(*field, motion, tick);
      ASSERT_TRUE(testing_field::same_bits(lasting, fresh)) << name << ", seed " << seed << ", tick " << tick;
      ASSERT_TRUE(testing_field::same_bits(lasting, used))
          << name << ", seed " << seed << ", tick " << tick << ", in the used field";
      for (std::size_t i = 0; i < lasting.size(); ++i) slid += lasting.state(i) == ElementState::slip ? 1 : 0;
    }
  }
  EXPECT_GT(slid, 100) << name;
}

TEST(EffectState, EveryEffectGoesOnFromASavedState) {
  // Tips with mass and elastic skins exclude cone, rate law, rheology and each other. So all effects
  // together need three sets.
  std::vector<Wanted> on_springs, with_mass{{"inertia", {}}}, in_one{{"elastic_skin", {{"patch", 1e-4}}}};
  for (const EffectKind& kind : effect_catalogue()) {
    expect_to_go_on_alike(alone(kind), kind.about.name);
    const FieldEffects effects = installed(one_unit(1000.0, 600.0), alone(kind));
    const Wanted wanted{kind.about.name, {}};
    if (effects.skin) continue;
    if (!effects.tip) on_springs.push_back(wanted);
    const bool maps = effects.cone || effects.rate || !effects.rheology.empty();
    if (!maps && kind.about.name != "inertia") with_mass.push_back(wanted);
    if (!maps && !effects.tip && !kind.after_tip) in_one.push_back(wanted);
  }
  expect_to_go_on_alike(on_springs, "all on springs");
  expect_to_go_on_alike(with_mass, "all of tips with mass");
  expect_to_go_on_alike(in_one, "all of elastic skins");
}

// Separated pads skip computations unless an effect has a memory. The results must not show it.
TEST(EffectState, APadApartIsWhatItWouldBe) {
  struct Remembers final : FrictionEffect {
    std::vector<double> nothing = std::vector<double>(1);
    void scale(const ElementColumns& /*elements*/, double* /*mu_s*/, double* /*mu_k*/) override {}
    std::span<double> memory() override { return nothing; }
  };
  int apart = 0, touching = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    RandomStream draw(seed, 0, "apart");
    const PadLayout pad = testing_field::random_pad(draw, 40, false);
    const auto [surface, facing] = testing_field::target(testing_field::Shape::box);
    std::vector<Wanted> wanted{{"patchy_friction", {}}, {"viscous_friction", {}}};
    if (seed % 2 == 0) wanted.push_back({"stribeck", {}});  // without this effect speeds are not computed either
    FieldEffects whole = installed(pad, wanted);
    whole.friction.push_back(std::make_unique<Remembers>());
    Field field(pad, surface, {0.5, 0.4}, installed(pad, wanted)), never(pad, surface, {0.5, 0.4}, std::move(whole));
    const testing_field::RandomMotion motion(draw, facing * testing_field::at(0.0, 0.0, 0.3e-3));
    for (int tick = 0; tick < 400; ++tick) {
      for (Field* one : {&field, &never}) one->step(motion.at(tick * 2e-3), 2e-3);
      ASSERT_TRUE(testing_field::same_bits(field, never)) << "seed " << seed << ", tick " << tick;
      (field.touching() == 0 ? apart : touching) += 1;
    }
  }
  EXPECT_GT(apart, 500);
  EXPECT_GT(touching, 500);
}

}  // namespace
}  // namespace slipbench::testing_effects::state_test
