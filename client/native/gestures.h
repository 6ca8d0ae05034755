// What a user does with mouse and keyboard in the window, turned into camera moves and pushes.
#pragma once

#include <optional>

#include "client/native/camera_path.h"
#include "client/native/controls.h"
#include "client/native/display.h"
#include "client/native/session.h"

union SDL_Event;

namespace brume::client {

// Where and how a push is asked for.
struct PushCursor {
    float x = 0, y = 0, aspect = 1; // in the picture of one eye
    float dx = 0, dy = 0;           // heights of the picture, right and down, since the last push was taken
    bool dragged = false;           // ever
    bool released = false;          // the last push is to be taken
};

class Gestures {
public:
    Gestures(const CameraPath& camera, uint8_t views) : controls_(camera.position, camera.target, camera.fov_y), views_(views) {}

    void handle(const SDL_Event& event, const Display& display);
    // Moves by the keys that are down.
    void passTime(float seconds);

    bool touched() const { return touched_; } // from the first camera move on: a path given at the start ends
    bool pauseToggled();                      // true once for each Space
    Pose pose() const { return controls_.pose(); }
    void standAt(const Pose& pose) { controls_.standAt(pose); } // where a path has come to

    // The push that Ctrl with a drag or a click asks for, taken once: along the hand as fast as it moves at the target's
    // distance, or for a click away from the ray. `seen` is the pose of the picture that the user pushes in; `seconds` is the
    // time since this was last called.
    std::optional<Push> takePush(const Pose& seen, float seconds);

private:
    Controls controls_;
    uint8_t views_;
    bool touched_ = false, pause_toggled_ = false;
    std::optional<PushCursor> cursor_; // while pushing
};

} // namespace brume::client
