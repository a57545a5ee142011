// The digest of named values: what README.md calls entries, whether they lie in memory or in a file.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "tools/base/files/sha256.h"

namespace slipbench {

class ContentDigest {
 public:
  // One array or attribute of numbers: `type` as numpy writes it ("<f8"), values little-endian in C order. An attribute's key is
  // its object's path, "@" and its name. Keys differ.
  void add_numbers(const std::string& key, std::string_view type, const std::vector<std::size_t>& extents, const void* bytes,
                   std::size_t size);
  // One of texts. A single one has no extents.
  void add_texts(const std::string& key, const std::vector<std::size_t>& extents, const std::vector<std::string>& texts);
  void add_text(const std::string& key, const std::string& text) { add_texts(key, {}, {text}); }
  // A trial of a file.
  void add_trial(const std::string& key, const Digest& digest) { add_numbers(key, "trial", {}, digest.data(), digest.size()); }

  // SHA-256 over the entries' digests in ascending order of key.
  [[nodiscard]] Digest finish() const;

 private:
  void begin(const std::string& key, std::string_view type, const std::vector<std::size_t>& extents);

  mutable Sha256 hash_;
  std::map<std::string, Digest> entries_;
};

}  // namespace slipbench
