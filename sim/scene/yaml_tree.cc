#include "sim/scene/yaml_tree.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <fstream>
#include <sstream>
#include <utility>

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include "sim/core/counted.h"
#include "sim/core/error.h"
#include "sim/core/process/regular_file.h"

namespace slipbench {
namespace {

constexpr std::size_t max_depth = 64;

// Builds the tree from yaml-cpp's events and refuses constructs that scenes do not support.
class TreeBuilder : public YAML::EventHandler {
 public:
  TreeBuilder(std::shared_ptr<const std::string> source, bool has_lines) : source_(std::move(source)), has_lines_(has_lines) {}

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (documents_++ > 0) fail(origin_of(mark), "a second YAML document; allowed: one document in a file");
  }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override { add(YamlNode::Kind::null, mark, "", anchor, ""); }

  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override { fail(origin_of(mark), "aliases ('*name') are not allowed"); }

  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, const std::string& value) override {
    if (value.find('\0') != std::string::npos) fail(origin_of(mark), quote(value) + " contains a zero byte");
    add(YamlNode::Kind::scalar, mark, tag, anchor, value);
  }

  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(YamlNode::Kind::sequence, mark, tag, anchor);
  }
  void OnSequenceEnd() override { close(); }

  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, YAML::EmitterStyle::value) override {
    open(YamlNode::Kind::map, mark, tag, anchor);
  }
  void OnMapEnd() override {
    refuse_duplicates(open_.back().node);
    close();
  }

  [[nodiscard]] Origin origin_of(const YAML::Mark& mark) const { return {source_, has_lines_ ? mark.line + 1 : 0, false}; }
  [[nodiscard]] YamlNode& root() { return root_; }

 private:
  // A sequence or map that is still being read.
  struct Open {
    YamlNode node;
    bool has_key = false;  // a map's key has been read, its value is next
    std::string key;
    Origin key_origin;
  };

  [[nodiscard]] bool expects_key() const {
    return !open_.empty() && open_.back().node.kind == YamlNode::Kind::map && !open_.back().has_key;
  }

  [[noreturn]] void refuse_key(const YAML::Mark& mark) const {
    fail(origin_of(mark), "a key that is not text; are all brackets closed?");
  }

  void check_plain(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor) const {
    if (anchor != 0) fail(origin_of(mark), "anchors ('&name') are not allowed");
    // yaml-cpp gives "?" to plain values, "!" to quoted text and "" to the rest; anything else was
    // written by the user.
    if (!tag.empty() && tag != "?" && tag != "!") fail(origin_of(mark), "tags ('!name') are not allowed");
  }

  void open(YamlNode::Kind kind, const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor) {
    check_plain(mark, tag, anchor);
    if (expects_key()) refuse_key(mark);
    if (open_.size() >= max_depth) fail(origin_of(mark), "nested too deeply; allowed: " + std::to_string(max_depth) + " levels");
    Open next;
    next.node.kind = kind;
    next.node.origin = origin_of(mark);
    open_.push_back(std::move(next));
  }

  void close() {
    YamlNode node = std::move(open_.back().node);
    open_.pop_back();
    attach(std::move(node));
  }

  void add(YamlNode::Kind kind, const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, const std::string& text) {
    check_plain(mark, tag, anchor);
    if (expects_key()) {
      if (kind == YamlNode::Kind::null) refuse_key(mark);
      if (text == "<<") fail(origin_of(mark), "merge keys ('<<') are not allowed");
      Open& map = open_.back();
      map.has_key = true;
      map.key = text;
      map.key_origin = origin_of(mark);
      return;
    }
    YamlNode node;
    node.kind = kind;
    node.origin = origin_of(mark);
    node.text = text;
    attach(std::move(node));
  }

  void attach(YamlNode node) {
    if (open_.empty()) {
      root_ = std::move(node);
      return;
    }
    Open& parent = open_.back();
    if (parent.node.kind == YamlNode::Kind::map) {
      node.key = std::move(parent.key);
      node.key_origin = std::move(parent.key_origin);
      // yaml-cpp gives a missing value the position of the next token.
      if (node.kind == YamlNode::Kind::null) node.origin = node.key_origin;
      parent.has_key = false;
    }
    parent.node.children.push_back(std::move(node));
  }

  static void refuse_duplicates(const YamlNode& map) {
    std::vector<const YamlNode*> sorted;
    for (const YamlNode& child : map.children) sorted.push_back(&child);
    std::ranges::stable_sort(sorted, {}, [](const YamlNode* child) -> const std::string& { return child->key; });
    const auto twin =
        std::ranges::adjacent_find(sorted, {}, [](const YamlNode* child) -> const std::string& { return child->key; });
    if (twin == sorted.end()) return;
    const YamlNode& first = **twin;
    const YamlNode& second = **std::next(twin);
    fail(second.key_origin, "duplicate key " + quote(second.key) + ", first at " + first.key_origin.text());
  }

  std::shared_ptr<const std::string> source_;
  bool has_lines_;
  int documents_ = 0;
  std::vector<Open> open_;
  YamlNode root_;
};

