#include "tools/studies/grid.h"

#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <string_view>
#include <system_error>

#include "sim/core/process/regular_file.h"
#include "tools/base/dataset/checked_dataset.h"
#include "tools/base/dataset/reader.h"
#include "tools/base/files/reject.h"
#include "tools/base/project/project_file.h"
#include "tools/program/catalogue/program_catalogues.h"
#include "tools/program/run/run_trial.h"
#include "tools/program/sweep/run_sweep.h"

namespace slipbench::reproduce {
namespace {

constexpr std::string_view beginning = "slipbench networks of a study, ";

std::string sha256_of(std::string_view bytes) {
  Sha256 sha;
  sha.update(bytes.data(), bytes.size());
  const Digest digest = sha.finish();
  return {reinterpret_cast<const char*>(digest.data()), digest.size()};
}

std::string first_line(const std::string& of) { return fmt::format("{}{}\n", beginning, text_sha256(of)); }

[[noreturn]] void fail_to_write(const std::string& path) {
  reject("cannot write {}: {}", path, std::generic_category().message(errno));
}

std::string bytes_of_file(int file, const std::string& path) {
  struct stat about {};
  if (::fstat(file, &about) != 0) fail_to_write(path);
  std::string bytes(static_cast<std::size_t>(about.st_size), '\0');
  for (std::size_t at = 0; at < bytes.size();) {
    const ssize_t read = ::pread(file, bytes.data() + at, bytes.size() - at, static_cast<off_t>(at));
    if (read <= 0) throw InputError(path + ": cannot be read");
    at += static_cast<std::size_t>(read);
  }
  return bytes;
}

void append_and_sync(int file, std::string_view bytes, const std::string& path) {
  const off_t end = ::lseek(file, 0, SEEK_END);
  if (end < 0 || !write_whole(file, bytes, static_cast<std::uint64_t>(end)) || !sync_file(file)) fail_to_write(path);
}

struct KeptRecord {
  std::uint64_t set = 0, index = 0;
  std::string_view said;
};
constexpr std::size_t head_bytes = 3 * sizeof(std::uint64_t);  // set, number, size
constexpr std::size_t digest_bytes = std::tuple_size_v<Digest>;

// The record at the beginning of the bytes, which it is taken off; none where it is not whole, as the last one of a run that was killed may be. Throws
// InputError where what follows shows that it once was.
std::optional<KeptRecord> take_record(std::string_view& bytes, const std::string& path) {
  std::array<std::uint64_t, 3> head{};
  if (bytes.size() < head_bytes + digest_bytes) return std::nullopt;
  std::memcpy(head.data(), bytes.data(), head_bytes);
  if (head[2] > bytes.size() - head_bytes - digest_bytes) return std::nullopt;
  const std::string_view body = bytes.substr(0, head_bytes + head[2]);
  if (bytes.substr(body.size(), digest_bytes) != sha256_of(body)) {
    if (body.size() + digest_bytes == bytes.size()) return std::nullopt;
    throw InputError(path + ": is damaged before its last network; allowed: delete the file");
  }
  bytes.remove_prefix(body.size() + digest_bytes);
  return KeptRecord{head[0], head[1], body.substr(head_bytes)};
}

}  // namespace

std::string GridCell::command(std::uint64_t seed) const {
  std::string line = "slipbench run " + scene;
  for (const Override& one : overrides) line += fmt::format(" --set '{}={}'", one.path, one.value);
  return fmt::format("{} --seed {}", line, seed);
}

TrialRecord GridTrial::record() const {
  TrialRecord record = run_trial(scene, number, Recording::full, max_record_bytes, &InterruptGuard::flag()).record;
  record.params = params;
  return record;
}

Grid::Grid(std::vector<GridCell> cells, std::uint64_t seed)
    : cells_(std::move(cells)), seed_(seed), catalogues_(program_catalogues()) {
  for (const GridCell& cell : cells_) {
    SceneFile file = SceneFile::load(project_file(cell.scene));
    for (const Override& one : cell.overrides) file.apply(one);
    plans_.emplace_back(file, catalogues_, cell.draws, seed_);
    for (std::size_t trial = 0; trial < plans_.back().size(); ++trial) places_.emplace_back(plans_.size() - 1, trial);
  }
}

void Grid::with_trial(std::size_t index, const std::function<void(const GridTrial&)>& use) const {
  const auto [place, number] = places_[index];
  const GridCell& cell = cells_[place];
  try {
    TrialPlan::Trial planned = plans_[place].trial(number);
    planned.scene.seed = seed_;
    if (cell.change) cell.change(planned.scene);
    Json params = Json::object();
    for (const auto& [path, value] : planned.drawn) params[path] = Json::parse(value);
    use({std::move(planned.scene), place, number, params.dump()});
  } catch (const InputError& error) {
    reject("{}, trial {}: {}; the same{}: {} --trials {} --trial {}", cell.name, number, error.what(),
           cell.change ? ", but for what the name says" : "", cell.command(seed_), plans_[place].size(), number);
  }
}

void with_trials(const std::string& path, const std::function<void(const TrialRecord&)>& use) {
  for_each_trial(checked_dataset(path), [&](const TrialRecord& record) {
    try {
      use(record);
    } catch (const InputError& error) {
      reject("{}: {}", path, error.what());
    }
  });
}

void check_only(const std::vector<std::string>& only, const std::vector<std::string>& names) {
  for (const std::string& name : only) {
    if (std::ranges::find(names, name) != names.end()) continue;
    reject("reproduce: --only: unknown name {}{}", quote(name), allowed_names(name, names));
  }
}

KeptNetworks::KeptNetworks(std::string path, const std::string& of, bool resume)
    : path_(std::move(path)), file_(lock_file(path_)) {
  const std::string bytes = bytes_of_file(file_.get(), path_), line = first_line(of);
  std::string_view left = bytes;
  if (!bytes.empty() && !bytes.starts_with(beginning))
    reject("{} is there and holds no networks of a study; allowed: another name of -o", path_);
  if (resume && !bytes.empty() && !bytes.starts_with(line)) {
    reject(
        "{} is of other options, data, scenes or another build of the program; allowed: with --resume the same command again, or delete the file",
        path_);
  }
  left.remove_prefix(std::min(left.size(), line.size()));
  while (const std::optional<KeptRecord> one = take_record(left, path_)) said_[{one->set, one->index}] = one->said;
  if (!resume && !said_.empty()) {
    reject("{} holds {} networks of a run that did not come to its end; allowed: --resume, or delete the file", path_,
           said_.size());
  }
  const std::size_t whole = bytes.starts_with(line) ? bytes.size() - left.size() : 0;
  if (::ftruncate(file_.get(), static_cast<off_t>(whole)) != 0) fail_to_write(path_);
  if (whole == 0) append_and_sync(file_.get(), line, path_);
}

KeptNetworks::~KeptNetworks() {
  if (said_.empty()) remove();
}

const std::string* KeptNetworks::find(std::size_t index) const {
  const auto found = said_.find({set_, index});
  return found == said_.end() ? nullptr : &found->second;
}

void KeptNetworks::keep(std::size_t index, const std::string& said) {
  const std::array<std::uint64_t, 3> head{set_, index, said.size()};
  std::string record(head_bytes, '\0');
  std::memcpy(record.data(), head.data(), head_bytes);
  record += said;
  record += sha256_of(record);
  append_and_sync(file_.get(), record, path_);
  said_[{set_, index}] = said;
}

void KeptNetworks::remove() { static_cast<void>(::unlink(path_.c_str())); }

}  // namespace slipbench::reproduce
