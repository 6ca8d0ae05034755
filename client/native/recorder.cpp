#include "client/native/recorder.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <span>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <png.h>

#include "client/native/jpeg.h"

namespace brume::client {
void writeFile(const std::filesystem::path& path, std::span<const char> bytes) {
    errno = 0;
    std::ofstream file(path, std::ios::binary);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    file.close();
    if (!file) throw std::runtime_error("cannot write " + path.string() + ": " + std::strerror(errno));
}

void writePng(const std::filesystem::path& path, const Picture& picture) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = uint32_t(picture.width), image.height = uint32_t(picture.height);
    image.format = PNG_FORMAT_RGB;
    if (!png_image_write_to_file(&image, path.c_str(), 0, picture.rgb.data(), 0, nullptr))
        throw std::runtime_error("cannot write " + path.string() + ": " + image.message);
}

Recorder::Recorder(std::filesystem::path folder, bool save_frames)
    : folder_(std::move(folder)), save_frames_(save_frames) {
    if (folder_.empty()) return;
    std::error_code error;
    std::filesystem::create_directories(folder_, error);
    if (error) throw std::runtime_error("cannot make the folder " + folder_.string() + ": " + error.message());
    writeFile(folder_ / "stats.json", {}); // now, not after an hour of watching
}

void Recorder::frame(const Received& message) {
    if (folder_.empty() || !save_frames_) return;
    const uint32_t views = message.as<wire::Frame>()->jpeg_bytes()->size();
    for (uint32_t view = 0; view < views; ++view) {
        const char* const side = views == 1 ? "" : view == 0 ? "-left" : "-right";
        const auto jpeg = message.parsed().view(view);
        writeFile(folder_ / fmt::format("frame-{:05}{}.{}", next_, side, isPng(jpeg) ? "png" : "jpg"),
                  {reinterpret_cast<const char*>(jpeg.data()), jpeg.size()});
    }
    ++next_;
}

void Recorder::picture(const Picture& picture) {
    if (folder_.empty() || !save_frames_) return;
    writePng(folder_ / fmt::format("frame-{:05}.png", next_), picture);
    ++next_;
}

void Recorder::statistics(const Statistics& statistics) {
    if (folder_.empty()) return;
    const std::string text = statistics.json().dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
    writeFile(folder_ / "stats.json", text);
}

} // namespace brume::client
