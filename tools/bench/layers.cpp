#include "tools/bench/layers.h"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/gtc/quaternion.hpp>
#include <turbojpeg.h>

#include "common/redraw.h"
#include "server/encode/layers_encoder.h"
#include "shaders/shared/depth_layers.h"
#include "shaders/shared/show.h"
#include "tools/bench/error.h"

namespace brume::bench {
namespace {

constexpr uint32_t kCounts[] = {1, 2, 4, 8};
constexpr uint32_t kLayersOfPage = 4;
constexpr int kFrames = 12; // of which the fastest counts

struct Motion {
    const char* name;
    float sideways = 0, turned = 0; // m, degrees
};
constexpr Motion kMotions[] = {{"0"},           {"32 mm", 0.032f}, {"64 mm", 0.064f}, {"0.2 m", 0.2f},
                               {"0.5 m", 0.5f}, {"5°", 0, 5},      {"10°", 0, 10},    {"15°", 0, 15}};

// What is drawn for a view that is shown, with a margin.
Pose wider(const Pose& shown, const LayersQuestion& question) {
    Pose made = shown;
    const Frustum f = frustumOf(shown, question.size.x, question.size.y);
    const float wide = 1 + question.margin;
    made.frustum = {wide * f.left, wide * f.right, wide * f.up, wide * f.down};
    return made;
}
glm::uvec2 widerSize(const LayersQuestion& question) {
    const glm::vec2 wide = (1 + question.margin) * glm::vec2(question.size);
    return 2u * glm::uvec2(glm::round(wide / 2.0f));
}

Pose moved(const Pose& pose, const Motion& motion) {
    Pose out = pose;
    out.position += pose.orientation * glm::vec3(motion.sideways, 0, 0);
    out.orientation = glm::angleAxis(glm::radians(motion.turned), glm::vec3(0, 1, 0)) * pose.orientation;
    return out;
}

double milliseconds(std::chrono::steady_clock::time_point since) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - since).count();
}

std::vector<glm::u8vec3> decoded(const std::vector<uint8_t>& jpeg, uint32_t width, uint32_t height) {
    const std::unique_ptr<void, int (*)(tjhandle)> handle(tjInitDecompress(), tjDestroy);
    std::vector<glm::u8vec3> pixels(size_t(width) * height);
    if (tjDecompress2(handle.get(), jpeg.data(), jpeg.size(), &pixels[0].x, int(width), 0, int(height), TJPF_RGB, 0))
        throw std::runtime_error(std::string("libjpeg-turbo: ") + tjGetErrorStr2(handle.get()));
    return pixels;
}

std::vector<uint8_t> decodedGrey(const std::vector<uint8_t>& jpeg, uint32_t width, uint32_t height) {
    const std::unique_ptr<void, int (*)(tjhandle)> handle(tjInitDecompress(), tjDestroy);
    std::vector<uint8_t> pixels(size_t(width) * height);
    if (tjDecompress2(handle.get(), jpeg.data(), jpeg.size(), pixels.data(), int(width), 0, int(height), TJPF_GRAY, 0))
        throw std::runtime_error(std::string("libjpeg-turbo: ") + tjGetErrorStr2(handle.get()));
    return pixels;
}

std::vector<uint8_t> packed(const uint8_t* plane, uint32_t stride, uint32_t width, uint32_t height) {
    std::vector<uint8_t> out;
    for (uint32_t y = 0; y < height; ++y)
        out.insert(out.end(), plane + size_t(y) * stride, plane + size_t(y) * stride + width);
    return out;
}

// The nodes of `blocks` layers, without the rows that fill JPEG's blocks.
template <class T>
std::vector<T> nodesOf(std::span<const T> plane, const LayeredPicture& of, uint32_t rows_apart, uint32_t blocks) {
    std::vector<T> out;
    for (uint32_t k = 0; k < blocks; ++k) {
        const auto first = plane.begin() + ptrdiff_t(size_t(k) * rows_apart * of.columns);
        out.insert(out.end(), first, first + ptrdiff_t(size_t(of.rows) * of.columns));
    }
    return out;
}

struct Drawn {
    LayeredPicture picture;
    size_t flat_bytes = 0, layer_bytes = 0, surface_bytes = 0;
    double flat_ms = 0, layers_ms = 0;                // of encoding
    double device_ms = 1e30, device_layers_ms = 1e30; // the least of some frames without and with layers
};

