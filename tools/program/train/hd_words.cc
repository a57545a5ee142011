#include "tools/program/train/hd_words.h"

#include <stdexcept>

namespace slipbench {

std::string model_name(const hd::Model& model) {
  const std::string prefix = model.context_driven ? "CL-" : "";
  switch (model.encoding) {
    case hd::Encoding::spatial: return prefix + "sHDC";
    case hd::Encoding::spatial_temporal: return prefix + "stHDC";
    case hd::Encoding::graph_spatial_temporal: return prefix + "gstHDC";
  }
  throw std::logic_error("encoding without a name");
}

}  // namespace slipbench
