// Where the frames of a film go: into ffmpeg, or into numbered pictures.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include <sys/types.h>

#include "client/native/jpeg.h"

namespace brume::client {

class FilmWriter {
public:
    // `out`: a film, whose ending tells ffmpeg its format, or a pattern with %04d. Throws std::runtime_error, one line,
    // where there is no ffmpeg, or a folder that cannot be written.
    FilmWriter(std::filesystem::path out, uint32_t fps, uint32_t width, uint32_t height);
    ~FilmWriter();
    FilmWriter(const FilmWriter&) = delete;
    FilmWriter& operator=(const FilmWriter&) = delete;

    // What add() takes: png, jpg or exr.
    std::string_view format() const { return format_; }
    // Both throw std::runtime_error, one line. A picture is that of the size, or it is refused.
    void add(const std::string& picture);
    void finish();

private:
    void pipeIn() const;

    std::filesystem::path out_;
    uint32_t width_, height_;
    std::string format_ = "png";
    uint64_t next_ = 1;
    JpegDecoder decoder_;
    Picture pixels_; // pixels of the newest picture
    int pipe_ = -1;  // to ffmpeg; -1: numbered pictures
    pid_t ffmpeg_ = -1;
};

} // namespace brume::client
