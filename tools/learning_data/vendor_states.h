// States of a PapillArray's pillar as its vendor's software and ROS driver report them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/learning_data/samples.h"

namespace slipbench {

enum class VendorState : std::int8_t {
  untouched = -2,     // has not touched yet
  contact_lost = -1,  // has touched, and does not touch now
  unknown = 0,        // without labels
  contact = 1,
  loaded = 2,   // is_loaded()
  slipped = 3,  // slips now
};

// Reported normal force [N] from which the vendor's software considers a pillar in contact.
inline constexpr float vendor_contact_force = 0.5F;

// "-2 not yet touched, -1 lost contact, ...": the codes with their meanings, for dataset cards.
std::string vendor_codes_text();

// True if a pillar touches with a true tangential force of the device's resolution or more.
bool is_loaded(const PillarLabels& labels, std::size_t row, std::size_t pillar);

// [T,9] The state of each pillar, from the truth.
std::vector<VendorState> vendor_states(const PillarLabels& labels);

}  // namespace slipbench
