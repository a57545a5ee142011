#include "tools/formats/import/source_table.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/api/sensor.h"
#include "sim/core/counted.h"
#include "sim/core/error.h"
#include "sim/core/math/decade.h"
#include "sim/core/process/interrupted.h"
#include "sim/core/process/regular_file.h"
#include "tools/files/reject.h"
#include "tools/registry/sensor_catalogue.h"

namespace slipbench {
namespace {

std::string_view without_blanks(std::string_view cell) {
  const std::size_t first = cell.find_first_not_of(" \t");
  return first == std::string_view::npos ? std::string_view() : cell.substr(first, cell.find_last_not_of(" \t") - first + 1);
}

}  // namespace

SourceTable::SourceTable(const SourceFile& file) : path_(file.path), buffer_(longest_line + 1) {
  check_regular_file(path_);
  stream_.open(path_, std::ios::binary);
  if (!stream_) reject("{}: cannot be opened: {}", path_, std::strerror(errno));
}

bool SourceTable::next() {
  end_if_interrupted();
  stream_.getline(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
  if (stream_.bad()) reject("{}: cannot be read", path_);
  if (stream_.eof() && stream_.gcount() == 0) return false;
  ++line_;
  if (stream_.fail()) fail(fmt::format("is longer than {} bytes; expected lines of text", longest_line));
  std::size_t size = static_cast<std::size_t>(stream_.gcount()) - (stream_.eof() ? 0 : 1);  // getline() counts the line end
  if (size > 0 && buffer_[size - 1] == '\r') --size;
  text_ = {buffer_.data(), size};
  constexpr std::string_view mark = "\xef\xbb\xbf";  // byte order mark that spreadsheets write before UTF-8
  if (line_ == 1 && text_.starts_with(mark)) text_.remove_prefix(mark.size());
  if (text_.empty() && at_end()) {
    --line_;
    return false;
  }
  cells_.clear();
  for (std::size_t from = 0;;) {
    const std::size_t comma = text_.find(',', from);
    cells_.push_back(without_blanks(text_.substr(from, comma - from)));
    if (comma == std::string_view::npos) return true;
    from = comma + 1;
  }
}

bool SourceTable::at_end() { return stream_.eof() || stream_.peek() == std::ifstream::traits_type::eof(); }

void SourceTable::fail(const std::string& what) const { reject("{}:{}: {}", path_, std::max<std::size_t>(1, line_), what); }

void SourceTable::refuse(std::size_t cell, std::string_view name, const std::string& allowed) const {
  fail(fmt::format("column {}, {}, is {}; allowed: {}", cell + 1, name, quote(cells_[cell]), allowed));
}

void SourceTable::expect_header(std::span<const std::string> names) {
  if (!next()) reject("{}:1: the file is empty; expected a header that begins with {}", path_, names.front());
  for (std::size_t i = 0; i < std::min(names.size(), cells_.size()); ++i) {
    if (cells_[i] != names[i]) fail(fmt::format("column {} is called {}; expected '{}'", i + 1, quote(cells_[i]), names[i]));
  }
  expect_cells(names.size());
}

void SourceTable::expect_cells(std::size_t count) const {
  if (cells_.size() != count)
    fail(fmt::format("has {} column{}; expected {}", cells_.size(), cells_.size() == 1 ? "" : "s", count));
}

double SourceTable::number(std::size_t cell, std::string_view name, double least, double most) const {
  const std::string_view text = cells_[cell];
  double number = 0.0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || stop != text.data() + text.size() || !(number >= least && number <= most)) {
    refuse(cell, name, std::abs(least) > 1e30 ? "a number" : fmt::format("a number from {} to {}", least, most));
  }
  return number;
}

float SourceTable::value(std::size_t cell, std::string_view name) const {
  constexpr double most = std::numeric_limits<float>::max();
  return static_cast<float>(number(cell, name, -most, most));
}

int SourceTable::one_of(std::size_t cell, std::string_view name, std::span<const int> allowed) const {
  const std::string_view text = cells_[cell];
  int number = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || stop != text.data() + text.size() || std::ranges::find(allowed, number) == allowed.end()) {
    refuse(cell, name, fmt::format("{}", fmt::join(allowed, ", ")));
  }
  return number;
}

