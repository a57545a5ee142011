// The layout of the public grasps with three BioTac SP (3dperceptionlab, bts3v2): a row a grasp.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tools/base/dataset/reader.h"

namespace slipbench {

// object,slipped,ff_biotac_1..24,mf_biotac_1..24,th_biotac_1..24: what was grasped, whether it was lost (0 or 1), and the counts of the three
// fingers' electrodes in the last row of the log up to `hold.from`. `trials` must each have three sensors biotac_sp ff, mf and th at sites, a body
// `object` and an outcome that says whether it was held. The object's name is its shape and its size in mm. Throws InputError where one has not.
std::string grasp_csv(const DatasetReader& reader, const std::vector<std::size_t>& trials);

bool begins_as_grasp_csv(std::string_view text);

}  // namespace slipbench
