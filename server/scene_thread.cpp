#include "server/scene_thread.h"

#include <utility>

#include <spdlog/spdlog.h>

namespace brume {

SceneThread::SceneThread(const ServerOptions& options, const Scene& scene, const SceneChanger::Server& server)
    : changer_(options, scene, server), thread_([this] { run(); }) {}

SceneThread::~SceneThread() {
    {
        const std::scoped_lock lock(mutex_);
        ends_ = true;
    }
    asked_.notify_one();
    thread_.join();
}

void SceneThread::ask(const auto& change) {
    {
        const std::scoped_lock lock(mutex_);
        change(jobs_);
    }
    asked_.notify_one();
}

void SceneThread::serveRequests() {
    ask([](Jobs& jobs) { jobs.requests = jobs.look = true; });
}

void SceneThread::compileBehind() {
    ask([](Jobs& jobs) { jobs.look = true; });
}

void SceneThread::reload(const ServerOptions& options) {
    ask([&](Jobs& jobs) { jobs.reload = options; });
}

void SceneThread::run() {
    for (;;) {
        Jobs now;
        {
            std::unique_lock lock(mutex_);
            asked_.wait(lock, [&] { return ends_ || jobs_.any(); });
            if (ends_) return;
            now = std::exchange(jobs_, {});
        }
        if (now.reload) {
            spdlog::set_level(spdlog::level::info);
            changer_.reload(*now.reload);
            spdlog::set_level(spdlog::level::from_str(now.reload->log_level));
        }
        if (now.requests) changer_.serveRequests();
        if (now.look) changer_.compileBehind();
    }
}

} // namespace brume
