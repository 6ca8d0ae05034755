// Views that are planned for, of many.
#include "server/plan/alike_views.h"

#include <numeric>

#include <gtest/gtest.h>

#include "common/camera.h"

namespace brume::alike_views_test {
namespace {

const MediumExtent kMedium{.lo = glm::vec3(-4), .hi = glm::vec3(4), .deviation = 0.5f};

PlanView at(float distance, uint32_t viewer, uint32_t width = 640) {
    return {lookAt({0, 0, distance}, {0, 0, 0}, 0.8f), width, width * 9 / 16, viewer};
}
PlanView away(float distance, uint32_t viewer) {
    return {lookAt({0, 0, distance}, {0, 0, 2 * distance}, 0.8f), 640, 360, viewer};
}
double pixels(std::span<const PlanView> views) {
    return std::accumulate(views.begin(), views.end(), 0.0, [](double sum, const PlanView& view) {
        return sum + view.weight * view.width * view.height;
    });
}
std::vector<PlanView> many(uint32_t count) {
    std::vector<PlanView> views;
    for (uint32_t i = 0; i < count; ++i) views.push_back(at(10 + float(i * 37 % count), i + 1, i % 2 ? 640 : 320));
    return views;
}

TEST(AlikeViews, FewAreAllPlannedFor) {
    const std::vector<PlanView> views = many(kMostPlanViews);
    const auto few = alikeViews(views, kMedium, {});
    ASSERT_EQ(few.size(), views.size());
    for (size_t i = 0; i < few.size(); ++i) {
        EXPECT_EQ(few[i].viewer, views[i].viewer);
        EXPECT_EQ(few[i].weight, 1);
    }
}

TEST(AlikeViews, OfManyStandForAllPixelsAndForTheNearestAndFarthest) {
    for (const uint32_t count : {9u, 20u, 64u, 1000u}) {
        const std::vector<PlanView> views = many(count);
        const auto few = alikeViews(views, kMedium, {});
        EXPECT_EQ(few.size(), kMostPlanViews);
        EXPECT_NEAR(pixels(few), pixels(views), 1e-6 * pixels(views)) << count;
        const auto largest = [](std::span<const PlanView> all) {
            double most = 0;
            for (const PlanView& view : all) most = std::max(most, projectedDeviation(kMedium, view));
            return most;
        };
        EXPECT_EQ(largest(few), largest(views)) << "none sees the medium larger than those that are planned for";
    }
}

// Whatever most do: a view in the medium, and one that sees it, have views of their kind.
TEST(AlikeViews, OneInTheMediumIsNotLostAmongOthersNorIsOneThatSeesIt) {
    std::vector<PlanView> views = many(200);
    views.push_back(at(1, 1000));
    const auto inside = [](const PlanView& view) { return isInside(kMedium, view.pose.position); };
    EXPECT_EQ(std::ranges::count_if(alikeViews(views, kMedium, {}), inside), 1);

    views.clear();
    for (uint32_t i = 0; i < 200; ++i) views.push_back(away(20, i + 1));
    views.push_back(at(20, 1000));
    const auto few = alikeViews(views, kMedium, {});
    ASSERT_EQ(few.size(), 2u);
    EXPECT_EQ(few[0].weight, 200);
    EXPECT_EQ(few[1].viewer, 1000u);
}

// Its error is the one that the promise is about.
TEST(AlikeViews, OneWhoseLawsAreTooLowIsPlannedFor) {
    const std::vector<PlanView> views = many(64);
    Corrections corrections;
    EXPECT_EQ(corrections.largest(17), 1);
    corrections.learn(17, "slabs", 0.002, {.middle = 3, .low = 2.9, .high = 3.1}, {});
    EXPECT_GT(corrections.largest(17), 2);
    EXPECT_EQ(corrections.largest(18), 1);
    const auto few = alikeViews(views, kMedium, corrections);
    EXPECT_EQ(std::ranges::count(few, 17u, &PlanView::viewer), 1);
}

} // namespace
} // namespace brume::alike_views_test
