#include "client/native/sheets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <glm/gtc/quaternion.hpp>

#include "common/redraw.h"
#include "shaders/shared/depth_layers.h"

namespace brume::client {
namespace {

constexpr float kInfinite = std::numeric_limits<float>::infinity();
constexpr float kLeastSeen = 0.3f;   // transmittance below which the picture does not tell what is behind the layer
constexpr float kLeastLight = 1e-4f; // light of layer and behind it together, below which neither has details
constexpr float kSmooth = 8;         // pixels over which what is behind the layer is a mean, at least
constexpr float kOneSurface = 1.1f;  // most factor between depths of one surface
constexpr int kPatches = 160;        // patches of what is behind the layer, in a row
constexpr float kLeastDepth = 1e-3f; // m, of what the eye can see

// Both curves by table: every pixel of every picture needs them.
struct Curves {
    std::array<float, 256> linear;     // light of each sRGB byte
    std::array<float, 4097> displayed; // sRGB of light in even steps from 0 to 1

    Curves() {
        for (size_t i = 0; i < linear.size(); ++i) {
            const float x = float(i) / 255;
            linear[i] = x <= 0.04045f ? x / 12.92f : std::pow((x + 0.055f) / 1.055f, 2.4f);
        }
        for (size_t i = 0; i < displayed.size(); ++i) {
            const float x = float(i) / float(displayed.size() - 1);
            displayed[i] = x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1 / 2.4f) - 0.055f;
        }
    }
    glm::vec3 linearOf(glm::vec3 srgb) const {
        const glm::vec3 byte = glm::round(255.0f * srgb);
        return {linear[size_t(byte.r)], linear[size_t(byte.g)], linear[size_t(byte.b)]};
    }
    glm::vec3 displayedOf(glm::vec3 light) const {
        const glm::vec3 at = glm::round(float(displayed.size() - 1) * glm::clamp(light, 0.0f, 1.0f));
        return {displayed[size_t(at.r)], displayed[size_t(at.g)], displayed[size_t(at.b)]};
    }
};
const Curves& curves() {
    static const Curves made;
    return made;
}

glm::vec3 texel(const Picture& picture, int x, int y) {
    const uint8_t* at = &picture.rgb[3 * (size_t(std::clamp(y, 0, picture.height - 1)) * size_t(picture.width) +
                                          size_t(std::clamp(x, 0, picture.width - 1)))];
    return glm::vec3(at[0], at[1], at[2]) / 255.0f;
}
void put(std::vector<uint8_t>& texture, size_t at, glm::vec3 colour) {
    const glm::vec3 bytes = glm::round(255.0f * glm::clamp(colour, 0.0f, 1.0f));
    texture[4 * at] = uint8_t(bytes.b), texture[4 * at + 1] = uint8_t(bytes.g), texture[4 * at + 2] = uint8_t(bytes.r);
    texture[4 * at + 3] = 255;
}

// The layer and what is behind it, as the frame tells them.
struct Told {
    const wire::DepthLayers& of;
    Picture picture, colours, data, surface; // surface: empty where there is nothing but sky