// Returns the position of the first byte that is not well-formed UTF-8 or is a control character
// other than tab, line feed and carriage return; npos if all bytes are valid.
std::size_t first_bad_byte(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
  std::size_t i = 0;
  while (i < text.size()) {
    const std::uint8_t lead = byte(i);
    if (lead < 0x80) {
      if ((lead < 0x20 && lead != '\t' && lead != '\n' && lead != '\r') || lead == 0x7f) return i;
      ++i;
      continue;
    }
    const std::size_t length = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
    if (lead < 0xc2 || lead > 0xf4 || i + length > text.size()) return i;
    for (std::size_t j = 1; j < length; ++j) {
      if ((byte(i + j) & 0xc0) != 0x80) return i;
    }
    // Overlong forms, surrogates and code points above U+10FFFF.
    const std::uint8_t second = byte(i + 1);
    if ((lead == 0xe0 && second < 0xa0) || (lead == 0xed && second > 0x9f) || (lead == 0xf0 && second < 0x90) ||
        (lead == 0xf4 && second > 0x8f)) {
      return i;
    }
    i += length;
  }
  return std::string_view::npos;
}

// Returns the first of the adjacent lines, ending with number `line`, that are indented with a
// tab; 0 if that line is not.
int first_tabbed_line(std::string_view text, int line) {
  int first = 0;
  for (int number = 1; number <= line; ++number) {
    const std::string_view current = text.substr(0, text.find('\n'));
    const std::size_t indent = std::min(current.find_first_not_of(" \t"), current.size());
    const bool tabbed = current.substr(0, indent).find('\t') != std::string_view::npos;
    first = !tabbed ? 0 : first == 0 ? number : first;
    text.remove_prefix(std::min(current.size() + 1, text.size()));
  }
  return first;
}

bool is_index(const std::string& part) {
  return !part.empty() && std::ranges::all_of(part, [](char c) { return c >= '0' && c <= '9'; });
}

// Returns the item of `sequence` that `part` selects, or null.
const YamlNode* item_of(const YamlNode& sequence, const std::string& part) {
  std::size_t index = 0;
  if (!is_index(part)) return nullptr;
  const auto result = std::from_chars(part.data(), part.data() + part.size(), index);
  return result.ec == std::errc{} && index < sequence.children.size() ? &sequence.children[index] : nullptr;
}

// Returns the item of `sequence`, named `here` in messages, that `part` selects. Throws InputError
// if `part` selects no item.
const YamlNode& needed_item(const YamlNode& sequence, const std::string& part, const std::string& here, const Origin& origin) {
  if (const YamlNode* item = item_of(sequence, part)) return *item;
  const std::size_t size = sequence.children.size();
  fail(origin, "no item " + quote(part) + " in " + here + "; allowed: " +
                   (size == 0   ? "none, it is empty"
                    : size == 1 ? "0"
                                : "0 to " + std::to_string(size - 1)));
}

std::string joined(std::span<const std::string> parts) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : ".") + part;
  return text;
}

std::string trimmed(std::string_view text) {
  constexpr std::string_view blank = " \t\r";
  const std::size_t first = std::min(text.find_first_not_of(blank), text.size());
  return std::string(text.substr(first, text.find_last_not_of(blank) + 1 - first));
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  for (std::size_t first = 0; first <= line.size();) {
    const std::size_t comma = std::min(line.find(',', first), line.size());
    cells.push_back(trimmed(std::string_view(line).substr(first, comma - first)));
    first = comma + 1;
  }
  return cells;
}

// Target column of the cells of a file's column, and the unit to append to each.
struct Place {
  std::size_t column;
  std::string unit;
};