Drawn drawn(Stage& stage, const Pose& pose, glm::uvec2 size, uint32_t count, int quality, int frames = 1) {
    Drawn out;
    LayeredPicture& p = out.picture;
    for (const uint32_t of : {0u, count}) {
        double& ms = of == 0 ? out.device_ms : out.device_layers_ms;
        for (int i = 0; i < frames; ++i) ms = std::min(ms, stage.layered(pose, size, of).ms);
    }
    const Stage::Layered last = stage.layered(pose, size, count);
    const PictureView& view = last.picture;
    const DepthLayersView& layers = last.layers;
    JpegEncoder encoder;
    auto begin = std::chrono::steady_clock::now();
    const std::vector<uint8_t> flat = encoder.encode(view, quality);
    out.flat_ms = milliseconds(begin);
    begin = std::chrono::steady_clock::now();
    const EncodedLayers encoded = encodeLayers(layers, view.layout, quality, encoder);
    out.layers_ms = milliseconds(begin);
    out.flat_bytes = flat.size();
    out.layer_bytes = encoded.colours.size() + encoded.data.size();
    out.surface_bytes = encoded.surface.size();
    p.eye = pose;
    p.width = size.x, p.height = size.y;
    p.exposure = layers.exposure, p.filmic = layers.filmic;
    p.count = layers.count, p.columns = layers.columns, p.rows = layers.rows;
    p.spacing = float(layers.spacing), p.first = layers.first;
    p.near = layers.near, p.far = layers.far;
    if (layers.count > 0) {
        const PlaneLayout& layout = layers.colours.layout;
        const uint32_t apart = layers.block_rows, rows = count * apart;
        const std::vector<glm::u8vec3> colours = decoded(encoded.colours, layout.width, layout.height);
        p.colours = nodesOf<glm::u8vec3>(colours, p, apart, layout.height / apart);
        const std::vector<uint8_t> data = decodedGrey(encoded.data, layout.width, 2 * rows);
        const std::span<const uint8_t> both(data);
        p.transmittance = nodesOf<uint8_t>(both.first(data.size() / 2), p, apart, count);
        p.depth = nodesOf<uint8_t>(both.last(data.size() / 2), p, apart, count);
    }
    if (layers.surface) p.surface = packed(layers.surface, view.layout.lumaStride(), size.x, size.y);
    p.picture = quality < 100 ? decoded(flat, size.x, size.y) : stage.shown(pose, size, gpu::kShowPicture);
    return out;
}

// All of it a plane across the view, `depth` m away.
LayeredPicture asPlane(LayeredPicture p, float depth) {
    p.count = 0;
    const float part = std::log(depth / gpu::kNearSurface) / std::log(gpu::kFarSurface / gpu::kNearSurface);
    p.surface.assign(p.picture.size(), uint8_t(std::lround(1 + 253 * std::clamp(part, 0.0f, 1.0f))));
    return p;
}
LayeredPicture distant(LayeredPicture p) {
    p.count = 0, p.surface.clear();
    return p;
}

RadianceImage redrawn(const LayeredPicture& p, const Pose& eye, glm::uvec2 size) {
    RadianceImage out{int(size.x), int(size.y), {}, {}};
    out.radiance.resize(size_t(size.x) * size.y), out.transmittance.resize(out.radiance.size(), 1);
    Redraw(p).draw(eye, size.x, size.y, out.radiance);
    return out;
}

// --- pictures over time ---

constexpr uint32_t kRates[] = {60, 30, 15, 10, 5}; // pictures a second
constexpr uint32_t kLooks = 12, kLookEvery = 7;    // of a display at 60 Hz, and ticks between them

// A camera that goes on for `seconds`.
struct Path {
    const char* name;
    float sideways = 0, around = 0; // m/s; degrees/s about the target
};
constexpr Path kPaths[] = {{"walks, 1.4 m/s", 1.4f}, {"orbits, 10°/s", 0, 10}};

Pose along(const Path& path, const Pose& pose, glm::vec3 target, float seconds) {
    Pose out = turnedAbout(pose, target, glm::radians(path.around) * seconds);
    out.position += out.orientation * glm::vec3(path.sideways * seconds, 0, 0);
    return out;
}

// Relative RMSE (%) and FLIP of what is seen, means over looks.
struct Sight {
    double error = 0, flip = 0;
};
std::string text(const Sight& s) { return fmt::format(" {:.2f} ({:.4f}) |", s.error, s.flip); }

