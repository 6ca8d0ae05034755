#include "server/net/particles_ply.h"

#include <bit>
#include <cstring>

#include <fmt/format.h>

#include "common/scene.h"

namespace brume::net {
namespace {

static_assert(std::endian::native == std::endian::little);

template <class T>
void put(T value, char*& to) {
    std::memcpy(to, &value, sizeof value);
    to += sizeof value;
}

} // namespace

std::string particlesPly(const TakenParticles& taken) {
    const bool far = taken.origin != glm::dvec3(0);
    const char* const place = far ? "double" : "float";
    std::string out = fmt::format(
        "ply\nformat binary_little_endian 1.0\ncomment scene {}, tick {}, state {:016x}; metres, y up; sizes for "
        "medium.falloff = {}\nelement vertex {}\nproperty {} x\nproperty {} y\nproperty {} z\nproperty float scale\n"
        "property float sigma_t\nproperty float red\nproperty float green\nproperty float blue\nproperty uint id\n",
        taken.scene, taken.tick, taken.state_hash, Medium().falloff, taken.particles.size(), place, place, place);
    const bool shaped = !taken.axes.empty();
    if (shaped)
        for (const char axis : {'a', 'b', 'c'})
            for (const char along : {'x', 'y', 'z'}) out += fmt::format("property float axis_{}_{}\n", axis, along);
    out += "end_header\n";
    const size_t head = out.size(), row = 3 * (far ? sizeof(double) : sizeof(float)) + 5 * sizeof(float) + 4 +
                                          (shaped ? sizeof(gpu::EllipsoidAxes) : 0);
    out.resize(head + row * taken.particles.size());
    char* to = out.data() + head;
    const float per_scale = taken.falloff / Medium().falloff;
    auto id = uint32_t(taken.first);
    for (size_t i = 0; i < taken.particles.size(); ++i) {
        const gpu::Particle& p = taken.particles[i];
        for (int axis = 0; axis < 3; ++axis)
            if (far)
                put(taken.origin[axis] + double(p.centre[axis]), to);
            else
                put(p.centre[axis], to);
        put(p.scale * per_scale, to);
        put(p.sigma_t, to);
        for (int c = 0; c < 3; ++c) put(p.albedo[c], to);
        put(id++, to);
        if (shaped) put(taken.axes[i], to);
    }
    return out;
}

} // namespace brume::net
