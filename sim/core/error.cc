#include "sim/core/error.h"

#include <array>
#include <cstdio>
#include <numeric>
#include <vector>

namespace slipbench {
namespace {

// A character of a text in UTF-8; if it is not `valid`, one byte that is not UTF-8.
struct Character {
  char32_t code;
  std::size_t bytes;
  bool valid;
};

Character character_at(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[at + k]); };
  const unsigned char first = byte(0);
  const Character invalid{first, 1, false};
  if (first < 0x80) return {first, 1, true};
  const std::size_t bytes = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first > 0xf4 || at + bytes > text.size()) return invalid;
  char32_t code = first & (0x7fu >> bytes);
  for (std::size_t k = 1; k < bytes; ++k) {
    if ((byte(k) & 0xc0u) != 0x80u) return invalid;
    code = code << 6u | (byte(k) & 0x3fu);
  }
  constexpr std::array<char32_t, 5> least{0, 0, 0x80, 0x800, 0x10000};  // a shorter form is not valid
  const bool surrogate = code >= 0xd800 && code <= 0xdfff;
  if (code < least[bytes] || code > 0x10ffff || surrogate) return invalid;
  return {code, bytes, true};
}

// Characters that show nothing, or that change the order in which others are shown.
bool is_hidden(char32_t code) {
  struct Range {
    char32_t first, last;
  };
  constexpr std::array<Range, 15> ranges{{{0x00ad, 0x00ad},      // soft hyphen
                                          {0x034f, 0x034f},      // combining grapheme joiner
                                          {0x061c, 0x061c},      // Arabic letter mark
                                          {0x115f, 0x1160},      // Hangul fillers
                                          {0x17b4, 0x17b5},      // Khmer inherent vowels
                                          {0x180b, 0x180f},      // Mongolian separators
                                          {0x200b, 0x200f},      // zero width, marks of direction
                                          {0x2028, 0x202e},      // separators, embeddings and overrides of direction
                                          {0x2060, 0x206f},      // invisible operators, isolates
                                          {0x3164, 0x3164},      // Hangul filler
                                          {0xfeff, 0xfeff},      // byte order mark
                                          {0xffa0, 0xffa0},      // half-width Hangul filler
                                          {0xfff0, 0xfffb},      // annotations
                                          {0x1d173, 0x1d17a},    // musical controls
                                          {0xe0000, 0xe0fff}}};  // tags
  return std::ranges::any_of(ranges, [code](const Range& range) { return code >= range.first && code <= range.last; });
}

// Returns Unicode's name of a character that looks like one of ASCII; "" for others.
std::string lookalike_name(char32_t code) {
  struct Named {
    char32_t code;
    const char* name;
  };
  constexpr std::array<Named, 27> names{{{0x00a0, "no-break space"},
                                         {0x1680, "Ogham space mark"},
                                         {0x2000, "en quad"},
                                         {0x2001, "em quad"},
                                         {0x2002, "en space"},
                                         {0x2003, "em space"},
                                         {0x2004, "three-per-em space"},
                                         {0x2005, "four-per-em space"},
                                         {0x2006, "six-per-em space"},
                                         {0x2007, "figure space"},
                                         {0x2008, "punctuation space"},
                                         {0x2009, "thin space"},
                                         {0x200a, "hair space"},
                                         {0x2010, "hyphen"},
                                         {0x2011, "non-breaking hyphen"},
                                         {0x2012, "figure dash"},
                                         {0x2013, "en dash"},
                                         {0x2014, "em dash"},
                                         {0x2015, "horizontal bar"},
                                         {0x2018, "left single quotation mark"},
                                         {0x2019, "right single quotation mark"},
                                         {0x202f, "narrow no-break space"},
                                         {0x205f, "medium mathematical space"},
                                         {0x2212, "minus sign"},
                                         {0x2215, "division slash"},
                                         {0x3000, "ideographic space"},
                                         {0xfe63, "small hyphen-minus"}}};
  const auto found = std::ranges::find(names, code, &Named::code);
  if (found != names.end()) return found->name;
  // U+FF01 to U+FF5E repeat "!" to "~".
  constexpr char32_t first = 0xff01, last = 0xff5e;
  return code >= first && code <= last ? std::string("full-width ") + static_cast<char>('!' + (code - first)) : "";
}

// Appends an unsigned number in the given format.
void append(std::string& text, const char* format, unsigned number) {
  std::array<char, 24> digits{};
  std::snprintf(digits.data(), digits.size(), format, number);
  text += digits.data();
}

}  // namespace

std::size_t edit_distance(std::string_view a, std::string_view b) {
  // One row of the dynamic programme: row[j] is the distance between a's first i and b's first j
  // characters.
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substitution = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitution});
    }
  }
  return row[b.size()];
}

std::string printable(std::string_view text, bool lines) {
  std::string result;
  for (std::size_t i = 0; i < text.size();) {
    const Character found = character_at(text, i);
    const std::string_view bytes = text.substr(i, found.bytes);
    const bool control = found.code < 0x20 || (found.code >= 0x7f && found.code <= 0x9f);
    if (!found.valid || (control && !(lines && found.code == '\n'))) {
      for (const char byte : bytes) append(result, "\\x%02x", static_cast<unsigned char>(byte));
    } else if (is_hidden(found.code)) {
      append(result, found.code > 0xffff ? "\\U%08x" : "\\u%04x", static_cast<unsigned>(found.code));
    } else {
      result += bytes;
    }
    i += found.bytes;
  }
  return result;
}

std::string quote(std::string_view text) {
  constexpr std::size_t longest = 60;
  std::size_t end = text.size();
  if (end > longest) {
    // Whole characters: of UTF-8, only a character's first byte does not begin with the bits 10.
    for (end = longest; end > longest - 3 && (static_cast<unsigned char>(text[end]) & 0xC0u) == 0x80u;) --end;
  }
  std::string result = "'" + printable(text.substr(0, end)) + (text.size() > longest ? "...'" : "'");
  for (std::size_t i = 0; i < text.size();) {
    const Character found = character_at(text, i);
    const std::string name = found.valid ? lookalike_name(found.code) : "";
    if (!name.empty()) {
      append(result, " (with U+%04X ", static_cast<unsigned>(found.code));
      return result + name + ")";
    }
    i += found.bytes;
  }
  return result;
}

}  // namespace slipbench