    bool isSky() const { return surface.rgb.empty(); }
    // Block 0: the layer. 1: the sky behind it, which lets nothing through.
    glm::vec4 node(int block, int x, int y) const {
        const glm::vec3 shown = texel(colours, x, block * of.block_rows() + y);
        return glm::vec4(curves().linearOf(shown), block == 0 ? texel(data, x, y).r : 0);
    }
    float depth(int x, int y) const { // m
        return of.near() * std::pow(of.far() / of.near(), texel(data, x, of.block_rows() + y).r);
    }
    float surfaceAt(int x, int y) const { // m, of a pixel's surface
        const auto byte = uint8_t(std::lround(255 * texel(surface, x, y).r));
        return byte == gpu::kSkyByte ? kInfinite : gpu::surfaceDepth(byte);
    }
};

// True: a lattice that may be of a picture of this size. Bytes of a server are not trusted.
bool isUsable(const wire::DepthLayers& of, int width, int height) {
    constexpr int kBeyond = 32; // nodes outside of the picture, in rows and columns, at most
    const auto holds = [](float x, float lo, float hi) { return x >= lo && x <= hi; };
    return of.count() == 1 && of.columns() >= 2 && of.columns() <= width + kBeyond && of.rows() >= 2 &&
           of.rows() <= of.block_rows() && of.block_rows() <= height + kBeyond && holds(of.spacing(), 1, 1e4f) &&
           holds(of.first(), -1e5f, 1e5f) && holds(of.near(), 1e-6f, 1e9f) && holds(of.far(), of.near(), 1e9f) &&
           of.far() > of.near();
}

// True: all pictures are there, and as large as the frame says.
bool read(const Received& message, JpegDecoder& decoder, Told& told) {
    const auto& frame = *message.as<wire::Frame>();
    const wire::DepthLayers& of = told.of;
    const auto picture = [&](uint32_t number) { return message.parsed().layerPicture(0, number); };
    const bool sky = picture(2).empty();
    return isUsable(of, frame.width(), frame.height()) &&
           decoder.decode(message.parsed().view(0), frame.width(), frame.height(), told.picture) &&
           decoder.decode(picture(0), of.columns(), (sky ? 2 : 1) * of.block_rows(), told.colours) &&
           decoder.decode(picture(1), of.columns(), 2 * of.block_rows(), told.data) &&
           (sky || decoder.decode(picture(2), frame.width(), frame.height(), told.surface));
}

// Light and transmittance of a block's nodes.
std::vector<glm::vec4> nodesOf(const Told& told, int block) {
    std::vector<glm::vec4> out;
    for (int y = 0; y < told.of.rows(); ++y)
        for (int x = 0; x < told.of.columns(); ++x) out.push_back(told.node(block, x, y));
    return out;
}

// Between nodes, at the middle of a pixel.
glm::vec4 between(const std::vector<glm::vec4>& nodes, const wire::DepthLayers& of, int x, int y) {
    const glm::vec2 node = (glm::vec2(x, y) + 0.5f - of.first()) / of.spacing();
    const glm::vec2 low = glm::clamp(glm::floor(node), glm::vec2(0), glm::vec2(of.columns(), of.rows()) - 2.0f),
                    t = glm::clamp(node - low, 0.0f, 1.0f);
    const size_t below = of.columns(), at = size_t(low.y) * below + size_t(low.x);
    return glm::mix(glm::mix(nodes[at], nodes[at + 1], t.x), glm::mix(nodes[at + below], nodes[at + below + 1], t.x),
                    t.y);
}

// What is behind the layer at its nodes, smooth.
std::vector<glm::vec4> behindNodes(const Told& told, const std::vector<glm::vec4>& layer) {
    if (told.isSky()) return nodesOf(told, 1);
    const wire::DepthLayers& of = told.of;
    std::vector<glm::vec3> rest;
    for (uint32_t i = 0; i < layer.size(); ++i) {
        const glm::vec2 at = of.first() + of.spacing() * glm::vec2(i % of.columns(), i / of.columns());
        const glm::vec3 shown = texel(told.picture, int(at.x), int(at.y));
        rest.push_back(curves().linearOf(shown) - glm::vec3(layer[i]));
    }
    const size_t smooth = of.spacing() < kSmooth ? 1 : 0;
    std::vector<glm::vec4> out;
    for (const glm::vec3& seen : seenThrough(rest, layer, of.columns(), of.rows(), smooth)) out.emplace_back(seen, 0);
    return out;
}

// The textures of what is behind the layer, and of the layer: what the picture shows besides. Details belong to what is
// bright enough to have them.
void addTextures(const Told& told, Sheet& behind, Sheet& layer) {
    const std::vector<glm::vec4> nodes = nodesOf(told, 0), seen_nodes = behindNodes(told, nodes);
    for (Sheet* const sheet : {&behind, &layer}) {
        sheet->width = told.picture.width, sheet->height = told.picture.height;
        sheet->colours.resize(4 * size_t(sheet->width) * size_t(sheet->height));
    }
    layer.transmittance.resize(layer.colours.size());
    for (int y = 0; y < layer.height; ++y)
        for (int x = 0; x < layer.width; ++x) {
            const size_t at = size_t(y) * size_t(layer.width) + size_t(x);
            const glm::vec3 shown = texel(told.picture, x, y);
            const glm::vec4 own = between(nodes, told.of, x, y);
            glm::vec3 seen(between(seen_nodes, told.of, x, y));
            if (!told.isSky()) {
                const glm::vec3 light = curves().linearOf(shown), through = own.a * seen;
                const glm::vec3 part = through / glm::max(glm::vec3(own) + glm::max(through, 0.0f), kLeastLight);
                seen += part * (light - glm::vec3(own) - through) / std::max(own.a, kLeastSeen);
            }
            const glm::vec3 back = curves().displayedOf(seen);
            put(behind.colours, at, back);
            put(layer.transmittance, at, glm::vec3(own.a));
            put(layer.colours, at, shown - own.a * back);
        }
}

// Patches between the layer's nodes, as far as they are in the picture.
void addLayer(Sheet& sheet, const Told& told) {
    const wire::DepthLayers& of = told.of;
    const glm::vec2 size(sheet.width, sheet.height);
    for (int y = 0; y + 1 < of.rows(); ++y)
        for (int x = 0; x + 1 < of.columns(); ++x)
            for (int corner = 0; corner < 4; ++corner) {
                const int i = x + corner % 2, j = y + corner / 2;
                const glm::vec2 at = glm::clamp(of.first() + of.spacing() * glm::vec2(i, j), glm::vec2(0), size);
                sheet.corners.push_back({at.x, at.y, at.x / size.x, at.y / size.y, told.depth(i, j)});
            }
}

// Patches of what is behind. First all of them with the farthest depth around, which is what shows where a nearer
// surface has moved away; then each with its own depth, far to near. One at an edge moves with the nearer surface.
void addSurface(Sheet& sheet, const Told& told) {
    const int side = std::max(4, (sheet.width + kPatches - 1) / kPatches);
    struct Patch {
        int x, y;
        float near, far; // m
    };
    std::vector<Patch> patches;
    for (int y = 0; y < sheet.height; y += side)
        for (int x = 0; x < sheet.width; x += side) {
            Patch patch{x, y, kInfinite, 0};
            for (int corner = 0; corner < 4 && !told.isSky(); ++corner) {
                const float depth = told.surfaceAt(x + corner % 2 * side, y + corner / 2 * side);
                patch.near = std::min(patch.near, depth), patch.far = std::max(patch.far, depth);
            }
            if (told.isSky()) patch.far = kInfinite;
            patches.push_back(patch);
        }
    const auto add = [&](const Patch& patch, float depth, bool own) {
        for (int corner = 0; corner < 4; ++corner) {
            const int x = std::min(patch.x + corner % 2 * side, sheet.width),
                      y = std::min(patch.y + corner / 2 * side, sheet.height);
            sheet.corners.push_back({float(x), float(y), float(x) / float(sheet.width), float(y) / float(sheet.height),
                                     own ? told.surfaceAt(x, y) : depth});
        }
    };
    for (const Patch& patch : patches) add(patch, patch.far, false);
    if (told.isSky()) return;
    std::ranges::stable_sort(patches, [](const Patch& a, const Patch& b) { return a.near > b.near; });
    for (const Patch& patch : patches)
        if (patch.near < kInfinite) add(patch, patch.near, patch.far < kOneSurface * patch.near);
}

} // namespace

