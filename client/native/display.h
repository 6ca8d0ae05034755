// A window that shows pictures. The only part besides window.cpp that sees SDL.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

struct SDL_Window;
struct SDL_Renderer;
struct SDL_Texture;

namespace brume::client {

class Display {
public:
    // Pixels of the drawing area. Throws std::runtime_error, one line, when there is no display.
    Display(const std::string& title, int width, int height);
    ~Display();
    Display(const Display&) = delete;
    Display& operator=(const Display&) = delete;

    void setTitle(const std::string& title);
    // Of the drawing area, now.
    int width() const;
    int height() const;

    // Gives `fill` the memory of a picture of this size (4 bytes a pixel: B, G, R, unused; rows `pitch` bytes apart), all of
    // which it writes; false from `fill` leaves the display as it is. Throws std::runtime_error when the device refuses.
    bool update(int width, int height, const std::function<bool(uint8_t* pixels, int pitch)>& fill);
    // Shows the newest picture, centred and as large as its shape allows.
    void present();
    // Where a point of the window lies in the picture, both in [0, 1] from the left and the top.
    std::pair<float, float> inPicture(int x, int y) const;

private:
    struct Place {
        int x, y, w, h;
    };
    Place place() const;

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
    int texture_width_ = 0, texture_height_ = 0;
    bool has_picture_ = false;
};

} // namespace brume::client
