#include "tools/base/page/page.h"

#include <cmath>

#include "tests/expect.h"
#include "tests/tools/base/page/unpack.h"

namespace slipbench::page {
namespace {

std::string base64_of(const std::string& text) {
  return base64({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

// The test vectors of RFC 4648, section 10.
TEST(Base64, FollowsTheStandard) {
  EXPECT_EQ(base64_of(""), "");
  EXPECT_EQ(base64_of("f"), "Zg==");
  EXPECT_EQ(base64_of("fo"), "Zm8=");
  EXPECT_EQ(base64_of("foo"), "Zm9v");
  EXPECT_EQ(base64_of("foob"), "Zm9vYg==");
  EXPECT_EQ(base64_of("fooba"), "Zm9vYmE=");
  EXPECT_EQ(base64_of("foobar"), "Zm9vYmFy");
}

TEST(PackCurves, KeepsEveryValueToHalfAStep) {
  // Two columns; the differences between extremes wrap around 16 bits.
  const std::vector<float> values = {-8.0F, 0.001F, 8.0F, 0.002F, -8.0F, -3.0F, 0.0F, 7.999F};
  const Json packed = pack_curves(values, 2, 1);
  EXPECT_DOUBLE_EQ(packed.at("step").get<double>(), 8.0 / 32767.0);
  const auto columns = unpack(packed);
  ASSERT_EQ(columns.size(), 2U);
  for (std::size_t row = 0; row < 4; ++row) {
    for (std::size_t column = 0; column < 2; ++column) {
      // Half a step, plus the rounding of the product itself.
      EXPECT_NEAR(columns[column][row], values[2 * row + column], 0.5 * 8.0 / 32767.0 + 1e-12);
    }
  }
}

TEST(PackCurves, MarksWhatIsNotFinite) {
  const float infinity = std::numeric_limits<float>::infinity();
  const auto columns = unpack(pack_curves(std::vector<float>{1.0F, std::nanf(""), infinity, -infinity, -1.0F}, 1, 1));
  EXPECT_DOUBLE_EQ(columns[0][0], 1.0);
  EXPECT_TRUE(std::isnan(columns[0][1]));
  EXPECT_TRUE(std::isnan(columns[0][2]));
  EXPECT_TRUE(std::isnan(columns[0][3]));
  EXPECT_DOUBLE_EQ(columns[0][4], -1.0);
}

TEST(PackCurves, ZerosStayZero) {
  EXPECT_THAT(unpack(pack_curves(std::vector<float>{0.0F, 0.0F}, 1, 1))[0], ElementsAre(0.0, 0.0));
}

TEST(PackCurves, ThinsFromTheFirstRow) {
  const auto columns = unpack(pack_curves(std::vector<float>{0.0F, 1.0F, 2.0F, 3.0F, 4.0F, 5.0F, 32767.0F}, 1, 3));
  EXPECT_THAT(columns[0], ElementsAre(0.0, 3.0, 32767.0));  // rows 0, 3 and 6; the step is 1
}

TEST(PackBytes, LosesNothing) {
  const auto columns = unpack(pack_bytes(std::vector<std::uint8_t>{0, 3, 1, 2, 255, 0}, 2));
  EXPECT_THAT(columns[0], ElementsAre(0, 1, 255));
  EXPECT_THAT(columns[1], ElementsAre(3, 2, 0));
}

TEST(PackTimes, KeepsMicroseconds) {
  const auto columns = unpack(pack_times(std::vector<double>{-0.5, 0.0, 1e-3, 1799.999999}));
  EXPECT_NEAR(columns[0][0], -0.5, 1e-12);
  EXPECT_NEAR(columns[0][2], 1e-3, 1e-12);
  EXPECT_NEAR(columns[0][3], 1799.999999, 1e-9);
}

TEST(PackTimes, ReachesAnyLength) {
  // 2^31 - 1 steps reach 5000 s, so that a step is 2.33 us.
  const auto columns = unpack(pack_times(std::vector<double>{0.0, 2500.0, 5000.0}));
  EXPECT_EQ(columns[0][0], 0.0);
  EXPECT_NEAR(columns[0][1], 2500.0, 0.5 * 2.33e-6);
  EXPECT_NEAR(columns[0][2], 5000.0, 0.5 * 2.33e-6);
}

}  // namespace
}  // namespace slipbench::page
