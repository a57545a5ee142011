#include "detectors/hd/memory_files.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <system_error>
#include <utility>

#include "detectors/hd/words.h"
#include "sim/core/choice.h"
#include "sim/core/counted.h"
#include "sim/core/process/own_library.h"
#include "sim/core/process/regular_file.h"

namespace slipbench::hd {
namespace {

namespace fs = std::filesystem;

constexpr const char* description_file = "model.txt";
constexpr const char* seen_file = "seen.txt";
constexpr std::array<const char*, 4> memory_files{"AM.hex", "CIM.hex", "CM.hex", "IM.hex"};
constexpr std::size_t published_item_rows = 14;
// 21 levels of the largest dimension, 65,535, take 344 kB.
constexpr std::uintmax_t largest_file = 1'000'000;
// Fits the digests of a million trials.
constexpr std::uintmax_t largest_seen = 65'000'000;

constexpr std::array version_words{Choice<int>{"1", 1}};
constexpr std::array<std::pair<const char*, std::size_t network::Alarm::*>, 3> alarm_keys{
    {{"on", &network::Alarm::on}, {"off", &network::Alarm::off}, {"least", &network::Alarm::least}}};
constexpr std::array flag_words{Choice<bool>{"false", false}, Choice<bool>{"true", true}};

std::string at(const fs::path& file, std::size_t line) { return file.string() + ":" + std::to_string(line) + ": "; }

// Returns a file's lines. The last line may lack its newline.
std::vector<std::string> lines_of(const fs::path& file, std::uintmax_t largest = largest_file) {
  check_regular_file(file.string(), largest);
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError(file.string() + ": " + std::generic_category().message(errno));
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  if (stream.bad()) throw InputError(file.string() + ": " + std::generic_category().message(errno));
  return lines;
}

// Returns the most common line length of all memories, so that a short or long line stands out; 0
// if there are no lines.
std::size_t usual_length(const fs::path& folder) {
  std::map<std::size_t, std::size_t> lines_by_length;
  for (const char* file : memory_files) {
    for (const std::string& line : lines_of(folder / file)) ++lines_by_length[line.size()];
  }
  const auto usual = std::ranges::max_element(lines_by_length, {}, [](const auto& entry) { return entry.second; });
  return usual == lines_by_length.end() ? 0 : usual->first;
}

// Reads a memory of `rows` vectors, or of `rows_too`, of which the first `rows` are kept.
std::vector<Hypervector> read_memory(const fs::path& file, std::size_t dimension, std::size_t rows, std::size_t rows_too) {
  const std::vector<std::string> lines = lines_of(file);
  std::vector<Hypervector> memory;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (i == rows_too) throw InputError(at(file, i + 1) + "one line too many; expected " + std::to_string(rows));
    try {
      memory.push_back(from_hex(lines[i], dimension));
    } catch (const InputError& error) {
      throw InputError(at(file, i + 1) + error.what());
    }
  }
  if (memory.size() != rows && memory.size() != rows_too) {
    throw InputError(at(file, lines.size() + 1) + "the file ends after " + counted(lines.size(), "line") + "; expected " +
                     std::to_string(rows));
  }
  memory.resize(rows);
  return memory;
}

// The keys of model.txt, each read once.
class DescriptionReader {
 public:
  explicit DescriptionReader(fs::path file) : file_(std::move(file)) {
    const std::vector<std::string> lines = lines_of(file_);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const std::size_t colon = lines[i].find(": ");
      if (colon == std::string::npos) throw InputError(at(file_, i + 1) + "found " + quote(lines[i]) + "; expected 'key: value'");
      const auto [entry, fresh] = entries_.emplace(lines[i].substr(0, colon), Entry{lines[i].substr(colon + 2), i + 1});
      if (!fresh)
        throw InputError(at(file_, i + 1) + quote(entry->first) + " was already given in line " +
                         std::to_string(entry->second.line));
    }
    line_count_ = lines.size();
  }

