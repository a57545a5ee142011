// What somebody else's program does with the installed libraries. Exit status 0: the answers are right.
#include "sim/core/quantity.h"
#include "sim/core/random.h"

int main() {
  const double speed = slipbench::parse_quantity("4 mm/s", slipbench::Quantity::speed);
  slipbench::RandomStream one(7, 0, "consumer");
  slipbench::RandomStream same(7, 0, "consumer");
  return speed == 0.004 && one.uniform() == same.uniform() ? 0 : 1;
}
