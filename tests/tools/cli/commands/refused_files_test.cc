// Files that the program must not open, or whose text must not reach a terminal: every command that
// reads such a file refuses it by name.
#include <sys/stat.h>

#include <fstream>

#include "tests/expect.h"
#include "tests/tools/cli/commands/child_process.h"

namespace slipbench {
namespace {

const std::string stage = SLIPBENCH_SOURCE_DIR "/scenes/papillarray/stage.yaml";
const std::string block = SLIPBENCH_SOURCE_DIR "/scenes/bodies/sliding_block.yaml";
const std::string published = SLIPBENCH_SOURCE_DIR "/tests/detectors/hd/data/published";

struct RefusedFiles : ::testing::Test {
  RefusedFiles() {
    pipe_ = folder_ / "pipe";
    ::mkfifo(pipe_.c_str(), 0600);
  }
  static void expect_refusal(const std::vector<std::string>& arguments, const std::vector<std::string>& words) {
    const ChildResult result = run_program_file(arguments);
    EXPECT_EQ(result.status, 2) << arguments.front();
    EXPECT_THAT(result.err, mentions(words));
  }

  TemporaryFolder folder_;
  std::string pipe_;
};

TEST_F(RefusedFiles, PipesAreRefusedByEveryReader) {
  const std::vector<std::string> a_pipe{pipe_, "a pipe"};
  expect_refusal({"report", pipe_, "-o", folder_ / "a.html"}, a_pipe);
  expect_refusal({"verify", pipe_}, a_pipe);
  expect_refusal({"export", pipe_, "--format", "npz", "-o", folder_ / "out"}, a_pipe);
  expect_refusal({"import", pipe_, "--format", "bts3v2"}, a_pipe);
  expect_refusal({"train-hd", pipe_, "-o", folder_ / "memories"}, a_pipe);
  expect_refusal({"hd", "replay", pipe_, "--memories", published, "--encoder", "paper"}, a_pipe);
  expect_refusal({"run", pipe_}, a_pipe);
  expect_refusal({"run", block, "--set", "model=" + pipe_}, a_pipe);
}

TEST_F(RefusedFiles, PipeAmongTheMemoriesIsRefused) {
  std::filesystem::copy(published, folder_ / "memories");
  std::filesystem::remove(folder_ / "memories/CIM.hex");
  ::mkfifo((folder_ / "memories/CIM.hex").c_str(), 0600);
  expect_refusal({"hd", "replay", published + "/vectors.csv", "--memories", folder_ / "memories", "--encoder", "paper"},
                 {"memories/CIM.hex", "a pipe"});
}

TEST_F(RefusedFiles, LargeMemoryIsRefusedBeforeItIsRead) {
  std::filesystem::copy(published, folder_ / "memories");
  std::filesystem::resize_file(folder_ / "memories/IM.hex", 1'000'001);
  expect_refusal({"hd", "replay", published + "/vectors.csv", "--memories", folder_ / "memories", "--encoder", "paper"},
                 {"memories/IM.hex", "1000001 bytes", "1000000"});
}

TEST_F(RefusedFiles, WhatAModelNamesAndDeclaresIsChecked) {
  const std::string model = folder_ / "model.xml";
  const auto expect_model_refusal = [&](const std::string& text, const std::vector<std::string>& words) {
    std::ofstream(model) << "<mujoco>\n" << text << "</mujoco>\n";
    expect_refusal({"run", block, "--set", "model=" + model}, words);
  };
  expect_model_refusal("<include file=\"pipe\"/>\n", {pipe_, "a pipe"});
  expect_model_refusal("<asset><mesh name=\"m\" file='pipe'/></asset>\n", {pipe_, "a pipe"});
  expect_model_refusal("<asset><hfield name=\"h\" nrow=\"100000\" ncol=\"100000\" size=\"1 1 1 1\"/></asset>\n",
                       {"model.xml:2", "<hfield>", "cells"});
  expect_model_refusal("<worldbody><replicate count=\"1000000000\"><geom size=\"1\"/></replicate></worldbody>\n",
                       {"model.xml:2", "<replicate>", "count"});
  // A thousand copies of a thousand are allowed, but not a thousand of these. Closing tags and
  // empty elements copy nothing.
  expect_model_refusal(
      "<worldbody><replicate count=\"1000\"/><replicate count=\"1000\"></replicate>\n<replicate count=\"1000\">"
      "<replicate count=\"1000\">\n<replicate count=\"2\"><geom size=\"1\"/></replicate></replicate></replicate></worldbody>\n",
      {"model.xml:4", "<replicate>", "count 2000000"});
  std::ofstream(folder_ / "copied.xml") << "<mujoco>\n<replicate count=\"1001\"><geom size=\"1\"/></replicate>\n</mujoco>\n";
  std::ofstream(folder_ / "large.xml") << "<mujoco><size nkey=\"10001\"/></mujoco>\n";
  expect_model_refusal("<worldbody><replicate count=\"1000\"><include file=\"copied.xml\"/></replicate></worldbody>\n",
                       {"copied.xml:2", "<replicate>", "count 1001000"});
  expect_model_refusal("<asset><model name=\"m\" file=\"large.xml\"/></asset>\n", {"large.xml:1", "<size>", "nkey"});
  // Elements that copy nothing do not hide nested ones. A model is counted where it is attached,
  // and a file at the place with the most copies.
  expect_model_refusal(
      "<worldbody><replicate count=\"0\"><replicate count=\"1000001\"><geom size=\"1\"/></replicate></replicate></worldbody>\n",
      {"model.xml:2", "<replicate>", "count 1000001"});
  expect_model_refusal(
      "<asset><model name=\"m\" file=\"copied.xml\"/></asset>\n<worldbody><replicate count=\"1000\"><attach model=\"m\"/>"
      "</replicate></worldbody>\n",
      {"copied.xml:2", "<replicate>", "count 1001000"});
  std::ofstream(folder_ / "again.xml") << "<mujoco><include file=\"copied.xml\"/></mujoco>\n";
  expect_model_refusal(
      "<asset><model name=\"m\" file=\"again.xml\"/></asset>\n<worldbody><replicate count=\"1000\"><include file=\"copied.xml\"/>"
      "</replicate></worldbody>\n",
      {"copied.xml:2", "<replicate>", "count 1001000"});
  std::filesystem::create_directories(folder_ / "robot/assets");
  ASSERT_EQ(mkfifo((folder_ / "robot/assets/mesh.stl").c_str(), 0600), 0);
  std::ofstream(folder_ / "robot/robot.xml")
      << "<mujoco><compiler meshdir=\"assets\"/><asset><mesh file=\"mesh.stl\"/></asset></mujoco>\n";
  expect_model_refusal("<asset><model name=\"m\" file=\"robot/robot.xml\"/></asset>\n", {"robot/assets/mesh.stl", "a pipe"});
  expect_model_refusal("<size nuser_body=\"2000000000\"/>\n", {"model.xml:2", "<size>", "nuser_body"});
  expect_model_refusal("<size memory=\"100G\"/>\n", {"model.xml:2", "<size>", "memory"});
  // Unusual syntax that MuJoCo accepts as XML.
  expect_model_refusal("<!x <!-- ><size\vmemory\f=\f\"100G\"/>\n", {"model.xml:2", "<size>", "memory"});
  expect_model_refusal("< size memory=\"100G\"/>\n", {"model.xml:2", "<size>", "memory"});
  expect_model_refusal("<size memory=\"&#57;9G\"/>\n", {"model.xml:2", "<size>", "memory"});
  expect_model_refusal("<include file=\"&#112;ipe\"/>\n", {"model.xml:2", "file", "&#112;ipe", "entities"});
  // A model of others names no file outside of its folder, whatever the way.
  std::filesystem::create_symlink("/etc/hostname", folder_ / "link.xml");
  const std::string way = std::filesystem::relative("/etc/hostname", folder_ / ".").string();
  for (const std::string& name : {std::string("/etc/hostname"), way, std::string("link.xml")}) {
    expect_model_refusal("<include file=\"" + name + "\"/>\n", {"model.xml:2: file", "outside of the folder"});
  }
  expect_model_refusal("<asset><mesh file=\"hostname\"/></asset>\n<compiler meshdir=\"/etc\"/>\n",
                       {"model.xml:2: file", "outside"});
  // By which rule MuJoCo makes a path of a name does not matter: ".." after a missing folder, a backslash, strippath,
  // and folders that another file of the model names.
  std::filesystem::create_directories(folder_ / "models/far");
  std::filesystem::rename(model, folder_ / "models/model.xml");
  std::ofstream(folder_ / "secret.stl") << "solid a\nendsolid a\n";
  const std::string inner = folder_ / "models/model.xml";
  const auto expect_inner_refusal = [&](const std::string& text, const std::vector<std::string>& words) {
    std::ofstream(inner) << "<mujoco>\n" << text << "</mujoco>\n";
    expect_refusal({"run", block, "--set", "model=" + inner}, words);
  };
  const auto mesh = [](const std::string& file) { return "<asset><mesh name=\"m\" file=\"" + file + "\"/></asset>\n"; };
  const std::vector<std::string> outside{"model.xml:2: file", "secret.stl", "outside of the folder"};
  expect_inner_refusal(mesh("nonexist/../../secret.stl"), outside);
  expect_inner_refusal(mesh("..\\secret.stl"), outside);
  expect_inner_refusal(mesh("nonexist\\..\\..\\secret.stl"), outside);
  expect_inner_refusal(mesh("../../../../none/missing.stl"), {"model.xml:2: file", "missing.stl", "outside"});
  expect_inner_refusal(mesh("a/secret.stl") + "<compiler strippath=\"true\" meshdir=\"..\"/>\n", outside);
  expect_inner_refusal("<include file=\"nonexist/../../secret.stl\"/>\n", outside);
  std::ofstream(folder_ / "models/mesh.xml") << "<mujocoinclude>\n" << mesh("secret.stl") << "</mujocoinclude>\n";
  std::ofstream(folder_ / "models/dirs.xml") << "<mujocoinclude><compiler meshdir=\"..\"/></mujocoinclude>\n";
  const std::vector<std::string> in_part{"mesh.xml:2: file", "secret.stl", "outside of the folder"};
  expect_inner_refusal("<compiler meshdir=\"..\"/><include file=\"mesh.xml\"/>\n", in_part);
  expect_inner_refusal("<include file=\"mesh.xml\"/><include file=\"dirs.xml\"/>\n", in_part);
  expect_inner_refusal(mesh("secret.stl") + "<include file=\"dirs.xml\"/>\n", outside);
  std::ofstream(folder_ / "models/child.xml")
      << "<mujoco><compiler meshdir=\"..\"/><include file=\"mesh.xml\"/><worldbody><body name=\"c\"/></worldbody></mujoco>\n";
  expect_inner_refusal("<asset><model name=\"c\" file=\"child.xml\"/></asset>\n", in_part);
  ASSERT_EQ(mkfifo((folder_ / "models/pipe").c_str(), 0600), 0);
  expect_inner_refusal(mesh("nonexist/../pipe"), {"models/pipe", "a pipe"});
  std::filesystem::rename(inner, model);
  // The sum counts, also over files.
  const std::string large = "<texture type=\"2d\" builtin=\"flat\" width=\"9000\" height=\"9000\"/>";
  std::string several = "<asset>";
  for (int k = 0; k < 5; ++k) several += large;
  std::ofstream(folder_ / "textures.xml") << "<mujocoinclude>" << several << "</asset></mujocoinclude>\n";
  expect_model_refusal(several + "</asset>\n<include file=\"textures.xml\"/>\n", {"model.xml", "textures", "GB in all"});
  // MuJoCo reports no lines of included files.
  std::ofstream(folder_ / "part.xml") << "<mujoco>\n<worldbody>\n<geom tipe=\"box\"/>\n</worldbody>\n</mujoco>\n";
  expect_model_refusal("<include file=\"part.xml\"/>\n", {"geom", folder_ / "part.xml" + ":3"});
}

// A text of the model, and files that are missing by one rule but exist by another.
TEST_F(RefusedFiles, NamesInsideTheFolderAreAccepted) {
  std::string text = bytes_of(SLIPBENCH_SOURCE_DIR "/scenes/bodies/block.xml");
  text.replace(
      text.find("<worldbody>"), 0,
      "<compiler assetdir=\"parts\"/><custom><text name=\"t\" data=\"nan\"/></custom><include file=\"parts/../more.xml\"/>");
  std::filesystem::create_directories(folder_ / "models/parts");
  std::ofstream(folder_ / "models/block.xml") << text;
  std::ofstream(folder_ / "models/more.xml") << "<mujocoinclude><custom><text name=\"u\" data=\"x\"/></custom></mujocoinclude>\n";
  const ChildResult result = run_program_file({"run", block, "--set", "model=" + (folder_ / "models/block.xml"), "--quiet"});
  EXPECT_NE(result.status, 2) << result.err;
}

// The name of a scene file does not make it the caller's own, nor does standard input.
TEST_F(RefusedFiles, SceneMayNameFilesOfItsFolderOnlyWhateverItsName) {
  std::ofstream(folder_ / "secret.csv") << "SECRET\n";
  std::filesystem::create_directory(folder_ / "scenes");
  std::string text = bytes_of(block);
  const std::string_view model = "model: block.xml";
  ASSERT_NE(text.find(model), std::string::npos);
  text.replace(text.find(model), model.size(), "model: " + (folder_ / "secret.csv"));
  for (const std::string& name : {std::string("<a>.yaml"), std::string("--a.yaml"), std::string("<stdin>")}) {
    const std::string scene = folder_ / "scenes/" + name;
    std::ofstream(scene) << text;
    expect_refusal({"run", scene}, {"model", "secret.csv", "outside of the folder"});
  }
  const ChildResult piped = run_shell("slipbench run - < '" + (folder_ / "scenes/<a>.yaml") + "'", folder_ / "scenes");
  EXPECT_EQ(piped.status, 2);
  EXPECT_THAT(piped.err, mentions({"model", "secret.csv", "outside of the folder"}));
  const ChildResult own = run_program_file({"run", block, "--set", "model=" + (folder_ / "secret.csv")});
  EXPECT_THAT(own.err, Not(HasSubstr("outside")));
}

// A text of a file cannot look like a message of the program.
TEST_F(RefusedFiles, TextThatEqualsAMarkDoesNotReachTheTerminal) {
  const std::string scene = folder_ / "a.yaml";
  std::string text = bytes_of(stage);
  const std::string_view words = "PapillArray pressed on acrylic and moved sideways";
  text.replace(text.find(words), words.size(), "\"x\\e[2m\\e[1;31mslipbench:\\e[0m forged\"");
  std::ofstream(scene) << text;
  const ChildResult run = run_program_file({"run", scene, "--set", "duration=0.6 s"});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("x\\x1b[2m\\x1b[1;31mslipbench:"), Not(HasSubstr("\x1b"))));
}

