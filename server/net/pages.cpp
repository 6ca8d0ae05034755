#include "server/net/pages.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <optional>

#include <fmt/format.h>

#include "server/net/routes.h"
#include "server/net/uri.h"

namespace brume::net {
namespace {

namespace fs = std::filesystem;

// The page's largest file is below 1 MiB. The limit keeps huge files out of memory if --web-root names a wrong folder.
constexpr uintmax_t kMaxFileBytes = 32 << 20;

std::string_view typeOf(const fs::path& file) {
    static constexpr std::array<std::pair<std::string_view, std::string_view>, 16> kTypes{{
        {".html", "text/html; charset=utf-8"},
        {".js", "text/javascript; charset=utf-8"},
        {".mjs", "text/javascript; charset=utf-8"},
        {".css", "text/css; charset=utf-8"},
        {".json", "application/json"},
        {".map", "application/json"},
        {".webmanifest", "application/manifest+json"},
        {".svg", "image/svg+xml"},
        {".png", "image/png"},
        {".jpg", "image/jpeg"},
        {".webp", "image/webp"},
        {".ico", "image/x-icon"},
        {".wasm", "application/wasm"},
        {".woff2", "font/woff2"},
        {".txt", "text/plain; charset=utf-8"},
        {".md", "text/plain; charset=utf-8"},
    }};
    const std::string extension = file.extension().string();
    const auto found =
        std::find_if(kTypes.begin(), kTypes.end(), [&](const auto& type) { return type.first == extension; });
    return found == kTypes.end() ? "application/octet-stream" : found->second;
}

// The path below the root that a request names. Nothing if the path is not allowed.
std::optional<fs::path> relativePath(std::string_view encoded) {
    const auto decoded = percentDecode(encoded);
    if (!decoded || !decoded->starts_with('/')) return {};
    if (*decoded == "/") return "index.html";
    fs::path out;
    std::string_view rest = std::string_view(*decoded).substr(1);
    for (;;) {
        const size_t end = std::min(rest.find('/'), rest.size());
        const std::string_view segment = rest.substr(0, end);
        // Refused: "..", hidden files, and characters that some systems take for a separator.
        if (segment.empty() || segment.front() == '.' ||
            segment.find_first_of(std::string_view("\\\0:", 3)) != segment.npos)
            return {};
        out /= segment;
        if (end == rest.size()) return out;
        rest.remove_prefix(end + 1);
    }
}

// `file` with its links resolved. Nothing unless the result is a plain file below `root`.
std::optional<fs::path> inside(const fs::path& root, const fs::path& file) {
    std::error_code error;
    const fs::path real_root = fs::canonical(root, error);
    if (error) return {};
    const fs::path real = fs::canonical(root / file, error);
    if (error || !fs::is_regular_file(real, error) || error) return {};
    const auto [root_end, ignored] = std::mismatch(real_root.begin(), real_root.end(), real.begin(), real.end());
    return root_end == real_root.end() ? std::optional(real) : std::nullopt;
}

} // namespace

Reply Pages::serve(std::string_view path, std::string_view if_none_match,
                   const std::vector<std::string>& framed_by) const {
    Reply reply = read(path, if_none_match);
    // The page loads and runs this server's files only. It may connect to any server, since a goodbye can name one.
    std::string policy = "default-src 'self'; connect-src http: https: ws: wss:; object-src 'none'; base-uri 'none'; "
                         "form-action 'none'; frame-ancestors 'self'";
    for (const std::string& origin : framed_by) policy += " " + origin;
    reply.headers.emplace_back("Content-Security-Policy", std::move(policy));
    reply.headers.emplace_back("Referrer-Policy", "no-referrer");
    return reply;
}

Reply noSuchPage() {
    std::string line = "no such page; there is /embed.html";
    for (const Route& route : allRoutes()) line += fmt::format(" {}", route.path);
    return lineReply(404, std::move(line));
}

Reply Pages::read(std::string_view path, std::string_view if_none_match) const {
    const auto relative = relativePath(path);
    const auto file = relative ? inside(root_, *relative) : std::nullopt;
    if (!file && path == "/")
        return lineReply(404, "the page is not built: run ./dev, or give its folder with --web-root");
    if (!file) return noSuchPage();

    std::error_code error;
    const uintmax_t size = fs::file_size(*file, error);
    const auto changed = error ? fs::file_time_type{} : fs::last_write_time(*file, error);
    if (error || size > kMaxFileBytes) return lineReply(404, "this file cannot be served");

    Reply reply;
    const std::string tag = fmt::format("\"{:x}-{:x}\"", size, changed.time_since_epoch().count());
    // Files under assets/ have a hash of their content in their names: a file of the same name never changes.
    const bool immutable = relative->begin()->string() == "assets";
    reply.headers = {{"ETag", tag}, {"Cache-Control", immutable ? "public, max-age=31536000, immutable" : "no-cache"}};
    if (if_none_match == "*" || if_none_match.find(tag) != if_none_match.npos) {
        reply.status = 304;
        return reply;
    }
    reply.content_type = typeOf(*file);
    reply.body.resize(size);
    std::ifstream in(*file, std::ios::binary);
    if (!in.read(reply.body.data(), std::streamsize(size))) return lineReply(404, "this file cannot be read");
    return reply;
}

} // namespace brume::net
