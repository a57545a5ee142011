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
  EXPECT_THAT(refusal(spec(number, Quantity::length, "1 mm", positive), "0"), mentions({"'0'", "> 0 m"}));
  EXPECT_THAT(refusal(spec(number, Quantity::length, "1 mm", non_negative), "-1 um"), mentions({"-1 um", ">= 0 um"}));
  EXPECT_THAT(refusal(spec(number, Quantity::none, "0", fraction), "1.5"), mentions({"1.5", ">= 0", "<= 1"}));
  EXPECT_THAT(refusal(spec(integer, Quantity::none, "1", {1, 64}), "65"), mentions({"65", ">= 1", "<= 64"}));
  EXPECT_THAT(refusal(spec(number, Quantity::none, "0", {.max = 2.0}), "3"), mentions({"3", "<= 2"}));
  EXPECT_EQ(refusal(spec(number, Quantity::none, "0", fraction), "1"), "accepted");
  EXPECT_EQ(refusal(spec(number, Quantity::none, "0", fraction), "0"), "accepted");
  EXPECT_EQ(refusal(spec(integer, Quantity::none, "1", {1, 64}), "64"), "accepted");
}

// A product of four numbers between 1e-60 and 1e60 is within the range of a double.
TEST(ParseScalar, RefusesSizesWhoseProductsLeaveTheRangeOfADouble) {
  using enum ParameterType;
  EXPECT_THAT(refusal(spec(number, Quantity::length, "1 mm", positive), "5e-324"), mentions({"5e-324", "small", "1e-60 m"}));
  EXPECT_THAT(refusal(spec(number, Quantity::none, "1"), "-1e-61"), mentions({"-1e-61", "1e-60", "or 0"}));
  EXPECT_THAT(refusal(spec(vector, Quantity::length, "[0, 0]"), "1.7e308 mm"), mentions({"1.7e308 mm", "large", "1e+63 mm"}));
  for (const char* text : {"0", "-0", "1e-60", "1e60", "-1e60"})
    EXPECT_EQ(refusal(spec(number, Quantity::none, "1"), text), "accepted") << text;
  EXPECT_EQ(refusal(spec(number, Quantity::time, "inf", positive), "inf"), "accepted");
}

TEST(ParseScalar, TakesInfinityOnlyWhereItHasAMeaning) {
  using enum ParameterType;
  EXPECT_THAT(refusal(spec(number, Quantity::speed, "1", positive), "inf"), mentions({"inf", "finite"}));
  EXPECT_EQ(refusal(spec(number, Quantity::time, "inf", positive), "inf"), "accepted");
  EXPECT_EQ(refusal(spec(number, Quantity::time, "1 s", positive_or_infinite), "inf"), "accepted");
  EXPECT_THAT(refusal(spec(number, Quantity::time, "1 s", positive_or_infinite), "-inf"), mentions({"-inf", "> 0 s"}));
}

TEST(ParseScalar, RefusesOtherText) {
  using enum ParameterType;
  EXPECT_THAT(refusal(spec(integer, Quantity::none, "1"), "1.5"), mentions({"1.5", "whole number"}));
  EXPECT_THAT(refusal(spec(integer, Quantity::none, "1"), "9223372036854775808"), mentions({"9223372036854775808", "64 bits"}));
  EXPECT_THAT(refusal(spec(flag, Quantity::none, "true"), "yes"), mentions({"yes", "true", "false"}));
  EXPECT_THAT(refusal(spec(choice, Quantity::none, "gripper"), "griper"), mentions({"griper", "gripper"}));
  EXPECT_THAT(refusal(spec(path, Quantity::none, "own"), ""), mentions({"path", "own"}));
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
