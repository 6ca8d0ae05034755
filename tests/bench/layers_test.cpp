// A slow camera and pictures that arrive five times a second: what is redrawn from layers with depth does not pop.
#include <algorithm>

#include "tests/bench/on_device.h"
#include "tools/bench/layers_over_time.h"

namespace brume::bench {
namespace {

double largest(const std::vector<double>& jumps) { return *std::ranges::max_element(jumps); }

class LayersTest : public OnDevice {};

// In props objects hide others, and in cloud there is nothing but the medium.
TEST_F(LayersTest, ASlowCameraSeesNoArrivals) {
    LayersQuestion question;
    question.size = {160, 90};
    for (const auto& [scene, path] :
         {std::pair{"cloud", Path{"walks", 0.3f}}, std::pair{"props", Path{"orbits", 0, 5}}}) {
        Case one;
        one.scene = scene;
        one.size = question.size;
        Stage stage(device(), one, question.ticks);
        const Jumps jumps = arrivalJumps(stage, question, path);
        EXPECT_LT(largest(jumps.blended), 2.5 * largest(jumps.truth)) << scene;
        EXPECT_LT(largest(jumps.blended), 0.7 * largest(jumps.layers)) << scene;
        EXPECT_GT(largest(jumps.stays), 1.5 * largest(jumps.truth)) << scene << ": old pictures do pop";
    }
}

} // namespace
} // namespace brume::bench
