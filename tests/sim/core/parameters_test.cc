#include "sim/core/parameters.h"

#include <stdexcept>

#include "tests/expect.h"

namespace slipbench {
namespace {

ParameterSpec spec(ParameterType type, Quantity quantity, std::string default_text, Range range = any_value) {
  return {"p", type, quantity, std::move(default_text), range, {"gripper", "hexapod"}, 2, {}, "doc", "assumed"};
}

std::string refusal(const ParameterSpec& spec, const char* text) {
  return refusal_of<std::invalid_argument>([&] { parse_scalar(spec, text); });
}

TEST(ParseScalar, ReadsEachType) {
  using enum ParameterType;
  EXPECT_EQ(std::get<double>(parse_scalar(spec(number, Quantity::length, "1 mm"), "2 mm")), 0.002);
  EXPECT_EQ(std::get<double>(parse_scalar(spec(vector, Quantity::length, "[0, 0]"), "2 mm")), 0.002);
  EXPECT_EQ(std::get<std::int64_t>(parse_scalar(spec(integer, Quantity::none, "1"), "-6")), -6);
  EXPECT_EQ(std::get<bool>(parse_scalar(spec(flag, Quantity::none, "true"), "false")), false);
  EXPECT_EQ(std::get<std::string>(parse_scalar(spec(choice, Quantity::none, "gripper"), "hexapod")), "hexapod");
  EXPECT_EQ(std::get<std::string>(parse_scalar(spec(path, Quantity::none, "own"), "../a b.hex")), "../a b.hex");
}

TEST(ParseScalar, ChecksTheRange) {
  using enum ParameterType;
  EXPECT_EQ(refusal(spec(number, Quantity::length, "1 mm", positive), "0"), "'0' is out of range; allowed: > 0 m");
  EXPECT_EQ(refusal(spec(number, Quantity::length, "1 mm", non_negative), "-1 um"), "'-1 um' is out of range; allowed: >= 0 m");
  EXPECT_EQ(refusal(spec(number, Quantity::none, "0", fraction), "1.5"), "'1.5' is out of range; allowed: >= 0 and <= 1");
  EXPECT_EQ(refusal(spec(integer, Quantity::none, "1", {1, 64}), "65"), "'65' is out of range; allowed: >= 1 and <= 64");
  EXPECT_EQ(refusal(spec(number, Quantity::none, "0", {.max = 2.0}), "3"), "'3' is out of range; allowed: <= 2");
  EXPECT_EQ(refusal(spec(number, Quantity::none, "0", fraction), "1"), "accepted");
  EXPECT_EQ(refusal(spec(number, Quantity::none, "0", fraction), "0"), "accepted");
  EXPECT_EQ(refusal(spec(integer, Quantity::none, "1", {1, 64}), "64"), "accepted");
}

TEST(ParseScalar, TakesInfinityOnlyWhereItHasAMeaning) {
  using enum ParameterType;
  EXPECT_EQ(refusal(spec(number, Quantity::speed, "1", positive), "inf"), "'inf' is infinite; allowed: a finite number");
  EXPECT_EQ(refusal(spec(number, Quantity::time, "inf", positive), "inf"), "accepted");
  EXPECT_EQ(refusal(spec(number, Quantity::time, "1 s", positive_or_infinite), "inf"), "accepted");
  EXPECT_EQ(refusal(spec(number, Quantity::time, "1 s", positive_or_infinite), "-inf"), "'-inf' is out of range; allowed: > 0 s");
}

TEST(ParseScalar, RefusesOtherText) {
  using enum ParameterType;
  EXPECT_EQ(refusal(spec(integer, Quantity::none, "1"), "1.5"),
            "'1.5' is not a whole number; allowed: digits, with a leading '-' if negative");
  EXPECT_EQ(refusal(spec(integer, Quantity::none, "1"), "9223372036854775808"),
            "'9223372036854775808' is beyond the range of 64 bits");
  EXPECT_EQ(refusal(spec(flag, Quantity::none, "true"), "yes"), "'yes' is not a flag; allowed: true, false");
  EXPECT_EQ(refusal(spec(choice, Quantity::none, "gripper"), "griper"),
            "unknown value 'griper'; did you mean 'gripper'? allowed: gripper, hexapod");
  EXPECT_EQ(refusal(spec(path, Quantity::none, "own"), ""), "the path is empty; allowed: a path, or own");
}

TEST(Defaults, AreReadFromTheDeclaration) {
  using enum ParameterType;
  const std::vector<ParameterSpec> specs{{"compression", number, Quantity::length, "1 mm", positive, {}, 1, {}, "", ""},
                                         {"pivot", vector, Quantity::length, "[3 mm, -1 mm]", any_value, {}, 2, {}, "", ""},
                                         {"bristles", integer, Quantity::none, "6", positive, {}, 1, {}, "", ""},
                                         {"stop", number, Quantity::time, "inf", positive, {}, 1, {}, "", ""}};
  const Parameters defaults = defaults_of(specs);
  EXPECT_EQ(defaults.values().size(), 4u);
  EXPECT_EQ(defaults.number("compression"), 0.001);
  EXPECT_EQ(defaults.vector("pivot"), (std::vector{0.003, -0.001}));
  EXPECT_EQ(defaults.integer("bristles"), 6);
  EXPECT_EQ(defaults.number("stop"), std::numeric_limits<double>::infinity());
}

TEST(Defaults, ThatDoNotFitTheirDeclarationAreABug) {
  using enum ParameterType;
  EXPECT_THROW(default_of(spec(number, Quantity::length, "1 s")), std::logic_error);
  EXPECT_THROW(default_of(spec(number, Quantity::length, "-1 mm", positive)), std::logic_error);
  EXPECT_THROW(default_of(spec(vector, Quantity::length, "[1 mm]")), std::logic_error);
  EXPECT_THROW(default_of(spec(vector, Quantity::length, "[1 mm, 2 mm, 3 mm]")), std::logic_error);
  EXPECT_THROW(default_of(spec(vector, Quantity::length, "1 mm, 2 mm")), std::logic_error);
  EXPECT_THROW(default_of(spec(choice, Quantity::none, "leg")), std::logic_error);
}

TEST(Parameters, AskedForWhatWasNotDeclaredAreABug) {
  Parameters parameters;
  parameters.set("speed", 1.0);
  EXPECT_EQ(parameters.number("speed"), 1.0);
  EXPECT_THROW(static_cast<void>(parameters.number("sped")), std::logic_error);
  EXPECT_THROW(static_cast<void>(parameters.integer("speed")), std::logic_error);
  EXPECT_THROW(static_cast<void>(parameters.flag("speed")), std::logic_error);
  EXPECT_THROW(static_cast<void>(parameters.choice("speed")), std::logic_error);
  EXPECT_THROW(static_cast<void>(parameters.vector("speed")), std::logic_error);
}

}  // namespace
}  // namespace slipbench
