// RadianceImage: linear radiance and transmittance of a picture; its files, and its conversion to what a display shows.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include <glm/glm.hpp>

namespace brume {

// Row by row from the top left; both lists hold width * height values.
struct RadianceImage {
    int width = 0, height = 0;
    std::vector<glm::vec3> radiance;  // linear, Rec. 709
    std::vector<float> transmittance; // of the medium, in [0, 1]; 1 without medium
    // 1 where an object's edge or that of its shadow crosses the pixel, otherwise 0; empty: not known.
    std::vector<uint8_t> edges = {};
    bool medium_alone = false; // True: rendered without sky and ambient light
};

inline constexpr int kMostPixelsASide = 16384; // of a picture that is read or written

// Writes OpenEXR with float32 channels R G B T, and E where edges are known, lossless: reading it gives the same bits,
// also of numbers that are not finite. The attribute mediumAlone holds `medium_alone`. Throws std::runtime_error, one
// line, if the lists do not fit the size, or if the file cannot be written.
void writeExr(const std::filesystem::path& file, const RadianceImage& image);

// Reads OpenEXR: channels R G B, half or float, T if there is one (otherwise transmittance is 1), and E if there is one
// (edges, where it is not 0). Other channels are skipped. The picture is the file's data window. Throws
// std::runtime_error, one line, for a file that cannot be read, is broken, lacks a channel or is larger than 16384 a
// side.
RadianceImage readExr(const std::filesystem::path& file);

// Writes sRGB, 8 bits a channel. Throws std::runtime_error, one line, if the pixels do not fit the size, or if the
// file cannot be written.
void writePng(const std::filesystem::path& file, int width, int height, std::span<const glm::u8vec3> pixels);

// Exposure and tone mapping, the same as in shaders/compose.comp.
struct DisplaySettings {
    float exposure = 1; // multiplies radiance, >= 0
    bool filmic = true; // True: Narkowicz's fit of the ACES curve (2015); false: linear, clipped at 1
};

// Linear light of a display, before the sRGB curve: exposed and tone mapped, in [0, 1]. NaN becomes black.
std::vector<glm::vec3> displayedLight(const RadianceImage& image, const DisplaySettings& display);

// The sRGB curve, of a value in [0, 1] (IEC 61966-2-1).
glm::vec3 srgbFromLinear(glm::vec3 light);

// displayedLight() after the sRGB curve, rounded to 8 bits.
std::vector<glm::u8vec3> displayed(const RadianceImage& image, const DisplaySettings& display);

// A mask of the pixels with medium: 1 where transmittance is below 1 - least, otherwise 0.
std::vector<uint8_t> mediumMask(const RadianceImage& image, float least = 1e-3f);

} // namespace brume
