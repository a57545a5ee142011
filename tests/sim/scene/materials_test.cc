#include "sim/scene/catalogues.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace slipbench {
namespace {

TEST(Materials, AreThoseOfTheBenchWithTheirSources) {
  std::set<std::string> names;
  for (const Material& material : material_table()) {
    names.insert(material.name);
    EXPECT_GT(material.mu_kinetic, 0.0) << material.name;
    EXPECT_LE(material.mu_kinetic, material.mu_static) << material.name;
    EXPECT_FALSE(material.source.empty()) << material.name;
  }
  const std::set<std::string> expected{
      "acrylic", "cardboard",           "felt",         "glass",    "masonite",  "paper",    "ptfe",
      "rubber",  "soaped_wavy_acrylic", "wavy_acrylic", "wet_felt", "wet_paper", "wet_ptfe", "wet_rubber"};
  EXPECT_EQ(names, expected);
  EXPECT_EQ(material_table().size(), expected.size());
}

}  // namespace
}  // namespace slipbench
