#include "common/bounding_tree.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace brume {
namespace {

constexpr int kMostSplits = 64; // by surfaces, on the way to any item

double surface(const Bounds3& b) {
    const glm::dvec3 size = b.hi - b.lo;
    return size.x * size.y + size.y * size.z + size.z * size.x;
}

class Builder {
public:
    explicit Builder(std::span<const Bounds3> items) : items_(items), order_(items.size()), behind_(items.size()) {
        std::iota(order_.begin(), order_.end(), 0);
        nodes_.reserve(2 * items.size());
    }

    std::vector<BoundingNode> build() {
        if (!items_.empty()) add(order_, 0);
        return std::move(nodes_);
    }

private:
    void add(std::span<uint32_t> items, int depth) {
        const size_t at = nodes_.size();
        nodes_.emplace_back();
        for (const uint32_t item : items) nodes_[at].bounds.add(items_[item]);
        if (items.size() == 1) {
            nodes_[at].item = items[0];
        } else {
            const size_t half = depth < kMostSplits ? split(items) : items.size() / 2;
            add(items.first(half), depth + 1);
            add(items.subspan(half), depth + 1);
        }
        nodes_[at].next = uint32_t(nodes_.size());
    }

    // Sorts the items so that the first ones, whose number it returns, are one half.
    size_t split(std::span<uint32_t> items) {
        double least = std::numeric_limits<double>::infinity();
        int best_axis = 0;
        size_t best = items.size() / 2;
        for (int axis = 0; axis < 3; ++axis) {
            sort(items, axis);
            Bounds3 bounds;
            for (size_t i = items.size() - 1; i > 0; --i) { // behind_[i]: surface of items from i on
                bounds.add(items_[items[i]]);
                behind_[i] = surface(bounds);
            }
            bounds = {};
            for (size_t i = 1; i < items.size(); ++i) {
                bounds.add(items_[items[i - 1]]);
                const double cost = surface(bounds) * double(i) + behind_[i] * double(items.size() - i);
                if (cost >= least) continue;
                least = cost;
                best_axis = axis;
                best = i;
            }
        }
        sort(items, best_axis);
        return best;
    }

    void sort(std::span<uint32_t> items, int axis) const {
        std::ranges::sort(items, [&](uint32_t a, uint32_t b) {
            const double at_a = items_[a].lo[axis] + items_[a].hi[axis], at_b = items_[b].lo[axis] + items_[b].hi[axis];
            return at_a < at_b || (at_a == at_b && a < b);
        });
    }

    std::span<const Bounds3> items_;
    std::vector<uint32_t> order_;
    std::vector<double> behind_;
    std::vector<BoundingNode> nodes_;
};

} // namespace

std::vector<BoundingNode> boundingTree(std::span<const Bounds3> items) { return Builder(items).build(); }

} // namespace brume
