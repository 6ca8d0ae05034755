#include "server/operate/recorder.h"

#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

namespace brume {
Recorder::Recorder(const Options& options, const RecordingHead& head, const Scene& scene, const gpu::Device& device)
    : options_(options), head_(head), scene_(scene), device_(device),
      out_(std::make_unique<RecordingWriter>(options.file, head, options.most_bytes)), begun_(head.tick),
      file_(options.file) {
    spdlog::info("recording to '{}', {} MiB at most", options.file.string(), options.most_bytes >> 20);
}

Recorder::~Recorder() { end("stopped"); }

void Recorder::ticked(const Simulation& simulation, std::span<const Command> commands, bool follows) {
    if (!out_) return;
    const bool first = !std::exchange(has_last_, true);
    if (!first && !follows) {
        RecordingHead head = head_;
        head.joined = true;
        return goOn(head, Scene(scene_), simulation, "another state was loaded");
    }
    const RecordedTick before = std::exchange(last_, {simulation.tick(), simulation.stateHash(), {}, {}, {}, {}});
    if (options_.frames > 0 && !pictures_)
        pictures_ = std::make_unique<OwnFrames>(device_, scene_, simulation.capacity());
    const bool picture = options_.frames > 0 && last_.tick > 0 && last_.tick % options_.frames == 0;
    if (commands.empty() && !picture && !first && last_.tick % kRecordEvery != 0) return;
    RecordedTick record = last_;
    record.commands.assign(commands.begin(), commands.end());
    if (picture) record.frame = pictures_->hash(simulation);
    if (last_.tick % kRecordEvery == 0) record.errors = errors_.take();
    if (!write(record)) {
        spdlog::warn("the recording is full and ends at tick {}", before.tick);
        last_ = before; // the state of this tick cannot be had without its commands
        end("full");
        return;
    }
    commands_ += commands.size();
    if (picture) {
        spdlog::info("tick {} frame {}", record.tick, hexOf(*record.frame));
    }
}

void Recorder::goOn(const RecordingHead& head, const Scene& scene, const Simulation& simulation, const char* why) {
    const bool was_open = out_ != nullptr;
    end(why);
    head_ = head;
    pictures_.reset();
    errors_.forget();
    scene_ = scene;
    if (!was_open) return;
    std::filesystem::path file = options_.file;
    file.replace_filename(fmt::format("{}-{}{}", file.stem().string(), ++files_, file.extension().string()));
    try {
        RecordingHead begun = head;
        begun.tick = simulation.tick();
        out_ = std::make_unique<RecordingWriter>(file, begun, options_.most_bytes);
        begun_ = begun.tick, commands_ = 0, file_ = file;
        spdlog::info("recording goes on in '{}'", file.string());
    } catch (const RecordingError& error) {
        spdlog::error("the recording does not go on: {}", error.what());
    }
    last_ = {simulation.tick(), simulation.stateHash(), {}, {}, {}, {}};
    if (out_) write(last_);
}

// False when it is full.
bool Recorder::write(const RecordedTick& tick) {
    try {
        return out_->write(tick);
    } catch (const std::exception& e) {
        spdlog::error("the recording ends at tick {}: {}", tick.tick, e.what());
        out_.reset();
        return true;
    }
}

void Recorder::end(const char* why) {
    if (!out_) return;
    if (last_.tick > 0) {
        last_.end = why;
        write(last_);
    }
    out_.reset();
    spdlog::info("recorded {} ticks, {} commands to '{}'", last_.tick - begun_, commands_, file_.string());
}

} // namespace brume
