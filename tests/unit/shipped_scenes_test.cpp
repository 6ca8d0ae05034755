// The scenes that are shipped: each loads, holds its medium and is shown in the gallery.
#include "common/scene.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "server/sim/simulation.h"

namespace brume::shipped_scenes_test {
namespace {

const std::filesystem::path kScenes = "server/scenes"; // tests run in the repository's root

// tau = sum of sigma u sqrt(pi / 50) exp(-50 b^2 / u^2) over the particles, b = distance from the line.
double depthAlong(const Simulation& simulation, glm::vec3 place, glm::vec3 direction) {
    std::vector<gpu::Particle> particles(simulation.liveCount());
    simulation.write(particles);
    double depth = 0;
    for (const gpu::Particle& p : particles) {
        const double u = static_cast<double>(p.scale) * simulation.now().medium.falloff;
        const glm::dvec3 across = glm::cross(glm::dvec3(p.centre - place), glm::dvec3(direction));
        depth += p.sigma_t * u * std::sqrt(std::numbers::pi / 50) * std::exp(-50 * glm::dot(across, across) / (u * u));
    }
    return depth;
}

struct Shipped {
    const char* name;
    uint32_t count; // 0: not laid down
    double depth;   // through the middle, along each axis; 0: not laid down
};

class ShippedScene : public testing::TestWithParam<Shipped> {};

TEST_P(ShippedScene, LoadsAndHoldsItsMedium) {
    const auto& [name, count, depth] = GetParam();
    const Scene scene = loadScene(findScene(name, kScenes));
    EXPECT_EQ(scene.name, name);
    EXPECT_TRUE(count == 0 || scene.medium.count == count);
    const Simulation simulation(scene);
    EXPECT_TRUE(scene.medium.layout == Layout::none || simulation.liveCount() > 0.9 * scene.medium.count);
    const glm::vec3 middle = 0.5f * (simulation.bounds().lo + simulation.bounds().hi);
    if (depth == 0) return;
    for (const glm::vec3 axis : {glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1)})
        EXPECT_NEAR(depthAlong(simulation, middle, axis), depth, 0.3);
}

INSTANTIATE_TEST_SUITE_P(All, ShippedScene,
                         testing::Values(Shipped{"cloud", 500, 3}, Shipped{"cloud-5000", 5000, 4},
                                         Shipped{"cloud-65535", 65535, 4}, Shipped{"tubes", 0, 0},
                                         Shipped{"tubes-union", 0, 0}, Shipped{"props", 0, 0}, Shipped{"cumulus", 0, 0},
                                         Shipped{"plume", 0, 0}, Shipped{"morning", 0, 0}, Shipped{"lamp", 0, 0},
                                         Shipped{"stage", 0, 0}, Shipped{"courtyard", 0, 0}, Shipped{"dusk", 0, 0},
                                         Shipped{"dusty-room", 0, 0}, Shipped{"islands", 0, 0},
                                         Shipped{"smoke-spots", 0, 0}, Shipped{"street", 0, 0},
                                         Shipped{"atrium-mesh", 0, 0}, Shipped{"flythrough", 0, 0},
                                         Shipped{"glass", 0, 0}, Shipped{"cube-and-sphere", 0, 0},
                                         Shipped{"tetrahedra", 0, 0}, Shipped{"flame", 0, 0}),
                         [](const auto& scene) {
                             std::string name = scene.param.name;
                             std::erase(name, '-');
                             return name;
                         });

std::set<std::string> shippedScenes() {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(kScenes))
        if (entry.path().extension() == ".toml") names.insert(entry.path().stem());
    return names;
}

TEST(Shipped, EverySceneIsTestedHere) { EXPECT_EQ(shippedScenes().size(), 23u); }

TEST(Shipped, EverySceneHasARowAndAPictureInTheGallery) {
    std::ifstream in("docs/gallery.md"); // tests run in the source folder
    const std::string page{std::istreambuf_iterator(in), {}};
    for (const std::string& name : shippedScenes()) {
        EXPECT_NE(page.find("| `" + name + "` |"), std::string::npos) << name;
        for (size_t at = page.find("](pictures/scenes/" + name); at != std::string::npos;) {
            const size_t from = at + 2, to = page.find(')', from);
            EXPECT_TRUE(std::filesystem::exists("docs/" + page.substr(from, to - from))) << name;
            at = page.find("](pictures/scenes/" + name, to);
        }
        EXPECT_NE(page.find("](pictures/scenes/" + name), std::string::npos) << name;
    }
}

} // namespace
} // namespace brume::shipped_scenes_test
