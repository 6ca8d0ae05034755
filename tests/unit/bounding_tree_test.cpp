// The tree of bounds: every item is in it once, within all nodes around it, and walks that leave nodes out miss
// nothing.
#include <algorithm>

#include <gtest/gtest.h>

#include "common/bounding_tree.h"
#include "common/random.h"

namespace brume {
namespace {

std::vector<Bounds3> someBounds(size_t count) {
    Random random(7);
    std::vector<Bounds3> bounds;
    for (size_t i = 0; i < count; ++i) {
        const glm::dvec3 at = 20.0f * random.inBox(), half = glm::abs(random.inBox());
        bounds.push_back({at - half, at + half});
    }
    return bounds;
}

bool meet(const Bounds3& a, const Bounds3& b) {
    return glm::all(glm::lessThanEqual(a.lo, b.hi)) && glm::all(glm::lessThanEqual(b.lo, a.hi));
}

TEST(BoundingTree, HoldsEveryItemOnceWithinItsNodes) {
    for (const size_t count : {0u, 1u, 2u, 3u, 100u, 4096u}) {
        const std::vector<Bounds3> items = someBounds(count);
        const std::vector<BoundingNode> nodes = boundingTree(items);
        ASSERT_EQ(nodes.size(), count == 0 ? 0 : 2 * count - 1);
        std::vector<int> seen(count, 0);
        for (size_t i = 0; i < nodes.size(); ++i) {
            ASSERT_GT(nodes[i].next, i);
            ASSERT_LE(nodes[i].next, nodes.size());
            for (size_t j = i; j < nodes[i].next; ++j) { // those within
                EXPECT_EQ(glm::min(nodes[i].bounds.lo, nodes[j].bounds.lo), nodes[i].bounds.lo);
                EXPECT_EQ(glm::max(nodes[i].bounds.hi, nodes[j].bounds.hi), nodes[i].bounds.hi);
            }
            if (nodes[i].item == BoundingNode::kInner) continue;
            EXPECT_EQ(nodes[i].next, i + 1);
            EXPECT_EQ(nodes[i].bounds.lo, items[nodes[i].item].lo);
            ++seen[nodes[i].item];
        }
        EXPECT_EQ(std::ranges::count(seen, 1), ptrdiff_t(count));
    }
}

TEST(BoundingTree, AWalkFindsWhatAskingAllFindsWithFewerQuestions) {
    const std::vector<Bounds3> items = someBounds(1000);
    const std::vector<BoundingNode> nodes = boundingTree(items);
    Random random(3);
    size_t asked = 0;
    for (int n = 0; n < 200; ++n) {
        const glm::dvec3 at = 20.0f * random.inBox();
        const Bounds3 where{at - 1.0, at + 1.0};
        std::vector<uint32_t> all, walked;
        for (uint32_t i = 0; i < items.size(); ++i)
            if (meet(items[i], where)) all.push_back(i);
        for (size_t i = 0; i < nodes.size(); ++asked) {
            const bool met = meet(nodes[i].bounds, where);
            if (met && nodes[i].item != BoundingNode::kInner) walked.push_back(nodes[i].item);
            i = met ? i + 1 : nodes[i].next;
        }
        std::ranges::sort(walked);
        EXPECT_EQ(walked, all);
    }
    EXPECT_LT(asked / 200, items.size() / 10);
}

// Many items at one place cannot be told apart; the tree is there all the same, and no deeper than it says.
TEST(BoundingTree, TakesEqualItems) {
    const std::vector<Bounds3> items(20'000, {glm::dvec3(1), glm::dvec3(2)});
    const std::vector<BoundingNode> nodes = boundingTree(items);
    EXPECT_EQ(nodes.size(), 39'999u);
    std::vector<uint32_t> ends; // of the nodes around the present one
    size_t deepest = 0;
    for (uint32_t i = 0; i < nodes.size(); ++i) {
        while (!ends.empty() && ends.back() == i) ends.pop_back();
        ends.push_back(nodes[i].next);
        deepest = std::max(deepest, ends.size());
    }
    EXPECT_LE(deepest, 96u);
}

} // namespace
} // namespace brume
