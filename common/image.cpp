#include "common/image.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <stdexcept>
#include <string>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStdIO.h>
#include <png.h>

namespace brume {

namespace {

[[noreturn]] void fail(const std::filesystem::path& file, const char* format, std::string what) {
    std::replace(what.begin(), what.end(), '\n', ' ');
    throw std::runtime_error(file.string() + ": " + format + ": " + what);
}

bool sizeIsAllowed(int width, int height) {
    return width > 0 && height > 0 && width <= kMostPixelsASide && height <= kMostPixelsASide;
}

constexpr const char *kEdges = "E", *kMediumAlone = "mediumAlone"; // a channel, an attribute

// Of the window's rows, which lie one after the other. `edges`: null for none.
Imf::FrameBuffer frameBuffer(const glm::vec3* radiance, const float* transmittance, const float* edges,
                             const Imath::Box2i& window) {
    const auto slice = [&](const float* first, size_t stride) {
        const size_t width = window.max.x - window.min.x + 1;
        return Imf::Slice::Make(Imf::FLOAT, first, window, stride, stride * width, 1, 1,
                                1.0); // 1: of a channel that is not there
    };
    Imf::FrameBuffer buffer;
    buffer.insert("R", slice(&radiance->x, sizeof(glm::vec3)));
    buffer.insert("G", slice(&radiance->y, sizeof(glm::vec3)));
    buffer.insert("B", slice(&radiance->z, sizeof(glm::vec3)));
    buffer.insert("T", slice(transmittance, sizeof(float)));
    if (edges) buffer.insert(kEdges, slice(edges, sizeof(float)));
    return buffer;
}

// In bands, so that a short file that claims to be large fails before its picture has taken memory.
RadianceImage readPixels(const std::filesystem::path& file, Imf::InputFile& in) {
    constexpr int kBand = 256; // rows
    const Imath::Box2i window = in.header().dataWindow();
    RadianceImage image{window.max.x - window.min.x + 1, window.max.y - window.min.y + 1, {}, {}};
    for (const char* name : {"R", "G", "B"})
        if (!in.header().channels().findChannel(name))
            fail(file, "EXR", std::string("has no channel ") + name + "; expected R, G, B and, for transmittance, T");
    const auto* alone = in.header().findTypedAttribute<Imf::IntAttribute>(kMediumAlone);
    image.medium_alone = alone && alone->value() != 0;
    const bool has_edges = in.header().channels().findChannel(kEdges) != nullptr;
    std::vector<float> edges;
    for (int y = 0; y < image.height; y += kBand) {
        Imath::Box2i band = window;
        band.min.y += y;
        band.max.y = std::min(band.min.y + kBand - 1, window.max.y);
        const size_t width = image.width, begin = y * width, end = (band.max.y - window.min.y + 1) * width;
        image.radiance.resize(end);
        image.transmittance.resize(end);
        if (has_edges) edges.resize(end - begin);
        in.setFrameBuffer(
            frameBuffer(&image.radiance[begin], &image.transmittance[begin], has_edges ? edges.data() : nullptr, band));
        in.readPixels(band.min.y, band.max.y);
        for (const float edge : edges) image.edges.push_back(edge != 0);
    }
    return image;
}

} // namespace

void writeExr(const std::filesystem::path& file, const RadianceImage& image) {
    const size_t pixels = size_t(image.width) * image.height;
    if (!sizeIsAllowed(image.width, image.height) || image.radiance.size() != pixels ||
        image.transmittance.size() != pixels || (!image.edges.empty() && image.edges.size() != pixels))
        fail(file, "EXR",
             "not written: expected 1 to 16384 pixels a side, and radiance, transmittance and edges of width * height "
             "values");
    std::ofstream out(file, std::ios::binary);
    if (!out) fail(file, "EXR", "cannot be written; check that its folder exists and is yours to write");
    try {
        Imf::Header header(image.width, image.height);
        header.compression() = Imf::ZIP_COMPRESSION;
        for (const char* name : {"R", "G", "B", "T"}) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
        const std::vector<float> edges(image.edges.begin(), image.edges.end());
        if (!edges.empty()) header.channels().insert(kEdges, Imf::Channel(Imf::FLOAT));
        if (image.medium_alone) header.insert(kMediumAlone, Imf::IntAttribute(1));
        Imf::StdOFStream stream(out, file.c_str());
        Imf::OutputFile exr(stream, header);
        exr.setFrameBuffer(frameBuffer(image.radiance.data(), image.transmittance.data(),
                                       edges.empty() ? nullptr : edges.data(), header.dataWindow()));
        exr.writePixels(image.height);
    } catch (const std::exception& error) {
        fail(file, "EXR", std::string("could not be written: ") + error.what());
    }
    out.close(); // the table of lines was written when `exr` went, without a word about errors
    if (!out) fail(file, "EXR", "could not be written to its end; check the free space");
}

RadianceImage readExr(const std::filesystem::path& file) {
    // OpenEXR refuses larger files before it takes memory for them.
    [[maybe_unused]] static const bool limited = [] {
        Imf::Header::setMaxImageSize(kMostPixelsASide, kMostPixelsASide);
        return true;
    }();
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error))
        fail(file, "EXR", "cannot be read; expected a picture with channels R, G, B and, for transmittance, T");
    try {
        Imf::InputFile in(file.c_str());
        return readPixels(file, in);
    } catch (const std::runtime_error&) {
        throw; // ours
    } catch (const std::exception& broken) {
        fail(file, "EXR",
             std::string("cannot be read: ") + broken.what() +
                 "; expected a whole OpenEXR file of at most 16384 pixels a side, written anew if it is broken");
    }
}

