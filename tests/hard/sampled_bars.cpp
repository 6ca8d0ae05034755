// Bars of methods that take samples of medium and light along a ray: froxels, lit, gradients, march. They are measured
// errors and a half of them more; where a method has the bits of a picture, they are 0.
//
// Not drawn with them, as it would show nothing of them: proxies of tetrahedra (vertices on edges, edge-on, the near
// plane), the closed form of the phase function, and what needs finer nodes than fit (particles of a tenth of a pixel,
// single ones 100 m away, many far apart; the picture of 8192 pixels, whose nodes are those of odd sizes).
#include <algorithm>
#include <stdexcept>

#include "tests/hard/hard.h"

namespace brume::test {
namespace {

// Each begins with the name of its cases. Nodes 0.08 standard deviations apart err by 6e-4 of an extinction, whatever
// samples them: "nodes".
const struct {
    std::string_view cases;
    SampledBar froxels, lit, gradients, march;
} kBars[] = {
    // No medium, no light or no number that changes a sum: bits.
    {"zero extinction", {0}, {0}, {0}, {0}},
    {"light depth 200", {0}, {0}, {0}, {0}},
    {"radiance 10^6", {0}, {0}, {0}, {0}},
    {"world at 10^6 m", {0}, {0}, {0}, {0}},
    {"NaN and infinite places", {0}, {0}, {0}, {0}},
    {"place -0", {0}, {0}, {0}, {0}},
    {"16 identical viewers", {0}, {0}, {0}, {0}},
    {"coincident particles", {0}, {0}, {0}, {0}},
    {"no particle", {1e-6}, {1e-6}, {1e-6}, {1e-6}},
    // Roundings of 1, as with methods that have a closed form.
    {"10^4 layers of depth 1e-4: furnace", {1e-6}, {1e-6}, {1e-6}, {1e-6}},
    {"10^4 layers of depth 1e-3: furnace", {1e-6}, {1e-6}, {1e-6}, {1e-6}},
    {"depth 20 ... 10^4 in one particle: light", {1e-6}, {1e-6}, {1e-6}, {1e-6}},
    {"particles without volume", {1e-6}, {1e-6}, {1e-6}, {1e-6}},
    {"sharp shaft", {1e-5}, {1e-5}, {1e-5}, {1e-5}},
    {"order at 20", {1e-6}, {1e-6}, {1e-6}, {1e-6}},
    // Nodes as fine as fit are a third of a deviation apart over 10 m of layers; of 10 times the depth 10 times that.
    {"10^4 layers of depth 1e-4: transmittance", {6e-3}, {6e-3}, {6e-3}, {6e-3}},
    {"10^4 layers of depth 1e-3: transmittance", {6e-2}, {6e-2}, {6e-2}, {6e-2}},
    // Nodes: 6e-4 of a depth of 1 at most, times its transmittance.
    {"depth 20 ... 10^4 in one particle: transmittance", {2.5e-4}, {2.5e-4}, {2.5e-4}, {2.5e-4}},
    {"camera 2 km away", {6e-4}, {6e-4}, {6e-4}, {6e-4}},
    {"camera inside one particle", {2.6e-4}, {2.6e-4}, {2.6e-4}, {2.6e-4}},
    {"camera inside 1,000 particles", {2.5e-4}, {2.5e-4}, {2.5e-4}, {2.5e-4}},
    {"u = 10^-4 m", {6e-4}, {6e-4}, {6e-4}, {1.4e-4}}, // 512 slices from 0.05 m to the end are 0.0002 m there
    {"u = 10^4 m", {2e-4}, {2e-4}, {2e-4}, {2e-4}},
    {"wall through a particle", {6e-4}, {6e-4}, {6e-4}, {6e-4}},
    // As the exact integral: light of one line that is lost, and nodes.
    {"camera inside 1,000 thin particles", {3.2e-2}, {3.2e-2}, {3.2e-2}, {3.2e-2}},
    // Nodes, and of lit and gradients light that is linear between nodes in place of exponential.
    {"light depth cancels view depth 0.001", {1.3e-3}, {1.3e-3}, {1.3e-3}, {1.3e-3}},
    {"light depth cancels view depth 0.500", {1.3e-3}, {1.3e-3}, {2.1e-3}, {1.3e-3}},
    {"light depth cancels view depth 3.000", {1e-3}, {2.4e-3}, {1.5e-2}, {1e-3}},
    // Light falls by e^40 along a ray: 4e-18 of radiance is less than what any of their steps resolves.
    {"light depth cancels view depth 40.00",
     {kCannot, "steps do not resolve e^-40"},
     {kCannot, "steps do not resolve e^-40"},
     {kCannot, "steps do not resolve e^-40"},
     {kCannot, "steps do not resolve e^-40"}},
    {"light along +Y", {1e-5}, {6e-4}, {5.1e-3}, {1.4e-5}},
    {"g = +-.99", {2.8e-5}, {2.8e-5}, {2.8e-5}, {2.8e-5}},
    {"particle in the shadow", {0.11}, {0.11}, {0.26}, {0.11}},
    {"particle larger than a slice", {2.6e-4}, {2.6e-4}, {2.6e-4}, {2.6e-4}}, // of the map, as for all methods
    // A step of 2 cm changes as much as the depth itself may there.
    {"moving through a particle, 2 cm", {0.3}, {0.3}, {0.3}, {0.3}},
    {"moving through a particle: change", {0.7}, {0.7}, {0.7}, {0.7}},
    {"slow orbit", {1e-4}, {1e-4}, {1e-4}, {1e-4}},
};

} // namespace

SampledBar barOf(const std::string& hard_case, const Way& way) {
    const auto* const row =
        std::ranges::find_if(kBars, [&](const auto& bar) { return hard_case.starts_with(bar.cases); });
    if (row == std::end(kBars)) throw std::out_of_range(hard_case + " has no bars for " + way.name());
    if (way.method == "froxels") return row->froxels;
    if (way.method == "lit") return row->lit;
    return way.method == "gradients" ? row->gradients : row->march;
}

} // namespace brume::test
