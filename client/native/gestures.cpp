#include "client/native/gestures.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <SDL2/SDL.h>

namespace brume::client {
namespace {

constexpr float kTurnPerHeight = 2.5f; // rad for a drag over the window's height
// What each push adds of the hand's speed: particles that a ray of some metres passes over end up about as fast as a
// click would make them. The web client does the same.
constexpr float kDragStrength = 0.15f;
constexpr float kMaxPushSpeed = 60; // m/s; the server takes up to 100 on each axis

} // namespace

void Gestures::handle(const SDL_Event& event, const Display& display) {
    const auto aim = [&](int x, int y) {
        auto [u, v] = display.inPicture(x, y);
        if (views_ == 2) u = u < 0.5f ? 2 * u : 2 * u - 1;
        if (!cursor_) cursor_.emplace();
        cursor_->x = u;
        cursor_->y = v;
        cursor_->aspect = display.aspect() / float(views_);
    };
    const float per_height = 1 / float(std::max(display.height(), 1));
    switch (event.type) {
    case SDL_KEYDOWN:
        if (event.key.repeat) break;
        if (event.key.keysym.sym == SDLK_f) controls_.toggleFly();
        if (event.key.keysym.sym == SDLK_SPACE) pause_toggled_ = true;
        if (event.key.keysym.sym == SDLK_z && (SDL_GetModState() & KMOD_CTRL) != 0) undo_asked_ = true;
        break;
    case SDL_MOUSEWHEEL:
        touched_ = true;
        controls_.wheel(event.wheel.preciseY);
        break;
    case SDL_MOUSEBUTTONDOWN:
        if (event.button.button != SDL_BUTTON_LEFT || (SDL_GetModState() & KMOD_CTRL) == 0) break;
        cursor_.reset();
        aim(event.button.x, event.button.y);
        break;
    case SDL_MOUSEBUTTONUP:
        if (event.button.button == SDL_BUTTON_LEFT && cursor_) cursor_->released = true;
        break;
    case SDL_MOUSEMOTION:
        if ((event.motion.state & SDL_BUTTON_LMASK) == 0) break;
        if (cursor_) {
            aim(event.motion.x, event.motion.y);
            cursor_->dx += per_height * float(event.motion.xrel);
            cursor_->dy += per_height * float(event.motion.yrel);
            cursor_->dragged = true;
        } else {
            // Orbiting, the cloud follows the hand; flying, the look does: the same turn.
            touched_ = true;
            controls_.turn(kTurnPerHeight * per_height * float(event.motion.xrel),
                           -kTurnPerHeight * per_height * float(event.motion.yrel));
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

bool Gestures::undoAsked() { return std::exchange(undo_asked_, false); }
bool Gestures::pauseToggled() { return std::exchange(pause_toggled_, false); }

std::optional<Impulse> Gestures::takeImpulse(const Pose& seen, float seconds) {
    if (!cursor_) return {};
    const PushCursor cursor = *cursor_;
    cursor_->dx = cursor_->dy = 0;
    if (cursor.released) cursor_.reset();
    const Ray ray = cursorRay(seen, cursor.x, cursor.y, cursor.aspect);
    const float moved = std::hypot(cursor.dx, cursor.dy);
    if (moved > 0) {
        const float metres = moved * 2 * std::tan(0.5f * seen.fov_y) * controls_.distance();
        const float speed = std::min(metres / std::max(seconds, 1e-3f), kMaxPushSpeed);
        return Impulse{ray.origin, ray.direction,
                       seen.orientation * (glm::vec3(cursor.dx, -cursor.dy, 0) * (speed / moved)), kDragStrength};
    }
    if (cursor.released && !cursor.dragged) return Impulse{ray.origin, ray.direction, glm::vec3(0), 1};
    return {};
}

} // namespace brume::client
