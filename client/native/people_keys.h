// The keys with which the user of the window points and sees where others look from.
#pragma once

#include <optional>

#include "client/native/camera_path.h"
#include "client/native/display.h"
#include "client/native/session.h"

union SDL_Event;

namespace brume::client {

class PeopleKeys {
public:
    explicit PeopleKeys(uint8_t views) : views_(views) {}

    void handle(const SDL_Event& event, const Display& display);
    // What the viewer says of itself now. While T is on, its ray goes from the eye of `seen`, the picture's pose,
    // through the cursor. The ray stays while the cursor does, even if the camera moves.
    const Appearance& appearance(const Pose& seen);
    bool cones() const { return now_.cameras; } // C: true to draw others' cameras

private:
    struct Cursor { // as cursorRay() takes it
        float x = 0, y = 0, aspect = 1;
    };
    uint8_t views_;
    bool pointing_ = false;
    std::optional<Cursor> moved_; // where the cursor has come to since the last appearance()
    Appearance now_;
};

} // namespace brume::client