bool SourceTable::flag(std::size_t cell, std::string_view name) const {
  constexpr std::array<int, 2> flags{0, 1};
  return one_of(cell, name, flags) == 1;
}

void SourceTable::expect_room(std::size_t rows, std::size_t row_bytes) const {
  if (rows * row_bytes > largest_recording) {
    fail(fmt::format("is row {} of one recording, which needs more than {} MB; split the file", rows,
                     largest_recording / 1'000'000));
  }
}

TrialRecord make_recording(const Json& params, const std::string& object) {
  TrialRecord record;
  record.material = object;
  record.params = params.dump();
  record.outcome.max_slip_distance = std::numeric_limits<double>::quiet_NaN();
  return record;
}

bool is_plain_name(const std::string& text) {
  try {
    static_cast<void>(nlohmann::json(text).dump());  // throws for invalid UTF-8
  } catch (const nlohmann::json::type_error&) {
    return false;
  }
  return !text.empty() && printable(text) == text;
}

bool is_scalar_channel(const std::string& type, const std::string& channel) {
  const std::vector<Entry> known = pad_catalogues().sensors;
  const auto entry = std::ranges::find(known, type, &Entry::name);
  if (entry == known.end()) return false;
  try {
    const std::unique_ptr<Sensor> sensor = make_sensor({"pad", type, defaults_of(entry->parameters), {}}, 0, 0);
    const auto found = std::ranges::find(sensor->channels(), channel, &Channel::name);
    return found != sensor->channels().end() && found->shape.empty();
  } catch (const InputError&) {  // a type without usable defaults, such as a plugin without its library
    return false;
  }
}

SensorRecord make_imported_sensor(const std::string& name, const std::string& type, double rate, const std::string& frame,
                                  const std::vector<std::string>& channels) {
  SensorRecord record;
  record.name = name;
  record.type = type;
  record.rate = rate;
  record.frame = frame;
  record.labels.truth = false;
  const std::vector<Entry> known = pad_catalogues().sensors;
  const auto entry = std::ranges::find(known, type, &Entry::name);
  if (entry == known.end()) throw std::logic_error("no sensor is called " + type);
  const std::unique_ptr<Sensor> sensor = make_sensor({name, type, defaults_of(entry->parameters), {}}, 0, 0);
  for (const std::string& wanted : channels) {
    const auto channel = std::ranges::find(sensor->channels(), wanted, &Channel::name);
    if (channel == sensor->channels().end()) throw std::logic_error(type + " has no channel " + wanted);
    record.channels.push_back({channel->name, channel->unit, channel->shape, {}});
    record.channel_names.insert(record.channel_names.end(), channel->channel_names.begin(), channel->channel_names.end());
  }
  return record;
}

double resolution_of(std::string_view number) {
  const std::size_t exponent_at = number.find_first_of("eE"), point = number.find('.');
  int exponent = 0;
  if (exponent_at != std::string_view::npos) {
    std::string_view text = number.substr(exponent_at + 1);
    if (text.starts_with('+')) text.remove_prefix(1);
    std::from_chars(text.data(), text.data() + text.size(), exponent);
  }
  const std::size_t decimals = point == std::string_view::npos ? 0 : std::min(number.size(), exponent_at) - point - 1;
  return power_of_ten(exponent - static_cast<int>(decimals));
}

void set_timing(const SourceTable& table, double resolution, SensorRecord& sensor) {
  if (sensor.time.size() < 2)
    table.fail(fmt::format("ends a recording of {}; at least two are needed to determine the rate",
                           counted(sensor.time.size(), "sample")));
  sensor.rate = rate_of(sensor.time, resolution);
  sensor.timing = timing_of(sensor.time, resolution);
}

}  // namespace slipbench
