#include "common/object_layout.h"

#include <algorithm>
#include <cmath>

#include "common/random.h"

namespace brume {
namespace {

constexpr glm::vec3 kStone{0.42f, 0.38f, 0.33f}, kPlaster{0.62f, 0.55f, 0.45f}, kWood{0.24f, 0.15f, 0.09f},
    kLeaves{0.09f, 0.17f, 0.06f}, kDark{0.07f, 0.08f, 0.1f}, kGrass{0.13f, 0.2f, 0.07f};

class LayoutBuilder {
public:
    explicit LayoutBuilder(const ObjectLayout& layout) : layout_(layout), random_(layout.seed) {}

    LaidOut build() {
        if (layout_.layout == kCourtyard) courtyard();
        if (layout_.layout == kStreet) street();
        if (layout_.layout == kIslands) islands();
        if (layout_.layout == kAtrium) atrium();
        return std::move(out_);
    }

private:
    bool full() const { return out_.boxes.size() + out_.spheres.size() >= layout_.count; }
    float between(float lo, float hi) { return random_.uniform(lo, hi); }
    glm::vec3 about(glm::vec3 colour) { return colour * between(0.8f, 1.2f); }

    // A box on `base`, the middle of its lower side.
    void box(glm::vec3 base, glm::vec3 size, glm::vec3 albedo, float yaw = 0) {
        if (!full()) out_.boxes.push_back({layout_.centre + base + glm::vec3(0, size.y / 2, 0), size, yaw, albedo});
    }
    void ball(glm::vec3 centre, float radius, glm::vec3 albedo) {
        if (!full()) out_.spheres.push_back({layout_.centre + centre, radius, albedo});
    }

    void tree(glm::vec3 base, float height) {
        const float yaw = between(0, 1);
        box(base, {0.07f * height, 0.5f * height, 0.07f * height}, about(kWood), yaw);
        for (int i = 0; i < 12; ++i) {
            const glm::vec3 at = 0.26f * height * random_.inBall();
            const glm::vec3 albedo = about(kLeaves);
            ball(base + glm::vec3(0, 0.7f * height, 0) + at, height * between(0.09f, 0.17f), albedo);
        }
    }

    // Rows of windows on a wall through `from` and `to`, which stands on the ground: a sill, a lintel and dark glass.
    // `out`: unit, away from the wall.
    void windows(glm::vec3 from, glm::vec3 to, glm::vec3 out, float first, float storey, int storeys, float apart) {
        const glm::vec3 along = glm::normalize(to - from);
        const int columns = int(glm::distance(from, to) / apart);
        const glm::vec3 across = glm::abs(along), depth = glm::abs(out);
        for (int y = 0; y < storeys; ++y)
            for (int x = 0; x < columns; ++x) {
                const glm::vec3 at = from + along * ((float(x) + 0.5f) * glm::distance(from, to) / float(columns)) +
                                     glm::vec3(0, first + storey * float(y), 0);
                box(at, across * 1.1f + depth * 0.1f + glm::vec3(0, 1.5f, 0), kDark);
                box(at - glm::vec3(0, 0.15f, 0), across * 1.5f + depth * 0.5f + glm::vec3(0, 0.15f, 0), about(kStone));
                box(at + glm::vec3(0, 1.5f, 0), across * 1.5f + depth * 0.4f + glm::vec3(0, 0.2f, 0), about(kStone));
            }
    }

    // A call's arguments are computed in an order that is the compiler's: at most one of them draws a random number.
    void stone(glm::vec3 base, float size, float lowest, float highest) {
        const float yaw = between(0, 3);
        const glm::vec3 albedo = about(kStone);
        box(base, {size, between(lowest, highest), size}, albedo, yaw);
    }

    // Small things on the ground of a rectangle, until all are there.
    void scatter(glm::vec2 half) {
        while (!full()) {
            const glm::vec3 at{between(-half.x, half.x), 0, between(-half.y, half.y)};
            const float size = between(0.15f, 0.5f);
            if (random_.uniform() < 0.4f)
                ball(at + glm::vec3(0, size / 2, 0), size / 2, about(kStone));
            else
                stone(at, size, 0.1f, 0.6f);
        }
    }

