// The promise itself: on small random views that no constant was fitted to, what `auto` promises holds.
#include <algorithm>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "common/random.h"
#include "tests/bench/on_device.h"
#include "tests/layer.h"
#include "tools/bench/error.h"
#include "tools/bench/promise.h"
#include "tools/bench/truth.h"
#include "tools/bench/which.h"
#include "tools/random_scene/random_scene.h"

namespace brume::bench {
namespace {

using nlohmann::json;

class PromiseHolds : public OnDevice {};

constexpr double kBudget = 0.005;
// Of so many views. One promise in nineteen breaks of those of docs/results/data/promise.md that no constant comes
// from.
size_t views() { return test::whole() ? 24 : 6; }
size_t mayBreak() { return test::whole() ? 2 : 1; }

// Rows of the first views that are small and whose plan says that the budget holds.
std::vector<json> promised(const gpu::Device& device, const std::filesystem::path& folder, double budget, double flip) {
    PromiseQuestion asked;
    asked.budget = budget, asked.flip = flip, asked.pixels = 150, asked.seconds = 0.3, asked.folder = folder;
    std::vector<json> rows;
    for (uint64_t seed = 1001; rows.size() < views() && seed < 1301; seed += 2) {
        const RandomScene scene = randomScene(seed);
        if (scene.size.x > 500 || scene.points.position.size() > 3000) continue;
        json row = promiseRow(device, builtInCosts(), asked, seed);
        if (row.contains("measured") && row["promised"]) rows.push_back(std::move(row));
    }
    return rows;
}

size_t broken(const std::vector<json>& rows) {
    return size_t(std::ranges::count_if(rows, [](const json& row) {
        return row["measured"] > kBudget || row["measured"] > 1.3 * std::max(row["predicted"].get<double>(), 0.002);
    }));
}

std::string all(const std::vector<json>& rows) {
    std::string text;
    for (const json& row : rows)
        text += row["seed"].dump() + ' ' + row["way"].get<std::string>() + ": " + row["predicted"].dump() + ", " +
                row["measured"].dump() + '\n';
    return text;
}

TEST_F(PromiseHolds, OnSmallRandomViews) {
    BRUME_WHOLE_LAYER_ONLY();
    const std::vector<json> rows = promised(device(), folder("promise-holds"), kBudget, 0.01);
    ASSERT_EQ(rows.size(), views());
    EXPECT_LE(broken(rows), mayBreak()) << all(rows);
}

// With laws that are halved the plan takes what it takes here for twice the budget. FLIP's budget would keep it from
// that.
TEST_F(PromiseHolds, AndNotWithLawsThatAreTooSmall) {
    BRUME_WHOLE_LAYER_ONLY();
    const std::vector<json> rows = promised(device(), folder("promise-breaks"), 2 * kBudget, 1);
    ASSERT_EQ(rows.size(), views());
    EXPECT_GT(broken(rows), 2 * mayBreak()) << all(rows);
}

// A family of media that laws which were fitted to shipped scenes did not know. Members differ in all of this.
struct Family {
    const char* name;
    uint32_t least, most;   // particles
    float extent;           // m, of the cube that they fill
    float smallest, spread; // least scale, m, and the largest over it
    double depth;           // twice the mean optical depth between particles and the light, within a factor of 1.5
};

Case memberOf(const Family& family, Random& random) {
    const uint32_t count = family.least + uint32_t(random.bits() % (family.most - family.least + 1));
    const float scale = family.smallest * random.uniform(1, 1.4f);
    const glm::vec3 to_light = random.direction();
    Case wanted{.size = {160, 90}};
    wanted.set = {std::begin(kMediumAlone), std::end(kMediumAlone)};
    wanted.set.push_back(fmt::format("medium.count={}", count));
    wanted.set.push_back(fmt::format("medium.extent={}", family.extent * random.uniform(0.8f, 1.2f)));
    wanted.set.push_back(fmt::format("medium.scale=[{}, {}]", scale, scale * family.spread));
    wanted.set.push_back(fmt::format("light.to_light=[{}, {}, {}]", to_light.x, to_light.y, to_light.z));
    wanted.set.push_back("medium.extinction=10");
    const Scene scene = sceneOf(wanted);
    const PlanScene plan = planScene(scene, Simulation(scene));
    double depth = 0;
    for (const SampledParticle& p : plan.medium_sample.even()) depth += 2 * p.to_light;
    depth /= double(plan.medium_sample.even().size());
    const double wish = family.depth * double(random.uniform(0.67f, 1.5f));
    wanted.set.back() = fmt::format("medium.extinction={}", 10 * wish / depth);
    return wanted;
}

TEST_F(PromiseHolds, OnFamiliesOfHardMedia) {
    Random random(20, 26);
    Truth truth(folder("promise-families"));
    const uint32_t every = test::whole() ? 1 : 5;
    for (const Family& family :
         {Family{"a soft ball", 1, 1, 1, 6, 1, 2}, Family{"overlapping blobs", 30, 50, 8, 6, 1.5f, 3},
          Family{"a dense cluster", 100, 300, 6, 4, 2, 30}, Family{"blobs of mixed size", 400, 600, 10, 2, 5, 4}})
        for (int i = 0; i < 3; ++i) {
            const Case wanted = memberOf(family, random);
            if (i > 0 && !test::whole()) continue;
            Stage stage(device(), wanted);
            const RadianceImage picture = thinned(stage.picture(stage.pose(), wanted.size), every);
            const MediumError error = mediumError(picture, truth.of(stage, stage.pose(), wanted.size, every), {});
            EXPECT_TRUE(stage.plan().within) << family.name;
            EXPECT_LE(error.medium.relative_rmse, kBudget) << family.name << ": " << summary(stage.plan());
        }
}

} // namespace
} // namespace brume::bench
