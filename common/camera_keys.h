// Key views of a camera, and the smooth path through them. client/web/src/camera-keys.ts has the same in TypeScript;
// protocol/examples/camera_path.json holds both to one table.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "common/camera.h"

namespace brume {

struct CameraKey {
    glm::vec3 position{0, 2, 26}, target{0}; // m; they differ by more than 1 mm
    float fov_y = 0.8f;                      // rad, the full vertical angle
    float seconds = 3;                       // from the key before; the first key's is not used
};

// The camera of a moment. Its horizon is level: it has no roll.
struct CameraView {
    glm::dvec3 position{0};
    double yaw = 0, pitch = 0; // rad; about +Y, 0 looks along -Z; up is positive
    double distance = 1;       // m, to the point looked at
    double fov_y = 0.8;        // rad
};
CameraView viewOf(const CameraKey& key);
Pose poseOf(const CameraView& view);

// Passes each key at its time and rests at both ends. Its speed has no jumps (C1). Between two keys no yaw, pitch,
// distance or field of view leaves the range of theirs, and equal keys in a row stand still. Yaw takes the shorter way.
class KeyPath {
public:
    // Precondition: there is a key, and all but the first have seconds above 0.
    explicit KeyPath(std::span<const CameraKey> keys);

    double seconds() const { return times_.back(); } // of the whole path; 0 with one key
    double timeOf(size_t key) const { return times_[key]; }
    // `seconds` from the first key on; before it, and behind the last, the camera rests there.
    CameraView at(double seconds) const;

private:
    // What is interpolated: x, y, z; yaw; pitch; log distance; fov_y. Each group moves by itself.
    struct Node {
        glm::dvec3 position;
        double angles_and_lens[4];
    };
    Node tangentAt(size_t key) const;

    std::vector<double> times_;
    std::vector<Node> nodes_, tangents_; // tangents are per second
};

} // namespace brume
