// What the field's constructor refuses, and the words it uses.
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>

#include "tests/expect.h"
#include "tests/oracle/pads.h"
#include "tests/sim/field/random_case.h"

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

TEST(FieldRefusal, PadWithoutElements) { EXPECT_EQ(refusal(PadLayout{}), "field: a pad needs at least one element"); }

TEST(FieldRefusal, PadOfMoreThan4096Elements) {
  PadLayout pad = oracle::square_grid(64, 10e-3, 100.0, 100.0);  // 64^2 = 4,096
  EXPECT_EQ(refusal(pad), "accepted");
  pad.elements.push_back(pad.elements.back());
  pad.units.push_back({4096, 1});
  EXPECT_EQ(refusal(pad), "field: a pad of 4097 elements; allowed are up to 4096");
}

TEST(FieldRefusal, StiffnessThatIsNotPositive) {
  for (const double bad : {0.0, -1.0, nan}) {
    EXPECT_EQ(refusal(changed([&](PadLayout& pad) { pad.elements[3].k_normal = bad; })),
              "field: element 3: stiffness must be positive and finite");
    EXPECT_EQ(refusal(changed([&](PadLayout& pad) { pad.elements[8].k_tangential = bad; })),
              "field: element 8: stiffness must be positive and finite");
  }
}

TEST(FieldRefusal, DashpotThatIsNegative) {
  for (const double bad : {-1e-9, nan}) {
    EXPECT_EQ(refusal(changed([&](PadLayout& pad) { pad.elements[0].c_normal = bad; })),
              "field: element 0: a dashpot must not be negative");
    EXPECT_EQ(refusal(changed([&](PadLayout& pad) { pad.elements[1].c_tangential = bad; })),
              "field: element 1: a dashpot must not be negative");
  }
}

TEST(FieldRefusal, AxisThatIsNoUnitVector) {
  for (const double bad : {0.0, 0.999999, 1.000001, nan}) {
    EXPECT_EQ(refusal(changed([&](PadLayout& pad) { pad.elements[2].axis *= bad; })),
              "field: element 2: the axis must be a unit vector");
  }
}

TEST(FieldRefusal, TipThatIsNotFinite) {
  for (const double bad : {std::numeric_limits<double>::infinity(), nan}) {
    EXPECT_EQ(refusal(changed([&](PadLayout& pad) { pad.elements[5].tip.y() = bad; })),
              "field: element 5: the tip must be finite");
  }
}

TEST(FieldRefusal, UnitsThatDoNotTileTheElementsInOrder) {
  const std::string message = "field: units must tile the elements in order";
  EXPECT_EQ(refusal(changed([](PadLayout& pad) { pad.units.pop_back(); })), message);
  EXPECT_EQ(refusal(changed([](PadLayout& pad) { pad.units.push_back({9, 1}); })), message);
  EXPECT_EQ(refusal(changed([](PadLayout& pad) { std::swap(pad.units[0], pad.units[1]); })), message);
  EXPECT_EQ(refusal(changed([](PadLayout& pad) { pad.units[4].count = 0; })), message);
  EXPECT_EQ(refusal(changed([](PadLayout& pad) { pad.units[4].count = 2; })), message);
  EXPECT_EQ(refusal(changed([](PadLayout& pad) { pad.units.clear(); })), message);
}

TEST(FieldRefusal, FrictionOutOfOrder) {
  const std::string message = "field: friction must satisfy 0 <= mu_kinetic <= mu_static";
  const PadLayout pad = oracle::nine_pillars();
  EXPECT_EQ(refusal(pad, {0.4, 0.5}), message);
  EXPECT_EQ(refusal(pad, {0.4, -0.1}), message);
  EXPECT_EQ(refusal(pad, {nan, 0.1}), message);
  EXPECT_EQ(refusal(pad, {0.5, nan}), message);
  EXPECT_EQ(refusal(pad, {0.0, 0.0}), "accepted");
}

}  // namespace
}  // namespace slipbench::testing_field::refusal_test
