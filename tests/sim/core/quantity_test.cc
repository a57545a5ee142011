#include "sim/core/quantity.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "sim/core/random.h"
#include "sim/core/readable_quantity.h"
#include "tests/expect.h"

namespace slipbench {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

struct Case {
  const char* text;
  Quantity quantity;
  double value;
};

class EveryUnit : public testing::TestWithParam<Case> {};

TEST_P(EveryUnit, IsTurnedIntoSi) {
  const Case& c = GetParam();
  // Exact: a decimal unit shifts the decimal point, it does not multiply.
  EXPECT_EQ(parse_quantity(c.text, c.quantity), c.value) << c.text;
  EXPECT_EQ(quantity_of(c.text), c.quantity) << c.text;
}

INSTANTIATE_TEST_SUITE_P(
    Quantity, EveryUnit,
    testing::Values(
        Case{"9", Quantity::none, 9.0}, Case{"9 %", Quantity::none, 0.09}, Case{"9 m", Quantity::length, 9.0},
        Case{"9 mm", Quantity::length, 0.009}, Case{"9 um", Quantity::length, 9e-6}, Case{"9 \u00b5m", Quantity::length, 9e-6},
        Case{"9 \u03bcm", Quantity::length, 9e-6}, Case{"9 cm", Quantity::length, 0.09}, Case{"9 nm", Quantity::length, 9e-9},
        Case{"9 s", Quantity::time, 9.0}, Case{"9 ms", Quantity::time, 0.009}, Case{"9 us", Quantity::time, 9e-6},
        Case{"9 min", Quantity::time, 540.0}, Case{"9 m/s", Quantity::speed, 9.0}, Case{"9 mm/s", Quantity::speed, 0.009},
        Case{"9 cm/s", Quantity::speed, 0.09}, Case{"9 um/s", Quantity::speed, 9e-6}, Case{"9 m/s2", Quantity::acceleration, 9.0},
        Case{"9 mm/s2", Quantity::acceleration, 0.009}, Case{"9 cm/s2", Quantity::acceleration, 0.09},
        Case{"9 m/s^2", Quantity::acceleration, 9.0}, Case{"9 mm/s^2", Quantity::acceleration, 0.009},
        Case{"9 rad", Quantity::angle, 9.0}, Case{"9 deg", Quantity::angle, 9.0 * degree},
        Case{"9 rad/s", Quantity::angular_speed, 9.0}, Case{"9 deg/s", Quantity::angular_speed, 9.0 * degree},
        Case{"9 rad/s2", Quantity::angular_acceleration, 9.0}, Case{"9 deg/s2", Quantity::angular_acceleration, 9.0 * degree},
        Case{"9 deg/s^2", Quantity::angular_acceleration, 9.0 * degree}, Case{"9 Hz", Quantity::frequency, 9.0},
        Case{"9 kHz", Quantity::frequency, 9e3}, Case{"9 MHz", Quantity::frequency, 9e6}, Case{"9 N", Quantity::force, 9.0},
        Case{"9 mN", Quantity::force, 0.009}, Case{"9 kN", Quantity::force, 9e3}, Case{"9 kg", Quantity::mass, 9.0},
        Case{"9 g", Quantity::mass, 0.009}, Case{"9 N/m", Quantity::stiffness, 9.0}, Case{"9 N/mm", Quantity::stiffness, 9e3},
        Case{"9 kN/m", Quantity::stiffness, 9e3}, Case{"9 N s/m", Quantity::damping, 9.0}, Case{"9 Ns/m", Quantity::damping, 9.0},
        Case{"9 MPa", Quantity::pressure, 9e6}));

TEST(ParseQuantity, ReadsTheFormsOfANumber) {
  EXPECT_EQ(parse_quantity("0.004", Quantity::speed), 0.004);
  EXPECT_EQ(parse_quantity("4mm/s", Quantity::speed), 0.004);
  EXPECT_EQ(parse_quantity("  4   mm/s ", Quantity::speed), 0.004);
  EXPECT_EQ(parse_quantity("-4 mm/s", Quantity::speed), -0.004);
  EXPECT_EQ(parse_quantity("+4 mm/s", Quantity::speed), 0.004);
  EXPECT_EQ(parse_quantity(".5", Quantity::none), 0.5);
  EXPECT_EQ(parse_quantity("5.", Quantity::none), 5.0);
  EXPECT_EQ(parse_quantity("4e-3", Quantity::speed), 0.004);
  EXPECT_EQ(parse_quantity("4E+3 mm/s", Quantity::speed), 4.0);
  EXPECT_EQ(parse_quantity("inf", Quantity::time), std::numeric_limits<double>::infinity());
  EXPECT_EQ(parse_quantity(".inf", Quantity::time), std::numeric_limits<double>::infinity());
  EXPECT_EQ(parse_quantity("-inf", Quantity::time), -std::numeric_limits<double>::infinity());
}

std::string refusal(const char* text, Quantity quantity) {
  return refusal_of<std::invalid_argument>([&] { parse_quantity(text, quantity); });
}

TEST(ParseQuantity, RefusesWhatIsNoNumberOfTheQuantity) {
  for (const std::string text : {"fast", "", "nan", "NaN", "-", ".", "e3", "- 4", "++4", "m/s", "infinity"}) {
    EXPECT_THAT(refusal(text.c_str(), Quantity::speed), mentions({"'" + text + "'", "speed", "m/s", "mm/s", "cm/s", "um/s"}));
  }
  EXPECT_THAT(refusal("much", Quantity::none), mentions({"much", "number"}));
  EXPECT_THAT(refusal("4 mmm/s", Quantity::speed), mentions({"4 mmm/s", "speed", "mm/s"}));
  EXPECT_THAT(refusal("4 mm", Quantity::speed), mentions({"4 mm", "speed"}));
  EXPECT_THAT(refusal("4 N", Quantity::none), mentions({"4 N", "%"}));
  EXPECT_THAT(refusal("0x10", Quantity::time), mentions({"0x10", "x10", "time"}));
  EXPECT_THAT(refusal("1,5 s", Quantity::time), mentions({"1,5 s", "time"}));
  EXPECT_THAT(refusal("inf s", Quantity::time), mentions({"inf s", "time"}));
}

TEST(ParseQuantity, RefusesNumbersBeyondADouble) {
  EXPECT_THAT(refusal("1e999", Quantity::none), mentions({"1e999", "double"}));
  EXPECT_THAT(refusal("1e308 kHz", Quantity::frequency), mentions({"1e308 kHz", "double"}));
  EXPECT_THAT(refusal("1e99999999999999999999", Quantity::none), mentions({"1e99999999999999999999", "double"}));
  EXPECT_THAT(refusal("1e-999", Quantity::none), mentions({"1e-999", "double"}));
  EXPECT_THAT(refusal("1e308 min", Quantity::time), mentions({"1e308 min", "double"}));
}

TEST(QuantityOf, TellsAQuantityByItsUnit) {
  EXPECT_EQ(quantity_of("30 deg"), Quantity::angle);
  EXPECT_EQ(quantity_of("30"), Quantity::none);
  EXPECT_EQ(quantity_of("inf"), Quantity::none);
  EXPECT_THROW(quantity_of("30 parsec"), std::invalid_argument);
  EXPECT_THROW(quantity_of("thirty"), std::invalid_argument);
}

TEST(SiUnit, ComesFirstAndHasFactorOne) {
  for (int i = 0; i <= static_cast<int>(Quantity::pressure); ++i) {
    const auto quantity = static_cast<Quantity>(i);
    EXPECT_EQ(units_of(quantity).front().symbol, si_symbol(quantity));
    EXPECT_EQ(units_of(quantity).front().factor, 1.0);
  }
}

TEST(FormatQuantity, ChoosesTheShortestNumber) {
  EXPECT_EQ(format_quantity(0.004, Quantity::speed), "4 mm/s");
  EXPECT_EQ(format_quantity(0.5, Quantity::time), "0.5 s");
  EXPECT_EQ(format_quantity(0.001, Quantity::time), "1 ms");
  EXPECT_EQ(format_quantity(30.0 * degree, Quantity::angle), "30 deg");
  EXPECT_EQ(format_quantity(1.0, Quantity::angle), "1 rad");
  EXPECT_EQ(format_quantity(1000.0, Quantity::frequency), "1 kHz");
  EXPECT_EQ(format_quantity(7100.0, Quantity::stiffness), "7.1 N/mm");
  EXPECT_EQ(format_quantity(0.4, Quantity::none), "0.4");
  EXPECT_EQ(format_quantity(0.0, Quantity::length), "0 m");
  EXPECT_EQ(format_quantity(std::numeric_limits<double>::infinity(), Quantity::time), "inf");
}

TEST(FormatQuantity, ReadsBackAsTheSameDouble) {
  RandomStream random(1, 0, "round trip");
  for (int i = 0; i <= static_cast<int>(Quantity::pressure); ++i) {
    const auto quantity = static_cast<Quantity>(i);
    for (int n = 0; n < 500; ++n) {
      const double sign = random.uniform() < 0.5 ? -1.0 : 1.0;
      const double value = sign * std::pow(10.0, random.uniform(-12.0, 12.0));
      const std::string text = format_quantity(value, quantity);
      ASSERT_EQ(parse_quantity(text, quantity), value) << text;
    }
  }
}

// At the ends of a double's range units other than SI may not hold a value; the text is then in SI.
TEST(FormatQuantity, ReadsBackAtTheEndsOfTheRange) {
  using Limits = std::numeric_limits<double>;
  for (int i = 0; i <= static_cast<int>(Quantity::pressure); ++i) {
    const auto quantity = static_cast<Quantity>(i);
    for (const double value : {1e308, Limits::max(), Limits::min(), 5e-324, 1e-320}) {
      for (const double sign : {1.0, -1.0}) {
        const std::string text = format_quantity(sign * value, quantity);
        ASSERT_FALSE(text.empty()) << value << " of quantity " << i;
        ASSERT_EQ(parse_quantity(text, quantity), sign * value) << text;
      }
    }
  }
  EXPECT_EQ(format_quantity(1e308, Quantity::speed), "1e+308 m/s");  // in mm/s it would be 1e311
}

TEST(ReadableQuantity, HasFourDigitsAndLengthsInMillimetres) {
  EXPECT_EQ(readable_quantity(452.00000000000006e-6, Quantity::length), "0.452 mm");
  EXPECT_EQ(readable_quantity(-0.0301, Quantity::length), "-30.1 mm");
  EXPECT_EQ(readable_quantity(2e-6, Quantity::length), "2 um");
  EXPECT_EQ(readable_quantity(0.0, Quantity::length), "0 m");
  EXPECT_EQ(readable_quantity(1.0 / 3000.0, Quantity::time), "333.3 us");
  // 27261 us is the shortest exact text, but four digits of it are 2.726e+04.
  EXPECT_EQ(readable_quantity(0.027261, Quantity::time), "27.26 ms");
  EXPECT_EQ(readable_quantity(12346.0, Quantity::frequency), "12350 Hz");
  EXPECT_EQ(readable_quantity(30.0 * degree, Quantity::angle), "30 deg");
  EXPECT_EQ(readable_quantity(std::numeric_limits<double>::infinity(), Quantity::time), "inf");
}

TEST(BoundInUnitOf, HasTheUnitOfTheText) {
  EXPECT_EQ(bound_in_unit_of("5 mm", 1e-6, Quantity::length, Bound::lower), "0.001 mm");
  EXPECT_EQ(bound_in_unit_of("50mm", 0.01, Quantity::length, Bound::upper), "10 mm");
  EXPECT_EQ(bound_in_unit_of("[0 mm, 0 mm]", -1.0, Quantity::length, Bound::lower), "-1000 mm");
  EXPECT_EQ(bound_in_unit_of("4 m/s", 10.0, Quantity::speed, Bound::upper), "10 m/s");
}

// 0.5 rad = 28.6479 deg, 100 rad/s = 5729.58 deg/s: four digits, towards zero.
TEST(BoundInUnitOf, RoundsIntoTheRange) {
  EXPECT_EQ(bound_in_unit_of("40 deg", 0.5, Quantity::angle, Bound::upper), "28.64 deg");
  EXPECT_EQ(bound_in_unit_of("-40 deg", -0.5, Quantity::angle, Bound::lower), "-28.64 deg");
  EXPECT_EQ(bound_in_unit_of("9 deg/s", 100.0, Quantity::angular_speed, Bound::upper), "5729 deg/s");
}

TEST(BoundInUnitOf, WithoutAUnitIsAsFormatted) {
  EXPECT_EQ(bound_in_unit_of("5", 0.01, Quantity::length, Bound::upper), format_quantity(0.01, Quantity::length));
  EXPECT_EQ(bound_in_unit_of("inf", 0.01, Quantity::length, Bound::upper), format_quantity(0.01, Quantity::length));
  EXPECT_EQ(bound_in_unit_of("0.5 %", 1.0, Quantity::none, Bound::upper), "100 %");
  EXPECT_EQ(bound_in_unit_of("2 mm", std::numeric_limits<double>::infinity(), Quantity::length, Bound::upper), "inf");
}

}  // namespace
}  // namespace slipbench
