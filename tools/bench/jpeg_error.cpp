#include "tools/bench/jpeg_error.h"

#include <chrono>
#include <cmath>
#include <memory>
#include <stdexcept>

#include <nlohmann/json.hpp>
#include <turbojpeg.h>

#include "common/metrics_flip.h"
#include "server/encode/jpeg.h"
#include "tools/bench/error.h"

namespace brume::bench {
namespace {

// sRGB values in [0, 1].
std::vector<glm::vec3> decoded(const std::vector<uint8_t>& jpeg, glm::uvec2 size) {
    const std::unique_ptr<void, int (*)(tjhandle)> handle(tjInitDecompress(), tjDestroy);
    std::vector<glm::u8vec3> pixels(size_t(size.x) * size.y);
    if (tjDecompress2(handle.get(), jpeg.data(), jpeg.size(), &pixels[0].x, int(size.x), 0, int(size.y), TJPF_RGB, 0) !=
        0)
        throw std::runtime_error(std::string("libjpeg-turbo: ") + tjGetErrorStr2(handle.get()));
    std::vector<glm::vec3> values;
    values.reserve(pixels.size());
    for (const glm::u8vec3& p : pixels) values.push_back(glm::vec3(p) / 255.0f);
    return values;
}

glm::vec3 linearFromSrgb(glm::vec3 v) {
    return glm::mix(v / 12.92f, glm::pow((v + 0.055f) / 1.055f, glm::vec3(2.4f)),
                    glm::vec3(glm::greaterThan(v, glm::vec3(0.04045f))));
}

} // namespace

nlohmann::json jpegRows(const gpu::Device& device, const std::string& variant, const Case& wanted, glm::uvec2 size,
                        const std::vector<std::string>& qualities) {
    Stage stage(device, wanted);
    const RadianceImage image = stage.picture(stage.pose(), size);
    const std::vector<glm::vec3> shown = displayedLight(image, displayOf(stage.scene().render));
    JpegEncoder encoder;
    nlohmann::json rows = nlohmann::json::array();
    for (const std::string& quality : qualities) {
        std::vector<double> ms;
        std::vector<uint8_t> jpeg;
        for (int i = 0; i < 21; ++i) {
            const auto begin = std::chrono::steady_clock::now();
            jpeg = encoder.encode(stage.planes()[0], std::stoi(quality));
            ms.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
        }
        std::vector<glm::vec3> seen = decoded(jpeg, size);
        double squares = 0, flip = 0;
        for (size_t i = 0; i < seen.size(); ++i) {
            const glm::vec3 off = seen[i] - srgbFromLinear(shown[i]);
            squares += double(glm::dot(off, off));
            seen[i] = linearFromSrgb(seen[i]);
        }
        for (const float f : flipMap(int(size.x), int(size.y), seen, shown)) flip += double(f) / double(seen.size());
        const double mse = squares / double(3 * seen.size());
        rows.push_back({{"scene", wanted.scene},
                        {"camera", wanted.camera},
                        {"size", std::to_string(size.x) + 'x' + std::to_string(size.y)},
                        {"variant", variant},
                        {"quality", std::stoi(quality)},
                        {"bytes", jpeg.size()},
                        {"encode_ms", median(ms)},
                        {"psnr", -10 * std::log10(mse)},
                        {"flip", flip}});
    }
    return rows;
}

} // namespace brume::bench
