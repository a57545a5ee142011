#include "tools/page/page.h"

#include <zlib.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <new>

#include <fmt/format.h>
#include <openssl/evp.h>

#include "sim/core/error.h"
#include "tools/dataset/record/encoder.h"
#include "tools/files/output_file.h"
#include "tools/files/reject.h"

namespace slipbench::page {
namespace {

constexpr std::string_view kind_mark = R"(<meta name="generator" content=")";

// Text that replaces {{marker}}.
struct Part {
  std::string_view marker;
  std::string text;
};

// Returns `html` with its markers replaced, in one pass: inserted text is not searched again.
std::string filled(std::string_view html, const std::vector<Part>& parts) {
  std::string page;
  while (true) {
    const std::size_t open = html.find("{{");
    page += html.substr(0, open);
    if (open == std::string_view::npos) return page;
    const std::size_t close = html.find("}}", open);
    const auto part = std::ranges::find(parts, html.substr(open + 2, close - open - 2), &Part::marker);
    if (part == parts.end()) throw std::logic_error("a page has an unknown marker");
    page += part->text;
    html.remove_prefix(close + 2);
  }
}

// Content of the elements `style` and `script`, whose markers have lines of their own.
std::string on_own_lines(const std::string& text) { return "\n" + text + "\n"; }

// Hash by which Content-Security-Policy permits an inline element: that of its content.
std::string policy_hash(const std::string& content) {
  const Digest digest = text_digest(content);
  return "'sha256-" + base64(digest) + "'";
}

// Only the page's own style and script are applied, whatever text is in the page; the empty icon of
// its tab is a data: URL. Scripts colour marks by style attributes.
std::string policy(const std::string& styles, const std::string& scripts) {
  std::string text = "default-src 'none'; style-src-elem " + policy_hash(on_own_lines(styles));
  if (!scripts.empty()) text += "; style-src-attr 'unsafe-inline'; script-src " + policy_hash(on_own_lines(scripts));
  return text + "; img-src data:; base-uri 'none'; form-action 'none'";
}

// Concatenates all files whose names end in `extension`, in order, a line end after each. A script
// that is not a library's (.min.js) gets its own scope, in which `sb` is the shared object
// `slipbench` of the page.
std::string joined(const std::vector<Asset>& files, std::string_view extension) {
  std::string text;
  for (const Asset& file : files) {
    if (!file.name.ends_with(extension)) continue;
    const bool own_script = extension == ".js" && !file.name.ends_with(".min.js");
    if (own_script) text += "(function(sb) {\n'use strict';\n";
    text.append(embedded(files, file.name)) += '\n';
    if (own_script) text += "})(window.slipbench = window.slipbench || {});\n";
  }
  return text;
}

// `own_styles` follow the shared ones. `scripts`: content of the element `script` in `elements`,
// which follow the body.
std::string skeleton(const Page& page, const std::string& own_styles, std::string body, const std::string& scripts,
                     std::string elements) {
  const std::string styles = joined(assets(), ".css") + own_styles;
  return filled(embedded(assets(), "page.html"), {{"generator", escape_html(page.generator)},
                                                  {"policy", policy(styles, scripts)},
                                                  {"title", escape_html(page.title)},
                                                  {"styles", styles},
                                                  {"body", std::move(body)},
                                                  {"scripts", std::move(elements)}});
}

// The number of four hexadecimal digits.
char32_t hex_number(std::string_view digits) {
  std::uint32_t number = 0;
  std::from_chars(digits.data(), digits.data() + digits.size(), number, 16);
  return number;
}

std::string utf8(char32_t code) {
  const auto low = [code](unsigned shift) { return static_cast<char>(0x80u | (code >> shift & 0x3fu)); };
  if (code < 0x80) return {static_cast<char>(code)};
  if (code < 0x800) return {static_cast<char>(0xc0u | code >> 6u), low(0)};
  if (code < 0x10000) return {static_cast<char>(0xe0u | code >> 12u), low(6), low(0)};
  return {static_cast<char>(0xf0u | code >> 18u), low(12), low(6), low(0)};
}

// JSON as the content of a <script> element. '<' and everything beyond ASCII is escaped, so that no
// content can end the element. Control, invisible and direction characters become texts, \\u202e
// for \u202e: the page shows them.
std::string script_json(const Json& data) {
  const std::string text = data.dump(-1, ' ', true, Json::error_handler_t::replace);
  constexpr std::size_t escape = 6;  // \uXXXX
  std::string safe;
  safe.reserve(text.size());
  for (std::size_t at = 0; at < text.size(); ++at) {
    if (text[at] == '<') {
      safe += "\\u003c";
    } else if (text[at] != '\\') {
      safe += text[at];
    } else if (text[at + 1] != 'u') {
      safe.append(text, at++, 2);
    } else {
      const std::string_view whole = text;
      char32_t code = hex_number(whole.substr(at + 2, 4));
      const bool pair = code >= 0xd800 && code < 0xdc00;  // of UTF-16
      if (pair) code = 0x10000 + ((code - 0xd800) << 10u) + (hex_number(whole.substr(at + escape + 2, 4)) - 0xdc00);
      const std::string character = utf8(code);
      const std::size_t length = pair ? 2 * escape : escape;
      for (std::size_t k = at; k < at + length; ++k) {
        if (text[k] == '\\' && printable(character) != character) safe += '\\';
        safe += text[k];
      }
      at += length - 1;
    }
  }
  return safe;
}

std::string row_html(const std::vector<std::string>& cells, std::string_view tag) {
  std::string html = "<tr>";
  for (const std::string& cell : cells)
    html.append("<").append(tag).append(">") += escape_html(cell) + "</" + std::string(tag) + ">";
  return html + "</tr>\n";
}

std::string note_html(const std::string& text) { return fmt::format("<p class=\"note\">{}</p>\n", escape_html(text)); }

constexpr std::uint16_t not_finite = 0x8000;  // -32768, the one unused code
constexpr double finest_time = 1e-6;          // s
constexpr double largest_code = 2147483647.0;

std::string deflate_base64(const std::vector<std::uint8_t>& bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::vector<std::uint8_t> packed(size);
  if (compress2(packed.data(), &size, bytes.data(), static_cast<uLong>(bytes.size()), 6) != Z_OK) throw std::bad_alloc();
  packed.resize(size);
  return base64(packed);
}

Json packed(const char* codec, std::size_t rows, std::size_t columns, const std::vector<std::uint8_t>& bytes) {
  return {{"codec", codec}, {"rows", rows}, {"columns", columns}, {"data", deflate_base64(bytes)}};
}

}  // namespace

