#include "tools/benchmark/protocol_file.h"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/expect.h"

namespace slipbench::benchmark {
namespace {

// Two sensors, one of which is pulled, and one disturbance.
const std::string text = R"(sensors:
  taxels:
    open: [pad, slow]
    disturbed: [skin]
    loop: [fast]
    real: no recordings
  nib_pad:
    open: [pad]
    disturbed: [nibs]
    loop: [skin]
    mover: pull
    real: two recordings, AUC .9
disturbances: [knock]
grasps: {time: 40 ms}
)";

Protocol read(const std::string& words) { return read_protocol("p-1", SceneFile::from_text(words, "p.yaml")); }

std::string refusal_with(const std::string& before, const std::string& after) {
  std::string changed = text;
  changed.replace(changed.find(before), before.size(), after);
  return refusal_of([&] { read(changed); });
}

// Per sensor: recordings inside and outside; then per disturbance each sensor; then grasps of each.
TEST(ProtocolFile, HasItsSetsInOrder) {
  const Protocol protocol = read(text);
  EXPECT_EQ(protocol.name, "p-1");
  EXPECT_EQ(protocol.real.at("nib_pad"), "two recordings, AUC .9");
  std::vector<std::string> scenes;
  for (const TestSet& one : protocol.held_out) scenes.push_back(one.sensor + " " + one.scene.substr(one.scene.rfind('/') + 1));
  EXPECT_EQ(scenes, (std::vector<std::string>{"taxels open_taxels.yaml", "taxels outside_taxels.yaml",
                                              "nib_pad open_nib_pad.yaml", "nib_pad outside_nib_pad.yaml", "taxels knock.yaml",
                                              "nib_pad knock.yaml", "taxels loop_taxels.yaml", "nib_pad loop_nib_pad.yaml"}));
  const TestSet &open = protocol.held_out[0], &pulled = protocol.held_out[2], &knock = protocol.held_out[4],
                &loop = protocol.held_out[6];
  EXPECT_EQ(open.scene, "scenes/benchmark/p-1/open_taxels.yaml");
  EXPECT_EQ(open.readers, (std::vector<std::string>{"pad", "slow"}));
  EXPECT_EQ(open.domain, "inside");
  EXPECT_EQ(open.mover, "");
  EXPECT_TRUE(std::isnan(open.time));
  EXPECT_EQ(pulled.mover, "pull");
  EXPECT_EQ(knock.track, Track::open);
  EXPECT_EQ(knock.disturbance, "knock");
  EXPECT_EQ(knock.domain, "disturbed");
  EXPECT_EQ(knock.readers, std::vector<std::string>{"skin"});
  EXPECT_TRUE(std::isnan(knock.time));
  EXPECT_EQ(loop.track, Track::loop);
  EXPECT_EQ(loop.time, 0.04);
}

TEST(ProtocolFile, FaultsAreNamedWithTheirLine) {
  EXPECT_THAT(refusal_with("    loop: [fast]\n", ""), mentions({"p.yaml:", "sensors.taxels has no key 'loop'"}));
  EXPECT_THAT(refusal_with("[nibs]", "nibs"), mentions({"p.yaml:9: ", "sensors.nib_pad.disturbed", "a sequence of names"}));
  EXPECT_THAT(refusal_with("time: 40 ms", "time: -40 ms"), mentions({"p.yaml:14: ", "grasps.time"}));
  EXPECT_THAT(refusal_with("mover: pull", "moves: pull"), mentions({"p.yaml:11: ", "moves", "mover"}));
  EXPECT_THAT(refusal_with("{time: 40 ms}", "40 ms"), mentions({"p.yaml:14: ", "grasps", "40 ms"}));
  EXPECT_THAT(refusal_with("disturbances: [knock]\n", ""), mentions({"p.yaml:", "has no key 'disturbances'"}));
}

}  // namespace
}  // namespace slipbench::benchmark
