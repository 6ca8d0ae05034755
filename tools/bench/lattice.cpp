#include "tools/bench/lattice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include <fmt/format.h>

#include "common/scene_limits.h"
#include "common/tetrahedra.h"

namespace brume::bench {
namespace {

constexpr double kReach = 0.6;  // of u: a Gaussian is e^-18 of its peak there
constexpr double kExtent = 0.4; // of u: the bounds end there
constexpr double kSmall = 1e-3; // part of the largest extinction
constexpr uint32_t kNone = ~0u;

struct Field {
    double extinction = 0; // 1/m
    glm::dvec3 scattering{0};
};

// Nodes are the corners of cubes, then their middles.
class Grid {
public:
    Grid(std::span<const gpu::Particle> particles, float falloff, uint32_t cells) {
        Bounds3 bounds;
        for (const gpu::Particle& p : particles) {
            const glm::dvec3 centre(p.centre), reach(kExtent * double(p.scale) * double(falloff));
            bounds.add({centre - reach, centre + reach});
        }
        const glm::dvec3 side = bounds.hi - bounds.lo;
        cell_ = std::max({side.x, side.y, side.z}) / cells;
        cubes_ = glm::uvec3(glm::ceil(side / cell_ - 1e-9)) + 2u; // one more on each side
        lo_ = 0.5 * (bounds.lo + bounds.hi) - 0.5 * cell_ * glm::dvec3(cubes_);
        corners_ = (cubes_.x + 1) * (cubes_.y + 1) * (cubes_.z + 1);
        field_.resize(corners_ + size_t(cubes_.x) * cubes_.y * cubes_.z);
        for (const gpu::Particle& p : particles)
            for (const bool middle : {false, true}) add(p, double(p.scale) * double(falloff), middle);
    }

    double cell() const { return cell_; }
    const std::vector<Field>& field() const { return field_; }

    glm::dvec3 place(uint32_t node) const {
        const bool middle = node >= corners_;
        const glm::uvec3 size = sizeOf(middle);
        const uint32_t i = node - (middle ? corners_ : 0);
        return placeOf({i % size.x, i / size.x % size.y, i / size.x / size.y}, middle);
    }

    // Calls act(uvec4) with the nodes of every tetrahedron.
    template <class Act>
    void eachTetrahedron(Act act) const {
        for (uint32_t z = 0; z < cubes_.z; ++z)
            for (uint32_t y = 0; y < cubes_.y; ++y)
                for (uint32_t x = 0; x < cubes_.x; ++x)
                    for (int axis = 0; axis < 3; ++axis) {
                        glm::uvec3 behind(x, y, z);
                        if (++behind[axis] == cubes_[axis]) continue;
                        // Round the common face.
                        glm::uvec3 u(0), v(0);
                        u[(axis + 1) % 3] = v[(axis + 2) % 3] = 1;
                        const std::array<uint32_t, 4> ring{node(behind, false), node(behind + u, false),
                                                           node(behind + u + v, false), node(behind + v, false)};
                        const uint32_t first = node({x, y, z}, true), second = node(behind, true);
                        for (size_t i = 0; i < 4; ++i) act(glm::uvec4(first, second, ring[i], ring[(i + 1) % 4]));
                    }
    }

private:
    glm::uvec3 sizeOf(bool middle) const { return middle ? cubes_ : cubes_ + 1u; }
    uint32_t node(glm::uvec3 at, bool middle) const {
        const glm::uvec3 size = sizeOf(middle);
        return (middle ? corners_ : 0) + at.x + size.x * (at.y + size.y * at.z);
    }
    glm::dvec3 placeOf(glm::uvec3 at, bool middle) const {
        return lo_ + cell_ * (glm::dvec3(at) + (middle ? 0.5 : 0.0));
    }

    void add(const gpu::Particle& p, double u, bool middle) {
        const glm::dvec3 centre = (glm::dvec3(p.centre) - lo_) / cell_ - (middle ? 0.5 : 0.0);
        const glm::dvec3 reach(kReach * u / cell_);
        const glm::uvec3 lo(glm::max(glm::ceil(centre - reach), 0.0)),
            end(glm::min(glm::floor(centre + reach) + 1.0, glm::dvec3(sizeOf(middle))));
        for (uint32_t z = lo.z; z < end.z; ++z)
            for (uint32_t y = lo.y; y < end.y; ++y)
                for (uint32_t x = lo.x; x < end.x; ++x) {
                    const glm::dvec3 to = placeOf({x, y, z}, middle) - glm::dvec3(p.centre);
                    const double extinction = double(p.sigma_t) * std::exp(-50 * glm::dot(to, to) / (u * u));
                    Field& field = field_[node({x, y, z}, middle)];
                    field.extinction += extinction;
                    field.scattering += extinction * glm::dvec3(p.albedo);
                }
    }

