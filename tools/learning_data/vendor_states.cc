#include "tools/learning_data/vendor_states.h"

#include <array>

#include <fmt/format.h>

namespace slipbench {
namespace {

// True tangential force from which a pillar counts as loaded [N]: the device's resolution.
constexpr double loaded_force = 0.05;

VendorState vendor_state(const PillarLabels& labels, std::size_t row, std::size_t pillar, bool touched_before) {
  if (!labels.touching(row, pillar)) return touched_before ? VendorState::contact_lost : VendorState::untouched;
  if (labels.slipping(row, pillar)) return VendorState::slipped;
  return is_loaded(labels, row, pillar) ? VendorState::loaded : VendorState::contact;
}

}  // namespace

std::string vendor_codes_text() {
  const auto code = [](VendorState state) { return static_cast<int>(state); };
  return fmt::format(
      "{} not yet touched, {} lost contact, {} not known, {} in contact, {} tangentially loaded (true force of {} N or more), "
      "{} slips now",
      code(VendorState::untouched), code(VendorState::contact_lost), code(VendorState::unknown), code(VendorState::contact),
      code(VendorState::loaded), loaded_force, code(VendorState::slipped));
}

bool is_loaded(const PillarLabels& labels, std::size_t row, std::size_t pillar) {
  return labels.touching(row, pillar) && labels.tangential_force(row, pillar) >= loaded_force;
}

std::vector<VendorState> vendor_states(const PillarLabels& labels) {
  std::vector<VendorState> states;
  states.reserve(labels.size() * pillars);
  std::array<bool, pillars> touched{};
  for (std::size_t row = 0; row < labels.size(); ++row) {
    for (std::size_t pillar = 0; pillar < pillars; ++pillar) {
      states.push_back(vendor_state(labels, row, pillar, touched[pillar]));
      touched[pillar] = touched[pillar] || labels.touching(row, pillar);
    }
  }
  return states;
}

}  // namespace slipbench
