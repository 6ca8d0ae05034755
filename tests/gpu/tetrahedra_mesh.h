// Meshes of tetrahedra for tests, and their optical depths in double, found in one tetrahedron after the other.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "server/effects/shadow_volume/shadow_volume.h"
#include "server/inputs/tetrahedra_buffers.h"
#include "tests/gpu/judged.h"
#include "tests/gpu/light_passes.h"

namespace brume::test {

struct Mesh {
    std::vector<Point> points;
    std::vector<glm::uvec4> cells;
};

// `side`^3 cubes around the origin, `width` m together, each cut into six tetrahedra about a diagonal. Points move by
// up to `jitter` of a cube's width. Precondition: jitter < 0.2, which turns none inside out.
inline Mesh lattice(uint32_t side, float width, float jitter, const std::function<float(glm::vec3)>& extinction,
                    uint32_t seed = 1) {
    Mesh mesh;
    Random random(seed);
    const float cube = width / float(side);
    for (uint32_t z = 0; z <= side; ++z)
        for (uint32_t y = 0; y <= side; ++y)
            for (uint32_t x = 0; x <= side; ++x) {
                const glm::vec3 at = cube * (glm::vec3(x, y, z) + random.inCube(jitter)) - 0.5f * width;
                mesh.points.push_back({.centre = at, .scale = cube, .sigma_t = extinction(at)});
            }
    constexpr std::array<std::array<int, 3>, 6> kOrders{
        {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
    const auto number = [&](glm::uvec3 at) { return (at.z * (side + 1) + at.y) * (side + 1) + at.x; };
    for (uint32_t z = 0; z < side; ++z)
        for (uint32_t y = 0; y < side; ++y)
            for (uint32_t x = 0; x < side; ++x)
                for (const std::array<int, 3>& order : kOrders) {
                    glm::uvec3 at(x, y, z);
                    glm::uvec4 cell(number(at));
                    for (int i = 0; i < 3; ++i) {
                        ++at[order[size_t(i)]];
                        cell[i + 1] = number(at);
                    }
                    mesh.cells.push_back(cell);
                }
    return mesh;
}

// A body-centred cubic lattice: `side`^3 cubes with their middles. A tetrahedron is between the middles of two cubes
// and an edge of the face that they share.
inline Mesh centred(uint32_t side, float width, const std::function<float(glm::vec3)>& extinction) {
    Mesh mesh;
    const float cube = width / float(side);
    const auto add = [&](uint32_t count, float first) {
        for (uint32_t z = 0; z < count; ++z)
            for (uint32_t y = 0; y < count; ++y)
                for (uint32_t x = 0; x < count; ++x) {
                    const glm::vec3 at = cube * (glm::vec3(x, y, z) + first) - 0.5f * width;
                    mesh.points.push_back({.centre = at, .scale = cube, .sigma_t = extinction(at)});
                }
    };
    add(side + 1, 0);
    add(side, 0.5f);
    const auto corner = [&](glm::uvec3 at) { return (at.z * (side + 1) + at.y) * (side + 1) + at.x; };
    const auto middle = [&](glm::uvec3 at) {
        return (side + 1) * (side + 1) * (side + 1) + (at.z * side + at.y) * side + at.x;
    };
    for (uint32_t z = 0; z < side; ++z)
        for (uint32_t y = 0; y < side; ++y)
            for (uint32_t x = 0; x < side; ++x)
                for (int axis = 0; axis < 3; ++axis) {
                    const glm::uvec3 here(x, y, z);
                    glm::uvec3 next = here, across(0), along(0);
                    if (++next[axis] == side) continue;
                    across[(axis + 1) % 3] = 1, along[(axis + 2) % 3] = 1;
                    const glm::uvec3 around[]{next, next + across, next + across + along, next + along};
                    for (int i = 0; i < 4; ++i)
                        mesh.cells.emplace_back(middle(here), middle(next), corner(around[i]),
                                                corner(around[(i + 1) % 4]));
                }
    return mesh;
}

inline float soft(glm::vec3 at) { return std::max(1.2f - glm::length(at) / 2.5f, 0.0f); }
inline float even(glm::vec3) { return 0.4f; }
inline float inner(glm::vec3 at) {
    return std::max(1 - glm::length(at) / 1.5f, 0.0f);
} // none outside of lattices 4 m wide

inline Scene sceneOf(const Mesh& mesh) {
    Scene scene = test::sceneOf(mesh.points, 1, mesh.cells);
    scene.render.shadow_size = scene.render.shadow_slices = 0; // as the medium needs
    return scene;
}

// The part of a ray within one tetrahedron, by its four planes.
struct Part {
    double begin = -1e300, end = 1e300;
    double sigma[2]{}; // at both
};
inline Part partOf(const Mesh& mesh, glm::uvec4 cell, glm::dvec3 origin, glm::dvec3 dir) {
    glm::dvec3 corner[4];
    for (int m = 0; m < 4; ++m) corner[m] = glm::dvec3(mesh.points[cell[m]].centre) - origin;
    Part part;
    double at_origin = 0, slope = 0; // of the extinction along the ray
    for (int m = 0; m < 4; ++m) {
        const glm::dvec3 a = corner[(m + 1) % 4], b = corner[(m + 2) % 4], c = corner[(m + 3) % 4];
        glm::dvec3 normal = glm::cross(b - a, c - a);
        normal /= glm::dot(normal, corner[m] - a); // the corner's own coordinate is dot(normal, x - a)
        const double here = -glm::dot(normal, a), along = glm::dot(normal, dir);
        const double sigma = double(mesh.points[cell[m]].sigma_t);
        at_origin += sigma * here, slope += sigma * along;
        if (along > 0) part.begin = std::max(part.begin, -here / along);
        if (along < 0) part.end = std::min(part.end, -here / along);
        if (along == 0 && here < 0) part.end = part.begin;
    }
    for (const int end : {0, 1}) part.sigma[end] = at_origin + slope * (end == 0 ? part.begin : part.end);
    return part;
}

inline double depthOn(const Mesh& mesh, glm::dvec3 origin, glm::dvec3 dir, double begin, double end) {
    double depth = 0;
    for (const glm::uvec4 cell : mesh.cells) {
        const Part part = partOf(mesh, cell, origin, dir);
        const double from = std::max(part.begin, begin), to = std::min(part.end, end);
        if (!(to > from)) continue;
        const auto sigma = [&](double t) {
            return glm::mix(part.sigma[0], part.sigma[1], (t - part.begin) / (part.end - part.begin));
        };
        depth += 0.5 * (sigma(from) + sigma(to)) * (to - from);
    }
    return depth;
}

class TetrahedraTest : public JudgedTest {
protected:
    // Rays in double are moved aside by less than a float can tell: they may lie in planes of faces, which both sides
    // have.
    static constexpr glm::dvec3 kAside{1.1e-7, 0.7e-7, 1.3e-7};

    // Optical depth on a pixel's ray.
    static double depthOnPixel(const Mesh& mesh, const Pose& pose, uint32_t x, uint32_t y) {
        const glm::dvec3 dir = pixelDirection(pose, kColumns, kRows, x, y);
        const double metres = glm::length(dir);
        return depthOn(mesh, glm::dvec3(pose.position) + kAside, dir / metres, kNear * metres, 1e9);
    }
    // The largest difference of transmittance to the mesh's own, over a picture's pixels.
    static double worstTransmittance(const Mesh& mesh, const Pose& pose) {
        const Picture picture = render(device(), sceneOf(mesh), pose, kColumns, kRows);
        double worst = 0;
        for (uint32_t y = 0; y < kRows; ++y)
            for (uint32_t x = 0; x < kColumns; ++x) {
                EXPECT_TRUE(std::isfinite(picture.at(x, y).r)) << x << ' ' << y;
                const double truth = std::exp(-depthOnPixel(mesh, pose, x, y));
                worst = std::max(worst, std::abs(double(picture.at(x, y).a) - truth));
            }
        return worst;
    }
    // The largest difference of light depths at planes to the mesh's own.
    static double worstShadow(const Scene& scene, const Mesh& mesh) {
        const Simulation simulation(scene);
        std::vector<gpu::Particle> particles(simulation.liveCount());
        simulation.write(particles);
        const gpu::Tick tick = makeTick(scene, simulation.now(), particles, {});
        TetrahedraBuffers buffers(device(), scene.tetrahedra);
        buffers.follow(particles);
        ShadowVolume volume(device(), uint32_t(particles.size()));
        recordAndWait(device(), tick, "Particles", particles, [&](gpu::Commands& commands, gpu::Resources& shared) {
            volume.record(commands, shared, tick, false, &buffers);
        });
        const std::vector<float> texels = readImage(device(), volume.image(), 4);
        const glm::dvec3 toward(tick.sun.to_light);
        double worst = 0;
        for (uint32_t y = 0; y < tick.map.texels.y; y += 1 + tick.map.texels.y / 20)
            for (uint32_t x = 0; x < tick.map.texels.x; x += 1 + tick.map.texels.x / 20)
                for (uint32_t plane = 0; plane < tick.map.slices; ++plane) {
                    const glm::dvec3 part((x + 0.5) / tick.map.texels.x, (y + 0.5) / tick.map.texels.y,
                                          1 - double(plane) / (tick.map.slices - 1));
                    const glm::dvec3 at = glm::mix(glm::dvec3(tick.map.lo), glm::dvec3(tick.map.hi), part);
                    const uint32_t layer = std::min(plane / 3, volume.image().layers() - 1);
                    const size_t texel = (size_t(layer) * tick.map.texels.y + y) * tick.map.texels.x + x;
                    const double got = double(texels[4 * texel + plane - 3 * layer]);
                    const double truth = depthOn(mesh, fromLightSpace(tick, at) + kAside, toward, 0, 1e9);
                    worst = std::max(worst, std::abs(got - truth));
                }
        return worst;
    }
    static constexpr uint32_t kColumns = 49, kRows = 33;
};

} // namespace brume::test
