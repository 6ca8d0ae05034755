// The promise itself: on small random views that no constant was fitted to, what `auto` promises holds.
#include <gtest/gtest.h>

#include "tests/bench/on_device.h"
#include "tools/bench/promise.h"
#include "tools/random_scene/random_scene.h"

namespace brume::bench {
namespace {

using nlohmann::json;

class PromiseHolds : public OnDevice {};

constexpr double kBudget = 0.005;
constexpr size_t kViews = 24;
// Views whose promise may break. On the 275 odd seeds of docs/results/data/promise.md one in twenty does.
constexpr size_t kMayBreak = 3;

// Rows of the first views, by odd seeds, that are small and whose plan says that the budget holds.
std::vector<json> promised(const gpu::Device& device, const std::filesystem::path& folder, double budget, double flip) {
    PromiseQuestion asked;
    asked.budget = budget, asked.flip = flip, asked.pixels = 150, asked.seconds = 0.3, asked.folder = folder;
    std::vector<json> rows;
    for (uint64_t seed = 1001; rows.size() < kViews && seed < 1301; seed += 2) {
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
    const std::vector<json> rows = promised(device(), folder("promise-holds"), kBudget, 0.01);
    ASSERT_EQ(rows.size(), kViews);
    EXPECT_LE(broken(rows), kMayBreak) << all(rows);
}

// With laws that are four times too small the plan takes what it takes here for four times the budget. FLIP's budget
// would keep it from that.
TEST_F(PromiseHolds, AndNotWithLawsThatAreTooSmall) {
    const std::vector<json> rows = promised(device(), folder("promise-breaks"), 4 * kBudget, 1);
    ASSERT_EQ(rows.size(), kViews);
    EXPECT_GT(broken(rows), 2 * kMayBreak) << all(rows);
}

} // namespace
} // namespace brume::bench
