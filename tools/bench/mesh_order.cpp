#include "tools/bench/mesh_order.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include <glm/glm.hpp>
#include <nlohmann/json.hpp>

namespace brume::bench {
namespace {

using Tetrahedron = std::array<glm::dvec3, 4>;

// Of a place of a lattice with `side` places a side.
size_t indexOf(glm::ivec3 c, int side) {
    return (size_t(c.z) * size_t(side) + size_t(c.y)) * size_t(side) + size_t(c.x);
}

// Tetrahedra of a body-centred cubic lattice of `cells` cubes a side, side 1 in all, about the origin: two middles of
// cubes side by side, and two corners of their common face. `moved`: how far corners lie from the lattice, as a part of
// a cube's edge. `stretch`: of x.
std::vector<Tetrahedron> meshOf(int cells, double moved, double stretch) {
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> offset(-moved, moved);
    const int n = cells + 1;
    std::vector<glm::dvec3> corners(size_t(n) * n * n), middles(size_t(cells) * cells * cells);
    const auto place = [&](glm::dvec3 at) {
        at += glm::dvec3(offset(random), offset(random), offset(random));
        return (at / double(cells) - 0.5) * glm::dvec3(stretch, 1, 1);
    };
    const auto cornerAt = [&](glm::ivec3 c) -> glm::dvec3& { return corners[indexOf(c, n)]; };
    const auto middleAt = [&](glm::ivec3 c) -> glm::dvec3& { return middles[indexOf(c, cells)]; };
    for (int z = 0; z < n; ++z)
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x) {
                cornerAt({x, y, z}) = place({x, y, z});
                if (x < cells && y < cells && z < cells) middleAt({x, y, z}) = place(glm::dvec3(x, y, z) + 0.5);
            }
    std::vector<Tetrahedron> out;
    for (int axis = 0; axis < 3; ++axis) {
        glm::ivec3 u(0), v(0), w(0);
        u[axis] = v[(axis + 1) % 3] = w[(axis + 2) % 3] = 1;
        for (int z = 0; z < cells; ++z)
            for (int y = 0; y < cells; ++y)
                for (int x = 0; x < cells; ++x) {
                    const glm::ivec3 cube(x, y, z);
                    if (cube[axis] + 1 >= cells) continue;
                    const std::array around{cube + u, cube + u + v, cube + u + v + w, cube + u + w};
                    for (size_t i = 0; i < 4; ++i)
                        out.push_back(
                            {middleAt(cube), middleAt(cube + u), cornerAt(around[i]), cornerAt(around[(i + 1) % 4])});
                }
    }
    return out;
}

struct Part {
    double begin, end, centre; // m along the ray; `centre`: distance of the tetrahedron's centre from the eye
};

// Its inner half spaces, dot(normal, x) >= offset, and its centre.
struct Cell {
    std::array<glm::dvec3, 4> normal;
    std::array<double, 4> offset;
    glm::dvec3 centre;
};

Cell cellOf(const Tetrahedron& t) {
    Cell cell{{}, {}, (t[0] + t[1] + t[2] + t[3]) / 4.0};
    for (size_t i = 0; i < 4; ++i) {
        const glm::dvec3 a = t[(i + 1) % 4], normal = glm::cross(t[(i + 2) % 4] - a, t[(i + 3) % 4] - a);
        cell.normal[i] = glm::dot(normal, t[i] - a) < 0 ? -normal : normal;
        cell.offset[i] = glm::dot(cell.normal[i], a);
    }
    return cell;
}

// The part of the ray within the cell; empty where end <= begin.
Part partOf(glm::dvec3 eye, glm::dvec3 direction, const Cell& cell) {
    Part part{0, 1e30, 0};
    for (size_t i = 0; i < 4; ++i) {
        const double height = glm::dot(cell.normal[i], eye) - cell.offset[i];
        const double slope = glm::dot(cell.normal[i], direction);
        if (slope == 0) {
            if (height < 0) return {0, 0, 0};
        } else if (slope > 0)
            part.begin = std::max(part.begin, -height / slope);
        else
            part.end = std::min(part.end, -height / slope);
        if (part.end <= part.begin) return part;
    }
    part.centre = glm::length(cell.centre - eye);
    return part;
}

// Radiance of the parts in their order, far ones behind near ones. `sigma`: 1/m. Light falls along y by e^-sigma.
double radianceOf(const std::vector<Part>& parts, glm::dvec3 eye, glm::dvec3 direction, double sigma) {
    double light = 0, transmittance = 1;
    for (const Part& p : parts) {
        const double opacity = -std::expm1(-sigma * (p.end - p.begin));
        const double height = eye.y + direction.y * (p.begin + p.end) / 2;
        light += transmittance * opacity * std::exp(sigma * (height - 0.5));
        transmittance *= 1 - opacity;
    }
    return light;
}

struct Difference {
    double squares = 0, of = 0, worst = 0, brightest = 0;
};

void compare(std::vector<Part>& parts, glm::dvec3 eye, glm::dvec3 direction, const std::array<double, 3>& sigmas,
             std::array<Difference, 3>& out) {
    std::array<double, 3> exact{};
    std::ranges::sort(parts, {}, &Part::begin);
    for (size_t d = 0; d < 3; ++d) exact[d] = radianceOf(parts, eye, direction, sigmas[d]);
    std::ranges::sort(parts, {}, &Part::centre);
    for (size_t d = 0; d < 3; ++d) {
        const double off = std::abs(radianceOf(parts, eye, direction, sigmas[d]) - exact[d]);
        out[d].squares += off * off, out[d].of += exact[d] * exact[d];
        out[d].worst = std::max(out[d].worst, off), out[d].brightest = std::max(out[d].brightest, exact[d]);
    }
}

std::array<Difference, 3> seenFrom(glm::dvec3 eye, const std::vector<Cell>& mesh, const std::array<double, 3>& sigmas,
                                   int wide, int high) {
    const glm::dvec3 ahead = glm::normalize(-eye);
    const glm::dvec3 right = glm::normalize(glm::cross(ahead, glm::dvec3(0, 1, 0))), up = glm::cross(right, ahead);
    const double tangent = std::min(1.0, 0.9 / glm::length(eye)); // a picture as high as the mesh, or 90 degrees
    std::array<Difference, 3> out{};
    std::vector<Part> parts;
    for (int y = 0; y < high; ++y)
        for (int x = 0; x < wide; ++x) {
            const double px = (x + 0.5) / high * 2 - double(wide) / high, py = 1 - (y + 0.5) / high * 2;
            const glm::dvec3 direction = glm::normalize(ahead + tangent * (px * right + py * up));
            parts.clear();
            for (const Cell& cell : mesh)
                if (const Part part = partOf(eye, direction, cell); part.end > part.begin) parts.push_back(part);
            compare(parts, eye, direction, sigmas, out);
        }
    return out;
}

} // namespace

