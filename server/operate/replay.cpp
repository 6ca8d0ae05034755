#include "server/operate/replay.h"

#include <ostream>
#include <set>

#include <fmt/format.h>

#include "server/operate/own_frames.h"
#include "server/operate/recorded_ticks.h"
#include "server/operate/replay_ticks.h"

namespace brume {
namespace {

class Replay {
public:
    Replay(const ReplayOptions& options, std::ostream& out)
        : options_(options), out_(out), recording_(options.file), scene_(sceneOf(recording_.head())),
          simulation_(scene_) {
        simulation_.countFrom(recording_.head().tick);
        const bool film = !options.film.folder.empty();
        if (options.frames == 0 && !film) return;
        device_ = std::make_unique<gpu::Device>(options.device);
        if (film)
            film_ = std::make_unique<ReplayPictures>(options.film, *device_, scene_, simulation_.capacity(),
                                                     recording_.head().tick, RecordingExtent(options.file).last);
        if (options.frames == 0) return;
        pictures_ = std::make_unique<OwnFrames>(*device_, scene_, simulation_.capacity());
        out_ << fmt::format("pictures of scene '{}' by {}, {}\n", scene_.name, device_->name(), device_->driver());
    }

    void run() {
        RecordedTicks ticks(recording_);
        check(ticks.records());
        if (film_) film_->ticked(simulation_);
        std::vector<Command> commands;
        while (ticks.take(Clock::now(), commands)) {
            step(commands);
            check(ticks.records());
            if (film_) film_->ticked(simulation_);
        }
        if (recording_.cut())
            out_ << fmt::format("{}: its last line is incomplete and left out\n", options_.file.string());
        out_ << fmt::format("replayed {} ticks with {} commands: {} states{} as recorded; {}\n",
                            simulation_.tick() - recording_.head().tick, commands_, states_,
                            frames_ > 0 ? fmt::format(" and {} frames", frames_) : "",
                            last_.end.empty() ? "the server was killed or still records"
                                              : "the recording ended: " + last_.end);
        tellErrors();
    }

private:
    void check(std::span<const RecordedTick> records) {
        for (const RecordedTick& record : records) {
            if (simulation_.stateHash() != record.state_hash)
                differ("state", simulation_.stateHash(), record.state_hash);
            if (record.frame && picture_ && *picture_ != *record.frame) differ("frame", *picture_, *record.frame);
            ++states_;
            frames_ += record.frame && picture_;
            for (const RecordedError& one : record.errors) {
                ++errors_;
                viewers_.insert(one.viewer);
                if (!worst_ || one.error.rmse > worst_->error.rmse) worst_ = one, worst_tick_ = record.tick;
            }
            last_ = record;
        }
    }

    void step(const std::vector<Command>& commands) {
        simulation_.step(commands);
        commands_ += commands.size();
        picture_.reset();
        if (!pictures_ || simulation_.tick() % options_.frames != 0) return;
        picture_ = pictures_->hash(simulation_);
        out_ << fmt::format("tick {} frame {}\n", simulation_.tick(), hexOf(*picture_));
    }

    void tellErrors() const {
        if (!worst_) return;
        const ErrorEstimate& e = worst_->error;
        out_ << fmt::format("{} measured errors of {} viewers; the largest: {:.2g} % ({:.2g} to {:.2g}) at tick {}, "
                            "viewer {} by {}, predicted {:.2g} %\n",
                            errors_, viewers_.size(), 100 * e.rmse, 100 * e.low, 100 * e.high, worst_tick_,
                            worst_->viewer, worst_->method, 100 * e.law);
    }

    [[noreturn]] void differ(const char* what, uint64_t here, uint64_t recorded) const {
        out_.flush();
        throw RecordingError(
            fmt::format("{}: the first difference is at tick {}: {} {}, recorded {}; tick {} was as recorded",
                        options_.file.string(), simulation_.tick(), what, hexOf(here), hexOf(recorded), last_.tick));
    }

    const ReplayOptions options_;
    std::ostream& out_;
    RecordingReader recording_;
    const Scene scene_;
    Simulation simulation_;
    std::unique_ptr<gpu::Device> device_;
    std::unique_ptr<OwnFrames> pictures_;
    std::unique_ptr<ReplayPictures> film_;
    std::optional<uint64_t> picture_; // of the present tick
    RecordedTick last_;               // that was as recorded
    uint64_t commands_ = 0, states_ = 0, frames_ = 0, errors_ = 0;
    std::set<uint32_t> viewers_; // with measured errors
    std::optional<RecordedError> worst_;
    uint64_t worst_tick_ = 0;
};

} // namespace

void replay(const ReplayOptions& options, std::ostream& out) { Replay(options, out).run(); }

} // namespace brume
