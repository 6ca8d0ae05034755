#include "tools/bench/layered_view.h"

#include <chrono>
#include <cmath>
#include <memory>
#include <stdexcept>

#include <turbojpeg.h>

#include "server/encode/layers_encoder.h"
#include "shaders/shared/depth_layers.h"
#include "shaders/shared/show.h"

namespace brume::bench {
namespace {

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

} // namespace

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

LayeredView layeredView(Stage& stage, const Pose& pose, glm::uvec2 size, uint32_t count, int quality, int frames) {
    LayeredView out;
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

} // namespace brume::bench
