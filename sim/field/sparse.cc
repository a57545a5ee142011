// Field: of many elements on a body's side few touch. All meet the surface in every step, since a touch is located by where an element was
// before. What springs, friction and labels make of it is worked out for groups of elements (kernel::lanes) of which one touches, or has touched in
// the two steps before, so that both columns of each pair now/before have been written by what touches nothing. Of all others every column is, to
// the sign of a zero, what the dense passes would leave.
#include <algorithm>

#include "sim/field/field.h"

namespace slipbench {

void Field::step_sparsely() {
  keep_energy();
  if (unsettled_ > 0) {
    --unsettled_;
    busy_count_ = busy_.size();
    for (std::size_t g = 0; g < busy_.size(); ++g) busy_[g] = static_cast<std::uint32_t>(g * kernel::lanes);
  } else {
    busy_count_ = kernel::find_active(columns_, padded_, busy_.data());
  }
  for (std::size_t k = 0; k < busy_count_; ++k) lit_[busy_[k] / kernel::lanes] = 1;
  if (touching_ < count_ && kernel::any_touches(columns_, false, padded_)) anchor_touched();
  kernel::map_active(columns_, busy());
}

void Field::view_sparsely() {
  shown_count_ = 0;
  for (std::size_t g = 0; g < lit_.size(); ++g) {
    if (lit_[g] != 0) shown_[shown_count_++] = static_cast<std::uint32_t>(g * kernel::lanes);
  }
  kernel::view_active(columns_, pose_.rotation.transpose(), {shown_.data(), shown_count_});
}

void Field::labels_have_read() {
  for (std::size_t k = 0; k < shown_count_; ++k) {
    const double* const state = columns_[mode] + shown_[k];
    lit_[shown_[k] / kernel::lanes] = std::any_of(state, state + kernel::lanes, [](double m) { return m != 0.0; }) ? 1 : 0;
  }
}

}  // namespace slipbench
