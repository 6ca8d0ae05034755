#include "tools/bench/sheet.h"

#include <algorithm>

#include "shaders/shared/show.h"
#include "tools/bench/picture_file.h"

namespace brume::bench {

void writeSheet(const gpu::Device& device, const Series& series, glm::uvec2 size, const std::filesystem::path& file) {
    const auto columns = uint32_t(series.variants.size()),
               rows = uint32_t(series.scenes.size() * series.cameras.size());
    const glm::uvec2 whole = size * glm::uvec2(columns, rows);
    std::vector<glm::u8vec3> sheet(size_t(whole.x) * whole.y);
    uint32_t row = 0;
    for (const std::string& scene : series.scenes)
        for (const std::string& camera : series.cameras) {
            for (uint32_t column = 0; column < columns; ++column) {
                Stage stage(device, caseOf(series, series.variants[column], scene, camera, false), series.ticks);
                const std::vector<glm::u8vec3> picture = stage.shown(stage.pose(), size, gpu::kShowPicture);
                for (uint32_t y = 0; y < size.y; ++y)
                    std::copy_n(picture.begin() + size_t(y) * size.x, size.x,
                                sheet.begin() + (size_t(row) * size.y + y) * whole.x + size_t(column) * size.x);
            }
            ++row;
        }
    writePixels(file, whole, sheet);
}

} // namespace brume::bench
