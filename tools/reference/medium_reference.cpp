#include "tools/reference/medium_reference.h"

#include <algorithm>
#include <cmath>

#include "tools/reference/rows.h"

namespace brume::reference {

std::vector<glm::dvec3> Picture::total() const {
    std::vector<glm::dvec3> sum = radiance;
    for (size_t i = 0; i < sum.size(); ++i) sum[i] += transmittance[i] * background[i];
    return sum;
}

Picture render(const World& world, const Camera& camera, const Settings& settings) {
    const Stage stage(world, settings);
    const size_t size = static_cast<size_t>(camera.width) * camera.height;
    Picture picture{camera.width, camera.height, {}, {}, {}};
    picture.radiance.resize(size);
    picture.transmittance.resize(size);
    picture.background.resize(size);
    forRows(camera.height, settings.threads, [&] {
        return [&, tracer = RayTracer(stage)](int y) mutable {
            for (int x = 0; x < camera.width; ++x) {
                const RayResult result = tracer.trace(rayThrough(camera, x + 0.5, y + 0.5));
                const size_t pixel = static_cast<size_t>(y) * camera.width + x;
                picture.radiance[pixel] = result.scattered;
                picture.transmittance[pixel] = result.transmittance;
                picture.background[pixel] = result.background;
            }
            if (settings.row_done) settings.row_done();
        };
    });
    return picture;
}

RayResult along(const World& world, const Ray& ray, const Settings& settings) {
    const Stage stage(world, settings);
    return RayTracer(stage).trace(ray);
}

World worldOf(const Medium& medium, const Light& light, Model model) {
    World world;
    world.blobs = blobsOf(medium.particles, medium.falloff);
    world.lights = {directional(light)};
    world.phase = {medium.anisotropy, medium.asymmetry};
    if (model != Model::overlapping) world.composition = Composition::sequential;
    if (model == Model::sequential_tetrahedron) world.support = Support::tetrahedron;
    return world;
}

Picture render(const Medium& medium, const Light& light, const Pose& pose, int width, int height, Model model,
               const Settings& settings) {
    return render(worldOf(medium, light, model), perspective(pose, width, height), settings);
}

double relativeRmse(std::span<const glm::dvec3> value, std::span<const glm::dvec3> reference) {
    double largest = 0, error = 0, size = 0;
    for (const glm::dvec3& r : reference) largest = std::max({largest, r.x, r.y, r.z});
    for (size_t i = 0; i < reference.size(); ++i) {
        for (int channel = 0; channel < 3; ++channel) {
            const double r = reference[i][channel];
            if (r <= 1e-3 * largest) continue;
            error += (value[i][channel] - r) * (value[i][channel] - r);
            size += r * r;
        }
    }
    return size == 0 ? 0 : std::sqrt(error / size);
}

} // namespace brume::reference
