#include "tests/bench/truth.h"

#include <chrono>
#include <cstdio>
#include <stdexcept>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "tests/reference/medium_reference.h"

namespace brume::bench {
namespace {

constexpr double kNearDepth = 0.05; // m, as the renderer has it
constexpr double kTolerance = 1e-6; // of the reference: a hundredth of the smallest error that a report prints

template <class T>
void add(XXH3_state_t& state, const T& values) {
    XXH3_64bits_update(&state, std::data(values), std::size(values) * sizeof(*std::data(values)));
}

// Of everything that the picture depends on; the version goes up when the reference itself changes.
std::string nameOf(const reference::World& world, std::span<const gpu::Particle> particles, const Pose& pose, glm::uvec2 size,
                   uint32_t every, bool centres) {
    XXH3_state_t state;
    XXH3_64bits_reset(&state);
    add(state, particles);
    std::vector<double> numbers = {
        2, double(size.x), double(size.y), kTolerance, world.anisotropy, world.asymmetry, double(pose.fov_y)};
    if (every != 1) numbers.push_back(every);
    if (centres && !world.obstacles.empty()) numbers.push_back(-1);
    const auto list = [&](glm::dvec3 v) { numbers.insert(numbers.end(), {v.x, v.y, v.z}); };
    for (const auto& blob : world.blobs) numbers.push_back(blob.k);
    for (const auto& light : world.lights) list(light.colour), list(light.to_light), list(light.position);
    for (const auto& o : world.obstacles) {
        list(o.centre), list(o.half_size), list(o.albedo);
        numbers.insert(numbers.end(), {o.yaw, double(o.kind)});
    }
    list(world.sky_zenith), list(world.sky_horizon), list(world.ambient), list(pose.position);
    const glm::quat q = pose.orientation;
    numbers.insert(numbers.end(), {q.x, q.y, q.z, q.w});
    add(state, numbers);
    char name[32];
    std::snprintf(name, sizeof name, "%016llx.exr", static_cast<unsigned long long>(XXH3_64bits_digest(&state)));
    return name;
}

} // namespace

Truth::Truth(std::filesystem::path folder) : folder_(std::move(folder)) { std::filesystem::create_directories(folder_); }

RadianceImage Truth::of(const Stage& stage, const Pose& pose, glm::uvec2 whole, uint32_t every, bool centres) {
    const glm::uvec2 size = thinned(whole, every);
    const std::vector<gpu::Particle> particles = stage.particles();
    const SceneNow& now = stage.simulation().now();
    const reference::World world = reference::worldOf(stage.scene(), particles, now.medium, now.light);
    const std::filesystem::path file = folder_ / nameOf(world, particles, pose, size, every, centres);
    if (std::filesystem::exists(file)) return readExr(file);

    std::fprintf(stderr, "  reference %ux%u of %s ...", size.x, size.y, stage.scene().name.c_str());
    const auto begin = std::chrono::steady_clock::now();
    reference::Settings settings;
    settings.tolerance = kTolerance;
    const int across = world.obstacles.empty() || centres ? 1 : 2;
    reference::Camera camera = reference::perspective(pose, int(size.x) * across, int(size.y) * across, kNearDepth);
    camera.cluster = across;
    camera.cluster_part = 1.0 / every;
    const reference::Picture exact = reference::render(world, camera, settings);
    RadianceImage image{int(size.x), int(size.y), {}, {}};
    const std::vector<glm::dvec3> total = exact.total();
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            glm::dvec3 radiance(0);
            double transmittance = 0;
            for (int i = 0; i < across * across; ++i) {
                const size_t at = (size_t(y) * across + i / across) * exact.width + size_t(x) * across + i % across;
                radiance += total[at] / double(across * across);
                transmittance += exact.transmittance[at] / double(across * across);
            }
            image.radiance.emplace_back(radiance);
            image.transmittance.push_back(float(transmittance));
        }
    const std::filesystem::path part = file.string() + ".part.exr"; // whole or not at all
    writeExr(part, image);
    std::filesystem::rename(part, file);
    std::fprintf(stderr, " %.1f s\n", std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    return image;
}

glm::uvec2 thinned(glm::uvec2 size, uint32_t every) {
    if (every % 2 == 0 || size.x % every != 0 || size.y % every != 0)
        throw std::runtime_error("every " + std::to_string(every) + "th pixel: allowed: an odd number that divides the size");
    return size / every;
}

RadianceImage thinned(const RadianceImage& image, uint32_t every) {
    const glm::uvec2 size = thinned(glm::uvec2(image.width, image.height), every);
    RadianceImage thin{int(size.x), int(size.y), {}, {}};
    for (uint32_t y = 0; y < size.y; ++y)
        for (uint32_t x = 0; x < size.x; ++x) {
            const size_t at = (size_t(y) * every + every / 2) * image.width + size_t(x) * every + every / 2;
            thin.radiance.push_back(image.radiance[at]);
            thin.transmittance.push_back(image.transmittance[at]);
        }
    return thin;
}

} // namespace brume::bench