// A picture of the server stays until the next one, and is redrawn at each look of the display. The medium goes on.
std::string overTime(const gpu::Device& device, const CostModel& costs, const LayersQuestion& question,
                     const Case& one) {
    std::string out = "\n| camera | pictures/s | stay | plane | 4 layers |\n|---|---|---|---|---|\n";
    for (const Path& path : kPaths)
        for (const uint32_t rate : kRates) {
            Stage stage(device, one, question.ticks, costs);
            const DisplaySettings display = displayOf(stage.scene().render);
            const glm::vec3 target = stage.scene().camera.target;
            const Pose first = stage.pose();
            const uint32_t period = 60 / rate;
            Sight stays, plane, layers;
            std::optional<Drawn> shown;
            Pose made;
            for (uint32_t tick = 0, looks = 0; looks < kLooks; ++tick, stage.step({})) {
                const Pose now = along(path, first, target, float(tick) / 60);
                if (tick % period == 0) {
                    made = now;
                    shown = drawn(stage, wider(now, question), widerSize(question), kLayersOfPage, question.quality);
                }
                if (tick % kLookEvery != 0) continue;
                ++looks;
                const RadianceImage truth = stage.picture(now, question.size);
                const std::vector<uint8_t> mask = mediumMask(truth);
                const auto add = [&](Sight& to, const LayeredPicture& p, const Pose& eye) {
                    const Errors e = compare(redrawn(p, eye, question.size), truth, display, mask);
                    to.error += 100 * e.relative_rmse / kLooks, to.flip += e.flip / kLooks;
                };
                const LayeredPicture& p = shown->picture;
                add(stays, distant(p), made);
                add(plane, asPlane(p, glm::distance(made.position, target)), now);
                add(layers, p, now);
            }
            out += fmt::format("| {} | {} |", path.name, rate) + text(stays) + text(plane) + text(layers) + '\n';
        }
    return out;
}

std::string tableOf(const gpu::Device& device, const CostModel& costs, const LayersQuestion& question,
                    const std::string& wanted) {
    const size_t colon = wanted.find(':');
    Case one{.scene = wanted.substr(0, colon), .size = question.size};
    if (colon != wanted.npos) one.camera = wanted.substr(colon + 1);
    Stage stage(device, one, question.ticks, costs);
    const Pose shown = stage.pose(), made = wider(shown, question);
    const glm::uvec2 size = widerSize(question);
    const DisplaySettings display = displayOf(stage.scene().render);

    std::string out =
        fmt::format("## {}\n\n{}. Relative RMSE of the medium's pixels in %, FLIP in brackets.\n\n| moved |", wanted,
                    wayText(stage.plan().chosen.settings));
    out += " stays | rotation | plane |";
    std::vector<Drawn> layered;
    for (const uint32_t count : kCounts) {
        layered.push_back(drawn(stage, made, size, count, question.quality, kFrames));
        out += fmt::format(" {} |", count);
    }
    out += "\n|---|---|---|---|---|---|---|---|\n";
    const float target = glm::distance(shown.position, stage.scene().camera.target);
    for (const Motion& motion : kMotions) {
        const Pose eye = moved(shown, motion);
        const RadianceImage truth = stage.picture(eye, question.size);
        const std::vector<uint8_t> mask = mediumMask(truth);
        const auto error = [&](const RadianceImage& picture) {
            const Errors e = compare(picture, truth, display, mask);
            out += fmt::format(" {:.2f} ({:.4f}) |", 100 * e.relative_rmse, e.flip);
        };
        out += fmt::format("| {} |", motion.name);
        const LayeredPicture& flat = layered.front().picture;
        error(redrawn(distant(flat), shown, question.size));
        error(redrawn(distant(flat), eye, question.size));
        error(redrawn(asPlane(flat, target), eye, question.size));
        for (size_t i = 0; i < layered.size(); ++i) {
            const RadianceImage picture = redrawn(layered[i].picture, eye, question.size);
            error(picture);
            if (question.pictures.empty()) continue;
            const auto file = [&](const std::string& of) {
                return std::filesystem::path(question.pictures) /
                       fmt::format("{}-{}-{}.png", one.scene, motion.name, of);
            };
            writePng(file(std::to_string(kCounts[i])), picture.width, picture.height, displayed(picture, display));
            if (i == 0) writePng(file("true"), truth.width, truth.height, displayed(truth, display));
        }
        out += '\n';
    }
    out += "\n| layers | bytes flat | of layers | of surfaces | device, ms flat | with layers | encoding, ms flat "
           "| layers |\n"
           "|---|---|---|---|---|---|---|---|\n";
    for (size_t i = 0; i < layered.size(); ++i)
        out += fmt::format("| {} | {} | {} | {} | {:.1f} | {:.1f} | {:.1f} | {:.1f} |\n", kCounts[i],
                           layered[i].flat_bytes, layered[i].layer_bytes, layered[i].surface_bytes,
                           layered[i].device_ms, layered[i].device_layers_ms, layered[i].flat_ms, layered[i].layers_ms);
    if (question.over_time) out += overTime(device, costs, question, one);
    return out + '\n';
}

} // namespace

std::string layersTables(const gpu::Device& device, const CostModel& costs, const LayersQuestion& question) {
    std::string out;
    for (const std::string& scene : question.scenes) {
        fmt::print(stderr, "  {}\n", scene);
        out += tableOf(device, costs, question, scene);
    }
    return out;
}

} // namespace brume::bench
