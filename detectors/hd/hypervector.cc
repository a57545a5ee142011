#include "detectors/hd/hypervector.h"

#include <bit>
#include <cassert>
#include <string>

#include "sim/core/error.h"

namespace slipbench::hd {
namespace {

// Value of a hexadecimal digit, or -1.
int digit_value(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

}  // namespace

Hypervector bind(const Hypervector& a, const Hypervector& b) {
  assert(a.dimension() == b.dimension());
  Hypervector bound(a.dimension());
  for (std::size_t i = 0; i < bound.words().size(); ++i) bound.words()[i] = ~(a.words()[i] ^ b.words()[i]);
  if (const std::size_t used = a.dimension() % 64; used != 0) bound.words().back() &= (std::uint64_t{1} << used) - 1;
  return bound;
}

Hypervector rotate(const Hypervector& a) {
  Hypervector rotated(a.dimension());
  for (std::size_t i = 0; i + 1 < a.dimension(); ++i) rotated.set(i, a.bit(i + 1));
  rotated.set(a.dimension() - 1, a.bit(0));
  return rotated;
}

std::size_t hamming(const Hypervector& a, const Hypervector& b) {
  assert(a.dimension() == b.dimension());
  std::size_t distance = 0;
  for (std::size_t i = 0; i < a.words().size(); ++i) {
    distance += static_cast<std::size_t>(std::popcount(a.words()[i] ^ b.words()[i]));
  }
  return distance;
}

std::string to_hex(const Hypervector& a) {
  std::string text;
  for (std::size_t digit = (a.dimension() + 3) / 4; digit-- > 0;) {
    text += "0123456789abcdef"[a.words()[digit / 16] >> (digit % 16 * 4) & 15];
  }
  return text;
}

Hypervector from_hex(std::string_view text, std::size_t dimension) {
  const std::size_t digits = (dimension + 3) / 4;
  if (text.size() != digits) {
    throw InputError(std::to_string(text.size()) + " digits; " + std::to_string(dimension) + " bits are " +
                     std::to_string(digits));
  }
  Hypervector vector(dimension);
  for (std::size_t column = 0; column < digits; ++column) {
    const int value = digit_value(text[column]);
    if (value < 0) {
      throw InputError(quote(text.substr(column, 1)) + " in column " + std::to_string(column + 1) + " is no hexadecimal digit");
    }
    const std::size_t digit = digits - 1 - column;
    if (column == 0 && dimension % 4 != 0 && value >> (dimension % 4) != 0) {
      throw InputError("the first digit has bits beyond the " + std::to_string(dimension) +
                       " of a vector: " + quote(text.substr(0, 1)));
    }
    vector.words()[digit / 16] |= static_cast<std::uint64_t>(value) << (digit % 16 * 4);
  }
  return vector;
}

}  // namespace slipbench::hd
