#include "client/native/display.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <stdexcept>

#include <SDL2/SDL.h>

namespace brume::client {
namespace {

constexpr SDL_Color kDark{11, 15, 20, 150}, kWhite{255, 255, 255, 255}; // around dots and lines, as on the page
constexpr float kDotRadius = 6;                                         // pixels
constexpr float kLineWidth = 1.6f, kDarkWidth = 3.5f;                   // pixels

SDL_Color colourOf(uint32_t rgb) { return {Uint8(rgb >> 16), Uint8(rgb >> 8), Uint8(rgb), 255}; }

// Rows, none of which is drawn twice: the colour may let something through.
void fillCircle(SDL_Renderer* renderer, glm::vec2 middle, float radius, SDL_Color colour) {
    std::vector<SDL_FRect> rows;
    for (float y = std::floor(middle.y - radius); y <= middle.y + radius; ++y) {
        const float above = y + 0.5f - middle.y, half = std::sqrt(std::max(radius * radius - above * above, 0.0f));
        const float left = std::round(middle.x - half), right = std::round(middle.x + half);
        if (right > left) rows.push_back({left, y, right - left, 1});
    }
    SDL_SetRenderDrawColor(renderer, colour.r, colour.g, colour.b, colour.a);
    SDL_RenderFillRectsF(renderer, rows.data(), int(rows.size()));
}

void drawLine(SDL_Renderer* renderer, const Line& line, float width, SDL_Color colour) {
    const glm::vec2 way = line.to - line.from;
    const float length = std::max(glm::length(way), 1e-3f);
    const glm::vec2 side = glm::vec2(-way.y, way.x) * (width / 2 / length);
    std::array<SDL_Vertex, 4> corners;
    for (size_t i = 0; i < 4; ++i) {
        const glm::vec2 at = (i < 2 ? line.from : line.to) + (i % 2 == 0 ? side : -side);
        corners[i] = {{at.x, at.y}, colour, {0, 0}};
    }
    constexpr std::array<int, 6> kTriangles{0, 1, 2, 2, 1, 3};
    SDL_RenderGeometry(renderer, nullptr, corners.data(), int(corners.size()), kTriangles.data(),
                       int(kTriangles.size()));
}

} // namespace

Display::Library::Library() {
    // Left alone, SDL would go on to its off-screen driver, where nobody sees anything; SDL_VIDEODRIVER still asks for
    // that, or for a console.
    const bool wayland = std::getenv("WAYLAND_DISPLAY") != nullptr;
    if (!std::getenv("SDL_VIDEODRIVER")) {
        if (!wayland && !std::getenv("DISPLAY"))
            throw std::runtime_error(
                "there is no display to open a window on (neither DISPLAY nor WAYLAND_DISPLAY is set): use --headless");
        SDL_SetHint(SDL_HINT_VIDEODRIVER, wayland ? "wayland,x11" : "x11");
    }
    SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
    SDL_SetHint(SDL_HINT_RENDER_SCALE_QUALITY, "linear");
    SDL_SetHint(SDL_HINT_VIDEO_ALLOW_SCREENSAVER, "1");
    if (SDL_Init(SDL_INIT_VIDEO) != 0)
        throw std::runtime_error("there is no display to open a window on (" + std::string(SDL_GetError()) +
                                 "): use --headless");
}
Display::Library::~Library() { SDL_Quit(); }

void Display::Destroy::operator()(SDL_Window* window) const { SDL_DestroyWindow(window); }
void Display::Destroy::operator()(SDL_Renderer* renderer) const { SDL_DestroyRenderer(renderer); }
void Display::Destroy::operator()(SDL_Texture* texture) const { SDL_DestroyTexture(texture); }

Display::Display(const std::string& title, int width, int height) {
    window_.reset(SDL_CreateWindow(title.c_str(), SDL_WINDOWPOS_UNDEFINED, SDL_WINDOWPOS_UNDEFINED, width, height,
                                   SDL_WINDOW_RESIZABLE));
    if (!window_)
        throw std::runtime_error("cannot open a window (" + std::string(SDL_GetError()) + "): use --headless");
    renderer_.reset(SDL_CreateRenderer(window_.get(), -1, SDL_RENDERER_PRESENTVSYNC));
    if (!renderer_)
        throw std::runtime_error("cannot draw in a window (" + std::string(SDL_GetError()) + "): use --headless");
    present();
}
Display::~Display() = default;

void Display::setTitle(const std::string& title) { SDL_SetWindowTitle(window_.get(), title.c_str()); }

int Display::width() const {
    int width = 0;
    SDL_GetRendererOutputSize(renderer_.get(), &width, nullptr);
    return width;
}

int Display::height() const {
    int height = 0;
    SDL_GetRendererOutputSize(renderer_.get(), nullptr, &height);
    return height;
}

bool Display::update(int width, int height, const std::function<bool(uint8_t*, int)>& fill) {
    sheets_.clear();
    if (!texture_ || width != texture_width_ || height != texture_height_) {
        texture_.reset(
            SDL_CreateTexture(renderer_.get(), SDL_PIXELFORMAT_RGB888, SDL_TEXTUREACCESS_STREAMING, width, height));
        if (!texture_) throw std::runtime_error("cannot show pictures of this size: " + std::string(SDL_GetError()));
        texture_width_ = width;
        texture_height_ = height;
        has_picture_ = false;
    }
    void* pixels = nullptr;
    int pitch = 0;
    if (SDL_LockTexture(texture_.get(), nullptr, &pixels, &pitch) != 0)
        throw std::runtime_error("cannot show pictures: " + std::string(SDL_GetError()));
    const bool filled = fill(static_cast<uint8_t*>(pixels), pitch);
    SDL_UnlockTexture(texture_.get());
    has_picture_ = has_picture_ || filled;
    return filled;
}

Display::Place Display::place() const {
    const int w = width(), h = height();
    if (!texture_ || w <= 0 || h <= 0 || !sheets_.empty()) return {0, 0, std::max(w, 1), std::max(h, 1)};
    const double scale = std::min(double(w) / texture_width_, double(h) / texture_height_);
    const int picture_w = std::max(1, int(texture_width_ * scale + 0.5)),
              picture_h = std::max(1, int(texture_height_ * scale + 0.5));
    return {(w - picture_w) / 2, (h - picture_h) / 2, picture_w, picture_h};
}

void Display::present() {
    SDL_SetRenderDrawColor(renderer_.get(), 24, 26, 30, 255);
    SDL_RenderClear(renderer_.get());
    if (has_picture_) {
        const Place at = place();
        const SDL_Rect rect{at.x, at.y, at.w, at.h};
        SDL_RenderCopy(renderer_.get(), texture_.get(), nullptr, &rect);
    }
    drawMarks();
    SDL_RenderPresent(renderer_.get());
}

void Display::drawMarks() {
    SDL_Renderer* const to = renderer_.get();
    SDL_SetRenderDrawBlendMode(to, SDL_BLENDMODE_BLEND);
    for (const auto& [line, colour] : marks_.edges) drawLine(to, line, kDarkWidth, kDark);
    for (const auto& [line, colour] : marks_.edges) drawLine(to, line, kLineWidth, colourOf(colour));
    for (const auto& [at, colour] : marks_.dots) {
        fillCircle(to, at, kDotRadius + 3, kDark);
        fillCircle(to, at, kDotRadius + 1.5f, kWhite);
        fillCircle(to, at, kDotRadius, colourOf(colour));
    }
    SDL_SetRenderDrawBlendMode(to, SDL_BLENDMODE_NONE);
}

bool Display::take(const Sheets& sheets) {
    sheets_.clear();
    for (const Sheet& sheet : sheets.all()) {
        SheetTextures& own = sheets_.emplace_back();
        const auto make = [&](std::unique_ptr<SDL_Texture, Destroy>& to, const std::vector<uint8_t>& bytes,
                              SDL_BlendMode mode) {
            if (bytes.empty()) return true;
            to.reset(SDL_CreateTexture(renderer_.get(), SDL_PIXELFORMAT_ARGB8888, SDL_TEXTUREACCESS_STATIC, sheet.width,
                                       sheet.height));
            return to && SDL_UpdateTexture(to.get(), nullptr, bytes.data(), 4 * sheet.width) == 0 &&
                   SDL_SetTextureBlendMode(to.get(), mode) == 0;
        };
        const bool hides = sheet.transmittance.empty();
        if (make(own.transmittance, sheet.transmittance, SDL_BLENDMODE_MOD) &&
            make(own.colours, sheet.colours, hides ? SDL_BLENDMODE_NONE : SDL_BLENDMODE_ADD))
            continue;
        sheets_.clear();
        return false;
    }
    return true;
}

void Display::present(const Sheets& sheets, const Pose& eye) {
    const auto w = float(width()), h = float(height());
    SDL_SetRenderDrawColor(renderer_.get(), 0, 0, 0, 255);
    SDL_RenderClear(renderer_.get());
    std::vector<SDL_Vertex> vertices;
    std::vector<int> triangles;
    for (size_t i = 0; i < sheets_.size(); ++i) {
        vertices.clear(), triangles.clear();
        for (const Vertex& one : sheets.seen(sheets.all()[i], eye, w / std::max(h, 1.0f)))
            vertices.push_back({{one.x * w, one.y * h}, {255, 255, 255, 255}, {one.u, one.v}});
        for (int patch = 0; patch < int(vertices.size()); patch += 4)
            for (const int corner : {0, 1, 2, 2, 1, 3}) triangles.push_back(patch + corner);
        for (const auto* texture : {&sheets_[i].transmittance, &sheets_[i].colours})
            if (*texture)
                SDL_RenderGeometry(renderer_.get(), texture->get(), vertices.data(), int(vertices.size()),
                                   triangles.data(), int(triangles.size()));
    }
    drawMarks();
    SDL_RenderPresent(renderer_.get());
}

std::vector<uint8_t> Display::read() const {
    std::vector<uint8_t> pixels(size_t(4) * size_t(width()) * size_t(height()));
    if (SDL_RenderReadPixels(renderer_.get(), nullptr, SDL_PIXELFORMAT_RGB888, pixels.data(), 4 * width()) != 0)
        return {};
    return pixels;
}

Area Display::area() const {
    const Place at = place();
    return {float(at.x), float(at.y), float(at.w), float(at.h)};
}

float Display::aspect() const {
    const Place at = place();
    return float(at.w) / float(at.h);
}

std::pair<float, float> Display::inPicture(int x, int y) const {
    const Place at = place();
    return {std::clamp((float(x - at.x) + 0.5f) / float(at.w), 0.0f, 1.0f),
            std::clamp((float(y - at.y) + 0.5f) / float(at.h), 0.0f, 1.0f)};
}

} // namespace brume::client
