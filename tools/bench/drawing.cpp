#include "tools/bench/drawing.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include <fmt/format.h>

#include "server/error/error_meter.h"
#include "server/frame/lit_rows.h"
#include "server/inputs/eye_request.h"
#include "tools/bench/drawing_links.h"
#include "tools/reference/camera.h"
#include "tools/reference/pixel.h"
#include "tools/reference/rows.h"

namespace brume::bench {
namespace {

constexpr uint32_t kManySlabs = 64; // that err by nothing
constexpr double kTolerance = 1e-5; // of the reference
constexpr uint32_t kMessages = 24;  // whose bytes are looked at: three of each eight
constexpr double kShows = 0.999;    // transmittance below which a pixel shows the medium

// Relative RMSE of pixels, in %.
struct Sum {
    double errors = 0, squares = 0;
    void add(glm::dvec3 value, glm::dvec3 truth) {
        errors += glm::dot(value - truth, value - truth);
        squares += glm::dot(truth, truth);
    }
    double percent() const { return 100 * std::sqrt(errors / squares); }
};

struct PixelSeen {
    bool counts = false; // True: it shows the medium, and no edge
    glm::dvec3 truth{0}, unrounded{0}, unslabbed{0}, drawn{0};
};

// True: it is a sun that shines.
bool isBrightSun(const reference::LightSource& light) {
    return light.kind == reference::LightSource::Kind::directional && light.colour != glm::dvec3(0);
}

// Bytes of a message a particle: of whole rows before and after they are packed, and of changes, every message and
// every second one.
struct Bytes {
    double plain = 0, whole = 0, changes = 0, half = 0;
};

Bytes bytesOf(Stage& stage) {
    Bytes bytes;
    lit::Packer packer;
    std::array<LitRows, lit::kLayers> held;
    double all = 0, count = 0, upper = 0, upper_count = 0;
    for (uint32_t number = 1; number <= kMessages; ++number) {
        stage.step({});
        stage.step({});
        LitRows rows = litRows(stage.fits(), stage.simulation().firstId());
        const auto particles = double(rows.rows.count);
        if (particles == 0) return bytes;
        const uint32_t reference = lit::referenceOf(number), layer = lit::layerOf(number);
        if (reference > 0) {
            const auto size = double(packer.pack(rows.rows, &held[lit::layerOf(reference)].rows).bytes.size());
            all += size / particles, ++count;
            if (layer > 0) upper += size / particles, ++upper_count;
        }
        if (number == kMessages) {
            const lit::PackedRows whole = packer.pack(rows.rows, nullptr);
            bytes.plain = double(lit::plainBytes(whole.present, rows.rows.count)) / particles;
            bytes.whole = double(whole.bytes.size()) / particles;
        }
        held[layer] = std::move(rows);
    }
    bytes.changes = all / count;
    bytes.half = upper / upper_count;
    return bytes;
}

// Gives each particle the light of points and spots at its centre, as its fluence: what one colour a particle can carry
// of them. Viewers get no such light; the error is why. Precondition: no sun.
void addLamps(const reference::World& world, const reference::Lighting& lighting, lit::Medium& medium) {
    medium.irradiance = medium.straight = glm::dvec3(1);
    medium.scatters_on = true;
    for (lit::Medium::Particle& p : medium.particles) {
        p.fits = {};
        p.fluence = {};
        for (size_t i = 0; i < world.lights.size(); ++i) {
            const reference::Arrival arrival = reference::arrivalAt(world.lights[i], p.centre);
            if (arrival.irradiance == glm::dvec3(0)) continue;
            const glm::dvec3 light = std::exp(-lighting.depth(i, p.centre, arrival)) * arrival.irradiance;
            for (int c = 0; c < 3; ++c) p.fluence[c] += light[c] * glm::dvec4(-arrival.to_light, 1);
        }
    }
}

std::string rowOf(const gpu::Device& device, const CostModel& costs, const DrawingQuestion& question,
                  const std::string& wanted) {
    const size_t colon = wanted.find(':');
    Case one{.scene = wanted.substr(0, colon), .size = question.size};
    if (colon != wanted.npos) one.camera = wanted.substr(colon + 1);
    Stage stage(device, one, question.ticks, costs);
    const Submission::Fits& fits = stage.fits();
    lit::Medium unrounded = litMedium(fits), drawn = litMedium(litRows(fits, 0), fits);
    unrounded.ambient = drawn.ambient = glm::dvec3(0);
    const std::vector<gpu::Particle> particles = stage.particles();
    const SceneNow& now = stage.simulation().now();
    reference::World world = reference::worldOf(
        stage.scene(), particles, {now.medium, now.light, now.lists.lights, now.lists.fogs, stage.simulation().axes()});
    // They would dilute the error.
    world.sky_zenith = world.sky_horizon = world.ambient = glm::dvec3(0), world.haze = 0;
    const reference::Stage truth(world, {.tolerance = kTolerance});
    if (!std::ranges::any_of(world.lights, isBrightSun))
        for (lit::Medium* medium : {&unrounded, &drawn}) {
            medium->mean_cosine = lobesOf(now.medium).meanCosine();
            addLamps(world, truth.lighting, *medium);
        }
    const reference::Camera camera =
        reference::perspective(stage.pose(), int(question.size.x), int(question.size.y), double(kNearDepth));
    std::vector<glm::uvec2> pixels;
    glm::vec3 lo(1e30f), hi(-1e30f);
    for (const gpu::Particle& p : particles) {
        const float reach = 0.3f * p.scale * fits.tick.falloff; // three deviations
        lo = glm::min(lo, p.centre - reach), hi = glm::max(hi, p.centre + reach);
    }
    for (uint64_t seed = 1; pixels.size() < question.pixels; ++seed) {
        const std::vector<glm::uvec2> more = pixelsOf(stage.pose(), question.size, lo, hi, seed);
        if (more.empty()) throw std::runtime_error(wanted + ": its camera does not see the medium");
        pixels.insert(pixels.end(), more.begin(), more.end());
    }
    std::vector<PixelSeen> seen(pixels.size());
    reference::forRows(int(seen.size()), 0, [&] {
        return [&, tracer = reference::PixelTracer(truth, camera)](int i) mutable {
            const glm::uvec2 pixel = pixels[size_t(i)];
            const reference::PixelResult result = tracer.at(pixel);
            PixelSeen& out = seen[size_t(i)];
            out.counts = !result.edge && result.transmittance < kShows;
            if (!out.counts) return;
            reference::Ray ray = reference::rayThrough(camera, pixel.x + 0.5, pixel.y + 0.5);
            const reference::Hit hit = truth.lighting.obstacles().nearest(ray);
            const double far = std::min(ray.end, hit.t);
            const auto total = [&](const lit::Medium& medium, uint32_t slabs) {
                const lit::Seen s = lit::along(medium, ray.origin, ray.direction, ray.begin, far, slabs);
                return s.radiance + s.transmittance * result.centre.background;
            };
            out.truth = result.centre.total();
            out.unslabbed = total(unrounded, kManySlabs);
            out.unrounded = total(unrounded, lit::kSlabs);
            out.drawn = total(drawn, lit::kSlabs);
        };
    });
    Sum light, slabs, rounding, all;
    size_t counted = 0;
    for (const PixelSeen& pixel : seen) {
        if (!pixel.counts) continue;
        ++counted;
        light.add(pixel.unslabbed, pixel.truth);
        slabs.add(pixel.unrounded, pixel.unslabbed);
        rounding.add(pixel.drawn, pixel.unrounded);
        all.add(pixel.drawn, pixel.truth);
    }
    const Bytes bytes = bytesOf(stage);
    return fmt::format("| {} | {} | {} | {:.2f} | {:.2f} | {:.3f} | {:.2f} | {:.1f} | {:.1f} | {:.1f} | {:.1f} |\n",
                       wanted, particles.size(), counted, light.percent(), slabs.percent(), rounding.percent(),
                       all.percent(), bytes.plain, bytes.whole, bytes.changes, bytes.half);
}

} // namespace

std::string drawingTable(const gpu::Device& device, const CostModel& costs, const DrawingQuestion& question) {
    std::string out =
        "| scene | particles | pixels | light, % | slabs, % | rounding, % | drawn, % | bytes: plain | whole | "
        "changes | every second |\n|---|---|---|---|---|---|---|---|---|---|---|\n";
    for (const std::string& scene : question.scenes) {
        const std::string row = rowOf(device, costs, question, scene);
        std::fputs(row.c_str(), stderr);
        out += row;
    }
    if (question.links) out += linksTable(device, costs, question, question.scenes.front());
    return out;
}

} // namespace brume::bench
