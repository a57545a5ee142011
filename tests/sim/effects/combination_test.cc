// Effects combined in one field, and requirements on all effects of the catalogue.
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "sim/contact/contact_labels.h"
#include "sim/core/error.h"
#include "tests/sim/contact/random_case.h"
#include "tests/sim/effects/effect_rig.h"

namespace slipbench::testing_effects::combination_test {
namespace {

TEST(EffectCombination, RelaxingDampedElementsStayOnAnEllipticCone) {
  int stuck = 0, slid = 0;
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    RandomStream draw(seed, 0, "effect combination");
    const PadLayout pad = testing_field::random_pad(draw, 60, true);
    const Friction friction = testing_field::random_friction(draw);
    const testing_field::RandomMotion motion(draw, Pose{});
    Field field = field_with(
        pad, friction, {{"viscoelastic", {{"relaxation", 0.3}, {"time", 0.1}}}, {"anisotropic_friction", {{"angle", 0.4}}}});
    for (int tick = 0; tick < 300; ++tick) {
      field.step(motion.at(tick * 1e-3), 1e-3);
      for (std::size_t i = 0; i < field.size(); ++i) {
        const Eigen::Vector3d f_t = field.tangential_force(i);
        const double f_n = field.normal_force(i);
        if (field.state(i) == ElementState::detached) {
          ASSERT_EQ(f_t.norm(), 0.0);
          continue;
        }
        ASSERT_GE(f_t.dot(field.slip_step(i)), 0.0);
        const bool slips = field.state(i) == ElementState::slip;
        (slips ? slid : stuck) += 1;
        const double gauge = field.cone_gauge(f_t, field.normal(i), (slips ? friction.mu_kinetic : friction.mu_static) * f_n);
        if (slips) {
          ASSERT_NEAR(gauge, 1.0, 1e-9) << "Newton stops when lambda moves by less than 1e-15 of itself";
        } else {
          ASSERT_LE(gauge, 1.0 + 1e-12);
        }
      }
    }
  }
  EXPECT_GT(stuck, 1000);
  EXPECT_GT(slid, 1000);
}

TEST(EffectCombination, EllipticConeWorksOnEverySurfaceThatAcceptsIt) {
  // A pad pressed on the top of a shape and slid: its margins are finite while it touches, and it
  // slips; or the effect refuses the shape.
  for (const testing_field::Shape shape : testing_field::all_shapes) {
    const testing_field::Target target = testing_field::target(shape);
    const PadLayout pad = one_unit(1000.0, 600.0);
    const bool flat = shape == testing_field::Shape::plane || shape == testing_field::Shape::box;
    try {
      Field field(pad, target.surface, {0.5, 0.5}, installed(pad, {{"anisotropic_friction", {}}}, flat));
      ContactLabels labels(field.layout());
      for (int tick = 0; tick <= 100; ++tick) {
        field.step(target.facing * at(0.0, 20e-6 * tick, -1e-3), 1e-3);
        EXPECT_FALSE(std::isnan(labels.update({&field, 1}, tick * 1e-3, 1e-3).margin[0]))
            << "shape " << static_cast<int>(shape) << ", tick " << tick;
      }
      // 2 mm of travel against mu k_n d/k_t = 0.83 mm along the grain, less across it.
      EXPECT_EQ(field.state(0), ElementState::slip) << "shape " << static_cast<int>(shape);
    } catch (const InputError&) {
      EXPECT_FALSE(flat);
    }
  }
}

TEST(EffectCatalogue, EveryEntryIsDocumentedAndItsDefaultsWork) {
  std::set<std::string> names;
  for (const EffectKind& kind : effect_catalogue()) {
    const Entry& about = kind.about;
    EXPECT_TRUE(names.insert(about.name).second) << about.name << " is listed twice";
    EXPECT_FALSE(about.summary.empty() || about.law.empty() || about.source.empty()) << about.name;
    EXPECT_FALSE(about.parameters.empty()) << about.name;
    std::set<std::string> parameters;
    for (const ParameterSpec& parameter : about.parameters) {
      EXPECT_TRUE(parameters.insert(parameter.name).second) << about.name << "." << parameter.name;
      EXPECT_FALSE(parameter.doc.empty() || parameter.source.empty() || parameter.default_text.empty())
          << about.name << "." << parameter.name;
      EXPECT_NO_THROW(default_of(parameter)) << about.name << "." << parameter.name;
    }
    // Pressed by 1 mm and slid by 4 mm: forces are finite, and the effect has joined the field.
    const PadLayout pad = one_unit(1000.0, 600.0, kind.body != nullptr ? 1 : 3);  // couples positions, not bristles
    FieldEffects effects = installed(pad, alone(kind));
    EXPECT_EQ(effects.surface.size() + effects.friction.size() + effects.rheology.size() + effects.ringing.size() +
                  (effects.rate ? 1 : 0) + (effects.cone ? 1 : 0) + (effects.tip ? 1 : 0) + (effects.skin ? 1 : 0),
              alone(kind).size())
        << about.name;
    Field field(pad, Plane{}, {0.5, 0.4}, std::move(effects));
    for (int tick = 0; tick <= 1000; ++tick) field.step(at(4e-6 * tick, 0.0, -1e-3), 1e-3);
    EXPECT_TRUE(field.wrench_on_pad().force.allFinite() && field.wrench_on_pad().torque.allFinite()) << about.name;
    EXPECT_GT(field.wrench_on_pad().force.z(), 0.1) << about.name;
  }
}

TEST(EffectCatalogue, EffectWithoutStrengthChangesNothing) {
  const std::vector<Wanted> idle{{"ageing", {{"rate", 0.0}}},
                                 {"load_dependent_friction", {{"exponent", 0.0}}},
                                 {"patchy_friction", {{"sd", 0.0}}},
                                 {"stribeck", {{"weakening", 0.0}}},
                                 {"texture", {{"height", 0.0}}},
                                 {"roughness", {{"height", 0.0}}},
                                 {"viscoelastic", {{"relaxation", 0.0}}},
                                 {"viscous_friction", {{"gain", 0.0}}},
                                 {"anisotropic_friction", {{"ratio", 1.0}}}};
  for (const Wanted& effect : idle) expect_no_influence(effect);
}

}  // namespace
}  // namespace slipbench::testing_effects::combination_test
