#include <gmock/gmock.h>

#include <filesystem>
#include <string>

#include "tests/controllers/rig.h"

namespace slipbench::controllers {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

const std::string folder = SLIPBENCH_TEST_PLUGINS;

std::string file(const std::string& name) { return folder + "/" + name + ".so"; }

std::unique_ptr<Controller> load(const std::string& path, const std::vector<Channel>& channels = papillarray_channels()) {
  return make_controller(named("plugin", {{"library", path}}), {.channels = channels, .preset = 4.0});
}

std::string refused(const std::string& path) {
  return refusal([&] { (void)load(path); });
}

// One count on slip, and no other before the measured position has followed: a gripper that takes three updates moves a count each three.
TEST(Plugin, RunsTheExample) {
  const auto controller = load(file("step_and_wait"));
  const PillarFrame frame = PillarFrame::of_forces(4.1);
  EXPECT_EQ(controller->update(input_of(frame, 20, PadState::non_slip)).position, 20);
  EXPECT_EQ(controller->update(input_of(frame, 20, PadState::incipient)).position, 21);
  EXPECT_EQ(controller->update(input_of(frame, 20, PadState::gross)).position, 21);
  EXPECT_EQ(controller->update(input_of(frame, 21, PadState::gross)).position, 22);
  EXPECT_EQ(controller->update(input_of(frame, 21, PadState::non_slip)).position, 22);
  EXPECT_EQ(controller->update(input_of(frame, 22, PadState::non_slip)).position, 22);
  EXPECT_EQ(controller->update(input_of(PillarFrame::of_forces(3.9), 22)).position, 23) << "below the preset of 4 N";
}

TEST(Plugin, MakesAControllerOfItsOwnEachTime) {
  const auto one = load(file("step_and_wait"));
  const auto other = load(file("step_and_wait"));
  const PillarFrame frame = PillarFrame::of_forces(4.1);
  EXPECT_EQ(one->update(input_of(frame, 20, PadState::gross)).position, 21);
  EXPECT_EQ(other->update(input_of(frame, 30, PadState::gross)).position, 31);
  EXPECT_EQ(one->update(input_of(frame, 20)).position, 21);
}

TEST(Plugin, IsHandedEverything) {
  const auto controller = load(file("echo"));
  std::vector<float> values(2 * pillars * 3);
  values.back() = 7.0F;
  ControlInput input;
  input.slip = {.time = 0.1, .latency = 0.2, .state = PadState::gross, .stuck_fraction = 0.5};
  input.frame = {.time = 0.3, .values = values};
  input.gripper = {.time = 0.4, .position = 42, .moving = false, .stopped = true};
  const GripCommand command = controller->update(input);
  EXPECT_EQ(command.position, 407042);  // preset in tenths, last value, position
  EXPECT_EQ(command.speed, 4321);       // times in tenths: status, frame, latency, slip
  EXPECT_EQ(command.force, 5103);       // stuck fraction, stopped, moving, state
}

TEST(Plugin, IsFoundFromTheWorkingFolderWhenItsNameIsBare) {
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder);
  EXPECT_EQ(refused("step_and_wait.so"), "accepted");
  std::filesystem::current_path(before);
}

TEST(Plugin, RefusesWhatIsNoController) {
  EXPECT_EQ(refusal([] { (void)make("plugin"); }),
            "controller.library: no library is named; allowed: the path of a shared library");
  EXPECT_EQ(refused(file("absent")),
            "controller.library: no file '" + file("absent") + "'; allowed: the path of a shared library");
  const std::string source = SLIPBENCH_SOURCE_DIR "/controllers/plugin_controller.cc";
  EXPECT_THAT(refused(source), AllOf(StartsWith("controller.library: cannot load '" + source + "': "),
                                     HasSubstr("invalid ELF header"), HasSubstr("; allowed: a shared library")));
  const std::string allowed = "; allowed: a library that exports what controllers/plugin_abi.h declares";
  EXPECT_EQ(refused(file("empty")),
            "controller.library: '" + file("empty") + "' has no symbol 'slipbench_controller_abi'" + allowed);
  EXPECT_EQ(refused(file("makes_nothing")),
            "controller.library: '" + file("makes_nothing") + "' has no symbol 'slipbench_make_controller'" + allowed);
  EXPECT_EQ(refused(file("other_version")),
            "controller.library: '" + file("other_version") + "' was built for version 2 of the interface; allowed: 1");
}

TEST(Plugin, MayRefuseASensor) {
  EXPECT_EQ(refusal([] { (void)load(file("echo"), {vector_channel_of("force", "N")}); }),
            "controller.library: '" + file("echo") +
                "' makes no controller for this sensor; allowed: a sensor with channels that it can work with");
}

TEST(Plugin, ThatThrowsIsAtFault) {
  const std::string threw = "controller plugin: '" + file("throws") + "' threw ";
  const auto controller = load(file("throws"));
  EXPECT_EQ(refusal([&] { (void)controller->update(input_of(PillarFrame(), 20)); }),
            threw + "'out of ideas'; allowed: no exceptions");
  EXPECT_EQ(refusal([&] { (void)controller->update(input_of(PillarFrame(), 0)); }), threw + "an exception; allowed: none");
  EXPECT_EQ(refused(file("throws_at_once")),
            "controller plugin: '" + file("throws_at_once") + "' threw 'no controller today'; allowed: no exceptions");
}

}  // namespace
}  // namespace slipbench::controllers
