#include "tools/base/record/content_digest.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace slipbench {

void ContentDigest::begin(const std::string& key, std::string_view type, const std::vector<std::size_t>& extents) {
  std::string head = key;
  head.push_back('\0');
  head += type;
  head.push_back('\0');
  head += fmt::format("{}", fmt::join(extents, ","));
  head.push_back('\0');
  hash_.update(head.data(), head.size());
}

void ContentDigest::add_numbers(const std::string& key, std::string_view type, const std::vector<std::size_t>& extents,
                                const void* bytes, std::size_t size) {
  begin(key, type, extents);
  hash_.update(bytes, size);
  entries_[key] = hash_.finish();
}

void ContentDigest::add_texts(const std::string& key, const std::vector<std::size_t>& extents,
                              const std::vector<std::string>& texts) {
  begin(key, "text", extents);
  for (const std::string& text : texts) hash_.update(text.c_str(), text.size() + 1);
  entries_[key] = hash_.finish();
}

Digest ContentDigest::finish() const {
  for (const auto& [key, digest] : entries_) hash_.update(digest.data(), digest.size());
  return hash_.finish();
}

}  // namespace slipbench
