#include "tests/integration/watcher.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace brume::test {

Watcher::Watcher(const client::Endpoint& server, const client::Wishes& wishes) : session(server, wishes, kPatience) {
    if (!watch({this}, [&] { return session.welcomed() || session.closed(); }) || session.closed())
        throw std::runtime_error("not welcomed: " + session.closedBecause());
}

uint32_t Watcher::look(const Pose& pose) {
    std::optional<uint32_t> seq; // nothing while the socket still writes the pose before
    if (!watch({this}, [&] { return bool(seq = session.sendPose(pose)); }))
        throw std::runtime_error("the socket takes no more poses");
    return *seq;
}

void Watcher::poll(milliseconds timeout) {
    const auto deadline = std::chrono::steady_clock::now() + timeout;
    // What is left is rounded up: the last wait is for 1 ms, and one of 0 ms takes what is there.
    const auto left = [&] {
        const auto rest = std::chrono::ceil<milliseconds>(deadline - std::chrono::steady_clock::now());
        return std::max(rest, milliseconds(0));
    };
    for (auto message = session.next(timeout); message; message = session.next(left())) {
        if (const auto* frame = message->as<wire::Frame>()) {
            Seen seen{
                frame->id(), frame->pose_seq(), frame->tick(), frame->state_hash(), frame->width(), frame->height(), {},
                {}};
            seen.quality = frame->quality();
            seen.render_ms = frame->stages()->render();
            seen.measured = frame->measured();
            seen.measured_low = frame->measured_low();
            seen.measured_high = frame->measured_high();
            seen.position = {frame->position()->x(), frame->position()->y(), frame->position()->z()};
            for (uint32_t view = 0; view < frame->jpeg_bytes()->size(); ++view) {
                const auto jpeg = message->parsed().view(view);
                seen.jpegs.emplace_back(jpeg.begin(), jpeg.end());
            }
            if (const auto* layers = frame->layers()) {
                seen.layers = layers->Get(0)->count(), seen.layer_rows = layers->Get(0)->block_rows();
                for (uint32_t picture = 0; picture < wire::kLayerPictures; ++picture) {
                    const auto bytes = message->parsed().layerPicture(0, picture);
                    seen.layer_pictures.emplace_back(bytes.begin(), bytes.end());
                }
            }
            hashes[seen.tick] = seen.state_hash;
            frames.push_back(std::move(seen));
            if (acknowledging) session.acknowledge(frame->id());
        } else if (const auto* state = message->as<wire::SceneState>()) {
            hashes[state->tick()] = state->state_hash();
            paused = state->paused();
            state_tick = state->tick();
            exposure = state->exposure();
            viewers = state->viewers();
            if (state->plan() && state->plan()->method()) method = state->plan()->method()->str();
            if (!state->lists()) continue;
            lists.clear();
            for (const wire::Elements* list : *state->lists())
                lists.emplace_back(list->values()->begin(), list->values()->end());
            lists_tick = state_tick;
        } else if (const auto* error = message->as<wire::Error>()) {
            errors.push_back({error->code(), error->text() ? error->text()->str() : "", error->input_seq()});
        } else if (const auto* bye = message->as<wire::Goodbye>()) {
            goodbye = bye->reason() ? bye->reason()->str() : "";
            if (bye->go_to()) go_to = bye->go_to()->str();
        }
    }
}

bool Watcher::saw(wire::ErrorCode code) const {
    for (const auto& error : errors)
        if (error.code == code) return true;
    return false;
}

bool watch(const std::vector<Watcher*>& watchers, const std::function<bool()>& until, milliseconds timeout) {
    const auto deadline = std::chrono::steady_clock::now() + timeout;
    while (!until()) {
        if (std::chrono::steady_clock::now() >= deadline) return false;
        for (Watcher* watcher : watchers) watcher->poll(milliseconds(2));
    }
    return true;
}

uint64_t setPaused(Watcher& watcher, bool paused, const std::vector<Watcher*>& others) {
    std::vector<Watcher*> all = others;
    all.push_back(&watcher);
    watcher.session.sendPaused(paused);
    if (!watch(all, [&] { return watcher.paused == paused; }))
        throw std::runtime_error("the simulation is not paused or resumed");
    return watcher.state_tick;
}

std::vector<std::pair<const Seen*, const Seen*>> commonTicks(const Watcher& a, const Watcher& b, uint64_t from_tick) {
    std::vector<std::pair<const Seen*, const Seen*>> pairs;
    for (const Seen& x : a.frames)
        for (const Seen& y : b.frames)
            if (x.tick == y.tick && x.tick >= from_tick) pairs.emplace_back(&x, &y);
    return pairs;
}

client::Picture decoded(const client::Bytes& jpeg, int width, int height) {
    client::JpegDecoder decoder;
    client::Picture picture;
    if (!decoder.decode(jpeg, width, height, picture)) throw std::runtime_error("not a picture: " + decoder.error());
    return picture;
}

client::Picture pictureOf(const Seen& frame, size_t view) {
    return decoded(frame.jpegs.at(view), frame.width, frame.height);
}

double difference(const client::Picture& a, const client::Picture& b) {
    if (a.rgb.size() != b.rgb.size()) throw std::runtime_error("pictures of different sizes");
    double sum = 0;
    for (size_t i = 0; i < a.rgb.size(); ++i) sum += std::abs(int{a.rgb[i]} - int{b.rgb[i]});
    return sum / static_cast<double>(a.rgb.size());
}

double contrast(const client::Picture& picture) {
    double sum = 0, squares = 0;
    for (size_t i = 1; i < picture.rgb.size(); i += 3) {
        sum += picture.rgb[i];
        squares += double(picture.rgb[i]) * picture.rgb[i];
    }
    const double count = double(picture.rgb.size()) / 3, mean = sum / count;
    return std::sqrt(std::max(0.0, squares / count - mean * mean));
}

} // namespace brume::test
