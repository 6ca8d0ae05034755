#include "tools/bench/drawing_links.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>

#include <fmt/format.h>

#include "client/native/drawn_scene.h"
#include "server/frame/lit_rows.h"
#include "server/net/outgoing.h"
#include "server/viewer/quality.h"
#include "tools/bench/error.h"
#include "tools/bench/layered_view.h"

namespace brume::bench {
namespace {

constexpr double kLinks[] = {0.5, 1, 5}; // Mbit/s
constexpr uint32_t kSeconds = 4;         // that are looked at, after one in which streams begin
constexpr uint32_t kFirst = 60, kEnd = kFirst + 60 * kSeconds, kLookEvery = 9; // ticks
constexpr float kAround = 10;                                                  // degrees a second
constexpr int kUsualQuality = 80;

Pose at(const Stage& stage, double tick) {
    return turnedAbout(stage.pose(), stage.scene().camera.target, glm::radians(kAround) * float(tick / 60));
}

// Relative RMSE (%) and FLIP, means over looks: beside the medium as it is now, and as it was when it was what is
// shown. kB/s; messages or pictures a second; how old the medium is, ms.
struct Sight {
    double error = 0, flip = 0, late_error = 0, late_flip = 0, rate = 0, hz = 0, age_ms = 0;
    uint32_t looks = 0;
    void add(const RadianceImage& seen, const RadianceImage& truth, const RadianceImage& late,
             const DisplaySettings& display, double age) {
        const Errors e = compare(seen, truth, display, mediumMask(truth)),
                     own = compare(seen, late, display, mediumMask(late));
        error += 100 * e.relative_rmse, flip += e.flip, late_error += 100 * own.relative_rmse, late_flip += own.flip;
        age_ms += age, ++looks;
    }
    std::string text() const {
        return fmt::format(" {:.1f} | {:.4f} | {:.1f} | {:.4f} | {:.0f} | {:.0f} | {:.1f} |", error / looks,
                           flip / looks, late_error / looks, late_flip / looks, age_ms / looks, rate, hz);
    }
};

// A link that sends one thing after another. Times are ticks.
struct Link {
    double bytes_per_tick, free = 0;
    double arrival(double now, double bytes) { return free = std::max(now, free) + bytes / bytes_per_tick; }
};

// The scene some time ago.
class Late {
public:
    Late(const gpu::Device& device, const Case& one, uint32_t ticks, const CostModel& costs)
        : stage_(device, one, ticks, costs) {}
    // Precondition: no earlier than the last one.
    RadianceImage picture(double tick, const Pose& pose, glm::uvec2 size) {
        for (; at_ + 0.5 < tick; ++at_) stage_.step({});
        return stage_.picture(pose, size);
    }

private:
    Stage stage_;
    double at_ = 0;
};

// Pictures at the step that the server would settle at (quality.h): the first that the link carries.
Sight pictures(const gpu::Device& device, const CostModel& costs, const DrawingQuestion& question, const Case& one,
               double bytes_per_tick) {
    Stage stage(device, one, question.ticks, costs);
    Late late(device, one, question.ticks, costs);
    const DisplaySettings display = displayOf(stage.scene().render);
    const auto picture = [&](double tick, const QualityStep& step) {
        const glm::uvec2 size = step.half ? question.size / 2u : question.size;
        return layeredView(stage, at(stage, tick), size, 1, std::min<int>(step.quality, kUsualQuality), 1);
    };
    uint32_t level = 0;
    while (level + 1 < QualityControl::kSteps &&
           double(picture(0, QualityControl::stepAt(level)).flat_bytes) / QualityControl::stepAt(level).every >
               bytes_per_tick)
        ++level;
    const QualityStep step = QualityControl::stepAt(level);
    Link link{bytes_per_tick};
    Sight sight;
    struct Coming {
        double tick, arrival;
        LayeredPicture picture;
    };
    std::deque<Coming> coming;
    double sent = 0;
    for (uint32_t tick = 0; tick < kEnd; ++tick, stage.step({})) {
        if (tick % step.every == 0 && link.free <= tick) { // no picture waits
            LayeredView view = picture(tick, step);
            coming.push_back({double(tick), link.arrival(tick, double(view.flat_bytes)), distant(view.picture)});
            if (tick >= kFirst) sent += double(view.flat_bytes), sight.hz += 1.0 / kSeconds;
        }
        while (coming.size() > 1 && coming[1].arrival <= tick) coming.pop_front();
        if (tick < kFirst || tick % kLookEvery != 0) continue;
        const Coming& seen = coming.front();
        const RadianceImage truth = stage.picture(at(stage, tick), question.size);
        sight.add(redrawn(seen.picture, at(stage, seen.tick), question.size), truth,
                  late.picture(seen.tick, at(stage, tick), question.size), display, (tick - seen.tick) * 1000 / 60);
    }
    sight.rate = sent / 1000 / kSeconds;
    return sight;
}

// A message as a viewer has it.
struct Message {
    double tick = 0, arrival = 0;
    std::vector<uint8_t> header;
    lit::Rows rows;
};

// The rows between two messages: of particles that both have, all numbers.
lit::Rows between(const lit::Rows& a, const lit::Rows& b, double part) {
    lit::Rows out = b;
    for (uint32_t column = 0; column < lit::kFit; ++column)
        for (uint32_t i = 0; i < b.count; ++i) {
            const uint64_t before = b.first + i - a.first;
            if (before >= a.count) continue;
            const double from = a.columns[column][before], to = b.columns[column][i];
            out.columns[column][i] = uint16_t(std::lround(from + (to - from) * part));
        }
    return out;
}

// Lit particles at the pace that the link carries, drawn one interval late by the renderer itself: so what slabs and
// fits err is left out.
Sight drawn(const gpu::Device& device, const CostModel& costs, const DrawingQuestion& question, const Case& one,
            double bytes_per_tick) {
    client::DrawnScene painter;
    client::Picture picture;
    Sight sight;
    for (uint32_t every = 1; every <= 8; every *= 2) {
        Stage stage(device, one, question.ticks, costs);
        Late late(device, one, question.ticks, costs);
        const DisplaySettings display = displayOf(stage.scene().render);
        lit::Packer packer;
        std::array<LitRows, lit::kLayers> held;
        Link link{bytes_per_tick};
        std::deque<Message> messages;
        sight = {};
        double sent = 0, wait = 0; // wait: ticks from a message's tick to its arrival, at most
        bool keeps_up = true;
        for (uint32_t tick = 0; tick < kEnd && keeps_up; ++tick, stage.step({})) {
            const uint32_t number = tick / 2 + 1;
            if (tick % 2 == 0 && number % every == 0) {
                const Submission::Fits& fits = stage.fits();
                LitRows made = litRows(fits, stage.simulation().firstId());
                const uint32_t reference = lit::referenceOf(number);
                auto lit = std::make_shared<LitTick>();
                lit->number = number;
                lit->first = made.rows.first, lit->count = made.rows.count;
                lit->origin = made.origin, lit->step = made.step;
                lit->scene = fits.tick, lit->objects = fits.objects;
                for (const Hue& hue : fits.hues) lit->hues.push_back({uint8_t(hue.channels), hue.particles});
                lit->exposure = display.exposure, lit->filmic = display.filmic;
                lit->changes = packer.pack(made.rows, reference ? &held[lit::layerOf(reference)].rows : nullptr);
                EncodedFrame frame;
                frame.lit = lit;
                const wire::Packed packed = net::packLitHeader(frame, 0);
                Message message{double(tick), 0, {packed.data(), packed.data() + packed.size()}, made.rows};
                const auto bytes = double(packed.size() + lit->changes.bytes.size());
                message.header.insert(message.header.end(), lit->changes.bytes.begin(), lit->changes.bytes.end());
                message.arrival = link.arrival(tick, bytes);
                if (tick >= kFirst / 2) wait = std::max(wait, message.arrival - tick);
                if (tick >= kFirst) sent += bytes, sight.hz += 1.0 / kSeconds;
                keeps_up = every == 8 || message.arrival < tick + 60;
                messages.push_back(std::move(message));
                held[lit::layerOf(number)] = std::move(made);
            }
            if (tick < kFirst || tick % kLookEvery != 0 || !keeps_up) continue;
            const double shown = tick - 2.0 * every - wait;
            while (messages.size() > 2 && messages[1].tick <= shown) messages.pop_front();
            const Message &from = messages[0], &to = messages[1];
            const double part = std::clamp((shown - from.tick) / (to.tick - from.tick), 0.0, 1.0);
            const auto parsed = wire::parse(to.header);
            painter.take(*parsed->as<wire::LitParticles>(), between(from.rows, to.rows, part));
            painter.draw(at(stage, tick), question.size.x, question.size.y, picture);
            LayeredPicture flat;
            flat.eye = at(stage, tick);
            flat.width = question.size.x, flat.height = question.size.y;
            flat.exposure = display.exposure, flat.filmic = display.filmic;
            for (size_t i = 0; i < picture.rgb.size(); i += 3)
                flat.picture.emplace_back(picture.rgb[i], picture.rgb[i + 1], picture.rgb[i + 2]);
            const RadianceImage truth = stage.picture(at(stage, tick), question.size);
            sight.add(redrawn(flat, flat.eye, question.size), truth, late.picture(shown, flat.eye, question.size),
                      display, (tick - shown) * 1000 / 60);
        }
        sight.rate = sent / 1000 / kSeconds;
        if (keeps_up && sent / (60 * kSeconds) <= bytes_per_tick) break;
    }
    return sight;
}

} // namespace

std::string linksTable(const gpu::Device& device, const CostModel& costs, const DrawingQuestion& question,
                       const std::string& scene) {
    const Case one{.scene = scene, .size = question.size};
    std::string out = fmt::format(
        "\n| {}, Mbit/s | way | error, % | FLIP | beside its own time: error, % | FLIP | medium is old, ms | kB/s | "
        "a second |\n|---|---|---|---|---|---|---|---|---|\n",
        scene);
    for (const double megabits : kLinks) {
        const double bytes_per_tick = megabits * 1e6 / 8 / 60;
        out += fmt::format("| {} | pictures |", megabits) +
               pictures(device, costs, question, one, bytes_per_tick).text() + '\n';
        out +=
            fmt::format("| {} | drawn |", megabits) + drawn(device, costs, question, one, bytes_per_tick).text() + '\n';
    }
    return out;
}

} // namespace brume::bench
