// Pictures of methods slabs and grid against the double-precision reference, from several places.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tests/gpu/closed_form.h"
#include "tests/gpu/truth.h"
#include "tools/reference/camera.h"

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
    // A scene's world at its start.
    static reference::World worldOf(const Scene& scene) {
        const Simulation simulation(scene);
        std::vector<gpu::Particle> particles(simulation.liveCount());
        simulation.write(particles);
        const SceneNow& now = simulation.now();
        return reference::worldOf(scene, particles,
                                  {now.medium, now.light, now.lists.lights, now.lists.fogs, simulation.axes()});
    }
    static Error errorOf(const Scene& scene, const Pose& pose) {
        Stage stage(device(), scene, Simulation(scene).capacity());
        return errorOf(stage, scene, pose);
    }
    static Error errorOf(Stage& stage, const Scene& scene, const Pose& pose) {
        const Picture picture = stage.see(scene, pose, kWidth, kHeight);
        std::vector<glm::uvec2> pixels;
        for (uint32_t y = kEvery / 2; y < kHeight; y += kEvery)
            for (uint32_t x = kEvery / 2; x < kWidth; x += kEvery) pixels.emplace_back(x, y);
        const std::vector<TruePixel> truth =
            truthOf(worldOf(scene), reference::perspective(pose, kWidth, kHeight, kNear), pixels, 1e-5);
        double errors = 0, values = 0, worst = 0;
        int count = 0;
        for (size_t i = 0; i < pixels.size(); ++i) {
            if (truth[i].edge) continue;
            const glm::dvec4 got(picture.at(pixels[i].x, pixels[i].y));
            const glm::dvec3 off = glm::dvec3(got) - truth[i].total;
            EXPECT_TRUE(std::isfinite(got.x + got.y + got.z + got.w)) << pixels[i].x << ' ' << pixels[i].y;
            errors += glm::dot(off, off), values += glm::dot(truth[i].total, truth[i].total), ++count;
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
            Stage stage(device(), scene, Simulation(scene).capacity());
            int number = 0;
            for (const Pose& pose : poses) {
                const Error error = errorOf(stage, scene, pose);
                std::printf("%-6s view %d: %.4f %%, worst pixel %.3f %%\n", method, number, 100 * error.rmse,
                            100 * error.worst);
                EXPECT_LE(error.rmse, allowed) << method << ", view " << number;
                ++number;
            }
        }
    }
};

} // namespace brume::test
