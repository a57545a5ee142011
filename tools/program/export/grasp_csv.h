// The layout of the public grasps with three BioTac SP (3dperceptionlab, bts3v2): a row a grasp.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tools/base/dataset/reader.h"

namespace slipbench {

// object,slipped,ff_biotac_1..24,mf_biotac_1..24,th_biotac_1..24: what was grasped, whether the lift lost it (0 or 1), and the counts of the three
// fingers' electrodes in the last row of the log before the lift. The lift begins where the thumb's pad is first 0.1 mm higher than at the start.
// The object is lost when, until the end, it has moved by more than 10 mm against the thumb: it fell, slid or stayed behind.
// `trials` must each have three sensors biotac_sp ff, mf and th at sites, and a body `object`. The object's name is its shape and its size in mm.
// Throws InputError where one has not, or has no lift.
std::string grasp_csv(const DatasetReader& reader, const std::vector<std::size_t>& trials);

bool begins_as_grasp_csv(std::string_view text);

}  // namespace slipbench
