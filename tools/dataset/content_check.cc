#include "tools/dataset/content_check.h"

#include <fmt/format.h>

#include "sim/core/error.h"

namespace slipbench {

void ContentCheck::finish() const {
  const std::vector<std::string> files = reader_->files();
  for (std::size_t k = 0; k < files.size(); ++k) {
    const std::string& written = reader_->content_sha256()[k];
    const std::string found = content_digest(digests_[k]);
    if (!written.empty() && found != written) {
      throw InputError(
          fmt::format("{}: is damaged: its arrays have the SHA-256 {}, content_sha256 says {}", files[k], found, written));
    }
  }
}

}  // namespace slipbench