    double cell_ = 0;
    glm::uvec3 cubes_{0};
    glm::dvec3 lo_{0};
    uint32_t corners_ = 0; // of cubes
    std::vector<Field> field_;
};

// Corners outside become 0, so that the medium ends continuously.
void endOutside(Lattice& lattice) {
    const std::vector<glm::vec3> places(lattice.position.begin(), lattice.position.end());
    const Tetrahedra all = connected(lattice.corners, places, "lattice");
    for (const Tetrahedra::Face& face : all.faces)
        for (int m = 0; m < 3; ++m) lattice.sigma_t[face.corners[m]] = 0;
}

template <class T>
void write(std::string& to, T value) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    to.append(bytes, sizeof(T));
}

} // namespace

Lattice latticeOf(std::span<const gpu::Particle> particles, float falloff, uint32_t cells) {
    if (particles.empty()) throw std::runtime_error("there are no particles; --ticks simulates an emitter first");
    const Grid grid(particles, falloff, cells);
    const std::vector<Field>& field = grid.field();
    const double most = std::ranges::max(field, {}, &Field::extinction).extinction;
    if (!(most > 0)) throw std::runtime_error("there is no extinction: medium.extinction changes it");

    Lattice out{.cell = grid.cell()};
    grid.eachTetrahedron([&](const glm::uvec4& nodes) {
        bool is_thick = false;
        for (int m = 0; m < 4; ++m) is_thick |= field[nodes[m]].extinction >= kSmall * most;
        if (is_thick) out.corners.push_back(nodes);
    });
    std::vector<uint32_t> point_of(field.size(), kNone);
    for (const glm::uvec4& nodes : out.corners)
        for (int m = 0; m < 4; ++m) point_of[nodes[m]] = 0;
    const bool coloured =
        std::ranges::any_of(particles, [&](const gpu::Particle& p) { return p.albedo != particles[0].albedo; });
    for (uint32_t node = 0; node < field.size(); ++node) {
        if (point_of[node] == kNone) continue;
        point_of[node] = uint32_t(out.position.size());
        out.position.push_back(grid.place(node));
        out.sigma_t.push_back(limits::kSigmaT.clamp(float(field[node].extinction)));
        if (coloured)
            out.albedo.push_back(field[node].extinction > 0
                                     ? glm::min(glm::vec3(field[node].scattering / field[node].extinction), 1.0f)
                                     : particles[0].albedo);
    }
    if (!limits::kTetrahedra.holds(double(out.corners.size())) || !limits::kCount.holds(double(out.position.size())))
        throw std::runtime_error(fmt::format("--cells {} makes {} tetrahedra of {} points; allowed: up to {:.0f} of "
                                             "{:.0f}",
                                             cells, out.corners.size(), out.position.size(), limits::kTetrahedra.hi,
                                             limits::kCount.hi));
    for (glm::uvec4& nodes : out.corners)
        for (int m = 0; m < 4; ++m) nodes[m] = point_of[nodes[m]];
    endOutside(out);
    return out;
}

std::string plyOf(const Lattice& lattice, glm::dvec3 origin) {
    const bool far = origin != glm::dvec3(0), few = lattice.position.size() <= 65536;
    const char* const place = far ? "double" : "float";
    std::string out = fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", lattice.position.size());
    for (const char* axis : {"x", "y", "z"}) out += fmt::format("property {} {}\n", place, axis);
    out += "property float sigma_t\n";
    if (!lattice.albedo.empty()) out += "property float red\nproperty float green\nproperty float blue\n";
    out += fmt::format("element tetrahedron {}\nproperty list uchar {} vertex_indices\nend_header\n",
                       lattice.corners.size(), few ? "ushort" : "int");
    for (size_t i = 0; i < lattice.position.size(); ++i) {
        for (int axis = 0; axis < 3; ++axis) {
            if (far)
                write(out, lattice.position[i][axis] + origin[axis]);
            else
                write(out, float(lattice.position[i][axis]));
        }
        write(out, lattice.sigma_t[i]);
        if (!lattice.albedo.empty())
            for (int c = 0; c < 3; ++c) write(out, lattice.albedo[i][c]);
    }
    for (const glm::uvec4& cell : lattice.corners) {
        write(out, uint8_t(4));
        for (int m = 0; m < 4; ++m) {
            if (few)
                write(out, uint16_t(cell[m]));
            else
                write(out, int32_t(cell[m]));
        }
    }
    return out;
}

} // namespace brume::bench
