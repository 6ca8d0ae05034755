// Wishes of operators for another scene. Connections make them; the thread that loads scenes answers them.
#pragma once

#include <atomic>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

namespace brume {

class SceneRequest {
public:
    // `scene`: name of the scene to show. `ply`: empty, or the bytes of a PLY file, which become a scene of that name.
    // `notify`: called once by the thread that answers.
    SceneRequest(std::string scene, std::string ply, std::function<void()> notify)
        : name(std::move(scene)), points(std::move(ply)), notify_(std::move(notify)) {}

    const std::string name, points; // as in the constructor

    // `complaint`: why the old scene stays, one line; empty: the wished one is shown.
    void answer(std::string complaint) {
        complaint_ = std::move(complaint);
        answered_ = true;
        notify_();
    }
    bool answered() const { return answered_; }
    // Precondition: answered().
    const std::string& complaint() const { return complaint_; }

private:
    const std::function<void()> notify_;
    std::string complaint_;
    std::atomic<bool> answered_{false};
};

// Thread-safe.
class SceneRequests {
public:
    // `wake` is called after every push, and at once if requests wait already.
    void serve(std::function<void()> wake) {
        const std::scoped_lock lock(mutex_);
        wake_ = std::move(wake);
        if (wake_ && !waiting_.empty()) wake_();
    }
    // False when too many wait.
    [[nodiscard]] bool push(std::shared_ptr<SceneRequest> request) {
        const std::scoped_lock lock(mutex_);
        if (waiting_.size() >= kMost) return false;
        waiting_.push_back(std::move(request));
        if (wake_) wake_();
        return true;
    }
    // The oldest; null when none waits.
    std::shared_ptr<SceneRequest> take() {
        const std::scoped_lock lock(mutex_);
        if (waiting_.empty()) return nullptr;
        std::shared_ptr<SceneRequest> request = std::move(waiting_.front());
        waiting_.pop_front();
        return request;
    }

private:
    static constexpr size_t kMost = 4;

    std::mutex mutex_;
    std::function<void()> wake_;
    std::deque<std::shared_ptr<SceneRequest>> waiting_;
};

} // namespace brume
