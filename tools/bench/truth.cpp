#include "tools/bench/truth.h"

#include <atomic>
#include <stdexcept>

#include <fmt/format.h>

#include "server/inputs/eye_request.h"
#include "tools/bench/error.h"
#include "tools/reference/medium_reference.h"
#include "tools/reference/numbers.h"
#include "tools/reference/pixel.h"
#include "tools/reference/progress.h"
#include "tools/reference/rows.h"

namespace brume::bench {
namespace {

constexpr double kTolerance = 1e-6; // of the reference: a hundredth of the smallest error that a report prints

reference::World worldOf(const Stage& stage) {
    const std::vector<gpu::Particle> particles = stage.particles();
    const SceneNow& now = stage.simulation().now();
    return reference::worldOf(stage.scene(), particles,
                              {now.medium, now.light, now.lists.lights, now.lists.fogs, stage.simulation().axes()});
}

// When to stop: no pixel is begun later than `seconds` after the start, once `least` are.
struct Limit {
    double seconds = reference::kInfinity;
    size_t least = 0;
};

// A picture of one row: the pixels, up to the limit.
RadianceImage traced(const reference::World& world, const reference::Camera& camera, std::span<const glm::uvec2> pixels,
                     reference::Progress& progress, const Limit& limit = {}) {
    reference::Settings settings;
    settings.tolerance = kTolerance;
    const reference::Stage stage(world, settings);
    RadianceImage image{int(pixels.size()), 1, {}, {}};
    image.radiance.resize(pixels.size());
    image.transmittance.resize(pixels.size());
    image.edges.resize(pixels.size());
    std::atomic<size_t> end{pixels.size()}; // the first that was too late
    reference::forRows(int(pixels.size()), settings.threads, [&] {
        return [&, tracer = reference::PixelTracer(stage, camera)](int i) mutable {
            if (size_t(i) >= limit.least && progress.seconds() > limit.seconds) {
                for (size_t seen = end; size_t(i) < seen && !end.compare_exchange_weak(seen, size_t(i));) {
                }
                return;
            }
            const reference::PixelResult pixel = tracer.at(pixels[i]);
            image.radiance[i] = pixel.total;
            image.transmittance[i] = float(pixel.transmittance);
            image.edges[i] = pixel.edge;
            progress.done();
        };
    });
    image.width = int(end);
    image.radiance.resize(end), image.transmittance.resize(end), image.edges.resize(end);
    return image;
}

} // namespace

std::string truthFile(const reference::World& world, const Pose& pose, glm::uvec2 size, uint32_t every) {
    constexpr double kVersion = 6; // goes up when the reference itself changes
    reference::Numbers numbers;
    for (const double number : {kVersion, double(size.x), double(size.y), kTolerance, double(every)})
        numbers.add(number);
    numbers.add(world);
    numbers.add(pose);
    return fmt::format("{:016x}.exr", numbers.hash());
}

Truth::Truth(std::filesystem::path folder) : folder_(std::move(folder)) {
    std::filesystem::create_directories(folder_);
}

RadianceImage Truth::of(const Stage& stage, const Pose& pose, glm::uvec2 whole, uint32_t every) {
    const glm::uvec2 size = thinned(whole, every);
    const reference::World world = worldOf(stage);
    const std::filesystem::path file = folder_ / truthFile(world, pose, size, every);
    if (std::filesystem::exists(file)) return readExr(file);

    std::vector<glm::uvec2> pixels;
    for (uint32_t y = 0; y < size.y; ++y)
        for (uint32_t x = 0; x < size.x; ++x) pixels.push_back(glm::uvec2(x, y) * every + every / 2);
    RadianceImage image;
    {
        reference::Progress progress(fmt::format("reference {}x{} of {}", size.x, size.y, stage.scene().name),
                                     pixels.size());
        image = traced(world, reference::perspective(pose, int(whole.x), int(whole.y), kNearDepth), pixels, progress);
    }
    image.width = int(size.x), image.height = int(size.y);
    image.medium_alone = isMediumAlone(stage.scene());
    const std::filesystem::path part = file.string() + ".part.exr"; // whole or not at all
    writeExr(part, image);
    std::filesystem::rename(part, file);
    return image;
}

reference::TrackedPicture tracked(const Stage& stage, const Pose& pose, glm::uvec2 size, int paths) {
    return reference::track(worldOf(stage), reference::perspective(pose, int(size.x), int(size.y), kNearDepth),
                            {.samples = paths});
}

RadianceImage Truth::scattered(const Stage& stage, const Pose& pose, glm::uvec2 size, int paths, double& error) {
    RadianceImage image = of(stage, pose, size); // for the transmittance and the edges
    const reference::TrackedPicture picture = tracked(stage, pose, size, paths);
    double errors = 0, squares = 0;
    for (size_t i = 0; i < image.radiance.size(); ++i) {
        image.radiance[i] = picture.radiance[i];
        errors += glm::dot(picture.standard_error[i], picture.standard_error[i]);
        squares += glm::dot(picture.radiance[i], picture.radiance[i]);
    }
    error = squares > 0 ? std::sqrt(errors / squares) : 0;
    return image;
}

RadianceImage truthAt(const Stage& stage, const Pose& pose, glm::uvec2 size, std::span<const glm::uvec2> pixels,
                      double seconds, size_t least) {
    const reference::World world = worldOf(stage);
    reference::Progress progress(fmt::format("reference of {}, up to {} pixels", stage.scene().name, pixels.size()),
                                 pixels.size());
    RadianceImage image = traced(world, reference::perspective(pose, int(size.x), int(size.y), kNearDepth), pixels,
                                 progress, {seconds, least});
    image.medium_alone = isMediumAlone(stage.scene());
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
    thin.medium_alone = image.medium_alone;
    return thin;
}

} // namespace brume::bench
