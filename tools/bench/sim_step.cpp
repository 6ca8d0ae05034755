// Milliseconds that one simulation step takes with 65,535 particles, for every layout: mean, median and worst of many
// steps on one core. brume-sim-bench [particles]
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "server/sim/simulation.h"

using namespace brume;

namespace {

void measure(const char* name, const Scene& scene, std::span<const Command> commands) {
    Simulation simulation(scene);
    std::vector<gpu::Particle> out(simulation.capacity());
    std::vector<double> ms, write_ms;
    const auto timed = [](std::vector<double>& into, auto&& work) {
        const auto begin = std::chrono::steady_clock::now();
        work();
        into.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
    };
    for (int i = 0; i < 600; ++i) {
        timed(ms, [&] { simulation.step(commands); });
        timed(write_ms, [&] { simulation.write(out); });
    }
    double sum = 0;
    for (const double m : ms) sum += m;
    std::sort(ms.begin(), ms.end());
    std::sort(write_ms.begin(), write_ms.end());
    std::printf("%-22s %8u live  mean %.3f  median %.3f  99%% %.3f ms   write %.3f ms   hash %016llx\n", name,
                simulation.liveCount(), sum / static_cast<double>(ms.size()), ms[ms.size() / 2],
                ms[ms.size() * 99 / 100], write_ms[write_ms.size() / 2],
                static_cast<unsigned long long>(simulation.stateHash()));
}

} // namespace

int main(int argc, char** argv) {
    Scene scene;
    scene.lights.resize(1);
    scene.medium.count = argc > 1 ? static_cast<uint32_t>(std::clamp(std::atol(argv[1]), 1000l, 1'000'000l)) : 65'535;
    scene.medium.scale = {0.5f, 1};
    const std::vector<Command> impulses(4, Command{.body = Impulse{.origin = {0, 0, 20}}});
    for (const auto& [name, layout] :
         {std::pair{"cube", Layout::cube}, {"tubes", Layout::tubes}, {"cumulus", Layout::cumulus}}) {
        scene.medium.layout = layout;
        measure(name, scene, {});
    }
    measure("cumulus, 4 impulses", scene, impulses);
    scene.medium.layout = Layout::emitter;
    scene.medium.emitter.life = 4;
    scene.medium.emitter.rate = static_cast<float>(scene.medium.count) / 4.001f;
    measure("emitter", scene, {});
    measure("emitter, 4 impulses", scene, impulses);
    // A ceiling in the smoke, pillars around it, and a grid of triangles that it passes under.
    scene.simulation.collide = true;
    scene.planes.push_back({.height = 0});
    scene.boxes.push_back({.centre = {0, 6, 0}, .size = {3, 0.2f, 3}});
    for (int i = 0; i < 32; ++i) scene.boxes.push_back({.centre = {i % 8 - 4, 2, i / 8 - 2}, .size = {0.1f, 4, 0.1f}});
    measure("emitter, 33 boxes", scene, {});
    scene.boxes.clear();
    const glm::vec3 x(0.05f, 0, 0), z(0, 0, 0.05f);
    for (int row = 0; row < 128; ++row)
        for (int column = 0; column < 256; ++column) {
            const glm::vec3 at = glm::vec3(-6, 5, -3) + float(column) * x + float(row) * z;
            scene.triangles.push_back({.corners = {at, at + x, at + z}, .albedo = {}});
            scene.triangles.push_back({.corners = {at + x, at + x + z, at + z}, .albedo = {}});
        }
    measure("emitter, 65536 triangles", scene, {});
}
