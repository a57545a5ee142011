// Help after a word that was not understood.
#pragma once

#include <string>
#include <vector>

namespace slipbench {

// What follows "unknown x 'word'" in a message: "; did you mean 'name'?" when a candidate is near, else ";".
std::string suggestion(const std::string& word, const std::vector<std::string>& candidates);

}  // namespace slipbench
