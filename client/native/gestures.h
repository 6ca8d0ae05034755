// Turns mouse and keyboard events of the window into camera moves and impulses.
#pragma once

#include <optional>

#include "client/native/camera_path.h"
#include "client/native/controls.h"
#include "client/native/display.h"
#include "client/native/session.h"

union SDL_Event;

namespace brume::client {

// The cursor while the user pushes the cloud with it.
struct PushCursor {
    float x = 0, y = 0, aspect = 1; // x, y in [0, 1] of one eye's picture, and that picture's width / height
    float dx = 0, dy = 0;           // way since the last takeImpulse(), right and down, in heights of the picture
    bool dragged = false;           // true: the cursor has moved since it was pressed
    bool released = false;          // true: the button is up; the next takeImpulse() is the last
};

class Gestures {
public:
    Gestures(const CameraPath& camera, uint8_t views)
        : controls_(camera.position, camera.target, camera.fov_y), views_(views) {}

    void handle(const SDL_Event& event, const Display& display);
    // Moves the camera by the keys that are down.
    void passTime(float seconds);

    bool touched() const { return touched_; } // true once the user has moved the camera, which ends a path
    bool pauseToggled();                      // true once for each press of Space
    bool undoAsked();                         // true once after each Ctrl+Z
    Pose pose() const { return controls_.pose(); }
    void standAt(const Pose& pose) { controls_.standAt(pose); }

    // The impulse that the user asks for with Ctrl; each is returned once. A drag pushes with the cursor's own speed,
    // at the distance of the target; a click pushes away from the ray. `seen` is the pose of the picture under the
    // cursor, `seconds` the time since the last call.
    std::optional<Impulse> takeImpulse(const Pose& seen, float seconds);

private:
    Controls controls_;
    uint8_t views_;
    bool touched_ = false, pause_toggled_ = false, undo_asked_ = false;
    std::optional<PushCursor> cursor_; // set while the user pushes
};

} // namespace brume::client