    void courtyard() {
        for (const float side : {-1.0f, 1.0f}) { // the wings, then the roofs of their arcades
            box({0, 0, side * 12}, {69, 12, 3}, kPlaster);
            box({side * 33, 0, 0}, {3, 12, 21}, kPlaster);
            box({0, 3.6f, side * 9.2f}, {57, 0.4f, 2.6f}, kStone);
            box({side * 30, 3.6f, 0}, {3, 0.4f, 21}, kStone);
            box({0, 12, side * 12}, {70, 0.5f, 4}, kWood);
            box({side * 33, 12, 0}, {4, 0.5f, 28}, kWood);
        }
        box({0, 0, 0}, {5, 0.8f, 5}, kStone, 0.78f);
        ball({0, 1.7f, 0}, 0.9f, kStone);
        for (int i = 0; i < 6; ++i) {
            const float height = between(5, 8);
            tree({(float(i) - 2.5f) * 9 + between(-1, 1), 0, (i % 2 ? 4.5f : -4.5f)}, height);
        }
        for (const float side : {-1.0f, 1.0f}) {
            for (int i = 0; i < 19; ++i) box({(float(i) - 9) * 3, 0, side * 8}, {0.5f, 3.6f, 0.5f}, about(kStone));
            for (int i = 0; i < 5; ++i) box({side * 28.6f, 0, (float(i) - 2) * 3}, {0.5f, 3.6f, 0.5f}, about(kStone));
        }
        for (const float side : {-1.0f, 1.0f}) {
            windows({-30, 0, side * 10.45f}, {30, 0, side * 10.45f}, {0, 0, -side}, 5, 3.3f, 2, 3);
            windows({side * 31.45f, 0, -9}, {side * 31.45f, 0, 9}, {-side, 0, 0}, 5, 3.3f, 2, 3);
        }
        scatter({28, 8});
    }

    void street() {
        constexpr float kHalf = 87, kKerb = 8;
        for (const float side : {-1.0f, 1.0f}) box({side * 16.5f, 0, 0}, {17, 0.2f, 2 * kHalf}, kStone);
        struct House {
            float side, at, width, height;
        };
        std::vector<House> houses;
        for (const float side : {-1.0f, 1.0f})
            for (float z = -kHalf; z < kHalf - 6;) {
                const float width = std::min(between(9, 16), kHalf - z);
                houses.push_back({side, z + width / 2, width - 0.6f, between(9, 24)});
                z += width;
            }
        for (const House& h : houses) {
            box({h.side * 18, 0, h.at}, {12, h.height, h.width}, about(kPlaster));
            box({h.side * 18, h.height, h.at}, {13, 0.6f, h.width + 0.4f}, about(kWood));
        }
        for (float z = -kHalf + 8; z < kHalf; z += 16)
            for (const float side : {-1.0f, 1.0f}) {
                box({side * kKerb, 0, z}, {0.16f, 5, 0.16f}, kDark);
                box({side * (kKerb - 0.5f), 5, z}, {1.2f, 0.12f, 0.3f}, kDark);
            }
        for (float z = -kHalf + 16; z < kHalf; z += 32)
            tree({kKerb + 1, 0, z}, between(5, 7)), tree({-kKerb - 1, 0, z + 8}, between(5, 7));
        for (const House& h : houses) {
            const float x = h.side * 11.95f;
            box({x, 0, h.at}, {0.5f, 2.6f, 1.4f}, kWood);
            windows({x, 0, h.at - h.width / 2}, {x, 0, h.at + h.width / 2}, {-h.side, 0, 0}, 4, 3.2f,
                    int((h.height - 3) / 3.2f), 2.6f);
        }
        scatter({kKerb, kHalf});
    }

