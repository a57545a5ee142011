// The names of the paper for what makes a classifier.
#pragma once

#include <array>
#include <string>

#include "detectors/hd/model.h"
#include "detectors/hd/words.h"

namespace slipbench {

// Encoders on the command line, as the paper abbreviates them.
inline constexpr std::array encoder_words{hd::Word<hd::Encoding>{"shdc", hd::Encoding::spatial},
                                          hd::Word<hd::Encoding>{"sthdc", hd::Encoding::spatial_temporal},
                                          hd::Word<hd::Encoding>{"gsthdc", hd::Encoding::graph_spatial_temporal}};

// "CL-gstHDC".
std::string model_name(const hd::Model& model);

}  // namespace slipbench
