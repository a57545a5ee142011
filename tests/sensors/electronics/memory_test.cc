// What the electronics carry from one sample to the next is in their memory: copied into another chain, it goes on to the same bits.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/sensors/electronics/model.h"

namespace slipbench {
namespace {

std::vector<float> sample(Electronics& electronics, const SignalModel& model, int tick) {
  std::vector<float> values(model.source.size(), 0.5F);
  electronics.apply(values, 1e-3 * tick);
  return values;
}

void copy_memory(const Electronics& from, const Electronics& to) {
  const auto saved = from.memory(), loaded = to.memory();
  ASSERT_EQ(saved.size(), loaded.size());
  for (std::size_t k = 0; k < saved.size(); ++k) std::copy(saved[k].begin(), saved[k].end(), loaded[k].begin());
}

TEST(ElectronicsMemory, CopiedIntoAnotherChainItGoesOnToTheSameBits) {
  const SignalModel model = two_values_a_source(7);  // an odd number of sources
  std::vector<Named> every_part;
  for (const Entry& entry : electronics_entries()) every_part.push_back(part(entry.name));
  for (const int saved_at : {0, 1, 50}) {
    Electronics lasting(every_part, model, default_key), fresh(every_part, model, default_key),
        used(every_part, model, default_key);
    for (int tick = 0; tick < saved_at; ++tick) sample(lasting, model, tick);
    for (int tick = 0; tick < 33; ++tick) sample(used, model, tick);
    copy_memory(lasting, fresh);
    copy_memory(lasting, used);
    std::vector<float> last;
    for (int tick = saved_at; tick < saved_at + 50; ++tick) {
      const std::vector<float> values = sample(lasting, model, tick);
      ASSERT_EQ(values, sample(fresh, model, tick)) << "tick " << tick << " after " << saved_at;
      ASSERT_EQ(values, sample(used, model, tick)) << "tick " << tick << " after " << saved_at << " in the used chain";
      EXPECT_NE(values, last) << "noise changes from sample to sample";
      last = values;
    }
  }
}

TEST(ElectronicsMemory, IdealElectronicsHaveNone) {
  EXPECT_TRUE(Electronics({}, two_values_a_source(2), default_key).memory().empty());
}

}  // namespace
}  // namespace slipbench
