// Pieces of MJCF, MuJoCo's XML.
#pragma once

#include <string>

namespace slipbench {

// `text` as it stands between double quotes.
[[nodiscard]] std::string escaped(const std::string& text);

// <config key="..." value="..."/>: an attribute of a plugin's instance.
[[nodiscard]] std::string config_element(const std::string& key, const std::string& value);

}  // namespace slipbench
