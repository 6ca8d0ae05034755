// The hash of settings: what changes it, and which changes of the table do not.
#include "server/sim/settings_hash.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/simulation_scenes.h"

namespace brume {
namespace {

using Settings = std::vector<const SceneSetting*>;

Settings all() { return {liveSettings().begin(), liveSettings().end()}; }

// Settings that a session may have: some at their defaults, some not.
SceneNow session() {
    SceneNow now;
    const SceneParts parts = partsOf(now);
    for (const Change& change : {Change("medium.extinction", 7.0f), Change("medium.phase", "rayleigh"),
                                 Change("light.irradiance", glm::vec3(1, 2, 3)), Change("simulation.paused", true)})
        apply(change, parts);
    return now;
}

Settings without(Settings settings, std::string_view path) {
    EXPECT_EQ(std::erase_if(settings, [&](auto* one) { return one->path == path; }), 1u) << path;
    return settings;
}

TEST(SettingsHash, OfDefaultsIsZero) {
    SceneNow now;
    EXPECT_EQ(hashOf(all(), partsOf(now)), 0u);
    now = session();
    EXPECT_NE(hashOf(all(), partsOf(now)), 0u);
}

// So the table may get a row, or lose it, or be sorted: recordings that were made before stay as they were.
TEST(SettingsHash, IsTheSameForATableWithOneMoreRowAndInAnyOrder) {
    SceneNow now = session();
    const uint64_t hash = hashOf(all(), partsOf(now));
    size_t unused = 0;
    for (const SceneSetting* setting : all()) {
        const bool used = valueOf(*setting, partsOf(now)) != defaultOf(*setting);
        EXPECT_EQ(hashOf(without(all(), setting->path), partsOf(now)) == hash, !used) << setting->path;
        unused += !used;
    }
    EXPECT_EQ(unused, all().size() - 4);
    Settings turned = all();
    std::ranges::reverse(turned);
    EXPECT_EQ(hashOf(turned, partsOf(now)), hash);
    std::ranges::sort(turned, {}, &SceneSetting::path);
    EXPECT_EQ(hashOf(turned, partsOf(now)), hash);
}

TEST(SettingsHash, TellsPathsValuesAndElementsApart) {
    SceneNow thick, fades;
    apply(Change("medium.extinction", 2.0f), partsOf(thick));
    apply(Change("medium.falloff", 2.0f), partsOf(fades));
    const uint64_t hash = hashOf(all(), partsOf(thick));
    EXPECT_NE(hash, hashOf(all(), partsOf(fades))) << "the same value elsewhere";
    apply(Change("medium.extinction", 2.5f), partsOf(thick));
    EXPECT_NE(hash, hashOf(all(), partsOf(thick)));

    Fog fog;
    fog.extinction = 2;
    const auto of = [&](uint32_t element) { return hashOf(liveSettings(SceneList::fogs), {.fog = &fog}, element); };
    EXPECT_NE(of(0), of(1));
}

TEST(SettingsHash, OfAListCountsItsElements) {
    SceneLists lists;
    EXPECT_EQ(hashOf(lists), 0u) << "a kind of list that is new and empty changes nothing";
    lists.fogs.emplace_back();
    const uint64_t one = hashOf(lists);
    lists.fogs.emplace_back();
    EXPECT_NE(hashOf(lists), one);
    lists.fogs.pop_back();
    lists.boxes.emplace_back();
    EXPECT_NE(hashOf(lists), one);
}

} // namespace
} // namespace brume