  [[nodiscard]] bool has(const std::string& key) const { return entries_.contains(key); }

  // Returns the text of a key.
  const std::string& text(const std::string& key) { return entry(key).text; }

  std::size_t number(const std::string& key, std::size_t least = 0) {
    const Entry& found = entry(key);
    constexpr std::size_t most_digits = 9;
    if (found.text.empty() || found.text.size() > most_digits ||
        found.text.find_first_not_of("0123456789") != std::string::npos) {
      throw InputError(at(file_, found.line) + key + ": found " + quote(found.text) + "; allowed: a whole number");
    }
    const std::size_t number = std::stoul(found.text);
    if (number < least)
      throw InputError(at(file_, found.line) + key + ": found " + found.text + "; allowed: " + std::to_string(least) +
                       " or more");
    return number;
  }

  template <class Words>
  auto word(const std::string& key, const Words& words) {
    const Entry& found = entry(key);
    const auto value = choice_value(words, found.text);
    if (!value)
      throw InputError(at(file_, found.line) + key + ": found " + quote(found.text) +
                       allowed_names(found.text, choice_names(words)));
    return *value;
  }

  // To be called after the last key is read: refuses keys that nothing has read.
  void finish() const {
    for (const auto& [key, entry] : entries_) {
      if (!asked_.contains(key))
        throw InputError(at(file_, entry.line) + "unknown key " + quote(key) + allowed_names(key, asked_));
    }
  }

 private:
  struct Entry {
    std::string text;
    std::size_t line;
  };

  const Entry& entry(const std::string& key) {
    asked_.insert(key);
    const auto found = entries_.find(key);
    if (found == entries_.end()) throw InputError(at(file_, line_count_ + 1) + "the file ends without the key " + quote(key));
    return found->second;
  }

  fs::path file_;
  std::map<std::string, Entry> entries_;
  std::set<std::string> asked_;
  std::size_t line_count_ = 0;
};

SavedModel read_description(const fs::path& file) {
  DescriptionReader reader(file);
  SavedModel saved;
  reader.word("slipbench_hd", version_words);
  saved.model.dimension = reader.number("dimension");
  saved.model.window = reader.number("window");
  saved.model.encoding = reader.word("encoding", encoding_words);
  saved.model.context_driven = reader.word("context_driven", flag_words);
  saved.model.ties = reader.word("ties", ties_words);
  saved.model.compat = reader.word("compat", compat_words);
  saved.quantiser = reader.word("quantiser", quantiser_words);
  for (const auto& [key, frames] : alarm_keys) {
    if (reader.has(key)) saved.alarm.*frames = reader.number(key, 1);
  }
  saved.trained = reader.text("trained");
  reader.finish();
  try {
    check(saved.model);
  } catch (const InputError& error) {
    throw InputError(file.string() + ": " + error.what());
  }
  return saved;
}

std::string description_of(const SavedModel& saved) {
  const Model& model = saved.model;
  std::string text = "slipbench_hd: 1\n";
  const auto line = [&](const char* key, const std::string& value) { text += std::string(key) + ": " + value + "\n"; };
  line("dimension", std::to_string(model.dimension));
  line("window", std::to_string(model.window));
  line("encoding", choice_name(encoding_words, model.encoding));
  line("context_driven", choice_name(flag_words, model.context_driven));
  line("ties", choice_name(ties_words, model.ties));
  line("compat", choice_name(compat_words, model.compat));
  line("quantiser", choice_name(quantiser_words, saved.quantiser));
  for (const auto& [key, frames] : alarm_keys) {
    if (saved.alarm.*frames != 1) line(key, std::to_string(saved.alarm.*frames));
  }
  line("trained", saved.trained);
  return text;
}

std::string hex_lines(const std::vector<Hypervector>& memory) {
  std::string text;
  for (const Hypervector& vector : memory) text += to_hex(vector) + "\n";
  return text;
}

