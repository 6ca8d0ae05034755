#include "client/native/options.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iostream>
#include <stdexcept>

#include <CLI/CLI.hpp>

#include "client/native/film.h"
#include "common/option_range.h"
#include "common/scene_camera.h"
#include "common/view_names.h"

namespace brume::client {
namespace {

[[noreturn]] void refuse(const std::string& option, const std::string& text, const std::string& allowed) {
    throw CLI::ValidationError(option, "'" + text + "' is not " + allowed);
}

// Exactly N finite numbers of at most 1e6 in magnitude, separated by commas; nothing otherwise.
template <size_t N>
std::optional<std::array<float, N>> numbers(std::string_view text) {
    std::array<float, N> values{};
    const char* at = text.data();
    const char* const end = at + text.size();
    for (size_t i = 0; i < N; ++i) {
        const auto [next, error] = std::from_chars(at, end, values[i]);
        const bool separated = i + 1 < N ? next != end && *next == ',' : next == end;
        if (error != std::errc{} || !separated || !(std::abs(values[i]) <= 1e6f)) return {};
        at = next + (i + 1 < N ? 1 : 0);
    }
    return values;
}

void parseSize(const std::string& text, Wishes& wishes) {
    const std::string allowed = "a size: WIDTHxHEIGHT in pixels of one eye, each from 16 to 8192, such as 640x360";
    const size_t cross = text.find('x');
    if (cross == text.npos) refuse("--size", text, allowed);
    const auto side = [&](std::string_view digits) {
        uint32_t value = 0;
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
        if (error != std::errc{} || end != digits.data() + digits.size() || value < 16 || value > 8192)
            refuse("--size", text, allowed);
        return static_cast<uint16_t>(value);
    };
    wishes.width = side(std::string_view(text).substr(0, cross));
    wishes.height = side(std::string_view(text).substr(cross + 1));
}

CameraPath parseCamera(const std::string& text) {
    const std::string allowed =
        "a camera: x,y,z,tx,ty,tz in metres, standing at x,y,z and looking at another point tx,ty,tz";
    const auto given = numbers<6>(text);
    if (!given) refuse("--camera", text, allowed);
    const auto& n = *given;
    CameraPath camera;
    camera.position = {n[0], n[1], n[2]};
    camera.target = {n[3], n[4], n[5]};
    if (!(glm::length(camera.position - camera.target) > 1e-3f)) refuse("--camera", text, allowed);
    return camera;
}

TimedImpulse parseImpulse(const std::string& text) {
    const std::string allowed =
        "a push: T:ox,oy,oz,dx,dy,dz,strength with T in seconds from 0, a ray from o along d (not zero)";
    const size_t colon = std::min(text.find(':'), text.size());
    const auto seconds = numbers<1>(std::string_view(text).substr(0, colon));
    const auto given = numbers<7>(std::string_view(text).substr(std::min(colon + 1, text.size())));
    if (!seconds || !given || (*seconds)[0] < 0) refuse("--impulse", text, allowed);
    const auto& n = *given;
    const glm::vec3 direction(n[3], n[4], n[5]);
    if (!(glm::length(direction) > 1e-6f)) refuse("--impulse", text, allowed);
    return {(*seconds)[0], Impulse{{n[0], n[1], n[2]}, glm::normalize(direction), glm::vec3(0), n[6]}};
}

} // namespace

std::optional<Options> parseOptions(int argc, const char* const* argv, int& exit_code) {
    Options options;
    std::vector<std::string> urls{"ws://127.0.0.1:8080"};
    std::string size = "640x360", camera, path = "still", out, token_file, ca;
    std::vector<std::string> impulses;
    bool stereo = false, no_save = false, no_reconnect = false;

    CLI::App app("Shows one viewer's picture of a brume server's shared cloud, in a window or without one.",
                 "brume-client");
    app.set_version_flag("--version", "brume-client " BRUME_VERSION);
    app.add_option("--url", urls,
                   "The server: ws://host:port, or wss://host:port for TLS; or its page, http://host:port. Or several "
                   "servers of one shared scene, with commas: the next one is tried at once when one is lost")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->default_str("ws://127.0.0.1:8080");
    app.add_option("--token-file", token_file, "File with the token that lets in; without it BRUME_TOKEN");
    app.add_option("--ca", ca, "PEM file of who vouches for a wss:// server, instead of whom the system trusts");
    app.add_option("--size", size, "Pixels of one eye: WIDTHxHEIGHT")->capture_default_str();
    app.add_flag("--stereo", stereo, "Left and right eye side by side, 64 mm apart");
    allow(app.add_option("--quality", options.wishes.quality, "JPEG quality wished for, 1 to 100; 0 = the server's"), 0,
          100);
    app.add_option("--view", options.wishes.view, "How the picture is made, in its place: " + allViewNames())
        ->capture_default_str()
        ->check(CLI::IsMember(std::vector<std::string>(std::begin(kViewNames), std::end(kViewNames))));
    app.add_option("--name", options.wishes.name, "Name that other viewers see, instead of the token's")
        ->check([](const std::string& text) { return std::string(text.size() <= 64 ? "" : "at most 64 bytes"); });
    app.add_option("--follow", options.wishes.follow,
                   "Show what the person of this name sees, as long as they are there");
    app.add_option("--camera", camera,
                   "Where to stand and where to look: x,y,z,tx,ty,tz in metres; the server's own if not given");
    app.add_option(
           "--path", path,
           "How the camera moves by itself: still, orbit, fly, walk, keys (the scene's key views), or a file with key "
           "views: a scene, or TOML or JSON of keys alone; orbit with --pause and --frames N: N even steps")
        ->capture_default_str();
    app.add_option("--impulse", impulses,
                   "Push the cloud T seconds after the first frame: T:ox,oy,oz,dx,dy,dz,strength; repeatable");
    app.add_flag("--pause", options.pause, "Pause the scene, for everybody, before the first picture");
    app.add_flag("--draw", options.draw,
                 "Draw here, with this machine's Vulkan device, from particles that the server has lit");
    app.add_flag("--redraw", options.redraw,
                 "Redraw pictures in the window where its camera is by now, from a layer with depth");
    app.add_flag("--headless", options.headless, "No window");
    allow(app.add_option("--frames", options.frames, "Stop after so many frames; 0 = go on"), 0, 10'000'000);
    allow(app.add_option("--seconds", options.seconds, "Stop so long after the first frame; 0 = go on"), 0.0, 1e7);
    app.add_option("--out", out,
                   "Write the frames (frame-00001.jpg ...) and stats.json to this folder; without a window also a film "
                   "of the path, each frame at whole size and at rest: film.mp4 (with ffmpeg), or frames-%04d.png");
    allow(app.add_option("--fps", options.fps, "Frames a second of a film")->capture_default_str(), 1, 240);
    app.add_flag("--no-save", no_save, "With --out: only stats.json, no pictures");
    allow(app.add_option("--timeout", options.timeout, "Give a connection up after so many seconds without a frame")
              ->capture_default_str(),
          0.1, 3600.0);
    app.add_flag(
        "--no-reconnect", no_reconnect,
        "End when the connection is lost. Else it is tried again: in a window for ever, without one for a minute");
    app.footer(
        "In the window: drag to turn, wheel to come nearer, W A S D Q E to move, F to fly or orbit,\n"
        "Ctrl+drag to push the cloud, Space to pause it for everyone,\n"
        "Ctrl+Z to undo the last change of anybody, T to point for all to see, C to see where others look from,\n"
        "Escape to leave.");

    try {
        app.parse(argc, argv);
        options.servers.clear();
        for (const std::string& url : urls) {
            Endpoint& server = options.servers.emplace_back(parseUrl(url));
            server.token = readToken(token_file);
            server.ca = ca;
        }
        parseSize(size, options.wishes);
        if (options.draw && (options.redraw || stereo || options.wishes.view != "picture"))
            throw CLI::ValidationError("--draw", "is for plain pictures of one eye");
        if (options.draw) options.wishes.draw_hz = kDrawHz;
        if (options.redraw && (options.headless || stereo))
            throw CLI::ValidationError("--redraw", "is for a window with one eye");
        options.wishes.views = stereo ? 2 : 1;
        const auto kind = pathNamed(path);
        std::error_code ignored;
        if (!kind && !std::filesystem::is_regular_file(path, ignored))
            refuse("--path", path, "still, orbit, fly, walk, keys, or a file with key views");
        options.path = kind.value_or(PathKind::keys);
        if (!kind) options.keys = std::make_shared<const KeyPath>(loadCameraKeys(path));
        if (!camera.empty()) options.camera = parseCamera(camera);
        if (options.camera) options.camera->kind = options.path;
        if (options.camera) options.camera->keys = options.keys;
        for (const auto& text : impulses) options.impulses.push_back(parseImpulse(text));
        std::stable_sort(options.impulses.begin(), options.impulses.end(),
                         [](const TimedImpulse& a, const TimedImpulse& b) { return a.seconds < b.seconds; });
        options.out = out;
        options.save = !no_save;
        options.reconnect = !no_reconnect;
        options.film = isFilm(options.out);
        if (options.film && !options.headless) throw CLI::ValidationError("--out", "a film is made with --headless");
        if (const std::string problem = options.film ? problemOf(options) : ""; !problem.empty())
            throw CLI::ValidationError(problem);
        if (!out.empty() && !options.film && options.save && options.frames == 0 && options.seconds == 0)
            throw CLI::ValidationError("--out",
                                       "needs --frames or --seconds, so that the disk does not fill up (or --no-save)");
    } catch (const CLI::Success& success) { // --help, --version
        exit_code = app.exit(success);
        return {};
    } catch (const std::exception& error) {
        std::cerr << "brume-client: " << error.what() << "; --help lists what there is\n";
        exit_code = 2;
        return {};
    }
    return options;
}

} // namespace brume::client
