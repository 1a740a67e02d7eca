// For tests alone, by LD_PRELOAD: MRPT's programs draw the same numbers each time. They seed their generator
// by the clock through this function, which stands in for MRPT's.
#include <mrpt/random/RandomGenerators.h>

void mrpt::random::CRandomGenerator::randomize() {
  randomize(1);
}
