#include "detectors/hd/memory_files.h"

#include <array>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <system_error>
#include <vector>

#include "tests/detectors/hd/published.h"
#include "tests/detectors/hd/random_frames.h"
#include "tests/expect.h"
#include "tests/files.h"

namespace slipbench::hd {
namespace {

struct MemoryFiles : testing::Test {
  MemoryFiles() {
    saved_.model = {65, 4, Encoding::spatial_temporal, false, Ties::zero, Compat::published_core};
    saved_.quantiser = Quantiser::exact;
    saved_.trained = "hexapod.h5: draw 3";
    saved_.memories = random_memories(saved_.model, 1);
  }

  [[nodiscard]] std::vector<std::string> lines(const std::string& file) const { return lines_of(bytes_of(folder_ + "/" + file)); }

  void write(const std::string& file, const std::vector<std::string>& all) const {
    std::ofstream stream(folder_ + "/" + file);
    for (const std::string& line : all) stream << line << "\n";
  }

  // Returns the error of load() after `change` of the lines of `file`, without the folder's name.
  std::string refusal(const std::string& file, const std::function<void(std::vector<std::string>&)>& change) const {
    save(folder_, saved_);
    std::vector<std::string> all = lines(file);
    change(all);
    write(file, all);
    const std::string message = refusal_of([&] { load(folder_); });
    return message.starts_with(folder_ + "/") ? message.substr(folder_.size() + 1) : message;
  }

  const TemporaryFolder temporary_;
  const std::string root_ = temporary_.path(), folder_ = root_ + "/model";
  SavedModel saved_;
};

TEST_F(MemoryFiles, WhatIsSavedIsLoaded) {
  save(folder_, saved_);
  const SavedModel loaded = load(folder_);
  EXPECT_EQ(loaded.model, saved_.model);
  EXPECT_EQ(loaded.quantiser, saved_.quantiser);
  EXPECT_EQ(loaded.trained, saved_.trained);
  EXPECT_EQ(loaded.memories, saved_.memories);
  EXPECT_EQ(lines("IM.hex").size(), 12U);
  EXPECT_EQ(lines("IM.hex")[11], to_hex(saved_.memories.item[11]));
}

// Any changed or missing bytes give a consistent classifier, or an error that names the file.
TEST_F(MemoryFiles, DamagedMemoriesAreRefusedOrFit) {
  save(folder_, saved_);
  for (std::size_t step = 0; step < 500; ++step) {
    const std::string file = folder_ + "/" + std::array{"AM.hex", "CIM.hex", "CM.hex", "IM.hex", "model.txt"}[step % 5];
    const std::string whole = bytes_of(file);
    std::string damaged = whole;
    if (step % 3 == 0) {
      damaged.resize(whole.size() * step / 500);
    } else {
      damaged[(step * 7919) % whole.size()] ^= static_cast<char>(1 + step % 255);
    }
    std::ofstream(file, std::ios::binary) << damaged;
    const std::string message = refusal_of([&] {
      const SavedModel loaded = load(folder_);
      check(loaded.model, loaded.memories, true);
    });
    EXPECT_TRUE(message == "accepted" || message.starts_with(file)) << step << ": " << message;
    std::ofstream(file, std::ios::binary) << whole;
  }
}

TEST_F(MemoryFiles, AModelIsReplacedWholeAndNothingElseIsLeft) {
  save(folder_, saved_);
  saved_.model.ties = Ties::one;
  save(folder_ + "/", saved_);
  EXPECT_EQ(load(folder_).model.ties, Ties::one);
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root_)) names.push_back(entry.path().filename());
  EXPECT_THAT(names, testing::UnorderedElementsAre("model", "AM.hex", "CIM.hex", "CM.hex", "IM.hex", "model.txt"));
}

// A killed run leaves FOLDER.partial.PID. Linux has no process of a number above 2^22.
TEST_F(MemoryFiles, WhatAKilledRunLeftIsRemoved) {
  const std::string dead = folder_ + ".partial.99999999", alive = folder_ + ".partial.1", other = folder_ + ".partial.99999998";
  for (const std::string& folder : {dead, alive, other}) {
    std::filesystem::create_directories(folder);
    std::ofstream(folder + "/AM.hex") << "00\n";
  }
  std::ofstream(other + "/thesis.tex") << "mine\n";
  save(folder_, saved_);
  EXPECT_FALSE(std::filesystem::exists(dead));
  EXPECT_TRUE(std::filesystem::exists(alive));
  EXPECT_TRUE(std::filesystem::exists(other));
  EXPECT_EQ(load(folder_).model, saved_.model);
}

