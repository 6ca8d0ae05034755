// A window that shows pictures. SDL is used here, in gestures.cpp and in window.cpp only.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "client/native/people.h"
#include "client/native/sheets.h"

struct SDL_Window;
struct SDL_Renderer;
struct SDL_Texture;

namespace brume::client {

class Display {
public:
    // `width` and `height` are pixels of the drawing area. Throws std::runtime_error, one line, when there is no
    // display.
    Display(const std::string& title, int width, int height);
    ~Display();
    Display(const Display&) = delete;
    Display& operator=(const Display&) = delete;

    void setTitle(const std::string& title);
    // Pixels of the drawing area now.
    int width() const;
    int height() const;

    // Replaces the picture. `fill` writes all its pixels: 4 bytes each (B, G, R, unused), rows `pitch` bytes apart.
    // Nothing is replaced if `fill` returns false. Returns what `fill` returns. Throws std::runtime_error if the
    // device fails.
    bool update(int width, int height, const std::function<bool(uint8_t* pixels, int pitch)>& fill);
    // Takes a picture with layers in place of the last ones. False: this display cannot draw them.
    bool take(const Sheets& sheets);
    // What every present() draws over the picture from now on, in pixels of the drawing area.
    void mark(Marks marks) { marks_ = std::move(marks); }
    // Draws the picture with layers as `eye` sees it, in the whole drawing area. Precondition: take() returned true.
    void present(const Sheets& sheets, const Pose& eye);
    // Draws the newest picture, centred and as large as fits in its own shape.
    void present();
    // What is shown: width() * height() pixels of 4 bytes (B, G, R, unused). Empty if the device does not say.
    std::vector<uint8_t> read() const;
    // Where a pixel of the window lies in the picture: from the left and from the top, each clamped to [0, 1].
    std::pair<float, float> inPicture(int x, int y) const;
    Area area() const;    // the part of the drawing area that the picture covers
    float aspect() const; // width / height of it

private:
    struct Place { // the picture's rectangle in the drawing area, in pixels; all of it for one with layers
        int x, y, w, h;
    };
    Place place() const;
    void drawMarks();

    struct Destroy {
        void operator()(SDL_Window* window) const;
        void operator()(SDL_Renderer* renderer) const;
        void operator()(SDL_Texture* texture) const;
    };
    struct Library {
        Library();
        ~Library();
    };
    Library library_;
    std::unique_ptr<SDL_Window, Destroy> window_;
    std::unique_ptr<SDL_Renderer, Destroy> renderer_;
    std::unique_ptr<SDL_Texture, Destroy> texture_;
    struct SheetTextures {
        std::unique_ptr<SDL_Texture, Destroy> transmittance, colours; // null: none
    };
    std::vector<SheetTextures> sheets_; // from back to front
    Marks marks_;
    int texture_width_ = 0, texture_height_ = 0;
    bool has_picture_ = false;
};

} // namespace brume::client