TEST_F(RefusedFiles, ControlCharactersDoNotReachTheTerminal) {
  const ChildResult result = run_program_file({"report", folder_ / "a\x1b[31m\xc2\x9b.h5"});
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err,
              AllOf(HasSubstr(R"(a\x1b[31m\xc2\x9b.h5: no such file)"), Not(HasSubstr("\x1b")), Not(HasSubstr("\xc2\x9b"))));
}

// A name or a description from another person's file. U+202E reverses the text that follows.
TEST_F(RefusedFiles, HiddenCharactersDoNotReachTheTerminal) {
  const std::string scene = folder_ / "a.yaml", hidden = "\xe2\x80\xae";
  std::string text = bytes_of(stage);
  const std::string_view words = "PapillArray pressed on acrylic and moved sideways";
  text.replace(text.find(words), words.size(), "\"gnp." + hidden + "exe\"");
  std::ofstream(scene) << text;
  const ChildResult run = run_program_file({"run", scene, "--set", "duration=0.6 s"});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("gnp.\\u202eexe"), Not(HasSubstr(hidden))));
  const ChildResult json =
      run_program_file({"run", scene, "--set", "duration=0.6 s", "--set", "motion." + hidden + "=1", "--json"});
  EXPECT_THAT(json.err, AllOf(HasSubstr("\\u202e"), Not(HasSubstr(hidden))));
  EXPECT_THAT(run_program_file({"run", stage, "--set", "motion.speed=4\xc2\xa0mm/s"}).err, HasSubstr("U+00A0 no-break space"));
}

