#include "server/plan/memory.h"

#include <algorithm>

#include <fmt/format.h>

#include "common/scene.h"
#include "common/tetrahedra.h"
#include "common/volume/volume.h"
#include "server/methods/plans.h"
#include "server/sim/columns.h"
#include "server/sim/simulation.h"
#include "shaders/shared/splat.h"
#include "shaders/shared/tetrahedra.h"
#include "shaders/shared/types.h"

namespace brume {
namespace {

constexpr uint64_t kParticle = sizeof(gpu::Particle),
                   kMerged = kParticle * 3 / 4;                       // a medium worth merging has no more left
constexpr uint64_t kCpu = 2 * uint64_t(Column::count) * sizeof(float) // now, and as at the start
                          + 3 * kParticle + kMerged // of this submission, of the last, ordered, merged
                          + 2 * sizeof(uint64_t)    // SpatialOrder's keys
                          + kParticle;              // a look of the plan
constexpr uint64_t kSubmissions = 3;
constexpr uint64_t kMebi = 1 << 20;
constexpr uint64_t kBitsOfBins =
    (409 + 278 + 7) / 8; // lines of tiles: of slabs at 1920 x 1080, of the largest shadow map
constexpr uint64_t kDevice = kParticle + kMerged * 5 / 4 + kSubmissions * (kParticle + kMerged) // uploads
                             + sizeof(gpu::LightParticle) + 2 * sizeof(gpu::ParticleLight)      // of both lists
                             + 4 * sizeof(uint32_t) // sort: keys and values, twice
                             + kBitsOfBins;

uint64_t deviceBytes() { // of one particle
    uint64_t most = 0;
    for (const MethodPlan* method : methodPlans()) most = std::max(most, method->bytesPerParticle());
    return kDevice + most;
}

} // namespace

ParticleMemory particleMemory(uint32_t count) { return {kCpu * count, deviceBytes() * count}; }

ParticleMemory tetrahedraMemory(const Tetrahedra* mesh) {
    if (!mesh) return {};
    const uint64_t cells = mesh->corners.size(), faces = mesh->faces.size(), nodes = mesh->tree.size();
    // The tree is there twice: of the file, and as the corners lie now.
    return {cells * 2 * sizeof(glm::uvec4) + faces * sizeof(Tetrahedra::Face) + 2 * nodes * sizeof(BoundingNode),
            cells * sizeof(gpu::Tetrahedron) + faces * sizeof(gpu::TetrahedraFace) + nodes * sizeof(gpu::ObjectNode)};
}

ParticleMemory ellipsoidMemory(size_t count) {
    return {count * kParticle, // as balls, ballsOf()
            count *
                ((1 + kSubmissions) * sizeof(gpu::EllipsoidAxes) + 2 * sizeof(gpu::Skew))}; // of light and of members
}

ParticleMemory volumeMemory(const Volume* volume) {
    if (!volume) return {};
    // Nodes are there twice while they are uploaded.
    return {volume->extinction.size() * sizeof(float), 2 * volume->nodes() * sizeof(float)};
}

std::string memoryRefusal(uint32_t count, uint64_t most, uint64_t besides, const Tetrahedra* mesh) {
    const uint64_t all = particleMemory(count).total() + besides + tetrahedraMemory(mesh).total();
    if (all <= most) return {};
    const std::string take = fmt::format("take {} MiB, --memory allows {}", (all + kMebi - 1) / kMebi, most / kMebi);
    if (mesh)
        return fmt::format("{} tetrahedra with {} corners {}: use a smaller mesh or allow more", mesh->corners.size(),
                           count, take);
    const uint64_t fit = (most - std::min(besides, most)) / (kCpu + deviceBytes());
    return fmt::format("{} particles {}: use {} or allow more", count, take,
                       fit > 0 ? fmt::format("at most {} particles", fit) : "fewer particles");
}

uint32_t boundedCapacity(const Scene& scene, const Simulation& simulation, uint64_t most) {
    const uint64_t voxels = volumeMemory(scene.volume.get()).total();
    if (scene.volume && voxels + particleMemory(simulation.capacity()).total() > most)
        throw SceneError(
            fmt::format("scene '{}': its volume takes {} MiB, --memory allows {}: use fewer voxels or allow "
                        "more",
                        scene.name, (voxels + kMebi - 1) / kMebi, most / kMebi));
    const uint64_t besides = simulation.besides() + ellipsoidMemory(simulation.axes().size()).total();
    const std::string wrong = memoryRefusal(simulation.capacity(), most, besides, scene.tetrahedra.get());
    if (!wrong.empty()) throw SceneError("scene '" + scene.name + "': " + wrong);
    return simulation.capacity();
}

} // namespace brume
