// SceneThread: changes scenes and makes ways ready on a thread of its own, so that signals are heard meanwhile.
#pragma once

#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

#include "server/scene_changer.h"

namespace brume {

class SceneThread {
public:
    // As of SceneChanger.
    SceneThread(const ServerOptions& options, const Scene& scene, const SceneChanger::Server& server);
    // Waits for what is under way.
    ~SceneThread();

    // Each returns at once; what is asked for several times before it begins is done once.
    void serveRequests();                      // SceneChanger::serveRequests(), then compileBehind()
    void compileBehind();                      // SceneChanger::compileBehind()
    void reload(const ServerOptions& options); // SceneChanger::reload(), logged whatever the level is

private:
    struct Jobs {
        bool requests = false, look = false;
        std::optional<ServerOptions> reload;
        bool any() const { return requests || look || reload; }
    };

    void run();
    void ask(const auto& change);

    SceneChanger changer_; // for the thread alone, from its start on
    std::mutex mutex_;
    std::condition_variable asked_;
    Jobs jobs_;
    bool ends_ = false;
    std::thread thread_;
};

} // namespace brume