// Names that the system accepts, but of which it finds nothing, or that are not UTF-8 (b\xe9ton in
// Latin-1).
TEST_F(RefusedFiles, UnusualPathsAreNoInternalErrors) {
  std::filesystem::create_symlink("loop", folder_ / "loop");
  std::filesystem::create_directory(folder_ / "b\xe9ton");
  const std::string data = folder_ / "b\xe9ton/a.h5";
  ASSERT_EQ(run_program_file({"run", stage, "--set", "duration=0.6 s", "--set", "sensors.pad.rate=100 Hz", "--quiet", "-o", data})
                .status,
            0);
  const std::vector<std::string> loop{"loop", "symbolic links"};
  expect_refusal({"report", folder_ / "loop/a.h5"}, loop);
  expect_refusal({"report", data, "-o", folder_ / "loop/a.html"}, loop);
  expect_refusal({"run", stage, "-o", folder_ / "loop/a.h5"}, loop);
  expect_refusal({"view", folder_ / "loop/a.h5"}, loop);
  expect_refusal({"export", data, "--format", "csv", "-o", folder_ / "loop/out"}, loop);
  const std::string name(300, 'x');
  expect_refusal({"run", stage, "-o", folder_ / name + ".h5"}, {"File name too long"});
  expect_refusal({"export", data, "--format", "parquet", "-o", folder_ / "b\xe9ton/out"}, {"b\\xe9ton", "UTF-8"});
  expect_refusal({"import", folder_ / "b\xe9ton", "--map", "xela_ros"}, {"b\\xe9ton: the name is not UTF-8 (sources)"});
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"verify", data},
                                             {"report", data},
                                             {"eval", data, "--detector", "force_ratio", "--json"},
                                             {"verify", data, "--json"}}) {
    const ChildResult result = run_program_file(words);
    EXPECT_THAT(result.err, Not(HasSubstr("internal error"))) << words.front();
  }
}