    void islands() {
        struct Island {
            glm::vec3 top;
            float radius;
        };
        std::vector<Island> islands;
        const int count = std::clamp(int(layout_.count / 60), 3, 40);
        for (int i = 0; i < count; ++i) {
            const glm::vec2 at = 40.0f * random_.inDisc();
            islands.push_back({{at.x, between(10, 56), at.y}, between(3, 8)});
        }
        for (const Island& i : islands) {
            const float yaw = between(0, 3);
            box(i.top - glm::vec3(0, 0.8f, 0), {1.7f * i.radius, 0.8f, 1.5f * i.radius}, about(kGrass), yaw);
        }
        for (int layer = 0; layer < 4; ++layer) // rock: smaller and smaller downward
            for (const Island& i : islands) {
                const float part = 1.5f - 0.33f * float(layer), high = 0.35f * i.radius;
                const float z = between(-1, 1), x = between(-1, 1), yaw = between(0, 3);
                const glm::vec3 off = 0.12f * i.radius * glm::vec3(x, 0, z), albedo = about(kStone);
                box(i.top + off - glm::vec3(0, 0.8f + high * float(layer + 1), 0),
                    {part * i.radius, high, part * i.radius * between(0.8f, 1)}, albedo, yaw);
            }
        for (int round = 0; round < 3; ++round)
            for (const Island& i : islands) {
                const glm::vec2 at = 0.5f * i.radius * random_.inDisc();
                tree(i.top + glm::vec3(at.x, 0, at.y), i.radius * between(0.5f, 0.9f));
            }
        while (!full()) { // rocks
            const Island& i = islands[size_t(random_.uniform() * float(islands.size()))];
            const glm::vec2 at = 0.6f * i.radius * random_.inDisc();
            const float size = between(0.2f, 0.7f);
            stone(i.top + glm::vec3(at.x, 0, at.y), size, 0.2f, 0.8f);
        }
    }

    void atrium() {
        for (const float side : {-1.0f, 1.0f}) {
            box({0, 0, side * 11.3f}, {37, 18, 0.6f}, kPlaster);
            box({side * 18.2f, 0, 0}, {0.6f, 18, 22}, kPlaster);
            for (const float level : {5.6f, 11.6f}) {
                box({0, level, side * 9}, {36, 0.4f, 4}, kStone);
                box({side * 16, level, 0}, {4, 0.4f, 14}, kStone);
            }
        }
        for (int i = 0; i < 13; ++i) box({(float(i) - 6) * 3, 18, 0}, {0.5f, 0.9f, 22.6f}, kWood);
        for (int i = 0; i < 7; ++i) box({0, 18.9f, (float(i) - 3) * 3.4f}, {37, 0.3f, 0.3f}, kWood);
        for (const float level : {0.0f, 6.0f, 12.0f})
            for (const float side : {-1.0f, 1.0f}) {
                for (int i = 0; i < 11; ++i) {
                    const glm::vec3 base{(float(i) - 5) * 3.2f, level, side * 7.2f};
                    box(base, {0.7f, 5.6f, 0.7f}, about(kStone));
                    box(base, {1, 0.4f, 1}, kStone);
                }
                for (int i = 0; i < 3; ++i)
                    box({side * 14.2f, level, (float(i) - 1) * 3.6f}, {0.7f, 5.6f, 0.7f}, about(kStone));
            }
        for (int i = 0; i < 4; ++i) tree({(float(i) - 1.5f) * 6, 0, (i % 2 ? 2.5f : -2.5f)}, between(3, 5));
        for (const float level : {6.0f, 12.0f}) // railings of the galleries
            for (const float side : {-1.0f, 1.0f}) {
                box({0, level + 1, side * 7.1f}, {35, 0.1f, 0.12f}, kWood);
                for (int i = 0; i < 70; ++i)
                    box({(float(i) - 34.5f) * 0.5f, level, side * 7.1f}, {0.06f, 1, 0.06f}, kWood);
            }
        scatter({14, 6});
    }

    const ObjectLayout& layout_;
    Random random_;
    LaidOut out_;
};

} // namespace

LaidOut layOut(const ObjectLayout& layout) { return LayoutBuilder(layout).build(); }

} // namespace brume
