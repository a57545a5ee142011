// Errors of the field's constructor.
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>

#include "tests/expect.h"
#include "tests/oracle/pads.h"
#include "tests/sim/contact/random_case.h"

namespace slipbench::testing_field::refusal_test {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::string refusal(const PadLayout& pad, Friction friction = {0.5, 0.5}) {
  return refusal_of<std::invalid_argument>([&] { Field field(pad, Plane{}, friction); });
}

PadLayout changed(const std::function<void(PadLayout&)>& change) {
  PadLayout pad = oracle::nine_pillars();
  change(pad);
  return pad;
}

TEST(FieldRefusal, PadWithoutElements) { EXPECT_THAT(refusal(PadLayout{}), refused_at("field", {"pad", "one element"})); }

TEST(FieldRefusal, PadOfMoreThan4096Elements) {
  PadLayout pad = oracle::square_grid(64, 10e-3, 100.0, 100.0);  // 64^2 = 4,096
  EXPECT_EQ(refusal(pad), "accepted");
  pad.elements.push_back(pad.elements.back());
  pad.units.push_back({4096, 1});
  EXPECT_THAT(refusal(pad), refused_at("field", {"4097", "4096"}));
}

TEST(FieldRefusal, StiffnessThatIsNotPositive) {
  for (const double bad : {0.0, -1.0, nan}) {
    EXPECT_THAT(refusal(changed([&](PadLayout& pad) { pad.elements[3].k_normal = bad; })),
                refused_at("field", {"element 3", "stiffness"}));
    EXPECT_THAT(refusal(changed([&](PadLayout& pad) { pad.elements[8].k_tangential = bad; })),
                refused_at("field", {"element 8", "stiffness"}));
  }
}

TEST(FieldRefusal, DashpotThatIsNegative) {
  for (const double bad : {-1e-9, nan}) {
    EXPECT_THAT(refusal(changed([&](PadLayout& pad) { pad.elements[0].c_normal = bad; })),
                refused_at("field", {"element 0", "dashpot"}));
    EXPECT_THAT(refusal(changed([&](PadLayout& pad) { pad.elements[1].c_tangential = bad; })),
                refused_at("field", {"element 1", "dashpot"}));
  }
}

TEST(FieldRefusal, AxisThatIsNoUnitVector) {
  for (const double bad : {0.0, 0.999999, 1.000001, nan}) {
    EXPECT_THAT(refusal(changed([&](PadLayout& pad) { pad.elements[2].axis *= bad; })),
                refused_at("field", {"element 2", "axis"}));
  }
}

TEST(FieldRefusal, TipThatIsNotFinite) {
  for (const double bad : {std::numeric_limits<double>::infinity(), nan}) {
    EXPECT_THAT(refusal(changed([&](PadLayout& pad) { pad.elements[5].tip.y() = bad; })),
                refused_at("field", {"element 5", "tip"}));
  }
}

TEST(FieldRefusal, UnitsThatDoNotTileTheElementsInOrder) {
  const auto refused = refused_at("field", {"units", "elements", "order"});
  EXPECT_THAT(refusal(changed([](PadLayout& pad) { pad.units.pop_back(); })), refused);
  EXPECT_THAT(refusal(changed([](PadLayout& pad) { pad.units.push_back({9, 1}); })), refused);
  EXPECT_THAT(refusal(changed([](PadLayout& pad) { std::swap(pad.units[0], pad.units[1]); })), refused);
  EXPECT_THAT(refusal(changed([](PadLayout& pad) { pad.units[4].count = 0; })), refused);
  EXPECT_THAT(refusal(changed([](PadLayout& pad) { pad.units[4].count = 2; })), refused);
  EXPECT_THAT(refusal(changed([](PadLayout& pad) { pad.units.clear(); })), refused);
}

TEST(FieldRefusal, FrictionOutOfOrder) {
  const auto refused = refused_at("field", {"mu_kinetic", "mu_static"});
  const PadLayout pad = oracle::nine_pillars();
  EXPECT_THAT(refusal(pad, {0.4, 0.5}), refused);
  EXPECT_THAT(refusal(pad, {0.4, -0.1}), refused);
  EXPECT_THAT(refusal(pad, {nan, 0.1}), refused);
  EXPECT_THAT(refusal(pad, {0.5, nan}), refused);
  EXPECT_EQ(refusal(pad, {0.0, 0.0}), "accepted");
}

}  // namespace
}  // namespace slipbench::testing_field::refusal_test
