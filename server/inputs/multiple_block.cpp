#include "server/inputs/multiple_block.h"

#include <algorithm>
#include <optional>

#include "common/phase_lobes.h"
#include "server/inputs/own_light.h"
#include "shaders/shared/multiple.h"

namespace brume {
namespace {

glm::dvec3 meanAlbedo(std::span<const gpu::Particle> particles) {
    glm::dvec3 sum(0);
    double weights = 0;
    for (const gpu::Particle& p : particles) {
        const double weight = double(p.sigma_t) * double(p.scale) * double(p.scale) * double(p.scale);
        sum += weight * glm::dvec3(p.albedo);
        weights += weight;
    }
    return weights > 0 ? sum / weights : glm::dvec3(0);
}

// True: the colours of some object differ by so much that its light is not taken as grey.
bool hasColours(std::span<const gpu::Opaque> objects) {
    constexpr float kGrey = 0.1f;
    return std::ranges::any_of(objects, [](const gpu::Opaque& object) {
        const glm::vec3 albedo = object.albedo;
        return std::max({albedo.x, albedo.y, albedo.z}) - std::min({albedo.x, albedo.y, albedo.z}) > kGrey;
    });
}

bool isGrey(glm::vec3 colour) { return colour.x == colour.y && colour.x == colour.z; }

// What the highest plane reflects of the sky; nothing without planes.
std::optional<glm::dvec3> groundOf(const Sky& sky, bool reflects, std::span<const gpu::Opaque> objects) {
    const gpu::Opaque* highest = nullptr;
    for (const gpu::Opaque& object : objects)
        if (object.kind == gpu::kPlane && (!highest || object.centre.y > highest->centre.y)) highest = &object;
    if (!highest) return {};
    return skyLitGround(sky, reflects ? glm::dvec3(highest->albedo) : glm::dvec3(0));
}

// True: what the fluxes have got by now is grey.
bool setOwnLight(const gpu::Tick& tick, const OuterLight& outer, gpu::Multiple& multiple) {
    const auto [mean, up] = enteringFluxes(outer, {tick.map.x, tick.map.y, -tick.sun.to_light});
    multiple.own = 1;
    multiple.sun = tick.sun.irradiance;
    multiple.irradiance = glm::vec3(1);
    multiple.entering = mean;
    for (size_t i = 0; i < 3; ++i) multiple.entering_up[i] = up[i];
    return isGrey(multiple.sun) && isGrey(multiple.entering) && isGrey(outer.up);
}

} // namespace

void setMultiple(gpu::Tick& tick, const Sky& sky, const SceneNow& now, std::span<const gpu::Particle> particles,
                 std::span<const gpu::Opaque> objects) {
    tick.multiple.sun = glm::vec3(1);
    tick.multiple.irradiance = tick.sun.irradiance;
    if (now.medium.model == kUnionMedium || particles.empty()) return;
    gpu::Multiple& multiple = tick.multiple;
    if (now.render.scattering == "octaves") {
        multiple.octaves = 1;
    } else if (now.render.scattering == "propagation") {
        constexpr uint32_t kStep = 1 << (gpu::kFluxLevels - 1);
        const PhaseLobes lobes = lobesOf(now.medium);
        const double cosine = lobes.meanCosine(), straight = physics::straightPart(cosine, lobes.secondMoment());
        const glm::dvec3 albedo = meanAlbedo(particles);
        multiple.cells = (now.render.propagation.cells + kStep - 1) / kStep * kStep;
        const bool surfaces = reflects(now.render.propagation);
        bool grey = albedo.x == albedo.y && albedo.x == albedo.z && !(surfaces && hasColours(objects));
        const bool emits = tick.emission != glm::vec3(0);
        if (sky.lights || emits) {
            const OuterLight outer = sky.lights ? outerLight(sky, groundOf(sky, surfaces, objects)) : OuterLight{};
            grey &= setOwnLight(tick, outer, multiple) && !emits;
        }
        multiple.channels = grey ? 1 : 3;
        multiple.mean_cosine = float(cosine);
        multiple.asymmetry = float(physics::beamAsymmetry(cosine, straight));
        for (int c = 0; c < 3; ++c) {
            multiple.passed[c] = float(physics::passedPart(albedo[c], straight));
            multiple.albedo[c] = float(physics::scaledAlbedo(albedo[c], straight));
        }
    }
}

} // namespace brume
