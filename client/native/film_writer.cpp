#include "client/native/film_writer.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <initializer_list>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "client/native/film.h"
#include "client/native/recorder.h"

extern char** environ;

namespace brume::client {
namespace {

// The run of %04d in the name: where it begins and ends, and how many digits it asks for. Nothing without one.
struct Run {
    size_t begin, end, digits;
};
std::optional<Run> runIn(const std::string& name) {
    const size_t begin = name.find('%');
    if (begin == name.npos) return {};
    size_t end = begin + 1;
    if (end < name.size() && name[end] == '0') ++end;
    size_t digits = 0;
    if (end < name.size() && name[end] >= '1' && name[end] <= '9') digits = size_t(name[end++] - '0');
    if (end >= name.size() || name[end] != 'd' || name.find('%', end) != name.npos) return {};
    return Run{begin, end + 1, digits};
}

bool hasEnding(const std::filesystem::path& out, std::initializer_list<const char*> endings) {
    return std::any_of(endings.begin(), endings.end(), [&](const char* one) { return out.extension() == one; });
}

} // namespace

bool isFilm(const std::filesystem::path& out) {
    return out.string().find('%') != std::string::npos || hasEnding(out, {".mp4", ".mkv", ".webm", ".mov", ".gif"});
}

std::string problemOf(const Options& options) {
    const std::string out = options.out.string();
    if (out.find('%') != out.npos && (!runIn(out) || !hasEnding(out, {".png", ".jpg", ".exr"})))
        return "--out " + out + ": numbered pictures are called like frames-%04d.png, .jpg or .exr";
    if (out.find('%') == out.npos && (options.wishes.width % 2 || options.wishes.height % 2))
        return "--size: a film has an even number of pixels each way";
    if (options.wishes.views != 1 || options.draw)
        return "--out " + out + ": a film is the server's picture of one eye";
    if (!options.impulses.empty()) return "--impulse: a film pushes nothing; record a session and make a film of that";
    if (options.path == PathKind::still && options.seconds == 0)
        return "--out " + out + ": a film of a camera that is still needs --seconds, or --path";
    return {};
}

std::string numbered(const std::string& pattern, uint64_t number) {
    const Run run = *runIn(pattern);
    std::string digits = std::to_string(number);
    if (digits.size() < run.digits) digits.insert(0, run.digits - digits.size(), '0');
    return pattern.substr(0, run.begin) + digits + pattern.substr(run.end);
}

FilmWriter::FilmWriter(std::filesystem::path out, uint32_t fps, uint32_t width, uint32_t height)
    : out_(std::move(out)), width_(width), height_(height) {
    if (!out_.parent_path().empty()) {
        std::error_code error;
        std::filesystem::create_directories(out_.parent_path(), error);
        if (error)
            throw std::runtime_error("cannot make the folder " + out_.parent_path().string() + ": " + error.message());
    }
    if (out_.string().find('%') != std::string::npos) {
        format_ = out_.extension().string().substr(1);
        return;
    }
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error(std::string("no pipe: ") + std::strerror(errno));
    std::signal(SIGPIPE, SIG_IGN); // an ffmpeg that ends is told by the write
    std::vector<std::string> words;
    const auto add = [&](std::initializer_list<const char*> more) {
        words.insert(words.end(), more.begin(), more.end());
    };
    add({"ffmpeg", "-hide_banner", "-loglevel", "error", "-y", "-f", "rawvideo", "-pixel_format", "rgb24"});
    const std::string size = fmt::format("{}x{}", width, height), rate = std::to_string(fps);
    add({"-video_size", size.c_str(), "-framerate", rate.c_str(), "-i", "-"});
    if (out_.extension() == ".gif") {
        add({"-pix_fmt", "rgb8"});
    } else {
        // Without a word on it ffmpeg converts as of standard definition, and players take large films for BT.709.
        add({"-vf", "scale=out_color_matrix=bt709:out_range=tv", "-colorspace", "bt709", "-color_primaries", "bt709"});
        add({"-color_trc", "iec61966-2-1", "-color_range", "tv", "-pix_fmt", "yuv420p", "-crf", "17"});
    }
    words.push_back(out_.string());
    std::vector<char*> arguments;
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[0], STDIN_FILENO);
    const int problem = ::posix_spawnp(&ffmpeg_, "ffmpeg", &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    ::close(ends[0]);
    pipe_ = ends[1];
    if (problem == 0) return;
    ffmpeg_ = -1;
    ::close(std::exchange(pipe_, -1));
    throw std::runtime_error(problem == ENOENT
                                 ? "there is no ffmpeg: install it, or write pictures with --out frames-%04d.png"
                                 : std::string("ffmpeg does not start: ") + std::strerror(problem));
}

FilmWriter::~FilmWriter() {
    if (pipe_ >= 0) ::close(pipe_);
    if (ffmpeg_ > 0) ::waitpid(ffmpeg_, nullptr, 0);
}

// A picture that the server has cut down is none of the film's. A large one may come as JPEG in place of PNG.
void FilmWriter::add(const std::string& picture) {
    const std::span bytes(reinterpret_cast<const uint8_t*>(picture.data()), picture.size());
    if (format_ != "exr" && !decoder_.decode(bytes, int(width_), int(height_), pixels_))
        throw std::runtime_error(fmt::format("frame {} is no picture of {}x{}: {} (does the server draw that size?)",
                                             next_, width_, height_, decoder_.error()));
    if (pipe_ >= 0) {
        pipeIn();
    } else if (const std::string name = numbered(out_.string(), next_); format_ == "png" && !isPng(bytes)) {
        writePng(name, pixels_);
    } else {
        writeFile(name, {picture.data(), picture.size()});
    }
    ++next_;
}

void FilmWriter::pipeIn() const {
    for (size_t at = 0; at < pixels_.rgb.size();) {
        const ssize_t written = ::write(pipe_, pixels_.rgb.data() + at, pixels_.rgb.size() - at);
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) throw std::runtime_error("ffmpeg has ended before the film: see above");
        at += size_t(written);
    }
}

void FilmWriter::finish() {
    if (pipe_ < 0) return;
    ::close(std::exchange(pipe_, -1));
    int status = 0;
    const pid_t ended = ::waitpid(std::exchange(ffmpeg_, -1), &status, 0);
    if (ended < 0 || !WIFEXITED(status) || WEXITSTATUS(status) != 0)
        throw std::runtime_error("ffmpeg made no film: see above");
}

} // namespace brume::client
