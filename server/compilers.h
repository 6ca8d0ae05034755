// Compilers: makes ways to render ready that are wanted, while pictures go on. A child process compiles a way, so that
// the driver has it on disk. Then its pipelines are made in this process, in a thread beside the frame loop's: a CPU
// driver takes up to a second for that, too.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "common/process.h"
#include "server/frame/frame_loop.h"
#include "server/options/options.h"

namespace brume {

// Tells the main thread, by SIGUSR1, that something waits for it.
void wakeMain();

class Compilers {
public:
    struct Server {
        int argc;
        const char* const* argv;
        FrameLoop& frames;
        Audience& audience;
        const gpu::Device& device;
        const CostModel& costs;
    };
    // The scene that is shown, with these overrides besides its own: as for --set.
    using Load = std::function<Scene(std::span<const std::string> overrides)>;

    // Both outlive it. SIGUSR1 tells this process that look() has something to do.
    Compilers(const ServerOptions& options, const Server& server);
    ~Compilers();

    // This scene is shown from now on. What it may need later is compiled.
    void begin(const Scene& scene, const std::filesystem::path& file, Load load);
    // Makes ready what the first pictures of another scene need, while those of the present one go on. May take as long
    // as the driver compiles.
    void prepare(const Scene& scene) const;
    // Hears what child processes have compiled, makes it ready, and starts one for what is wanted. To be called on
    // SIGCHLD and SIGUSR1.
    void look();

private:
    // A way that is wanted.
    struct Job {
        SceneFeatures lists; // features of the lists that pictures show then
        WayShaders way;
        Scene scene; // as it was when the way was wanted; its render settings are the way's
    };
    struct Compiler {
        std::unique_ptr<Process> process;
        SceneFeatures lists;    // features that it compiles for
        std::optional<Job> job; // the way that it was started for; nothing once that is ready
        size_t heard = 0;       // bytes of its output
    };

    // `wanted`: null: the first way for lists with these features.
    Compiler start(const SceneFeatures& lists, const CompiledWays::Wanted* wanted) const;
    std::optional<Job> jobOf(const SceneFeatures& lists, const CompiledWays::Wanted* wanted,
                             std::span<const std::string> overrides) const;
    std::vector<std::string> overridesOf(const SceneFeatures& lists, const CompiledWays::Wanted* wanted) const;
    bool isOnDisk(const Job& job) const;
    void makeReady(const Job& job);
    void makeBeside(const Scene& scene, const WayShaders& way) const;
    bool hear(Compiler& compiler);

    const ServerOptions& options_;
    const Server server_;
    Load load_;
    std::vector<std::string> command_; // the server's, for the scene that is shown; empty: nothing is compiled behind
    // What may be needed later, and lists that pictures do not show yet; ways that are wanted.
    Compiler ahead_, behind_;
    std::map<SceneFeatures, std::set<WayShaders>> on_disk_; // ways of this scene that processes have compiled
};

} // namespace brume
