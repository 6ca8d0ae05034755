#include "server/sim/spacing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace brume {

namespace {

constexpr size_t kNeighbours = 8;
constexpr size_t kSample = 2048; // points: their median is within a percent of that of all
constexpr size_t kLeaf = 32;     // points of a tree's part that is searched one by one

// Squared distances of the nearest points so far, ascending. The first is that of the point itself.
class Nearest {
public:
    explicit Nearest(size_t count) : count_(count) { squares_.fill(std::numeric_limits<float>::max()); }
    float farthest() const { return squares_[count_ - 1]; }
    void add(float square) {
        if (!(square < farthest())) return;
        size_t i = count_ - 1;
        for (; i > 0 && squares_[i - 1] > square; --i) squares_[i] = squares_[i - 1];
        squares_[i] = square;
    }

private:
    size_t count_;
    std::array<float, kNeighbours + 1> squares_{};
};

// A k-d tree: the middle point of a range divides the others along the longest side of their box.
class Tree {
public:
    explicit Tree(std::span<const glm::vec3> points) : points_(points.begin(), points.end()), axes_(points.size()) {
        build(0, points_.size());
    }
    void search(glm::vec3 from, Nearest& nearest) const { search(from, nearest, 0, points_.size()); }

private:
    void build(size_t begin, size_t end) {
        if (end - begin <= kLeaf) return;
        glm::vec3 lo = points_[begin], hi = lo;
        for (size_t i = begin; i < end; ++i) lo = glm::min(lo, points_[i]), hi = glm::max(hi, points_[i]);
        const glm::vec3 side = hi - lo;
        const int axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
        const size_t middle = begin + (end - begin) / 2;
        const auto at = [&](size_t i) { return points_.begin() + static_cast<std::ptrdiff_t>(i); };
        std::nth_element(at(begin), at(middle), at(end),
                         [axis](const glm::vec3& a, const glm::vec3& b) { return a[axis] < b[axis]; });
        axes_[middle] = static_cast<uint8_t>(axis);
        build(begin, middle);
        build(middle + 1, end);
    }

    void search(glm::vec3 from, Nearest& nearest, size_t begin, size_t end) const {
        const auto add = [&](glm::vec3 point) { nearest.add(glm::dot(point - from, point - from)); };
        if (end - begin <= kLeaf) {
            for (size_t i = begin; i < end; ++i) add(points_[i]);
            return;
        }
        const size_t middle = begin + (end - begin) / 2;
        const float beyond = from[axes_[middle]] - points_[middle][axes_[middle]];
        add(points_[middle]);
        const auto left = [&] { search(from, nearest, begin, middle); };
        const auto right = [&] { search(from, nearest, middle + 1, end); };
        beyond < 0 ? left() : right();
        if (beyond * beyond < nearest.farthest()) beyond < 0 ? right() : left();
    }

    std::vector<glm::vec3> points_;
    std::vector<uint8_t> axes_; // of each middle: the axis that it divides
};

} // namespace

float spacing(std::span<const glm::vec3> points) {
    if (points.size() < 2) return 0;
    const Tree tree(points);
    std::vector<float> squares;
    const size_t stride = (points.size() + kSample - 1) / kSample;
    for (size_t i = 0; i < points.size(); i += stride) {
        Nearest nearest(std::min(kNeighbours + 1, points.size()));
        tree.search(points[i], nearest);
        squares.push_back(nearest.farthest());
    }
    const auto median = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
    std::nth_element(squares.begin(), median, squares.end());
    return std::sqrt(*median);
}

} // namespace brume