void writePng(const std::filesystem::path& file, int width, int height, std::span<const glm::u8vec3> pixels) {
    static_assert(sizeof(glm::u8vec3) == 3);
    if (!sizeIsAllowed(width, height) || pixels.size() != size_t(width) * height)
        fail(file, "PNG", "not written: expected 1 to 16384 pixels a side, and width * height pixels");
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = width;
    image.height = height;
    image.format = PNG_FORMAT_RGB;
    if (!png_image_write_to_file(&image, file.c_str(), 0, pixels.data(), 3 * width, nullptr))
        fail(file, "PNG",
             std::string("could not be written: ") + image.message + "; check its folder and the free space");
}

std::vector<glm::vec3> displayedLight(const RadianceImage& image, const DisplaySettings& display) {
    std::vector<glm::vec3> out;
    out.reserve(image.radiance.size());
    for (const glm::vec3& radiance : image.radiance) {
        glm::vec3 light;
        for (int c = 0; c < 3; ++c) {
            const float exposed = radiance[c] * display.exposure;
            const float x = exposed > 0 ? std::min(exposed, 1e4f) : 0; // also for NaN
            light[c] = display.filmic ? x * (2.51f * x + 0.03f) / (x * (2.43f * x + 0.59f) + 0.14f) : x;
        }
        out.push_back(glm::clamp(light, 0.0f, 1.0f));
    }
    return out;
}

glm::vec3 srgbFromLinear(glm::vec3 light) {
    for (int c = 0; c < 3; ++c)
        light[c] = light[c] > 0.0031308f ? 1.055f * std::pow(light[c], 1 / 2.4f) - 0.055f : 12.92f * light[c];
    return light;
}

std::vector<glm::u8vec3> displayed(const RadianceImage& image, const DisplaySettings& display) {
    std::vector<glm::u8vec3> out;
    out.reserve(image.radiance.size());
    for (const glm::vec3& light : displayedLight(image, display))
        out.emplace_back(255.0f * srgbFromLinear(light) + 0.5f);
    return out;
}

std::vector<uint8_t> mediumMask(const RadianceImage& image, float least) {
    std::vector<uint8_t> out;
    out.reserve(image.transmittance.size());
    for (const float t : image.transmittance) out.push_back(t < 1 - least);
    return out;
}

} // namespace brume