std::optional<Sheets> Sheets::of(const Received& message, JpegDecoder& decoder) {
    const auto* frame = message.as<wire::Frame>();
    if (!frame || !frame->layers() || frame->layers()->size() != 1 || frame->jpeg_bytes()->size() != 1) return {};
    Told told{*frame->layers()->Get(0), {}, {}, {}, {}};
    if (!read(message, decoder, told)) return {};
    Sheets out;
    out.width_ = frame->width(), out.height_ = frame->height();
    const wire::Vec3& position = *frame->position();
    const wire::Quat& turn = *frame->orientation();
    out.made_.position = glm::vec3(position.x(), position.y(), position.z());
    out.made_.orientation = glm::quat(turn.w(), turn.x(), turn.y(), turn.z());
    out.made_.fov_y = frame->fov_y();
    if (!brume::isUsable(out.made_)) return {};
    auto& [behind, layer] = out.sheets_;
    addTextures(told, behind, layer);
    addSurface(behind, told);
    addLayer(layer, told);
    return out;
}

std::vector<Vertex> Sheets::seen(const Sheet& sheet, const Pose& eye, float aspect) const {
    const float up = std::tan(made_.fov_y / 2), right = up * width_ / height_;
    const float shown_up = std::tan(eye.fov_y / 2), shown_right = shown_up * aspect;
    const glm::mat3 turn = glm::mat3_cast(glm::inverse(eye.orientation) * made_.orientation);
    const glm::vec3 moved = glm::inverse(eye.orientation) * (made_.position - eye.position);
    std::vector<Vertex> out;
    out.reserve(sheet.corners.size());
    for (size_t patch = 0; patch < sheet.corners.size(); patch += 4) {
        bool behind = false;
        for (size_t i = patch; i < patch + 4; ++i) {
            const Sheet::Corner& corner = sheet.corners[i];
            const glm::vec3 ray(right * (2 * corner.x / width_ - 1), up * (1 - 2 * corner.y / height_), -1);
            const glm::vec3 at = std::isinf(corner.depth) ? turn * ray : turn * (ray * corner.depth) + moved;
            behind = behind || -at.z < kLeastDepth;
            const float z = std::max(-at.z, kLeastDepth);
            out.push_back(
                {0.5f + 0.5f * at.x / z / shown_right, 0.5f - 0.5f * at.y / z / shown_up, corner.u, corner.v});
        }
        if (behind) std::fill(out.begin() + ptrdiff_t(patch), out.end(), Vertex{});
    }
    return out;
}

} // namespace brume::client