[[noreturn]] void refuse(const std::string& folder, const std::error_code& reason) {
  throw InputError(folder + ": cannot be written: " + reason.message());
}

std::error_code last_error() { return {errno, std::generic_category()}; }

// Removes the slash of "folder/".
fs::path whole_name(const std::string& folder) {
  const fs::path name = fs::absolute(folder).lexically_normal();
  return name.has_filename() ? name : name.parent_path();
}

// Throws InputError if `folder` cannot be made or replaced: it is not a folder, it holds a file not
// in `own_names`, or its parent folder cannot be made or written to.
void check_folder_target(const std::string& folder, const std::vector<std::string>& own_names) {
  const fs::path target = whole_name(folder);
  try {
    if (fs::exists(fs::symlink_status(target))) {
      if (!fs::is_directory(fs::symlink_status(target)))
        throw InputError(target.string() + ": is not a folder; choose a new name, or the folder of a model");
      for (const fs::directory_entry& entry : fs::directory_iterator(target)) {
        const std::string name = entry.path().filename().string();
        if (std::ranges::find(own_names, name) == own_names.end()) {
          throw InputError(target.string() + ": holds " + quote(name) + ", which is not part of a model; choose another name");
        }
      }
    }
    fs::path above = target.parent_path();
    while (!fs::exists(above)) above = above.parent_path();
    if (!fs::is_directory(above)) refuse(target, std::make_error_code(std::errc::not_a_directory));
    if (::access(above.c_str(), W_OK | X_OK) != 0) refuse(target, last_error());
  } catch (const std::system_error& error) {
    refuse(target, error.code());
  }
}

// Removes FOLDER.partial.PID of runs that were killed: folders that contain only `files`, whose process
// does not exist.
void remove_leftovers(const fs::path& target, const std::vector<TextFile>& files) {
  std::error_code error;
  const std::string beginning = target.filename().string() + ".partial.";
  std::vector<fs::path> found;
  for (const fs::directory_entry& entry : fs::directory_iterator(target.parent_path(), error)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(beginning) || !entry.is_directory(error) || entry.is_symlink(error)) continue;
    pid_t process = 0;
    const char* const first = name.data() + beginning.size();
    const auto [end, failure] = std::from_chars(first, name.data() + name.size(), process);
    if (failure != std::errc() || end != name.data() + name.size() || process <= 0) continue;
    if (::kill(process, 0) == 0 || errno != ESRCH) continue;
    found.push_back(entry.path());
  }
  for (const fs::path& folder : found) {
    const fs::directory_iterator entries(folder, error);
    const bool own = !error && std::all_of(begin(entries), end(entries), [&files](const fs::directory_entry& entry) {
      return std::ranges::find(files, entry.path().filename().string(), &TextFile::name) != files.end();
    });
    if (own) fs::remove_all(folder, error);
  }
}

// Writes the files to FOLDER.partial.PID, syncs them and moves that folder into place; makes parent
// folders and removes the old folder. Throws InputError if that fails; the old folder then stays.
// Call check_folder_target() first.
void write_folder(const std::string& folder, const std::vector<TextFile>& files) {
  const fs::path target = whole_name(folder);
  const std::string fresh = target.string() + ".partial." + std::to_string(::getpid());
  const std::string stale = target.string() + ".old." + std::to_string(::getpid());
  remove_leftovers(target, files);
  try {
    fs::create_directories(fresh);
    for (const TextFile& file : files) {
      // Does not follow a link at that name.
      if (!write_synced_file((fs::path(fresh) / file.name).c_str(), O_EXCL, file.text)) throw std::system_error(last_error());
    }
    replace_folder(fresh, target, stale);
  } catch (const std::system_error& error) {
    std::error_code ignored;
    fs::remove_all(fresh, ignored);
    refuse(target, error.code());
  }
  std::error_code error;
  fs::remove_all(stale, error);
  if (error)
    throw InputError(target.string() + ": written, but the previous content is still at " + stale + ": " + error.message());
}

}  // namespace

