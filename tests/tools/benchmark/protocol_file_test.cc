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
    inside: {clock: 1.2 s, time: 80 ms, speed: 4.368 mm/s, speed_time: 60 ms, travel: 0.2271 mm}
    outside: {clock: 1.1 s, time: 30 ms, speed: 16 mm/s, speed_time: 20 ms, travel: 62 um}
  nib_pad:
    open: [pad]
    disturbed: [nibs]
    loop: [skin]
    mover: pull
    inside: {clock: 1.3 s, time: 0.28 s, force_rate: 11.26, speed_time: 0.08 s, force: 1171 mN}
    outside: {clock: 1.2 s, time: 0.19 s, force_rate: 14.87, speed_time: 0.04 s, force: 0.8 N}
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
  EXPECT_EQ(open.clock, 1.2);
  EXPECT_EQ(open.time, 0.08);
  EXPECT_EQ(open.speed, 0.004368);
  EXPECT_EQ(open.speed_time, 0.06);
  EXPECT_EQ(open.travel, 0.0002271);
  EXPECT_EQ(pulled.mover, "pull");
  EXPECT_EQ(pulled.speed, 11.26);
  EXPECT_EQ(pulled.travel, 1.171);
  EXPECT_EQ(knock.track, Track::open);
  EXPECT_EQ(knock.disturbance, "knock");
  EXPECT_EQ(knock.domain, "disturbed");
  EXPECT_EQ(knock.readers, std::vector<std::string>{"skin"});
  EXPECT_TRUE(std::isnan(knock.clock));
  EXPECT_EQ(loop.track, Track::loop);
  EXPECT_EQ(loop.time, 0.04);
  EXPECT_TRUE(std::isnan(loop.clock));
}

TEST(ProtocolFile, FaultsAreNamedWithTheirLine) {
  EXPECT_THAT(refusal_with("speed: 16 mm/s", "speed: 16 N"), mentions({"p.yaml:7: ", "sensors.taxels.outside.speed", "16 N"}));
  EXPECT_THAT(refusal_with("time: 80 ms", "time: -80 ms"), mentions({"p.yaml:6: ", "sensors.taxels.inside.time"}));
  EXPECT_THAT(refusal_with(", travel: 62 um", ""), mentions({"p.yaml:7: ", "sensors.taxels.outside has no key 'travel'"}));
  EXPECT_THAT(refusal_with("travel: 62 um", "travle: 62 um"), mentions({"p.yaml:7: ", "travle", "travel"}));
  EXPECT_THAT(refusal_with("    loop: [fast]\n", ""), mentions({"p.yaml:", "sensors.taxels has no key 'loop'"}));
  EXPECT_THAT(refusal_with("[nibs]", "nibs"), mentions({"p.yaml:10: ", "sensors.nib_pad.disturbed", "a sequence of names"}));
  EXPECT_THAT(refusal_with("{time: 40 ms}", "40 ms"), mentions({"p.yaml:16: ", "grasps", "40 ms"}));
  EXPECT_THAT(refusal_with("disturbances: [knock]\n", ""), mentions({"p.yaml:", "has no key 'disturbances'"}));
}

}  // namespace
}  // namespace slipbench::benchmark
