// Pictures as they are measured: linear radiance and transmittance, their files, and how a viewer would see them.
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
    std::vector<float> transmittance; // of the medium, in [0, 1]; 1 where there is none
};

inline constexpr int kMostPixelsASide = 16384; // of any picture that is read or written

// OpenEXR, float32 channels R G B T, lossless: what is read again is the same bit for bit, also what is not finite.
// Throws std::runtime_error, one line, when the lists do not fit the size, or the file cannot be written.
void writeExr(const std::filesystem::path& file, const RadianceImage& image);

// Channels R G B, half or float, and T where there is one (else transmittance is 1); other channels are skipped. The picture is
// the file's data window. Throws std::runtime_error, one line, for a file that cannot be read, is broken, lacks a channel or is
// larger than 16384 a side.
RadianceImage readExr(const std::filesystem::path& file);

// sRGB, 8 bits a channel. Throws std::runtime_error, one line, when the pixels do not fit the size, or the file cannot be
// written.
void writePng(const std::filesystem::path& file, int width, int height, std::span<const glm::u8vec3> pixels);

// As in shaders/compose.comp.
struct DisplaySettings {
    float exposure = 1; // multiplies radiance, >= 0
    bool filmic = true; // Narkowicz's fit of the ACES curve (2015); false: linear, clipped at 1
};

// Exposed and tone mapped, in [0, 1]: linear light of a display, before the sRGB curve. What is not a number is black.
std::vector<glm::vec3> displayedLight(const RadianceImage& image, const DisplaySettings& display);

// The sRGB curve, of a value in [0, 1] (IEC 61966-2-1).
glm::vec3 srgbFromLinear(glm::vec3 light);

// displayedLight under the sRGB curve, rounded to 8 bits.
std::vector<glm::u8vec3> displayed(const RadianceImage& image, const DisplaySettings& display);

// 1 for pixels with medium: transmittance below 1 - least; 0 for the others.
std::vector<uint8_t> mediumMask(const RadianceImage& image, float least = 1e-3f);

} // namespace brume