SavedModel load(const std::string& folder, const std::optional<Model>& unnamed) {
  const fs::path path(folder);
  SavedModel saved;
  std::size_t item_rows_too = item_count;
  if (std::error_code ignored; fs::exists(path / description_file, ignored)) {  // an unreadable file is reported below
    saved = read_description(path / description_file);
  } else {
    const std::size_t digits = usual_length(path);
    if (!unnamed) {
      throw UnnamedModelError(
          (path / description_file).string() +
          ": no such file, and the memories do not say which model they belong to; expected a folder that `slipbench train-hd` wrote");
    }
    saved.model = *unnamed;
    saved.model.dimension = 4 * digits;
    item_rows_too = published_item_rows;
    try {
      check(saved.model);
    } catch (const InputError& error) {
      throw InputError(path.string() + ": most lines have " + counted(digits, "digit") + ": " + error.what());
    }
  }
  const auto read = [&](std::size_t file, std::size_t rows, std::size_t rows_too) {
    return read_memory(path / memory_files[file], saved.model.dimension, rows, rows_too);
  };
  saved.memories.associative = read(0, class_count, class_count);
  saved.memories.level = read(1, level_count, level_count);
  saved.memories.context = read(2, context_count, context_count);
  saved.memories.item = read(3, item_count, item_rows_too);
  return saved;
}

void check_save_target(const std::string& folder) {
  std::vector<std::string> names(memory_files.begin(), memory_files.end());
  names.emplace_back(description_file);
  names.emplace_back(seen_file);
  check_folder_target(folder, names);
}

void save(const std::string& folder, const SavedModel& saved, const std::set<std::string>& seen) {
  check(saved.model, saved.memories, true);
  if (saved.trained.find('\n') != std::string::npos) throw InputError("trained: contains a line break; expected one line");
  check_save_target(folder);
  std::vector<TextFile> files{{memory_files[0], hex_lines(saved.memories.associative)},
                              {memory_files[1], hex_lines(saved.memories.level)},
                              {memory_files[2], hex_lines(saved.memories.context)},
                              {memory_files[3], hex_lines(saved.memories.item)},
                              {description_file, description_of(saved)}};
  if (!seen.empty()) {
    files.push_back({seen_file, ""});
    for (const std::string& digest : seen) files.back().text += digest + "\n";
  }
  write_folder(folder, files);
}

std::optional<std::set<std::string>> seen_by(const std::string& folder) {
  const fs::path file = fs::path(folder) / seen_file;
  if (std::error_code ignored; !fs::exists(file, ignored)) return std::nullopt;
  constexpr std::size_t digits = 64;
  const std::vector<std::string> lines = lines_of(file, largest_seen);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i].size() != digits || lines[i].find_first_not_of("0123456789abcdef") != std::string::npos)
      throw InputError(at(file, i + 1) + "found " + quote(lines[i]) + "; expected the digest of a trial, 64 hexadecimal digits");
  }
  return std::set<std::string>(lines.begin(), lines.end());
}

std::string shipped_memories(const std::string& name) {
  const fs::path folder = fs::path(own_path(SLIPBENCH_HD_MEMORIES)) / name;
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    throw InputError("the included memories " + quote(name) + " are not at " + folder.string() +
                     "; expected a folder with AM.hex, CIM.hex, CM.hex and IM.hex");
  }
  return folder.string();
}

std::string memories_folder(const std::string& name) {
  return name == default_memories || name == learnt_memories ? shipped_memories(name) : name;
}

void replace_folder(const std::string& fresh, const std::string& target, const std::string& stale) {
  const bool stands = fs::exists(target);
  if (stands) fs::rename(target, stale);
  try {
    fs::rename(fresh, target);
  } catch (const fs::filesystem_error&) {
    if (stands) fs::rename(stale, target);
    throw;
  }
}

}  // namespace slipbench::hd
