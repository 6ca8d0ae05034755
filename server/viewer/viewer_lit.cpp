// What a viewer who draws by itself gets, and how often: the lit medium in place of pictures.
#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>
#include <utility>

#include "server/sim/simulation.h"
#include "server/viewer/viewer.h"

namespace brume {
namespace {

// Without a full window for so long, messages of the lit medium come twice as often.
constexpr std::chrono::seconds kLitFaster{2};

} // namespace

bool Viewer::chooseRows() {
    const LitTick& lit = *frame_->lit;
    const bool changes = lit_held_.has(lit.reference);
    if (!changes && lit.whole.bytes.empty()) {
        pacing_.dropped(frame_->id);
        ++counts_.superseded;
        frame_.reset();
        lit_scene_.reset();
        return false;
    }
    lit_held_.add(lit.number);
    if (changes) return true;
    auto whole = std::make_shared<EncodedFrame>(*frame_);
    whole->lit_whole = true;
    frame_ = std::move(whole);
    return true;
}

uint32_t Viewer::drawHz() const {
    const std::scoped_lock lock(mutex_);
    return closed_ || !pose_ || pose_->hidden || pose_->one_shot || !refusal_.empty() ? 0 : pose_->draw_hz;
}

bool Viewer::lags(uint64_t scene, Clock::time_point now) const {
    const std::scoped_lock lock(mutex_);
    return !closed_ && pose_ && !pose_->hidden && pose_->draw_hz > 0 && refusal_.empty() && lit_scene_ != scene &&
           pacing_.isOpen(now);
}

std::optional<Viewer::Due> Viewer::takeLit(uint32_t number, double hz, double most_hz, uint64_t scene,
                                           Clock::time_point now) {
    const std::scoped_lock lock(mutex_);
    if (closed_ || !pose_ || pose_->hidden || pose_->draw_hz == 0 || !refusal_.empty()) return {};
    const bool rests = std::isinf(most_hz);
    if (rests && lit_scene_ == scene) return {};
    const double wanted = std::min({double(pose_->draw_hz), most_hz, 1 / (kTickSeconds * step().every)});
    const uint32_t most = 1u << (lit::kLayers - 1);
    if (lit_every_ > 1 && now - lit_held_back_ > kLitFaster) lit_every_ /= 2, lit_held_back_ = now;
    const uint32_t every = std::min(std::max(std::bit_ceil(uint32_t(std::ceil(hz / wanted - 0.01))), lit_every_), most);
    if (number % every != 0 && !rests && !lit_held_.isEmpty()) return {};
    if (!pacing_.isOpen(now)) { // rather a slower pace than gaps, after which it would need whole rows
        held_back_ = held_back_ || pacing_.isHeldByBytes();
        if (number % every == 0 && !rests) lit_every_ = std::min(2 * every, most), lit_held_back_ = now;
        return {};
    }
    if (++issued_ == 0) ++issued_; // 0 is no frame
    pacing_.issued(issued_, now);
    made_.reset(); // the next picture, if there is one, is new
    lit_scene_ = scene;
    return Due{issued_, *pose_, false, !lit_held_.has(lit::referenceOf(number))};
}

} // namespace brume
