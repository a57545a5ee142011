#include "tools/dataset/record/codes.h"

#include "tests/expect.h"

namespace slipbench::codes_test {
namespace {

// The table of codes in tools/dataset/README.md, as files of all versions have it.
TEST(Codes, AreThoseOfTheFormat) {
  EXPECT_EQ(codes_of("unit_state"), R"({"detached":0,"stick":1,"slip":2,"partial":3})");
  EXPECT_EQ(codes_of("events/kind"), R"({"touch":0,"slip":1,"stick":2,"detach":3,"micro":4,"part_sticks":5})");
  for (const char* array : {"state", "state_micro", "state_paper", "detector_class"})
    EXPECT_EQ(codes_of(array), R"({"no_contact":0,"non_slip":1,"incipient":2,"gross":3})") << array;
  EXPECT_EQ(codes_with_unknown(), R"({"no_contact":0,"non_slip":1,"incipient":2,"gross":3,"unknown":4})");
  EXPECT_EQ(codes_of("margin"), "");
}

TEST(ShownUnit, NamesWhatAPureNumberCounts) {
  EXPECT_EQ(shown_unit("state", "1"), "code");
  EXPECT_EQ(shown_unit("events/unit", "1"), "index");
  EXPECT_EQ(shown_unit("command", "1"), "counts");
  EXPECT_EQ(shown_unit("margin", "1"), "1");
  EXPECT_EQ(shown_unit("force", "N"), "N");
}

}  // namespace
}  // namespace slipbench::codes_test
