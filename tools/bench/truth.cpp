#include "tools/bench/truth.h"

#include <chrono>
#include <cstdio>
#include <stdexcept>

#define XXH_INLINE_ALL
#include <fmt/format.h>
#include <xxhash.h>

#include "tools/reference/medium_reference.h"

namespace brume::bench {
namespace {

constexpr double kNearDepth = 0.05; // m, as the renderer has it
constexpr double kTolerance = 1e-6; // of the reference: a hundredth of the smallest error that a report prints

// All numbers of a world, in order. The structures are taken apart member by member: one that gets another member does
// not compile until it is counted here.
class Numbers {
public:
    std::vector<double> all;

    void add(double number) { all.push_back(number); }
    void add(glm::dvec3 v) { all.insert(all.end(), {v.x, v.y, v.z}); }
    void add(const reference::Blob& blob) {
        const auto& [centre, scale, k, sigma_t, half_line, albedo] = blob;
        add(centre), add(scale), add(k), add(sigma_t), add(half_line), add(albedo);
    }
    void add(const reference::UnionMedium::Ball& ball) {
        const auto& [centre, radius] = ball;
        add(centre), add(radius);
    }
    void add(const reference::UnionMedium& medium) {
        const auto& [balls, sigma_t, albedo] = medium;
        add(balls), add(sigma_t), add(albedo);
    }
    void add(const reference::Fog& fog) {
        const auto& [sigma_t, albedo, falloff, lo, hi, centre, radius] = fog;
        add(sigma_t), add(albedo), add(falloff), add(lo), add(hi), add(centre), add(radius);
    }
    void add(const reference::LightSource& light) {
        const auto& [kind, colour, to_light, position, axis, cos_outer, cos_inner] = light;
        add(double(kind)), add(colour), add(to_light), add(position), add(axis), add(cos_outer), add(cos_inner);
    }
    void add(const reference::Obstacle& obstacle) {
        const auto& [kind, centre, half_size, yaw, albedo] = obstacle;
        add(double(kind)), add(centre), add(half_size), add(yaw), add(albedo);
    }
    template <class Element>
    void add(const std::vector<Element>& list) {
        add(double(list.size()));
        for (const Element& element : list) add(element);
    }
    void add(const reference::World& world) {
        const auto& [blobs, support, cut_light, composition, balls, fogs, lights, obstacles, zenith, horizon, ambient,
                     anisotropy, asymmetry] = world;
        add(blobs), add(double(support)), add(double(cut_light)), add(double(composition)), add(balls), add(fogs),
            add(lights);
        add(obstacles), add(zenith), add(horizon), add(ambient), add(anisotropy), add(asymmetry);
    }
    void add(const Frustum& frustum) {
        const auto& [left, right, up, down] = frustum;
        add(left), add(right), add(up), add(down);
    }
    void add(const Pose& pose) {
        const auto& [position, orientation, fov_y, eye_separation, frustum, right_frustum] = pose;
        add(glm::dvec3(position));
        for (int i = 0; i < 4; ++i) add(double(orientation[i]));
        add(fov_y), add(eye_separation), add(frustum), add(right_frustum);
    }
};

} // namespace

std::string truthFile(const reference::World& world, const Pose& pose, glm::uvec2 size, uint32_t every, bool centres) {
    constexpr double kVersion = 3; // goes up when the reference itself changes
    Numbers numbers;
    for (const double number : {kVersion, double(size.x), double(size.y), kTolerance, double(every)})
        numbers.add(number);
    numbers.add(centres && !world.obstacles.empty() ? 1.0 : 0.0);
    numbers.add(world);
    numbers.add(pose);
    return fmt::format("{:016x}.exr", XXH3_64bits(numbers.all.data(), numbers.all.size() * sizeof(double)));
}

Truth::Truth(std::filesystem::path folder) : folder_(std::move(folder)) {
    std::filesystem::create_directories(folder_);
}

RadianceImage Truth::of(const Stage& stage, const Pose& pose, glm::uvec2 whole, uint32_t every, bool centres) {
    const glm::uvec2 size = thinned(whole, every);
    const std::vector<gpu::Particle> particles = stage.particles();
    const SceneNow& now = stage.simulation().now();
    const reference::World world = reference::worldOf(stage.scene(), particles, now.medium, now.light);
    const std::filesystem::path file = folder_ / truthFile(world, pose, size, every, centres);
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
        throw std::runtime_error("every " + std::to_string(every) +
                                 "th pixel: allowed: an odd number that divides the size");
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
