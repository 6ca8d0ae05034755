#include "server/scene_changer.h"

#include <algorithm>
#include <csignal>

#include <fmt/ranges.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "common/numbered_files.h"
#include "common/scene_text.h"
#include "common/text.h"
#include "server/operate/upload.h"
#include "server/operate/uploaded_clouds.h"
#include "server/plan/memory.h"
#include "server/sim/point_cloud.h"
#include "server/sim/sequence_files.h"

namespace brume {
namespace {

namespace fs = std::filesystem;

std::string askedFor(const ServerOptions& options) {
    return fmt::format("{}\n{}", options.scene, fmt::join(sceneOverrides(options), "\n"));
}

// Viewers are told of the scene that comes.
class Preparing {
public:
    Preparing(Audience& audience, const std::string& name) : audience_(audience) { audience_.prepare(name); }
    ~Preparing() { audience_.prepare({}); }
    Preparing(const Preparing&) = delete;
    Preparing& operator=(const Preparing&) = delete;

private:
    Audience& audience_;
};

std::string why(const std::exception_ptr& exception) {
    try {
        std::rethrow_exception(exception);
    } catch (const std::exception& error) {
        return oneLine(error.what());
    }
}

} // namespace

struct SceneChanger::Files {
    fs::path scene;
    std::string text; // the scene file's
    std::vector<std::string> overrides;
    std::pair<uintmax_t, fs::file_time_type> beside{}; // size of point clouds, meshes and maps, time of the newest

