// Wishes of connections that another thread answers.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <utility>

namespace brume {

// Thread-safe.
template <class Request>
class Requests {
public:
    // `wake` is called after every push, and at once if requests wait already.
    void serve(std::function<void()> wake) {
        const std::scoped_lock lock(mutex_);
        wake_ = std::move(wake);
        if (wake_ && !waiting_.empty()) wake_();
    }
    // False when too many wait.
    [[nodiscard]] bool push(std::shared_ptr<Request> request) {
        const std::scoped_lock lock(mutex_);
        if (waiting_.size() >= kMost) return false;
        waiting_.push_back(std::move(request));
        if (wake_) wake_();
        return true;
    }
    // The oldest; null when none waits.
    std::shared_ptr<Request> take() {
        const std::scoped_lock lock(mutex_);
        if (waiting_.empty()) return nullptr;
        std::shared_ptr<Request> request = std::move(waiting_.front());
        waiting_.pop_front();
        return request;
    }

private:
    static constexpr size_t kMost = 4;

    std::mutex mutex_;
    std::function<void()> wake_;
    std::deque<std::shared_ptr<Request>> waiting_;
};

} // namespace brume
