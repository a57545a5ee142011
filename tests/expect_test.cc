// The matchers distinguish messages independently of their wording.
#include "tests/expect.h"

#include <stdexcept>

namespace slipbench {
namespace {

const std::string message =
    "s.yaml:3: motion.top_speed: '4 mn/s' has an unknown unit; did you mean 'mm/s'? allowed: <= 4096 mm/s";

TEST(Mentions, FindsWholeWordsOnly) {
  EXPECT_THAT(message, mentions({"motion.top_speed", "4 mn/s", "mm/s", "4096 mm/s", "<= 4096"}));
  EXPECT_THAT(message, Not(mentions({"409"})));
  EXPECT_THAT(message, Not(mentions({"096"})));
  EXPECT_THAT(message, Not(mentions({"speed"}))) << "a part of top_speed";
  EXPECT_THAT(message, Not(mentions({"motion"}))) << "a part of motion.top_speed";
  EXPECT_THAT("0.4 and 4.0", Not(mentions({"4"})));
  EXPECT_THAT("4.", mentions({"4"}));
  EXPECT_THAT(message, Not(mentions({"4 mn/s", "5 mn/s"}))) << "one of the two";
  EXPECT_THAT("40 is not 4", mentions({"4"})) << "alone behind the first place, where it is not";
}

TEST(RefusedAt, NeedsThePlaceInFront) {
  EXPECT_THAT(message, refused_at("s.yaml:3", {"4 mn/s"}));
  EXPECT_THAT(message, Not(refused_at("s.yaml:2", {"4 mn/s"})));
  EXPECT_THAT("s.yaml:31: 4 mn/s", Not(refused_at("s.yaml:3", {"4 mn/s"})));
  EXPECT_THAT("in " + message, Not(refused_at("s.yaml:3", {"4 mn/s"})));
  EXPECT_THAT(message, Not(refused_at("s.yaml:3", {"4 mm"})));
  EXPECT_THAT(message, Not(refused_at("s.yaml:3", {"s.yaml"}))) << "in the place alone";
}

TEST(RefusalOf, IsOfTheErrorThatIsAskedFor) {
  const auto wrong_value = [] { throw SceneValueError("motion.start", "too late"); };
  EXPECT_THAT(refusal_of(wrong_value), refused_at("motion.start", {"late"}));
  EXPECT_THAT(scene_refusal_of(wrong_value), refused_at("motion.start", {"late"}));
  EXPECT_EQ(refusal_of([] {}), "accepted");
  EXPECT_THROW(refusal_of([] { throw std::runtime_error("too late"); }), std::runtime_error) << "no InputError";
}

}  // namespace
}  // namespace slipbench
