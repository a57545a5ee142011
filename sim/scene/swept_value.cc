#include "sim/scene/swept_value.h"

#include <cstddef>

namespace slipbench {

std::vector<std::string> swept_parts(const YamlNode& root, const std::string& path) {
  static_cast<void>(split_path(path, {}));
  const std::string rest = path.substr(path.find('.') + 1);
  const YamlNode* sweep = root.find("sweep");
  // The longest entry first, as there may be one for motion and one for motion.compression.
  for (std::size_t dot = rest.rfind('.'); sweep != nullptr && dot != std::string::npos && dot > 0;
       dot = rest.rfind('.', dot - 1)) {
    const YamlNode* entry = sweep->find(rest.substr(0, dot));
    if (entry == nullptr) continue;
    const std::vector<std::string> inside = split_path(rest.substr(dot + 1), {});
    if (node_at(*entry, inside) == nullptr) continue;
    std::vector<std::string> parts{"sweep", entry->key};
    parts.insert(parts.end(), inside.begin(), inside.end());
    return parts;
  }
  return {"sweep", rest};
}

}  // namespace slipbench
