// SHA-256, by OpenSSL.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

struct evp_md_ctx_st;

namespace slipbench {

using Digest = std::array<std::uint8_t, 32>;

class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;

  void update(const void* bytes, std::size_t size);
  // The digest of all that was given; the object then begins anew.
  Digest finish();

 private:
  evp_md_ctx_st* context_;
};

// 64 hexadecimal digits.
std::string hexadecimal(const Digest& digest);

}  // namespace slipbench
