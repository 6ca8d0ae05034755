// Picture files of the measuring programs: the format follows from the file's name.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/image.h"

namespace brume::bench {

// Empty for a name that writePicture() takes; otherwise one line that names the formats.
std::string pictureRefusal(const std::filesystem::path& file);

// Writes .exr: linear radiance, transmittance and edges. Writes .png, .jpg and .jpeg: what a display shows, JPEG with
// quality 95 and full chroma. Throws std::runtime_error, one line.
void writePicture(const std::filesystem::path& file, const RadianceImage& image, const DisplaySettings& display);
// The same of what a display shows already, to .png, .jpg or .jpeg.
void writePixels(const std::filesystem::path& file, glm::uvec2 size, const std::vector<glm::u8vec3>& pixels);

} // namespace brume::bench
