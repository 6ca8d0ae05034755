#include "tools/bench/picture_file.h"

#include <fstream>
#include <memory>
#include <stdexcept>
#include <vector>

#include <turbojpeg.h>

namespace brume::bench {
namespace {

constexpr int kQuality = 95;

bool isJpeg(const std::filesystem::path& file) { return file.extension() == ".jpg" || file.extension() == ".jpeg"; }

void writeJpeg(const std::filesystem::path& file, int width, int height, const std::vector<glm::u8vec3>& pixels) {
    const std::unique_ptr<void, int (*)(tjhandle)> handle(tjInitCompress(), tjDestroy);
    std::vector<unsigned char> jpeg(tjBufSize(width, height, TJSAMP_444));
    unsigned char* bytes = jpeg.data();
    unsigned long size = jpeg.size();
    if (tjCompress2(handle.get(), &pixels[0].x, width, 0, height, TJPF_RGB, &bytes, &size, TJSAMP_444, kQuality,
                    TJFLAG_NOREALLOC) != 0)
        throw std::runtime_error(file.string() + ": JPEG: " + tjGetErrorStr2(handle.get()));
    std::ofstream out(file, std::ios::binary);
    out.write(reinterpret_cast<const char*>(bytes), std::streamsize(size));
    if (!out.flush())
        throw std::runtime_error(file.string() + ": JPEG: cannot be written; check its folder and the free space");
}

} // namespace

std::string pictureRefusal(const std::filesystem::path& file) {
    const std::filesystem::path kind = file.extension();
    if (kind == ".exr" || kind == ".png" || isJpeg(file)) return {};
    return file.string() + ": no format is called \"" + kind.string() + "\"; allowed: .exr, .png, .jpg, .jpeg";
}

void writePicture(const std::filesystem::path& file, const RadianceImage& image, const DisplaySettings& display) {
    if (const std::string refused = pictureRefusal(file); !refused.empty()) throw std::runtime_error(refused);
    if (file.extension() == ".exr") return writeExr(file, image);
    writePixels(file, {image.width, image.height}, displayed(image, display));
}

void writePixels(const std::filesystem::path& file, glm::uvec2 size, const std::vector<glm::u8vec3>& pixels) {
    if (isJpeg(file)) return writeJpeg(file, int(size.x), int(size.y), pixels);
    writePng(file, int(size.x), int(size.y), pixels);
}

} // namespace brume::bench
