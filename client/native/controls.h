// A camera that a user moves: around a target, or flying freely. Mouse and keys are gestures.h's.
#pragma once

#include "common/camera.h"

namespace brume::client {

class Controls {
public:
    Controls(glm::vec3 position, glm::vec3 target, float fov_y);

    bool flying() const { return flying_; }
    // Changes between orbiting and flying without moving the camera. After flying, the target is the point ahead of
    // the camera at the distance that it had before.
    void toggleFly();

    // Turns by radians, to the right and up: orbiting, the camera moves around the target; flying, it turns on the
    // spot.
    void turn(float yaw, float pitch);
    // Wheel steps of 10 % each; positive: orbiting, nearer to the target; flying, faster.
    void wheel(float steps);
    // Moves for a time at speed() times a direction in view space (right, up, ahead; each in [-1, 1]). Orbiting moves
    // the target too.
    void move(glm::vec3 direction, float seconds);

    // Takes the position and view direction of this pose; its roll is left out.
    void standAt(const Pose& pose);

    Pose pose() const;
    float distance() const { return distance_; } // m, to the target
    float speed() const { return speed_; }       // m/s

private:
    glm::vec3 ahead() const;
    void lookAlong(glm::vec3 direction);

    float yaw_ = 0, pitch_ = 0; // rad; 0, 0 looks along -Z; yaw grows to the left, pitch up
    float distance_;            // m, to the target
    glm::vec3 position_;
    float fov_y_;
    float speed_;
    bool flying_ = false;
};

} // namespace brume::client
