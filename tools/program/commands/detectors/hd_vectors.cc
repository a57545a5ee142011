#include "tools/program/commands/detectors/detector_commands.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <limits>
#include <string_view>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/core/process/regular_file.h"

namespace slipbench {
namespace {

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  for (std::size_t from = 0;;) {
    const std::size_t comma = line.find(',', from);
    cells.push_back(line.substr(from, comma - from));
    if (comma == std::string_view::npos) return cells;
    from = comma + 1;
  }
}

// A column that is read: where it stands, and the largest number that it may hold.
struct Column {
  std::string name;
  std::uint64_t max;
  std::size_t index = 0;
};

std::vector<Column> needed_columns() {
  std::vector<Column> columns{{"n", std::numeric_limits<std::uint64_t>::max()}};
  for (std::size_t p = 0; p < hd::pillar_count; ++p) columns.push_back({fmt::format("L{}", p), hd::level_count - 1});
  columns.push_back({"ctx", hd::context_count - 1});
  return columns;
}

}  // namespace

std::vector<HdVector> read_hd_vectors(const std::string& file) {
  check_regular_file(file);
  std::ifstream stream(file);
  std::string line;
  if (!stream) throw InputError(fmt::format("{}: {}", file, std::strerror(errno)));
  if (!std::getline(stream, line)) throw InputError(fmt::format("{}:1: the file is empty; needed: n, L0 to L8, ctx", file));

  std::vector<Column> columns = needed_columns();
  const std::vector<std::string_view> names = cells_of(line);
  const std::size_t width = names.size();
  for (Column& column : columns) {
    const auto count = std::ranges::count(names, column.name);
    if (count != 1) {
      throw InputError(fmt::format("{}:1: {} column {}; needed: n, L0 to L8, ctx", file, count == 0 ? "no" : "more than one",
                                   quote(column.name)));
    }
    column.index = static_cast<std::size_t>(std::ranges::find(names, column.name) - names.begin());
  }

  std::vector<HdVector> vectors;
  for (std::size_t number = 2; std::getline(stream, line); ++number) {
    const std::vector<std::string_view> cells = cells_of(line);
    if (cells.size() != width)
      throw InputError(fmt::format("{}:{}: {} cells; the header has {}", file, number, cells.size(), width));
    std::array<std::uint64_t, 1 + hd::pillar_count + 1> values{};
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const std::string_view cell = cells[columns[i].index];
      const auto [stop, status] = std::from_chars(cell.data(), cell.data() + cell.size(), values[i]);
      if (status != std::errc{} || stop != cell.data() + cell.size() || values[i] > columns[i].max) {
        throw InputError(fmt::format("{}:{}: {} is {}; allowed: a whole number from 0 to {}", file, number, columns[i].name,
                                     quote(cell), columns[i].max));
      }
    }
    HdVector vector{values[0], {}};
    for (std::size_t p = 0; p < hd::pillar_count; ++p) vector.frame.level[p] = static_cast<std::uint8_t>(values[1 + p]);
    vector.frame.context = static_cast<std::uint8_t>(values.back());
    if (!vectors.empty() && vector.step != vectors.back().step + 1) {
      throw InputError(
          fmt::format("{}:{}: step {} after step {}; a window has no gaps", file, number, vector.step, vectors.back().step));
    }
    vectors.push_back(vector);
  }
  if (stream.bad()) throw InputError(fmt::format("{}: {}", file, std::strerror(errno)));
  return vectors;
}

}  // namespace slipbench
