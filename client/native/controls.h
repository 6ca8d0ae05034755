// A camera under a user's hand: around a target, or flying freely. Knows nothing of mice and keys.
#pragma once

#include "common/camera.h"

namespace brume::client {

class Controls {
public:
    Controls(glm::vec3 position, glm::vec3 target, float fov_y);

    bool flying() const { return flying_; }
    // The picture stays where it is; from flying, the target becomes the point ahead at the distance that it had.
    void toggleFly();

    // Turns by radians to the right and up: the camera around the target, or the look when flying.
    void turn(float yaw, float pitch);
    // Wheel steps: nearer for positive ones, 10 % each; when flying, the speed instead.
    void wheel(float steps);
    // Moves by view-space directions in [-1, 1] (right, up, ahead) for a time; the target moves along when orbiting.
    void move(glm::vec3 direction, float seconds);

    // Stands and looks as this pose does (without its roll).
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
