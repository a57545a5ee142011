#include "tools/learning_data/vendor_states.h"

#include "tests/expect.h"

namespace slipbench::vendor_states_test {
namespace {

// Five samples of nine equal pillars: detached, stick under 0.04 N and 0.05 N, slip, detached.
TEST(VendorStates, FollowTheTruth) {
  const std::vector<UnitState> truth{UnitState::detached, UnitState::stick, UnitState::stick, UnitState::slip,
                                     UnitState::detached};
  const std::vector<float> tangential{0.0F, 0.04F, 0.05F, 0.05F, 0.0F};  // N; 0.05F is above 0.05
  std::vector<std::uint8_t> unit_state;
  std::vector<float> velocity, force;
  std::vector<VendorState> expected;
  for (std::size_t row = 0; row < truth.size(); ++row) {
    constexpr std::array states{VendorState::untouched, VendorState::contact, VendorState::loaded, VendorState::slipped,
                                VendorState::contact_lost};
    for (std::size_t pillar = 0; pillar < pillars; ++pillar) {
      unit_state.push_back(static_cast<std::uint8_t>(truth[row]));
      velocity.insert(velocity.end(), {0.0F, 0.0F});
      force.insert(force.end(), {0.0F, tangential[row], 1.0F});
      expected.push_back(states.at(row));
    }
  }
  EXPECT_EQ(vendor_states({unit_state, velocity, force, LabelRule::strict, default_label_speed}), expected);
  velocity.pop_back();
  EXPECT_THAT(refusal_of([&] { PillarLabels(unit_state, velocity, force, LabelRule::strict, default_label_speed); }),
              mentions({"45 states", "89 velocities", "135 forces"}));
}

}  // namespace
}  // namespace slipbench::vendor_states_test
