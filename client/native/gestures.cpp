#include "client/native/gestures.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <SDL2/SDL.h>

namespace brume::client {
namespace {

constexpr float kTurnPerHeight = 2.5f; // rad for a drag over the window's height

} // namespace

void Gestures::handle(const SDL_Event& event, const Display& display) {
    const auto aim = [&](int x, int y, float dx, float dy) {
        auto [u, v] = display.inPicture(x, y);
        if (views_ == 2) u = u < 0.5f ? 2 * u : 2 * u - 1;
        const float aspect = float(display.width()) / float(views_) / float(display.height());
        const bool going_on = cursor_.has_value();
        cursor_ = Cursor{u, v, aspect, dx + (going_on ? cursor_->dx : 0), dy + (going_on ? cursor_->dy : 0)};
    };
    switch (event.type) {
    case SDL_KEYDOWN:
        if (event.key.repeat) break;
        if (event.key.keysym.sym == SDLK_f) controls_.toggleFly();
        if (event.key.keysym.sym == SDLK_SPACE) pause_toggled_ = true;
        break;
    case SDL_MOUSEWHEEL:
        touched_ = true;
        controls_.wheel(event.wheel.preciseY);
        break;
    case SDL_MOUSEBUTTONDOWN:
        pushing_ = event.button.button == SDL_BUTTON_LEFT && (SDL_GetModState() & KMOD_CTRL) != 0;
        if (pushing_) aim(event.button.x, event.button.y, 0, 0);
        break;
    case SDL_MOUSEBUTTONUP:
        if (event.button.button == SDL_BUTTON_LEFT) pushing_ = false;
        break;
    case SDL_MOUSEMOTION:
        if ((event.motion.state & SDL_BUTTON_LMASK) == 0) break;
        if (pushing_) {
            aim(event.motion.x, event.motion.y, float(event.motion.xrel), float(event.motion.yrel));
        } else {
            // Orbiting, the cloud follows the hand; flying, the look does.
            const float step = kTurnPerHeight / float(std::max(display.height(), 1));
            const float sense = controls_.flying() ? 1.0f : -1.0f;
            touched_ = true;
            controls_.turn(sense * step * float(event.motion.xrel), -sense * step * float(event.motion.yrel));
        }
        break;
    default:
        break;
    }
}

void Gestures::passTime(float seconds) {
    const uint8_t* const keys = SDL_GetKeyboardState(nullptr);
    const auto axis = [&](SDL_Scancode plus, SDL_Scancode minus) { return float(keys[plus]) - float(keys[minus]); };
    const glm::vec3 direction(axis(SDL_SCANCODE_D, SDL_SCANCODE_A), axis(SDL_SCANCODE_E, SDL_SCANCODE_Q),
                              axis(SDL_SCANCODE_W, SDL_SCANCODE_S));
    if (direction == glm::vec3(0)) return;
    touched_ = true;
    const float hurry = (SDL_GetModState() & KMOD_SHIFT) != 0 ? 4.0f : 1.0f;
    controls_.move(hurry * glm::normalize(direction), seconds);
}

bool Gestures::pauseToggled() { return std::exchange(pause_toggled_, false); }

std::optional<Push> Gestures::takePush(const Pose& seen) {
    if (!cursor_) return {};
    const Ray ray = cursorRay(seen, cursor_->x, cursor_->y, cursor_->aspect);
    Push push{ray.origin, ray.direction, glm::vec3(0), 1};
    const float moved = std::hypot(cursor_->dx, cursor_->dy);
    if (moved > 0) push.push = seen.orientation * (glm::vec3(cursor_->dx, -cursor_->dy, 0) / moved); // along the hand
    cursor_.reset();
    return push;
}

} // namespace brume::client