std::vector<Place> places_of(const std::vector<std::string>& header, const std::vector<TableColumn>& columns, const Origin& at) {
  std::vector<std::string> names;
  for (const TableColumn& column : columns) names.emplace_back(column.name);
  std::vector<Place> places;
  for (const std::string& cell : header) {
    const std::size_t bracket = std::min(cell.find('['), cell.size());
    const std::string name = trimmed(std::string_view(cell).substr(0, bracket));
    const auto found = std::ranges::find(names, name);
    if (found == names.end()) fail(at, "unknown column " + quote(name) + allowed_names(name, names));
    const auto column = static_cast<std::size_t>(found - names.begin());
    if (std::ranges::find(places, column, &Place::column) != places.end()) fail(at, "column " + quote(name) + " appears twice");
    const bool has_unit = bracket < cell.size() && cell.back() == ']';
    if (!has_unit && bracket < cell.size()) fail(at, quote(cell) + " does not end with ']'; allowed: a name, or a name [unit]");
    places.push_back({column, has_unit ? " " + cell.substr(bracket + 1, cell.size() - bracket - 2) : ""});
  }
  return places;
}

YamlNode node_of(YamlNode::Kind kind, const Origin& origin) {
  YamlNode node;
  node.kind = kind;
  node.origin = origin;
  return node;
}

}  // namespace

std::string Origin::text() const {
  std::string result = source ? *source : "";
  if (line > 0) result.append(":").append(std::to_string(line));
  return drawn ? result + " (drawn)" : result;
}

const YamlNode* YamlNode::find(std::string_view name) const {
  if (kind != Kind::map) return nullptr;
  const auto found = std::ranges::find(children, name, &YamlNode::key);
  return found == children.end() ? nullptr : &*found;
}

YamlNode* YamlNode::find(std::string_view name) { return const_cast<YamlNode*>(std::as_const(*this).find(name)); }

std::string described(const YamlNode& node) {
  switch (node.kind) {
    case YamlNode::Kind::null: return "nothing";
    case YamlNode::Kind::scalar: return quote(node.text);
    case YamlNode::Kind::sequence: return "a sequence";
    case YamlNode::Kind::map: return "a map";
  }
  throw std::logic_error("no such kind of node");
}

void fail(const Origin& origin, const std::string& message) { throw InputError(origin.text() + ": " + message); }

YamlNode parse_yaml(const std::string& text, const std::string& source, bool has_lines) {
  const auto shared_source = std::make_shared<const std::string>(source);
  const auto at_line = [&](std::size_t line) { return Origin{shared_source, has_lines ? static_cast<int>(line) : 0, false}; };
  if (text.size() > max_yaml_bytes) {
    fail({shared_source, 0, false}, "longer than " + std::to_string(max_yaml_bytes) + " bytes, the most that is allowed");
  }
  if (const std::size_t bad = first_bad_byte(text); bad != std::string_view::npos) {
    const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(bad), '\n');
    fail(at_line(static_cast<std::size_t>(line)), "byte " + std::to_string(bad) + " is not text; allowed: UTF-8 text");
  }
  if (text.find_first_not_of(" \t\r\n") == std::string::npos) fail(at_line(1), "empty");
  if (text.find('\n') == std::string::npos && text.find('\r') != std::string::npos) {
    fail(at_line(1), "lines end with a carriage return only; expected line feeds, with or without carriage returns");
  }
  TreeBuilder builder(shared_source, has_lines);
  try {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    if (!parser.HandleNextDocument(builder)) fail(at_line(1), "empty");
    while (parser.HandleNextDocument(builder)) {
    }
  } catch (const YAML::Exception& error) {
    if (const int line = first_tabbed_line(text, error.mark.line + 1); line > 0) {
      fail(at_line(static_cast<std::size_t>(line)), "a tab before the first word; indent YAML with spaces");
    }
    fail(builder.origin_of(error.mark), "not valid YAML: " + error.msg);
  }
  return std::move(builder.root());
}

