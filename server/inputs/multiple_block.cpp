#include "server/inputs/multiple_block.h"

#include <algorithm>

#include "common/phase_lobes.h"
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

} // namespace

void setMultiple(gpu::Tick& tick, const SceneNow& now, std::span<const gpu::Particle> particles,
                 std::span<const gpu::Opaque> objects) {
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
        const bool grey = albedo.x == albedo.y && albedo.x == albedo.z;
        multiple.channels = grey && !(reflects(now.render.propagation) && hasColours(objects)) ? 1 : 3;
        multiple.mean_cosine = float(cosine);
        multiple.asymmetry = float(physics::beamAsymmetry(cosine, straight));
        for (int c = 0; c < 3; ++c) {
            multiple.passed[c] = float(physics::passedPart(albedo[c], straight));
            multiple.albedo[c] = float(physics::scaledAlbedo(albedo[c], straight));
        }
    }
}

} // namespace brume
