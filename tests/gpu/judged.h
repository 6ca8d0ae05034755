// Pictures of methods slabs and grid against the double-precision reference, from several places.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tests/gpu/closed_form.h"
#include "tools/reference/camera.h"
#include "tools/reference/pixel.h"
#include "tools/reference/ray_tracer.h"

namespace brume::test {

class JudgedTest : public GpuTest {
protected:
    static constexpr uint32_t kWidth = 160, kHeight = 90;
    static constexpr double kNear = 0.05;    // m, where pictures begin
    static constexpr uint32_t kEvery = 5;    // one pixel of so many is compared, across and down
    static constexpr double kAllowed = 5e-3; // relative RMSE

    struct Error {
        double rmse, worst; // of total radiance; relative to its RMS
    };
    static Error errorOf(const Scene& scene, const Pose& pose) {
        const Picture picture = render(device(), scene, pose, kWidth, kHeight);
        const Simulation simulation(scene);
        std::vector<gpu::Particle> particles(simulation.liveCount());
        simulation.write(particles);
        const SceneNow& now = simulation.now();
        const reference::World world =
            reference::worldOf(scene, particles, {now.medium, now.light, now.lists.lights, now.lists.fogs});
        const reference::Stage stage(world, {.tolerance = 1e-5});
        reference::RayTracer tracer(stage);
        const bool structure = reference::hasStructure(world);
        const reference::Camera camera = reference::perspective(pose, kWidth, kHeight, kNear);
        double errors = 0, values = 0, worst = 0;
        int count = 0;
        for (uint32_t y = kEvery / 2; y < kHeight; y += kEvery)
            for (uint32_t x = kEvery / 2; x < kWidth; x += kEvery) {
                const auto at = [&](double dx, double dy, bool even) {
                    reference::Ray ray = reference::rayThrough(camera, x + dx, y + dy);
                    ray.even = even;
                    return tracer.trace(ray);
                };
                const reference::PixelResult truth = reference::pixelOf(at, reference::hasEdges(world), structure);
                if (truth.edge) continue;
                const glm::dvec4 got(picture.at(x, y));
                const glm::dvec3 off = glm::dvec3(got) - truth.total;
                EXPECT_TRUE(std::isfinite(got.x + got.y + got.z + got.w)) << x << ' ' << y;
                errors += glm::dot(off, off), values += glm::dot(truth.total, truth.total), ++count;
                worst = std::max(worst, glm::length(off));
            }
        EXPECT_GT(count, 300);
        return {std::sqrt(errors / values), worst / std::sqrt(values / count)};
    }

    // Judges slabs and grid from several places. The grid's nodes are 0.5 standard deviations apart, or as the scene
    // says.
    static void judge(Scene scene, std::initializer_list<Pose> poses, double allowed = kAllowed) {
        for (const char* method : {"slabs", "grid"}) {
            scene.render.method = method;
            if (scene.render.grid.spacing == kAuto) scene.render.grid.spacing = 0.5f;
            int number = 0;
            for (const Pose& pose : poses) {
                const Error error = errorOf(scene, pose);
                std::printf("%-6s view %d: %.4f %%, worst pixel %.3f %%\n", method, number, 100 * error.rmse,
                            100 * error.worst);
                EXPECT_LE(error.rmse, allowed) << method << ", view " << number;
                ++number;
            }
        }
    }
};

} // namespace brume::test