    bool operator==(const Files&) const = default;
};

RecordingHead recordingHead(const fs::path& file, const Scene& scene, std::vector<std::string> overrides) {
    return {scene.name, fs::absolute(file).string(), sceneText(file), std::move(overrides), BRUME_VERSION};
}

std::vector<std::string> otherScenes(const ServerOptions& options) {
    std::vector<std::string> names = sceneNames(options.scene_dir);
    const std::vector<std::string> clouds = sceneNames(options.cloud_dir);
    names.insert(names.end(), clouds.begin(), clouds.end());
    const std::string own = fs::path(options.scene).stem().string(); // a file elsewhere, perhaps
    if (std::ranges::find(names, own) == names.end()) names.push_back(own);
    return names;
}

fs::path fileOfScene(const ServerOptions& options, const std::string& name) {
    const std::vector<std::string> kept = sceneNames(options.cloud_dir);
    const bool uploaded = std::ranges::find(kept, name) != kept.end();
    const fs::path file = (uploaded ? options.cloud_dir : options.scene_dir) / (name + ".toml");
    std::error_code error;
    return fs::exists(file, error) ? file : findScene(options.scene, options.scene_dir); // the scene of the start
}

SceneChanger::SceneChanger(const ServerOptions& options, const Scene& scene, const Server& server)
    : options_(options), server_(server),
      shown_(std::make_unique<Files>(filesOf(findScene(options.scene, options.scene_dir), sceneOverrides(options)))),
      asked_(askedFor(options)), compilers_(options_, server) {
    compile(scene);
    server.audience.sceneRequests().serve(wakeMain);
}

SceneChanger::~SceneChanger() { server_.audience.sceneRequests().serve(nullptr); }

void SceneChanger::serveRequests() {
    while (const auto request = server_.audience.sceneRequests().take()) request->answer(change(request->wish));
}

SceneAnswer SceneChanger::change(const SceneWish& wish) {
    const UploadedClouds clouds(options_.cloud_dir);
    if (server_.fixed) return {.complaint = server_.fixed, .notes = {}};
    try {
        if (!wish.upload.empty()) {
            const Preparing preparing(server_.audience, wish.name);
            return showCloud(wish);
        }
        const std::vector<std::string> names = otherScenes(options_);
        if (std::find(names.begin(), names.end(), wish.name) == names.end())
            return {.complaint = fmt::format("no scene of that name; there are: {}", fmt::join(names, ", ")),
                    .notes = {}};
        const Preparing preparing(server_.audience, wish.name); // once it is known to be a scene
        return show(filesOf(fileOfScene(options_, wish.name), rendererOverrides(options_)));
    } catch (const std::exception&) {
        const std::string reason = why(std::current_exception());
        spdlog::error("the scene stays: {}", reason);
        return {.complaint = wish.upload.empty() ? reason : clouds.withoutFolders(reason), .notes = {}};
    }
}

// The file becomes a scene beside it, with a camera that sees all of it. Nothing is
// replaced before it is known to be good: show() then finds nothing wrong but what the device lacks.
SceneAnswer SceneChanger::showCloud(const SceneWish& wish) {
    const std::vector<std::string> own = sceneNames(options_.scene_dir);
    if (std::find(own.begin(), own.end(), wish.name) != own.end() ||
        wish.name == fs::path(options_.scene).stem().string())
        throw SceneError("there is a scene '" + wish.name + "' already: give another with ?name=");
    const UploadedClouds clouds(options_.cloud_dir);
    UploadedClouds::Incoming incoming = clouds.take(wish.name, wish.upload, endingOf(wish.upload));
    const UploadedScene uploaded = sceneOfUpload(wish.upload, wish.options, incoming.scene());
    const std::string text = sceneToml(uploaded.scene);
    const std::vector<std::string> overrides = rendererOverrides(options_);
    const Scene wanted = sceneOf(text, incoming.scene(), overrides);
    checkScene(wanted, incoming.scene(), overrides);
    boundedCapacity(wanted, Simulation(wanted, options_.frame.memory), options_.frame.memory);
    SceneAnswer answer = show(filesOf(incoming.keep(text), overrides));
    answer.notes.insert(answer.notes.end(), uploaded.notes.begin(), uploaded.notes.end());
    return answer;
}

void SceneChanger::reload(const ServerOptions& options) {
    options_ = options;
    if (server_.fixed) return spdlog::info("reload: {}", server_.fixed);
    try {
        const std::string asked = askedFor(options_);
        const Files now = asked_ == asked
                              ? filesOf(shown_->scene, shown_->overrides)
                              : filesOf(findScene(options_.scene, options_.scene_dir), sceneOverrides(options_));
        asked_ = asked;
        if (now == *shown_) return spdlog::info("reload: the scene's files have not changed");
        show(now);
    } catch (const std::exception&) {
        spdlog::error("reload: the scene stays: {}", why(std::current_exception()));
    }
}

SceneAnswer SceneChanger::show(const Files& files) {
    const Preparing preparing(server_.audience, files.scene.stem().string());
    Scene scene = sceneOf(files.text, files.scene, files.overrides);
    checkScene(scene, files.scene, files.overrides);
    placeCamera(scene);
    return show(std::move(scene), files);
}

// Waits until the frame loop shows it. Throws what keeps the frame loop from it.
SceneAnswer SceneChanger::show(Scene scene, const Files& files) {
    Simulation simulation(scene, options_.frame.memory);
    SceneAnswer answer{.complaint = {}, .notes = tellOfPointCloud(scene, simulation)};
    for (std::string& note : answer.notes) note = UploadedClouds(options_.cloud_dir).withoutFolders(note);
    if (simulation.pointCloud()) {
        if (scene.volume)
            answer.voxels = scene.volume->size;
        else
            answer.points = simulation.liveCount();
        answer.lo = scene.origin + glm::dvec3(simulation.bounds().lo);
        answer.hi = scene.origin + glm::dvec3(simulation.bounds().hi);
    }
    compilers_.prepare(scene);
    const RecordingHead head = recordingHead(files.scene, scene, files.overrides);
    std::future<void> shown = server_.frames.replaceScene(
        {scene, std::move(simulation), otherScenes(options_), [&, this](const Simulation& of) {
             if (server_.recorder) server_.recorder->goOn(head, scene, of, "another scene is shown");
         }});
    while (shown.wait_for(std::chrono::milliseconds(50)) != std::future_status::ready)
        if (server_.ended) throw std::runtime_error("the server stops");
    shown.get();
    *shown_ = files;
    spdlog::info("scene '{}' is shown", scene.name);
    compile(scene);
    return answer;
}

void SceneChanger::compile(const Scene& scene) {
    compilers_.begin(scene, shown_->scene, [files = *shown_](std::span<const std::string> overrides) {
        std::vector<std::string> all = files.overrides;
        all.insert(all.end(), overrides.begin(), overrides.end());
        Scene present = sceneOf(files.text, files.scene, all);
        placeCamera(present);
        return present;
    });
}

SceneChanger::Files SceneChanger::filesOf(fs::path file, std::vector<std::string> overrides) const {
    Files files{std::move(file), {}, std::move(overrides)};
    files.text = sceneText(files.scene);
    const Scene scene = sceneOf(files.text, files.scene, files.overrides);
    const Medium& medium = scene.medium;
    std::vector<std::pair<uint64_t, fs::path>> beside;
    if (medium.layout == Layout::file || medium.layout == Layout::volume) beside = {{0, medium.file}};
    if (medium.layout == Layout::sequence) beside = numberedFiles(medium.file);
    for (const Mesh& mesh : scene.meshes) beside.emplace_back(0, mesh.file);
    if (scene.render.sprites.maps == "files")
        for (const char* side : {"-positive.png", "-negative.png"})
            beside.emplace_back(0, medium.sprite_maps.string() + side);
    std::error_code error; // a cloud that is not there is complained about when it is loaded
    for (const auto& [number, file_beside] : beside) {
        files.beside.first += fs::file_size(file_beside, error);
        files.beside.second = std::max(files.beside.second, fs::last_write_time(file_beside, error));
    }
    return files;
}

} // namespace brume