TEST_F(MemoryFiles, AFolderWithAnythingElseIsNotReplaced) {
  save(folder_, saved_);
  write("thesis.tex", {"years of work"});
  EXPECT_THAT(refusal_of([&] { save(folder_, saved_); }), mentions({"thesis.tex", "model"}));
  EXPECT_EQ(lines("thesis.tex"), std::vector<std::string>{"years of work"});
  EXPECT_THAT(refusal_of([&] { save(folder_ + "/thesis.tex", saved_); }), mentions({"thesis.tex", "folder"}));
}

TEST_F(MemoryFiles, AFolderThatCannotBeWrittenIsRefused) {
  std::ofstream(root_ + "/file") << "in the way";
  EXPECT_THAT(refusal_of([&] { save(root_ + "/file/model", saved_); }), refused_at(root_ + "/file/model", {"Not a directory"}));
}

TEST_F(MemoryFiles, ALinkToAFolderIsNotReplaced) {
  save(folder_, saved_);
  std::filesystem::create_directory_symlink(folder_, root_ + "/link");
  EXPECT_THAT(refusal_of([&] { save(root_ + "/link", saved_); }), mentions({"link", "folder"}));
}

// The second of two renames fails because its source does not exist; the first is undone.
TEST_F(MemoryFiles, AReplacementThatFailsLeavesWhatStoodThere) {
  save(folder_, saved_);
  EXPECT_THROW(replace_folder(root_ + "/nowhere", folder_, root_ + "/stale"), std::system_error);
  EXPECT_EQ(load(folder_).memories, saved_.memories);
  EXPECT_FALSE(std::filesystem::exists(root_ + "/stale"));
}

TEST_F(MemoryFiles, WhatDoesNotFitTogetherIsNotSaved) {
  saved_.memories.associative.clear();
  EXPECT_THAT(refusal_of([&] { save(folder_, saved_); }), mentions({"associative memory", "0", "3"}));
  EXPECT_FALSE(std::filesystem::exists(folder_));
}

TEST_F(MemoryFiles, ShortLongAndGarbledMemoriesAreRefusedWithTheirLine) {
  EXPECT_THAT(refusal("AM.hex", [](auto& all) { all.pop_back(); }), refused_at("AM.hex:3", {"2 lines", "3"}));
  EXPECT_THAT(refusal("CIM.hex", [](auto& all) { all.clear(); }), refused_at("CIM.hex:1", {"0 lines", "21"}));
  EXPECT_THAT(refusal("CM.hex", [](auto& all) { all.push_back(all[0]); }), refused_at("CM.hex:5", {"line", "4"}));
  // 65 bits are 17 digits; the first digit holds one bit.
  EXPECT_THAT(refusal("CIM.hex", [](auto& all) { all[20].pop_back(); }),
              refused_at("CIM.hex:21", {"16 digits", "65 bits", "17"}));
  EXPECT_THAT(refusal("IM.hex", [](auto& all) { all[4] += "0"; }), refused_at("IM.hex:5", {"18 digits", "65 bits", "17"}));
  EXPECT_THAT(refusal("IM.hex", [](auto& all) { all[1][16] = 'x'; }), refused_at("IM.hex:2", {"x", "column 17"}));
  EXPECT_THAT(refusal("AM.hex", [](auto& all) { all[0][0] = '2'; }), refused_at("AM.hex:1", {"2", "65"}));
  EXPECT_THAT(refusal("CM.hex", [](auto& all) { all[3] += "\r"; }), refused_at("CM.hex:4", {"18 digits", "65 bits", "17"}));
  EXPECT_THAT(refusal("IM.hex", [](auto& all) { all.insert(all.end(), 2, all[0]); }), refused_at("IM.hex:13", {"line", "12"}));
  save(folder_, saved_);
  std::filesystem::remove(folder_ + "/CM.hex");
  EXPECT_THAT(refusal_of([&] { load(folder_); }), refused_at(folder_ + "/CM.hex", {"No such file or directory"}));
}

