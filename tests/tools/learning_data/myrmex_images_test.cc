// Images of a Myrmex: the paper's augmentation against closed forms, and the public tools' layout.
#include "tools/learning_data/myrmex_images.h"

#include <cmath>
#include <numbers>

#include "tests/expect.h"

namespace slipbench::myrmex_images_test {
namespace {

using Cropped = std::array<float, cropped * cropped>;

// a + b x + c y in taxels from the middle, x to the right, y up; turned by an angle it is a + b x'
// + c y' at the position turned back.
float plane(double x, double y) { return static_cast<float>(1000.0 + 20.0 * x + 7.0 * y); }

std::vector<float> image_of(std::size_t rows, std::size_t columns) {
  std::vector<float> image;
  for (std::size_t r = 0; r < rows; ++r) {
    for (std::size_t c = 0; c < columns; ++c) {
      image.push_back(plane(static_cast<double>(c) - 0.5 * (static_cast<double>(columns) - 1.0),
                            0.5 * (static_cast<double>(rows) - 1.0) - static_cast<double>(r)));
    }
  }
  return image;
}

TEST(TurnImage, TurnsAPlaneExactly) {
  // Bilinear interpolation is exact for a plane; only corners may be clamped, by 0.013 taxels:
  // 0.013 (20 + 7) counts.
  const std::vector<float> image = image_of(16, 16);
  for (std::size_t turn = 0; turn < rotations; ++turn) {
    Cropped turned;
    turn_image(image, 16, 16, turn, turned);
    const double angle = std::numbers::pi / 6.0 * static_cast<double>(turn);
    for (std::size_t r = 0; r < cropped; ++r) {
      for (std::size_t c = 0; c < cropped; ++c) {
        const double x = static_cast<double>(c) - 5.5, y = 5.5 - static_cast<double>(r);
        const double back_x = std::cos(angle) * x + std::sin(angle) * y, back_y = std::cos(angle) * y - std::sin(angle) * x;
        const bool inside = std::abs(back_x) <= 7.5 && std::abs(back_y) <= 7.5;
        ASSERT_NEAR(turned[r * cropped + c], plane(back_x, back_y), inside ? 1e-3 : 0.36) << turn << " " << r << " " << c;
      }
    }
  }
}

TEST(TurnImage, QuarterTurnsMoveTaxelsToTheBit) {
  std::vector<float> image(256);
  for (std::size_t k = 0; k < 256; ++k) image[k] = static_cast<float>(k * k % 4096);
  Cropped upright, quarter;
  turn_image(image, 16, 16, 0, upright);
  turn_image(image, 16, 16, 3, quarter);
  for (std::size_t r = 0; r < cropped; ++r) {
    for (std::size_t c = 0; c < cropped; ++c) {
      ASSERT_EQ(upright[r * cropped + c], image[(r + 2) * 16 + c + 2]);
      // Anticlockwise: the right edge, row r, moves to the top edge, column r.
      ASSERT_EQ(quarter[(cropped - 1 - c) * cropped + r], upright[r * cropped + c]);
    }
  }
}

SensorRecord array(std::size_t rows, std::size_t columns, std::vector<float> values) {
  SensorRecord sensor;
  sensor.name = "left";
  sensor.type = "myrmex";
  sensor.channels.push_back({"taxels", "counts", {rows, columns}, std::move(values), {}});
  return sensor;
}

TEST(TurnedImages, TakeThePlaceOfLargeArraysOnly) {
  TrialRecord record;
  std::vector<float> two = image_of(16, 16), second = image_of(16, 16);
  two.insert(two.end(), second.begin(), second.end());
  record.sensors = {array(16, 16, two), array(4, 3, std::vector<float>(12, 4095.0F))};
  const TrialRecord turned = turned_images(record);
  EXPECT_EQ(turned.sensors[0].channels[0].shape, (std::vector<std::size_t>{12, 12, 12}));
  ASSERT_EQ(turned.sensors[0].channels[0].values.size(), 2u * 12 * 144);
  Cropped expected;
  turn_image(second, 16, 16, 5, expected);
  for (std::size_t k = 0; k < expected.size(); ++k)
    ASSERT_EQ(turned.sensors[0].channels[0].values[(12 + 5) * 144 + k], expected[k]);
  EXPECT_EQ(turned.sensors[1].channels[0].values.size(), 12u);
  record.sensors.erase(record.sensors.begin());
  EXPECT_THAT([&] { turned_images(record); }, ::testing::ThrowsMessage<InputError>(HasSubstr("no myrmex of 12 x 12")));
}

TEST(MyrmexCsv, IsTransposedAndRounded) {
  EXPECT_EQ(myrmex_csv(array(2, 3, {1, 2, 3, 4, 5, 6, 4095, 4094.6F, 0, 0, 0, 0.5F})), "1,4,2,5,3,6\n4095,0,4095,0,0,0\n");
  EXPECT_THAT([] { myrmex_csv(array(1, 1, {4096.0F})); }, ::testing::ThrowsMessage<InputError>(mentions({"4096 counts"})));
  EXPECT_THAT([] { myrmex_csv(array(1, 1, {-1.0F})); }, ::testing::ThrowsMessage<InputError>(mentions({"0", "4095"})));
  SensorRecord other = array(1, 1, {1.0F});
  other.type = "nib_pad";
  EXPECT_THAT([&] { myrmex_csv(other); }, ::testing::ThrowsMessage<InputError>(mentions({"nib_pad", "myrmex"})));
  EXPECT_TRUE(begins_as_myrmex_csv("1,4,2,5\n"));
  EXPECT_FALSE(begins_as_myrmex_csv("t [s],T0_0 [counts]\n"));
  EXPECT_FALSE(begins_as_myrmex_csv("1,,2\n"));
  EXPECT_FALSE(begins_as_myrmex_csv("2024\n")) << "a year, which any file may begin with";
  EXPECT_FALSE(begins_as_myrmex_csv("4095,4096\n")) << "no count";
  EXPECT_TRUE(begins_as_myrmex_csv("4095,0\n"));
  EXPECT_FALSE(begins_as_myrmex_csv(""));
}

}  // namespace
}  // namespace slipbench::myrmex_images_test
