// Media and lights for the reference's tests.
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <random>
#include <vector>

#include "tools/reference/world.h"

namespace brume::reference::test {

// `depth`: optical depth through the centre.
inline Blob blob(glm::dvec3 centre, double scale, double falloff, double depth, glm::dvec3 albedo = glm::dvec3(1)) {
    const double k = std::sqrt(50.0) / (scale * falloff);
    return {centre, scale, k, depth * k / kSqrtPi, depth / 2, albedo};
}

// Blobs of falloff 1.6 in a cube; scales and depths vary by a half about the given ones.
inline std::vector<Blob> cloud(int count, double extent, double scale, double depth, glm::dvec3 albedo) {
    std::mt19937 random(5);
    const auto unit = [&] { return random() / 4294967296.0 - 0.5; };
    std::vector<Blob> blobs;
    for (int i = 0; i < count; ++i) {
        const double x = unit(), y = unit(), z = unit(), size = unit(), thickness = unit();
        blobs.push_back(blob(extent * glm::dvec3(x, y, z), scale * (1 + size), 1.6, depth * (1 + thickness), albedo));
    }
    return blobs;
}

inline constexpr double kSide = 2; // m, of cubes, which lie from 0 to kSide

using Field = std::function<double(glm::dvec3)>;
inline Field even(double sigma) {
    return [sigma](glm::dvec3) { return sigma; };
}
// The cube as n^3 cubes of six tetrahedra each (Kuhn 1960). Corners on the inside are moved by up to `jitter` of a
// small cube's side along each axis.
inline TetrahedralMedium cube(int n, double jitter, const Field& sigma, glm::dvec3 albedo = glm::dvec3(1)) {
    std::mt19937 random(3);
    const auto move = [&](int i) {
        const double by = jitter * (random() / 2147483648.0 - 1);
        return kSide * (i + (i > 0 && i < n ? by : 0)) / n;
    };
    TetrahedralMedium medium;
    for (int z = 0; z <= n; ++z)
        for (int y = 0; y <= n; ++y)
            for (int x = 0; x <= n; ++x) {
                const double at_x = move(x), at_y = move(y), at_z = move(z);
                const glm::dvec3 place(at_x, at_y, at_z);
                medium.corners.push_back({place, sigma(place), albedo});
            }
    const auto index = [n](glm::ivec3 at) { return uint32_t((at.z * (n + 1) + at.y) * (n + 1) + at.x); };
    for (int i = 0; i < n * n * n; ++i) {
        std::array<int, 3> axes{0, 1, 2};
        do {
            glm::ivec3 at(i % n, i / n % n, i / n / n);
            glm::uvec4 cell(index(at), 0, 0, 0);
            for (int step = 0; step < 3; ++step) ++at[axes[size_t(step)]], cell[step + 1] = index(at);
            medium.cells.push_back(cell);
        } while (std::next_permutation(axes.begin(), axes.end()));
    }
    return medium;
}

// The cube as a regular tetrahedron and four corners cut off.
inline TetrahedralMedium fiveInACube(const Field& sigma) {
    TetrahedralMedium medium;
    for (int i = 0; i < 8; ++i) {
        const glm::dvec3 place = kSide * glm::dvec3(i & 1, i >> 1 & 1, i >> 2);
        medium.corners.push_back({place, sigma(place), glm::dvec3(1)});
    }
    medium.cells = {{0, 3, 5, 6}, {1, 0, 3, 5}, {2, 0, 3, 6}, {4, 0, 5, 6}, {7, 3, 5, 6}};
    return medium;
}

inline LightSource distant(glm::dvec3 to_light, double irradiance = 1) {
    LightSource light;
    light.to_light = glm::normalize(to_light);
    light.colour = glm::dvec3(irradiance);
    return light;
}

} // namespace brume::reference::test