TEST_F(MemoryFiles, GarbledDescriptionsAreRefusedWithTheirLine) {
  EXPECT_THAT(refusal("model.txt", [](auto& all) { all[0] = "slipbench_hd: 2"; }),
              refused_at("model.txt:1", {"slipbench_hd", "2", "1"}));
  EXPECT_THAT(refusal("model.txt", [](auto& all) { all[1] = "dimension: 1e3"; }),
              refused_at("model.txt:2", {"dimension", "1e3"}));
  EXPECT_THAT(refusal("model.txt", [](auto& all) { all[1] = "dimension: 99999999999999999999"; }),
              refused_at("model.txt:2", {"dimension", "99999999999999999999"}));
  EXPECT_THAT(refusal("model.txt", [](auto& all) { all[2] = "window: 0"; }),
              refused_at("model.txt", {"window", "0", "1", "1000"}));
  EXPECT_THAT(refusal("model.txt", [](auto& all) { all[5] = "ties: ones"; }), refused_at("model.txt:6", {"ties", "ones", "one"}));
  EXPECT_THAT(refusal("model.txt", [](auto& all) { all[5] = "ties"; }), refused_at("model.txt:6", {"ties", "key"}));
  EXPECT_THAT(refusal("model.txt", [](auto& all) { all[5] = all[4]; }), refused_at("model.txt:6", {"context_driven", "line 5"}));
  EXPECT_THAT(refusal("model.txt", [](auto& all) { all.erase(all.begin() + 5); }), refused_at("model.txt:9", {"ties"}));
  EXPECT_THAT(refusal("model.txt", [](auto& all) { all.push_back("tie: one"); }), mentions({"model.txt:10", "tie", "ties"}));
}

// The dimension comes from the other lines, wherever the short one is: 68 bits are 17 digits.
TEST_F(MemoryFiles, WithoutADescriptionTheLineThatDiffersIsBlamed) {
  saved_.model.dimension = 68;
  saved_.memories = random_memories(saved_.model, 1);
  for (const char* file : {"AM.hex", "IM.hex"}) {
    save(folder_, saved_);
    std::filesystem::remove(folder_ + "/model.txt");
    EXPECT_EQ(load(folder_, Model{}).model.dimension, 68U);
    std::vector<std::string> all = lines(file);
    all[0].pop_back();
    write(file, all);
    EXPECT_THAT(refusal_of([&] { load(folder_, Model{}); }),
                refused_at(folder_ + "/" + file + ":1", {"16 digits", "68 bits", "17"}));
  }
  for (const char* file : {"AM.hex", "CIM.hex", "CM.hex", "IM.hex"}) write(file, {});
  EXPECT_THAT(refusal_of([&] { load(folder_, Model{}); }), refused_at(folder_, {"dimension", "0", "8", "65535"}));
}

TEST_F(MemoryFiles, PublishedMemoriesNeedAModelFromElsewhere) {
  EXPECT_THROW(load(published_folder), UnnamedModelError);
  EXPECT_THAT(refusal_of([] { load(published_folder); }),
              AllOf(HasSubstr("model.txt: no such file"), HasSubstr("expected a folder that `slipbench train-hd` wrote")));
  const SavedModel published = load(published_folder, published_model("A"));
  EXPECT_EQ(published.model, published_model("A"));
  EXPECT_EQ(published.memories.item.size(), 12U);
  // The published level memory: 25 bits per level.
  for (std::size_t level = 0; level < level_count; ++level) {
    EXPECT_EQ(hamming(published.memories.level[0], published.memories.level[level]), 25 * level);
  }
}

// A chosen operating point is stored in model.txt; nothing is stored if each frame counts for
// itself.
TEST_F(MemoryFiles, KeepTheOperatingPoint) {
  save(folder_, saved_);
  const std::size_t without = lines("model.txt").size();
  saved_.alarm = {5, 1, 3};
  save(folder_, saved_);
  EXPECT_EQ(lines("model.txt").size(), without + 2);
  const network::Alarm alarm = load(folder_).alarm;
  EXPECT_THAT((std::array{alarm.on, alarm.off, alarm.least}), ElementsAre(5U, 1U, 3U));
  saved_.alarm = {0, 1, 1};
  save(folder_, saved_);
  EXPECT_THAT(refusal_of([&] { load(folder_); }), mentions({"on", "0", "1"}));
}

TEST_F(MemoryFiles, AreKnownByNameWhereTheyShip) {
  EXPECT_EQ(memories_folder(default_memories), shipped_memories(default_memories));
  EXPECT_EQ(memories_folder(learnt_memories), shipped_memories(learnt_memories));
  EXPECT_EQ(memories_folder("any/learn_gst_hd"), "any/learn_gst_hd");  // a path that does not exist is an error, never a name
  // A folder of that name must be given as a path, so that a scene, a detector's name and a digest
  // mean the same classifier.
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::create_directory(root_ + "/" + default_memories);
  std::filesystem::current_path(root_);
  EXPECT_EQ(memories_folder(default_memories), shipped_memories(default_memories));
  EXPECT_EQ(memories_folder(std::string("./") + default_memories), std::string("./") + default_memories);
  std::filesystem::current_path(before);
}

}  // namespace
}  // namespace slipbench::hd
