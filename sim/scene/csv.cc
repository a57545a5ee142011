#include "sim/scene/csv.h"

#include <algorithm>
#include <fstream>
#include <memory>
#include <string_view>

#include "sim/core/error.h"
#include "sim/core/process/regular_file.h"

namespace slipbench {
namespace {

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

// Where the cells of a file's column go, and what is written behind each.
struct Place {
  std::size_t column;
  std::string unit;
};

std::vector<Place> places_of(const std::vector<std::string>& header, const std::vector<TableColumn>& columns, const Origin& at) {
  std::vector<std::string> names;
  for (const TableColumn& column : columns) names.push_back(column.name);
  std::vector<Place> places;
  for (const std::string& cell : header) {
    const std::size_t bracket = std::min(cell.find('['), cell.size());
    const std::string name = trimmed(std::string_view(cell).substr(0, bracket));
    const auto found = std::ranges::find(names, name);
    if (found == names.end()) fail(at, "unknown column " + quote(name) + allowed_names(name, names));
    const auto column = static_cast<std::size_t>(found - names.begin());
    if (std::ranges::find(places, column, &Place::column) != places.end())
      fail(at, "column " + quote(name) + " stands there twice");
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

YamlNode read_csv(const std::string& path, const std::vector<TableColumn>& columns, const Origin& named) {
  try {
    check_regular_file(path, max_yaml_bytes);
  } catch (const InputError& error) {
    fail(named, error.what());
  }
  std::ifstream file(path);
  if (!file) fail(named, "no file " + quote(path) + " can be read; allowed: the path of a CSV file from the scene's own folder");
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
      fail(at, "a row of " + std::to_string(cells.size()) + " cells; allowed: as the header, " + std::to_string(places.size()));
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
