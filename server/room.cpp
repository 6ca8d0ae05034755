#include "server/room.h"

#include <algorithm>
#include <cctype>

#include <spdlog/spdlog.h>

#include "common/scene_text.h"
#include "server/compile/ahead.h"
#include "server/loop/idle_ticks.h"

namespace brume {
namespace {

constexpr const char* kOneOfSeveral = "one of several servers: all show the scene that their log began with";

ServerFacts factsOf(const gpu::Device& device) {
    ServerFacts facts{device.name(), {kAutoMethod}};
    for (const std::string& method : methodNames()) facts.methods.push_back(method);
    return facts;
}

// Null: nothing is recorded. `first_tick`: of the state that it begins with; not 0 where that came from elsewhere.
std::unique_ptr<Recorder> recorderOf(const ServerOptions& options, const Scene& scene, const gpu::Device& device,
                                     uint64_t first_tick) {
    if (options.record.empty()) return nullptr;
    const std::filesystem::path file = findScene(options.scene, options.scene_dir);
    RecordingHead head = recordingHead(file, scene, sceneOverrides(options));
    head.tick = first_tick;
    head.joined = first_tick > 0;
    return std::make_unique<Recorder>(
        Recorder::Options{options.record, uint64_t{options.record_limit} << 20, options.frames}, head, scene, device);
}

// A name of a log: letters, digits, '-' and '_'.
std::string logName(std::string name) {
    std::ranges::replace_if(
        name, [](unsigned char c) { return !std::isalnum(c) && c != '-' && c != '_'; }, '_');
    return name;
}

// Null: this server is alone.
std::unique_ptr<cluster::Node> nodeOf(const ServerOptions& options, const Scene& scene, Audience& audience) {
    if (options.cluster.engine.servers.empty()) return nullptr;
    return std::make_unique<cluster::Node>(options.cluster, scene,
                                           sceneText(findScene(options.scene, options.scene_dir)),
                                           sceneOverrides(options), options.frame.memory, audience);
}

} // namespace

void nameLog(ServerOptions& options, const Scene& scene) {
    std::string& log = options.cluster.engine.log;
    if (log.empty()) log = logName(scene.name);
}

// Settings that are given for the scene at "/" may not suit another scene.
ServerOptions optionsOfRoom(const ServerOptions& server, const std::string& name, const std::string& scene) {
    ServerOptions options = server;
    options.scene = scene;
    options.overrides.clear();
    options.rooms.clear();
    if (!options.record.empty())
        options.record.replace_filename(options.record.stem().string() + "-" + name +
                                        options.record.extension().string());
    cluster::ClusterOptions& cluster = options.cluster;
    cluster.engine.room = name;
    cluster.url = net::roomUrl(cluster.url, name);
    return options;
}

ServedRoom::ServedRoom(std::string name, const ServerOptions& options, const SharedByRooms& shared, Scene scene,
                       const RecordingExtent* replay)
    : name_(std::move(name)), options_(options), shared_(shared), replay_(replay), scene_(std::move(scene)),
      audience_(factsOf(shared.device),
                sceneFacts(scene_, options_.cluster.engine.servers.empty() && !replay ? otherScenes(options_)
                                                                                      : std::vector<std::string>()),
                options_.max_viewers, options_.max_in_flight) {
    audience_.setMaxViewers(options_.max_viewers, options_.max_viewers_per_owner, options_.max_drawing_viewers);
    audience_.keepPlaceForOperators(!options_.net.token_key.empty());
    if (!replay_) {
        node_ = nodeOf(options_, scene_, audience_);
        recorder_ = recorderOf(options_, scene_, shared.device, node_ ? node_->firstTick() : 0);
    }
    if (node_) {
        metrics_.collect([node = node_.get()] { return node->samples(); });
        ticks_ = node_->ticks();
    } else if (!name_.empty() && options_.idle_rooms == "sleep") {
        ticks_ = std::make_unique<IdleTicks>(audience_.commands(), Clock::now(),
                                             [this] { return audience_.size() > 0 || !audience_.commands().empty(); });
    }
    frames_.emplace(scene_, shared.device, audience_, metrics_, frameOptions());
}

FrameLoop::Options ServedRoom::frameOptions() {
    FrameLoop::Options frame = options_.frame;
    frame.costs = shared_.costs;
    frame.turns = &shared_.turns;
    // What is learnt in one room holds for all; the others learn for themselves.
    if (name_.empty() && frame.learn_costs && (shared_.costs.learnt || !shared_.costs.calibrated))
        frame.on_costs = [file = costFile(options_.costs, shared_.device.name(), shared_.device.driver()),
                          &device = shared_.device](CostModel learnt) {
            learnt.learnt = true;
            try {
                saveCosts(file, learnt, device.name(), device.driver());
            } catch (const std::runtime_error& error) {
                spdlog::debug("{}", error.what());
            }
        };
    frame.compiled_behind = !replay_ && options_.ahead == "background" && isWorthCompiling(scene_);
    if (recorder_ || node_)
        frame.ticked = [this](const Simulation& s, std::span<const Command> commands, bool follows) {
            if (recorder_) recorder_->ticked(s, commands, follows);
            if (node_) node_->ticked(s);
        };
    if (recorder_)
        frame.on_errors = [this](auto, std::span<const ViewError> errors, const Plan&) { recorder_->measured(errors); };
    if (replay_) {
        const auto control = std::make_shared<ReplayControl>(replay_->head.tick, replay_->last);
        audience_.setReplay(control);
        auto replay = std::make_unique<ReplayTicks>(options_.replay, control, Clock::now());
        frame.ticked = [replay = replay.get()](const Simulation& s, auto, bool) { replay->check(s); };
        ticks_ = std::move(replay);
        frame.first_tick = replay_->head.tick;
    }
    return frame;
}

ServedRoom::~ServedRoom() { stop(); }

void ServedRoom::start(std::function<void()> failed) {
    if (!replay_)
        scenes_.emplace(
            options_, scene_,
            SceneChanger::Server{{shared_.argc, shared_.argv, *frames_, audience_, shared_.device, shared_.costs},
                                 recorder_.get(),
                                 node_ ? kOneOfSeveral : nullptr,
                                 ended_});
    frames_->start(
        [this, failed = std::move(failed)] {
            failed_ = ended_ = true;
            if (!stopping_) failed();
        },
        std::move(ticks_));
    if (node_) node_->start();
}

void ServedRoom::stop() {
    stopping_ = true;
    frames_->stop();
    ended_ = true;
    scenes_.reset();
    recorder_.reset(); // whole, whatever else goes on
}

} // namespace brume