std::string_view embedded(const std::vector<Asset>& files, std::string_view name) {
  const auto found = std::ranges::find(files, name, &Asset::name);
  if (found == files.end()) throw std::logic_error("no embedded file " + std::string(name));
  const std::size_t pointer = found->text.find("# sourceMappingURL=");
  // The comment with the pointer to the source map is the file's last line.
  return found->text.substr(0, pointer == std::string_view::npos ? pointer : found->text.rfind('\n', pointer));
}

std::string escape_html(std::string_view text) {
  std::string safe, shown;
  for (bool more = true; more;) {  // a tab is white space in HTML
    const std::size_t tab = text.find('\t');
    more = tab != std::string_view::npos;
    shown += printable(text.substr(0, tab), true) + (more ? "\t" : "");
    text.remove_prefix(more ? tab + 1 : text.size());
  }
  for (const char c : shown) {
    switch (c) {
      case '&': safe += "&amp;"; break;
      case '<': safe += "&lt;"; break;
      case '>': safe += "&gt;"; break;
      case '"': safe += "&quot;"; break;
      case '\'': safe += "&#39;"; break;
      default: safe += c;
    }
  }
  return safe;
}

std::string compose_page(const Page& page, std::string_view body) { return skeleton(page, "", std::string(body), "", ""); }

std::string compose_drawn_page(const Page& page, const std::vector<Asset>& files, const Json& data,
                               const std::vector<std::pair<std::string, Json>>& later) {
  const auto both = [&](std::string_view extension) { return joined(assets(), extension) + joined(files, extension); };
  const std::string scripts = both(".js");
  std::string elements =
      filled(embedded(assets(), "scripts.html"), {{"data", script_json(data)}, {"licences", both(".txt")}, {"scripts", scripts}});
  for (const auto& [name, value] : later) {
    elements.append(R"(<script type="application/json" id=")").append(name).append("\">") += script_json(value);
    elements += "</script>\n";
  }
  return skeleton(page, joined(files, ".css"), R"(<p class="wait">Unpacking …</p>)", scripts, std::move(elements));
}

bool begins_as_page(std::string_view text, std::string_view generator) {
  const std::size_t mark = text.find(kind_mark);
  return text.starts_with("<!DOCTYPE html>") && mark != std::string_view::npos &&
         text.substr(mark + kind_mark.size()).starts_with(std::string(generator) + "\"");
}

bool begins_as_object(std::string_view text, const PageKind& kind) {
  if (!text.starts_with("{\n")) return false;
  const std::string_view first = text.substr(std::min(text.find_first_not_of(' ', 2), text.size()));
  return std::ranges::any_of(kind.keys, [first](std::string_view key) {
    return !key.empty() && first.starts_with(fmt::format("\"{}\": ", key));  // the second key is empty if a kind has only one
  });
}

std::string json_path(const std::string& html_path) {
  return std::filesystem::path(html_path).replace_extension(".json").string();
}

void check_page_files(const std::string& html_path, const PageKind& kind) {
  if (!html_path.ends_with(".html")) {
    reject("-o {}: {} is an HTML page with a JSON file next to it; the name must end in .html", html_path, kind.what);
  }
  check_text_target(html_path, {}, {kind.page, [&](std::string_view text) { return begins_as_page(text, kind.generator); }});
  check_text_target(json_path(html_path), {}, {kind.json, [&](std::string_view text) { return begins_as_object(text, kind); }});
}

