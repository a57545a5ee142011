// The words of the command line for what makes a classifier.
#pragma once

#include <string>
#include <vector>

#include "detectors/hd/features.h"
#include "detectors/hd/model.h"

namespace slipbench {

// Encoders as the paper abbreviates them: "shdc", "sthdc", "gsthdc"; the other words are those of detectors/hd/words.h. The parsers throw
// InputError with the nearest name.
hd::Encoding parse_encoder(const std::string& name);
hd::Ties parse_ties(const std::string& name);
hd::Quantiser parse_quantiser(const std::string& name);
std::vector<std::string> encoder_names();

// "CL-gstHDC", as the paper writes it.
std::string model_name(const hd::Model& model);

}  // namespace slipbench
