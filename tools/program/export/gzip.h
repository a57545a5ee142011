// Text files in the container of gzip.
#pragma once

#include <string>
#include <string_view>

namespace slipbench {

// As `gzip` writes it, without a name or a time: the same text gives the same bytes.
std::string gzip(std::string_view text);

// The text of a file of gzip that begins so, up to 64 kB of it; empty: it is none.
std::string beginning_of_gzip(std::string_view bytes);

}  // namespace slipbench
