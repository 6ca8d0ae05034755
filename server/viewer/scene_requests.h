// Wishes of operators for another scene. Connections make them; the thread that loads scenes answers them.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "common/ply/upload_frame.h"
#include "server/viewer/requests.h"

namespace brume {

struct SceneWish {
    std::string name;      // of the scene to show
    std::string upload;    // empty, or the bytes of a PLY or NRRD file, which become a scene of that name
    UploadOptions options; // of these
};

struct SceneAnswer {
    std::string complaint; // why the old scene stays, one line; empty: the wished one is shown
    // Of a scene of files: how many points there are, or voxels along x, y and z, and where, m, in the world; and one
    // line each of what they came with, and of what was guessed, left out or passed over.
    size_t points = 0;
    glm::uvec3 voxels{0};
    glm::dvec3 lo{0}, hi{0};
    std::vector<std::string> notes;
};

class SceneRequest {
public:
    // `notify`: called once by the thread that answers.
    SceneRequest(SceneWish of, std::function<void()> notify) : wish(std::move(of)), notify_(std::move(notify)) {}

    const SceneWish wish;

    void answer(SceneAnswer given) {
        answer_ = std::move(given);
        answered_ = true;
        notify_();
    }
    bool answered() const { return answered_; }
    // Precondition: answered().
    const SceneAnswer& answer() const { return answer_; }

private:
    const std::function<void()> notify_;
    SceneAnswer answer_;
    std::atomic<bool> answered_{false};
};

using SceneRequests = Requests<SceneRequest>;

} // namespace brume
