#include "sim/mujoco/mjcf_text.h"

#include <fmt/format.h>

namespace slipbench {

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&': result += "&amp;"; break;
      case '<': result += "&lt;"; break;
      case '"': result += "&quot;"; break;
      default: result += c;
    }
  }
  return result;
}

std::string config_element(const std::string& key, const std::string& value) {
  return fmt::format("<config key=\"{}\" value=\"{}\"/>", key, escaped(value));
}

}  // namespace slipbench
