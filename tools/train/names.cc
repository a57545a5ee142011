#include "tools/train/names.h"

#include <array>
#include <stdexcept>

#include <fmt/format.h>

#include "detectors/hd/words.h"
#include "sim/core/error.h"

namespace slipbench {
namespace {

constexpr std::array encoders{hd::Word<hd::Encoding>{"shdc", hd::Encoding::spatial},
                              hd::Word<hd::Encoding>{"sthdc", hd::Encoding::spatial_temporal},
                              hd::Word<hd::Encoding>{"gsthdc", hd::Encoding::graph_spatial_temporal}};

template <class Words>
auto parse_name(const Words& words, const std::string& name, const char* what) {
  const auto value = hd::value_of(words, name);
  if (!value) throw InputError(fmt::format("unknown {} '{}'{}", what, name, allowed_names(name, hd::names_of(words))));
  return *value;
}

}  // namespace

hd::Encoding parse_encoder(const std::string& name) { return parse_name(encoders, name, "encoder"); }
hd::Ties parse_ties(const std::string& name) { return parse_name(hd::ties_words, name, "rule for ties"); }
hd::Quantiser parse_quantiser(const std::string& name) { return parse_name(hd::quantiser_words, name, "quantiser"); }
std::vector<std::string> encoder_names() { return hd::names_of(encoders); }

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