std::vector<std::string> split_path(const std::string& path, const Origin& origin) {
  std::vector<std::string> parts(1);
  for (const char c : path) {
    if (c == '.') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  if (std::ranges::any_of(parts, &std::string::empty) || parts.size() > max_depth) {
    fail(origin, quote(path) + " is not a path; allowed: keys joined by dots, such as 'motion.speed' or 'motion.tilt.0'");
  }
  return parts;
}

const YamlNode* node_at(const YamlNode& root, std::span<const std::string> path) {
  const YamlNode* node = &root;
  for (const std::string& part : path) {
    node = node->kind == YamlNode::Kind::sequence ? item_of(*node, part) : node->find(part);
    if (node == nullptr) return nullptr;
  }
  return node;
}

YamlNode& place_at(YamlNode& root, std::span<const std::string> path, const Origin& origin) {
  YamlNode* node = &root;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const std::string& part = path[i];
    const auto here = [&] { return i == 0 ? std::string("the scene") : quote(joined(path.first(i))); };
    if (node->kind == YamlNode::Kind::sequence) {
      node = const_cast<YamlNode*>(&needed_item(*node, part, here(), origin));
      continue;
    }
    if (node->kind == YamlNode::Kind::scalar) {
      const bool names_it = i > 0 && is_index(path[i - 1]) && node->text == part;
      if (!names_it) fail(origin, "no key " + quote(part) + " in " + here() + ", which is " + described(*node));
      node->kind = YamlNode::Kind::map;
      node->text.clear();
    }
    if (node->kind == YamlNode::Kind::null) {
      if (is_index(part)) fail(origin, "no item " + quote(part) + " in " + here() + ", which the scene does not set");
      node->kind = YamlNode::Kind::map;
      node->origin = origin;
    }
    YamlNode* child = node->find(part);
    if (child == nullptr) {
      YamlNode fresh;
      fresh.key = part;
      fresh.key_origin = origin;
      fresh.origin = origin;
      child = &node->children.emplace_back(std::move(fresh));
    }
    node = child;
  }
  return *node;
}

void remove_at(YamlNode& root, std::span<const std::string> path, const Origin& origin) {
  YamlNode* node = &root;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const std::string& part = path[i];
    const std::string here = i == 0 ? std::string("the scene") : quote(joined(path.first(i)));
    const bool last = i + 1 == path.size();
    if (node->kind == YamlNode::Kind::sequence) {
      const YamlNode& item = needed_item(*node, part, here, origin);
      if (last) {
        fail(origin, here + " is a sequence, which has no keys to remove; allowed: all items that stay, as in " +
                         joined(path.first(i)) + "=[...]");
      }
      node = const_cast<YamlNode*>(&item);
      continue;
    }
    YamlNode* child = node->find(part);
    if (child == nullptr && node->kind != YamlNode::Kind::map) {
      fail(origin, "no key " + quote(part) + " in " + here + ", which is " + described(*node));
    }
    if (child == nullptr) {
      std::vector<std::string> keys;
      for (const YamlNode& other : node->children) keys.push_back(other.key);
      fail(origin, "no key " + quote(part) + " to remove in " + here + allowed_names(part, keys));
    }
    if (last) {
      node->children.erase(node->children.begin() + (child - node->children.data()));
      return;
    }
    node = child;
  }
}

void assign(YamlNode& place, const YamlNode& value) {
  place.kind = value.kind;
  place.origin = value.origin;
  place.text = value.text;
  place.children = value.children;
}

void merge(YamlNode& place, const YamlNode& value) {
  if (place.kind != YamlNode::Kind::map || value.kind != YamlNode::Kind::map) {
    assign(place, value);
    return;
  }
  for (const YamlNode& child : value.children) {
    if (YamlNode* existing = place.find(child.key)) {
      merge(*existing, child);
    } else {
      place.children.push_back(child);
    }
  }
}

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

YamlNode read_csv(const std::string& path, const std::vector<TableColumn>& columns, const Origin& named) {
  try {
    check_regular_file(path, max_yaml_bytes);
  } catch (const InputError& error) {
    fail(named, error.what());
  }
  std::ifstream file(path);
  if (!file)
    fail(named, "cannot read the file " + quote(path) +
                    "; expected the path of a CSV file relative to the scene's folder, in --set to the current folder");
  Origin at{std::make_shared<const std::string>(path), 0};
  YamlNode rows = node_of(YamlNode::Kind::sequence, at);
  std::vector<Place> places;
  for (std::string line; std::getline(file, line);) {
    ++at.line;
    if (trimmed(line).empty()) continue;
    const std::vector<std::string> cells = cells_of(line);
    if (places.empty() && !columns.empty()) {
      places = places_of(cells, columns, at);
      continue;
    }
    if (!columns.empty() && cells.size() != places.size()) {
      fail(at, "a row of " + counted(cells.size(), "cell") + ", but the header has " + std::to_string(places.size()));
    }
    YamlNode row = node_of(YamlNode::Kind::sequence, at);
    row.children.assign(columns.empty() ? cells.size() : columns.size(), node_of(YamlNode::Kind::null, at));
    for (std::size_t i = 0; i < cells.size(); ++i) {
      YamlNode& cell = row.children[columns.empty() ? i : places[i].column];
      cell.kind = YamlNode::Kind::scalar;
      cell.text = cells[i] + (columns.empty() ? "" : places[i].unit);
    }
    rows.children.push_back(std::move(row));
  }
  return rows;
}

}  // namespace slipbench
