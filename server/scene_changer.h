// SceneChanger: loads another scene while the server runs, and hands it to the frame loop. For one thread.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "common/scene.h"
#include "server/compilers.h"
#include "server/operate/recorder.h"
#include "server/options/options.h"

namespace brume {

// What is recorded of a scene when a recording begins with it.
RecordingHead recordingHead(const std::filesystem::path& file, const Scene& scene, std::vector<std::string> overrides);
// Names of the scenes that an operator can switch to: those of the scenes' folder, of uploaded clouds, and the one that
// the server was started with.
std::vector<std::string> otherScenes(const ServerOptions& options);
// The file of one of them.
std::filesystem::path fileOfScene(const ServerOptions& options, const std::string& name);

class SceneChanger {
public:
    // What there is in the running server.
    struct Server : Compilers::Server {
        Recorder* recorder;             // null: nothing is recorded
        const char* fixed;              // why no other scene can be shown, one line; null: others can
        const std::atomic<bool>& ended; // True: the frame loop ended, and shows no scene any more
    };
    // `scene`: of the options, which is shown. Requests are served from now on: SIGUSR1 tells this process of them.
    SceneChanger(const ServerOptions& options, const Scene& scene, const Server& server);
    ~SceneChanger();

    // Answers all requests that wait.
    void serveRequests();
    // These are the options from now on. Shows their scene again where it was changed: another name or overrides, or
    // else another text or other points in the files that are shown. Otherwise nothing happens. Logs what it did, in
    // one line.
    void reload(const ServerOptions& options);
    // Compilers::look().
    void compileBehind() { compilers_.look(); }

private:
    struct Files; // the files of a scene, as they were when it was loaded

    SceneAnswer change(const SceneWish& wish);
    SceneAnswer showCloud(const SceneWish& wish);
    SceneAnswer show(const Files& files);
    SceneAnswer show(Scene scene, const Files& files);
    Files filesOf(std::filesystem::path file, std::vector<std::string> overrides) const;
    void compile(const Scene& scene);

    ServerOptions options_;
    const Server server_;
    std::unique_ptr<Files> shown_;
    std::string asked_; // the options' scene and overrides, when they were looked at last
    Compilers compilers_;
};

} // namespace brume
