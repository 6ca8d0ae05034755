#include "client/native/people_keys.h"

#include <SDL2/SDL.h>

namespace brume::client {

void PeopleKeys::handle(const SDL_Event& event, const Display& display) {
    const auto pointNowhere = [&] {
        moved_.reset();
        now_.pointer.reset();
    };
    if (event.type == SDL_KEYDOWN && !event.key.repeat) {
        if (event.key.keysym.sym == SDLK_c) now_.cameras = !now_.cameras;
        if (event.key.keysym.sym == SDLK_t) {
            pointing_ = !pointing_;
            pointNowhere();
        }
    } else if (event.type == SDL_WINDOWEVENT && event.window.event == SDL_WINDOWEVENT_LEAVE) {
        pointNowhere();
    } else if (event.type == SDL_MOUSEMOTION && pointing_) {
        auto [x, y] = display.inPicture(event.motion.x, event.motion.y);
        if (views_ == 2) x = x < 0.5f ? 2 * x : 2 * x - 1;
        moved_ = Cursor{x, y, display.aspect() / float(views_)};
    }
}

const Appearance& PeopleKeys::appearance(const Pose& seen) {
    if (moved_) now_.pointer = cursorRay(seen, moved_->x, moved_->y, moved_->aspect);
    moved_.reset();
    return now_;
}

} // namespace brume::client
