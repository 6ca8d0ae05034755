#include "server/sim/sequence.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/scene_limits.h"
#include "server/sim/kernels.h"

namespace brume {
namespace {

constexpr double kStepsPerSecond = 60;
constexpr uint32_t kNone = ~0u;

template <class T>
T between(const T& a, const T& b, float part) {
    return a + (b - a) * part;
}

} // namespace

Sequence::Sequence(const Medium& medium, SequenceFiles files, Columns& columns)
    : files_(std::move(files)), rate_(static_cast<double>(medium.rate)), loop_(medium.loop), unit_(medium.extinction),
      next_(files_.most), albedos_(files_.facts.coloured ? files_.most : 0) {
    before_.push_back(0);
    for (const SequenceFile& file : files_.files) before_.push_back(before_.back() + file.position.size());
    turnTo(0);
    show(columns, 0, glm::vec3(0));
}

// From the number of steps, not from a running sum: rounding cannot pile up.
Sequence::Moment Sequence::at(uint64_t step) const {
    const auto& files = files_.files;
    const uint64_t first = files.front().number, last = files.back().number;
    const double passed = static_cast<double>(step) * rate_ / kStepsPerSecond;
    const double now = loop_ ? std::fmod(passed, static_cast<double>(last - first + 1)) // which is exact
                             : std::min(passed, static_cast<double>(last - first));
    const auto after = std::upper_bound(files.begin(), files.end(), now, [&](double time, const SequenceFile& file) {
        return time < static_cast<double>(file.number - first);
    });
    const auto shown = std::prev(after);
    const double since = now - static_cast<double>(shown->number - first);
    Moment moment{.file = static_cast<size_t>(shown - files.begin()), .since = static_cast<float>(since / rate_)};
    if (loop_) moment.round = static_cast<uint64_t>((passed - now) / static_cast<double>(last - first + 1) + 0.5);
    if (after == files.end() || !(files_.has_ids || files_.has_velocities)) return moment;
    const auto whole = static_cast<double>(after->number - shown->number);
    moment.part = static_cast<float>(since / whole);
    moment.left = static_cast<float>((whole - since) / rate_);
    return moment;
}

// Ids ascend in every file, so that one pass over both finds all that are in both.
void Sequence::turnTo(size_t file) {
    present_ = file;
    const SequenceFile& now = files_.files[file];
    live_ = static_cast<uint32_t>(now.position.size());
    std::copy(now.albedo.begin(), now.albedo.end(), albedos_.begin()); // also for a restart that no step follows
    if (!files_.has_ids || file + 1 == files_.files.size()) return;
    const std::vector<int64_t>& then = files_.files[file + 1].id;
    uint32_t other = 0;
    for (uint32_t row = 0; row < live_; ++row) {
        while (other < then.size() && then[other] < now.id[row]) ++other;
        next_[row] = other < then.size() && then[other] == now.id[row] ? other : kNone;
    }
}

void Sequence::add(Columns& columns, const SequenceFile& file, float seconds, float part, glm::vec3 volume) {
    for (size_t i = 0; i < file.position.size(); ++i, ++live_) {
        glm::vec3 place = file.position[i];
        if (!file.velocity.empty()) place += seconds * file.velocity[i];
        for (int axis = 0; axis < 3; ++axis) place[axis] = limits::kPlace.clamp(place[axis]);
        columns[Column::x][live_] = place.x + volume.x;
        columns[Column::y][live_] = place.y + volume.y;
        columns[Column::z][live_] = place.z + volume.z;
        columns[Column::scale][live_] = file.scale[i];
        columns[Column::weight][live_] = part * file.weight[i];
        if (!albedos_.empty()) albedos_[live_] = file.albedo[i];
    }
}

void Sequence::show(Columns& columns, uint64_t step, glm::vec3 volume) {
    const Moment moment = at(step);
    if (moment.file != present_) turnTo(moment.file);
    first_id_ = before_[moment.file] + moment.round * before_.back();
    const SequenceFile& now = files_.files[moment.file];
    const SequenceFile* then = moment.part > 0 ? &files_.files[moment.file + 1] : nullptr;
    if (files_.has_velocities) {
        live_ = 0;
        add(columns, now, moment.since, 1 - moment.part, volume);
        if (then) add(columns, *then, -moment.left, moment.part, volume);
        return;
    }
    for (uint32_t row = 0; row < live_; ++row) {
        glm::vec3 place = now.position[row];
        float scale = now.scale[row], weight = now.weight[row];
        if (!albedos_.empty()) albedos_[row] = now.albedo[row];
        if (const uint32_t other = then ? next_[row] : kNone; other != kNone) {
            place = between(place, then->position[other], moment.part);
            scale = between(scale, then->scale[other], moment.part);
            weight = between(weight, then->weight[other], moment.part);
            if (!albedos_.empty()) albedos_[row] = between(now.albedo[row], then->albedo[other], moment.part);
        }
        columns[Column::x][row] = place.x + volume.x;
        columns[Column::y][row] = place.y + volume.y;
        columns[Column::z][row] = place.z + volume.z;
        columns[Column::scale][row] = scale;
        columns[Column::weight][row] = weight;
    }
}

void Sequence::settle(Columns& columns, float extinction) {
    if (files_.own_extinction)
        scaleSigma(columns, {0, live_}, unit_ > 0 ? extinction / unit_ : 1);
    else
        setSigma(columns, {0, live_}, extinction);
}

uint64_t Sequence::bytes() const {
    return files_.bytes + next_.capacity() * sizeof(uint32_t) + albedos_.capacity() * sizeof(glm::vec3);
}

} // namespace brume
