// Where the engines of the hyperdimensional classifier are composed: in C++, and those that are hardware.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "detectors/hd/engine.h"

namespace slipbench {

// "kernel", "reference", "rtl".
std::vector<std::string> hd_engine_names();

// The engine of that name. Throws InputError for a name that the catalogue does not have, and what the engine itself refuses.
std::unique_ptr<hd::Engine> make_hd_engine(std::string_view name, const hd::Model& model, const hd::Memories& memories);

}  // namespace slipbench
