#include "server/operate/replay_pictures.h"

#include <fstream>
#include <limits>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "server/encode/png.h"
#include "server/operate/recording.h"

namespace brume {
namespace {

constexpr int kQuality = 95;
constexpr uint64_t kTellEveryPictures = 100; // pictures

} // namespace

ReplayPictures::ReplayPictures(const Options& options, const gpu::Device& device, const Scene& scene, uint32_t capacity,
                               uint64_t first, uint64_t last)
    : options_(options), first_(first), all_((last - first) * options.fps / 60 + 1), frames_(device, scene, capacity) {
    std::error_code error;
    std::filesystem::create_directories(options.folder, error);
    if (!std::filesystem::is_directory(options.folder))
        throw RecordingError(options.folder.string() + ": no folder, and it cannot be made: " + error.message());
    spdlog::info("{} pictures of {}x{} to '{}', {} a second", all_, options.width, options.height,
                 options.folder.string(), options.fps);
}

void ReplayPictures::ticked(const Simulation& simulation) {
    if (written_ == all_ || simulation.tick() < tickOf(written_)) return;
    const PictureView picture = frames_.picture(simulation, options_.width, options_.height);
    const std::vector<uint8_t> bytes =
        options_.png ? encodePng(picture, std::numeric_limits<size_t>::max()) : jpeg_.encode(picture, kQuality);
    const std::filesystem::path file =
        options_.folder / fmt::format("{:06}.{}", written_, options_.png ? "png" : "jpg");
    std::ofstream out(file, std::ios::binary | std::ios::trunc);
    out.write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
    out.close();
    if (!out) throw RecordingError(file.string() + ": cannot be written; is the disk full?");
    ++written_;
    if (written_ % kTellEveryPictures == 0 || written_ == all_)
        spdlog::info("{} of {} pictures, tick {}", written_, all_, simulation.tick());
}

} // namespace brume