nlohmann::json meshOrderRows(const MeshOrderQuestion& q) {
    struct Mesh {
        const char* name;
        double moved, stretch;
    };
    constexpr Mesh kMeshes[]{{"body-centred cubic", 0, 1},
                             {"the same, stretched 4:1", 0, 4},
                             {"corners moved by up to 0.2 cubes", 0.2, 1},
                             {"the same, moved and stretched 4:1", 0.2, 4}};
    // Oblique, near, from within, and ten times as far.
    constexpr std::array kEyes{glm::dvec3(1.6, 1.1, 1.3), glm::dvec3(0.3, 0.2, 0.9), glm::dvec3(0.11, 0.07, 0.05),
                               glm::dvec3(16, 11, 13)};
    const std::array<double, 3> depths{1, 4, 16};
    nlohmann::json rows = nlohmann::json::array();
    for (const Mesh& one : kMeshes) {
        std::vector<Cell> mesh;
        for (const Tetrahedron& t : meshOf(q.cells, one.moved, one.stretch)) mesh.push_back(cellOf(t));
        std::vector<std::array<Difference, 3>> seen;
        for (const glm::dvec3 eye : kEyes)
            seen.push_back(seenFrom(eye * glm::dvec3(one.stretch, 1, 1), mesh, depths, q.wide, q.high));
        for (size_t d = 0; d < depths.size(); ++d) {
            std::vector<double> errors;
            double worst = 0;
            for (const std::array<Difference, 3>& view : seen) {
                errors.push_back(std::sqrt(view[d].squares / view[d].of));
                worst = std::max(worst, view[d].worst / view[d].brightest);
            }
            rows.push_back({{"variant", one.name},
                            {"tetrahedra", mesh.size()},
                            {"depth", depths[d]},
                            {"least", *std::ranges::min_element(errors)},
                            {"most", *std::ranges::max_element(errors)},
                            {"worst_pixel", worst}});
        }
    }
    return rows;
}

} // namespace brume::bench
