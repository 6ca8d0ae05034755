// brume-reference: a shipped scene in double precision, as the server shows it after some ticks. Prints how long it
// took and how far a coarser tolerance is from it; writes the picture as PFM (linear radiance, 32-bit float).
#include <chrono>
#include <cstdio>
#include <fstream>
#include <iostream>

#include <CLI/CLI.hpp>

#include "common/option_range.h"
#include "server/sim/simulation.h"
#include "tools/reference/medium_reference.h"
#include "tools/reference/progress.h"

namespace {

using namespace brume;

void writePfm(const std::string& file, const reference::Picture& picture) {
    std::ofstream out(file, std::ios::binary);
    out << "PF\n" << picture.width << ' ' << picture.height << "\n-1\n"; // little-endian, bottom row first
    const std::vector<glm::dvec3> total = picture.total();
    for (int y = picture.height - 1; y >= 0; --y)
        for (int x = 0; x < picture.width; ++x) {
            const glm::vec3 pixel(total[static_cast<size_t>(y) * picture.width + x]);
            out.write(reinterpret_cast<const char*>(&pixel), sizeof pixel);
        }
}

} // namespace

int main(int argc, char** argv) {
    std::string scene_name = "cloud", out;
    int width = 160, height = 90, ticks = 1;
    double tolerance = 1e-8, compare = 0;
    bool sequential = false, tetrahedron = false;
    CLI::App app{"brume-reference: a shipped scene in double precision."};
    app.add_option("--scene", scene_name, "a shipped scene or a file")->capture_default_str();
    allow(app.add_option("--width", width)->capture_default_str(), 1, 8192);
    allow(app.add_option("--height", height)->capture_default_str(), 1, 8192);
    allow(app.add_option("--ticks", ticks, "of 1/60 s before the picture")->capture_default_str(), 0, 1'000'000);
    allow(app.add_option("--tolerance", tolerance)->capture_default_str(), 1e-12, 1e-2);
    allow(app.add_option("--compare", compare, "render with this tolerance, too, and print the difference"), 1e-12,
          1e-2);
    app.add_flag("--sequential", sequential, "particles composited one after another");
    app.add_flag("--tetrahedron", tetrahedron, "particles end at their tetrahedra along the view");
    app.add_option("--out", out, "a .pfm file");
    CLI11_PARSE(app, argc, argv);
    try {
        const Scene scene = loadScene(findScene(scene_name, BRUME_SCENES));
        Simulation simulation(scene);
        for (int i = 0; i < ticks; ++i) simulation.step({});
        std::vector<gpu::Particle> particles(simulation.liveCount());
        simulation.write(particles);
        const SceneNow& now = simulation.now();
        reference::World world = reference::worldOf(
            scene, particles, {now.medium, now.light, now.lists.lights, now.lists.fogs, simulation.axes()});
        if (sequential) world.composition = reference::Composition::sequential;
        if (tetrahedron) world.support = reference::Support::tetrahedron;
        const reference::Camera camera = reference::perspective(
            lookAt(scene.camera.position, scene.camera.target, scene.camera.fov_y), width, height);
        const auto timed = [&](double with) {
            reference::Settings settings;
            settings.tolerance = with;
            reference::Progress progress(scene.name, size_t(height));
            settings.row_done = [&] { progress.done(); };
            const auto begin = std::chrono::steady_clock::now();
            reference::Picture picture = reference::render(world, camera, settings);
            const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
            std::printf("%s, %zu particles, %dx%d, tolerance %g: %.1f s\n", scene.name.c_str(), particles.size(), width,
                        height, with, seconds);
            std::fflush(stdout);
            return picture;
        };
        const reference::Picture picture = timed(tolerance);
        if (compare > 0)
            std::printf("relative RMSE of tolerance %g against it: %.2g\n", compare,
                        reference::relativeRmse(timed(compare).radiance, picture.radiance));
        if (!out.empty()) writePfm(out, picture);
        return 0;
    } catch (const std::exception& e) {
        std::cerr << "brume-reference: " << e.what() << '\n';
        return 1;
    }
}