TEST_F(RefusedFiles, FolderOfAnUnfinishedDatasetIsNamed) {
  std::filesystem::create_directory(folder_ / "a.h5.partial");
  for (const char* command : {"verify", "report"}) {
    expect_refusal({command, folder_ / "a.h5.partial"}, {"a.h5.partial", "unfinished dataset", folder_ / "a.h5", "--resume"});
    expect_refusal({command, folder_ / "a.h5.partial/"}, {"unfinished dataset"});
  }
  std::ofstream(folder_ / "a.h5.partial/batch.h5") << "x";
  expect_refusal({"verify", folder_ / "a.h5.partial"}, {"a.h5.partial/batch.h5"});
}

// dash counts blocks of 512 bytes: 4 kB are less than a page or a dataset, and more than a message.
TEST_F(RefusedFiles, LimitOfAFilesSizeIsAFullDisk) {
  ASSERT_EQ(run_program_file({"run", stage, "--set", "duration=0.6 s", "--quiet", "-o", folder_ / "a.h5"}).status, 0);
  for (const std::string& words : {std::string("report a.h5 -o b.html"), std::string("export a.h5 --format npz -o b"),
                                   "run " + stage + " --set 'duration=0.6 s' --quiet -o b.h5"}) {
    const ChildResult result = run_shell("ulimit -f 8; slipbench " + words, folder_ / "");
    EXPECT_EQ(result.status, 2) << words;
    EXPECT_THAT(result.err, AllOf(HasSubstr("File too large"), Not(HasSubstr("internal error")))) << words;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_.path())) {
      if (!entry.is_regular_file()) continue;
      EXPECT_THAT(entry.path().filename().string(), Not(HasSubstr("partial"))) << words;
    }
  }
}

// Exit statuses 0, 1 and 2.
TEST_F(RefusedFiles, VerifyTellsByItsStatus) {
  const std::string data = folder_ / "a.h5";
  ASSERT_EQ(run_program_file({"run", stage, "--set", "duration=0.6 s", "sensors.pad.rate=100 Hz", "--quiet", "-o", data}).status,
            0);
  const ChildResult holds = run_program_file({"verify", data});
  EXPECT_EQ(holds.status, 0);
  EXPECT_THAT(holds.out, AllOf(HasSubstr("ok: " + data), HasSubstr("digests"), HasSubstr("cone")));
  EXPECT_EQ(run_program_file({"verify", data, folder_ / "none.h5"}).status, 2);
  expect_refusal({"verify"}, {"verify"});
}

}  // namespace
}  // namespace slipbench