std::vector<std::string> write_page_files(const std::string& html_path, const PageKind& kind, const std::string& page,
                                          const Json& object) {
  check_page_files(html_path, kind);
  write_text_files(
      {{html_path, page}, {json_path(html_path), object.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"}});
  return {html_path, json_path(html_path)};
}

std::string table_html(const TextTable& table) {
  std::string html =
      "<div class=\"scroll\"><table class=\"plain\">\n<thead>" + row_html(table.head, "th") + "</thead>\n<tbody>\n";
  for (const std::vector<std::string>& row : table.rows) html += row_html(row, "td");
  return html + "</tbody></table></div>\n";
}

std::string head_html(std::string_view generator, const std::string& title, const std::vector<std::string>& notes,
                      const std::string& command) {
  std::string html =
      fmt::format("<header class=\"plain\"><p class=\"eyebrow\">{}</p>\n<h1>{}</h1>\n", generator, escape_html(title));
  for (const std::string& note : notes) html += note_html(note);
  if (!command.empty()) html += fmt::format("<p class=\"note\"><code>{}</code></p>\n", escape_html(command));
  return html + "</header>\n";
}

std::string section_html(const std::string& title, const std::string& note, const std::string& content) {
  const std::string said = note.empty() ? "" : note_html(note);
  return fmt::format("<section><h2>{}</h2>\n{}{}</section>\n", escape_html(title), said, content);
}

std::string list_html(const std::vector<std::string>& items) {
  std::string html = "<ul class=\"plain\">\n";
  for (const std::string& item : items) html += "<li>" + escape_html(item) + "</li>\n";
  return html + "</ul>\n";
}

std::string base64(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t piece = std::size_t{3}
                                << 20;  // OpenSSL counts by int; a multiple of 3, so that only the last piece is padded
  std::string text((bytes.size() + 2) / 3 * 4 + 1, '\0');  // OpenSSL ends each piece with a zero
  auto* to = reinterpret_cast<unsigned char*>(text.data());
  for (; !bytes.empty(); bytes = bytes.subspan(std::min(piece, bytes.size())))
    to += EVP_EncodeBlock(to, bytes.data(), static_cast<int>(std::min(piece, bytes.size())));
  text.pop_back();
  return text;
}

Json pack_curves(std::span<const float> values, std::size_t columns, std::size_t stride) {
  const std::size_t all_rows = values.size() / columns;
  const std::size_t rows = (all_rows + stride - 1) / stride;
  double largest = 0.0;
  for (const float value : values) {
    if (std::isfinite(value)) largest = std::max(largest, std::abs(static_cast<double>(value)));
  }
  const double step = largest > 0.0 ? largest / 32767.0 : 1.0;
  std::vector<std::uint8_t> bytes(2 * rows * columns);
  std::uint8_t* const low = bytes.data();
  std::uint8_t* const high = low + rows * columns;
  for (std::size_t column = 0; column < columns; ++column) {
    std::uint16_t previous = 0;
    for (std::size_t row = 0; row < rows; ++row) {
      const float value = values[row * stride * columns + column];
      const std::uint16_t code =
          std::isfinite(value) ? static_cast<std::uint16_t>(static_cast<std::int32_t>(std::lround(value / step))) : not_finite;
      const auto difference = static_cast<std::uint16_t>(code - previous);
      low[column * rows + row] = static_cast<std::uint8_t>(difference & 0xFFU);
      high[column * rows + row] = static_cast<std::uint8_t>(difference >> 8U);
      previous = code;
    }
  }
  Json result = packed("delta16", rows, columns, bytes);
  result["step"] = step;
  return result;
}

Json pack_bytes(std::span<const std::uint8_t> values, std::size_t columns) {
  const std::size_t rows = values.size() / columns;
  std::vector<std::uint8_t> bytes(values.size());
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < columns; ++column) bytes[column * rows + row] = values[row * columns + column];
  }
  return packed("bytes", rows, columns, bytes);
}

Json pack_times(std::span<const double> times) {
  std::vector<std::uint8_t> bytes(4 * times.size());
  double latest = 0.0;
  for (const double time : times) latest = std::max(latest, std::abs(time));
  const double step = std::max(finest_time, latest / largest_code);
  std::uint32_t previous = 0;
  for (std::size_t row = 0; row < times.size(); ++row) {
    const auto code = static_cast<std::uint32_t>(std::lround(times[row] / step));
    const std::uint32_t difference = code - previous;
    for (std::size_t k = 0; k < 4; ++k) {
      bytes[k * times.size() + row] = static_cast<std::uint8_t>((difference >> (8U * k)) & 0xFFU);
    }
    previous = code;
  }
  Json result = packed("delta32", times.size(), 1, bytes);
  result["step"] = step;
  return result;
}

}  // namespace slipbench::page
