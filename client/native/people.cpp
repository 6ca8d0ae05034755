#include "client/native/people.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "common/text.h"

namespace brume::client {
namespace {

constexpr float kNear = 0.01f;       // m before the eye; what is nearer is not drawn
constexpr float kConeLength = 0.06f; // length of a cone / its distance from the eye
constexpr size_t kMostNames = 4;     // in a title

// The server's colours (server/viewer/people.cpp) in words. Of another colour the nearest counts.
struct ColourName {
    uint32_t colour;
    const char* name;
};
constexpr ColourName kColourNames[] = {
    {0xe69f00, "orange"}, {0x56b4e9, "blue"}, {0x2bb58b, "green"}, {0xf0e442, "yellow"},
    {0xd55e00, "red"},    {0xcc79a7, "pink"}, {0x88ccee, "sky"},   {0xddcc77, "sand"},
    {0x9a8cff, "violet"}, {0xff8f8f, "rose"}, {0x99dd55, "lime"},  {0xc8c8c8, "grey"},
};

const char* nameOfColour(uint32_t colour) {
    const auto distance = [&](const ColourName& one) {
        int sum = 0;
        for (const int shift : {0, 8, 16}) {
            const int step = int(colour >> shift & 255) - int(one.colour >> shift & 255);
            sum += step * step;
        }
        return sum;
    };
    return std::ranges::min_element(kColourNames, {}, distance)->name;
}

glm::vec3 vectorOf(const wire::Vec3& v) { return {v.x(), v.y(), v.z()}; }

} // namespace

std::vector<Person> peopleOf(const wire::People& message) {
    std::vector<Person> people;
    for (const wire::Person* one : *message.people()) {
        Person& person = people.emplace_back();
        person.id = one->id();
        person.name = oneLine(one->name()->str());
        person.colour = one->colour() & 0xffffff;
        if (const wire::Look* look = one->look()) {
            const wire::Quat& turn = look->orientation();
            person.look = Look{vectorOf(look->position()), glm::quat(turn.w(), turn.x(), turn.y(), turn.z()),
                               look->right(), look->up()};
        }
        if (one->pointer()) person.pointer = vectorOf(*one->pointer());
    }
    return people;
}

std::string namesOf(const std::vector<Person>& people, uint32_t me) {
    std::string names;
    size_t others = 0;
    for (const Person& person : people) {
        if (person.id == me || ++others > kMostNames) continue;
        names += fmt::format("{}{} ({}{})", names.empty() ? "" : ", ", person.name, nameOfColour(person.colour),
                             person.pointer ? ", points" : "");
    }
    return others > kMostNames ? fmt::format("{} and {} more", names, others - kMostNames) : names;
}

std::optional<glm::vec2> seenAt(glm::vec3 place, const Pose& eye, const Area& area) {
    const glm::vec3 seen = glm::conjugate(eye.orientation) * (place - eye.position);
    if (!(seen.z <= -kNear)) return {}; // also what is no number
    const float pixels = area.height / (2 * std::tan(eye.fov_y / 2));
    const glm::vec2 at(area.x + area.width / 2 - seen.x / seen.z * pixels,
                       area.y + area.height / 2 + seen.y / seen.z * pixels);
    return std::isfinite(at.x) && std::isfinite(at.y) ? std::optional(at) : std::nullopt;
}

std::optional<Line> inside(const Line& line, const Area& area) {
    const glm::vec2 lo(area.x, area.y), hi = lo + glm::vec2(area.width, area.height), way = line.to - line.from;
    float begin = 0, end = 1; // parts of the way
    for (const int axis : {0, 1}) {
        const float to_lo = lo[axis] - line.from[axis], to_hi = hi[axis] - line.from[axis];
        if (way[axis] == 0) {
            if (to_lo > 0 || to_hi < 0) return {};
            continue;
        }
        begin = std::max(begin, std::min(to_lo / way[axis], to_hi / way[axis]));
        end = std::min(end, std::max(to_lo / way[axis], to_hi / way[axis]));
    }
    if (!(begin < end)) return {};
    return Line{line.from + begin * way, line.from + end * way};
}

std::vector<Line> coneSeen(const Look& look, const Pose& eye, const Area& area) {
    const float reach = kConeLength * glm::length(look.position - eye.position);
    std::array<std::optional<glm::vec2>, 5> corners{seenAt(look.position, eye, area)};
    constexpr std::array<glm::vec2, 4> kSides{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
    for (size_t i = 0; i < 4; ++i)
        corners[i + 1] = seenAt(
            look.position + look.orientation * glm::vec3(kSides[i].x * look.right, kSides[i].y * look.up, -1) * reach,
            eye, area);
    if (!std::ranges::all_of(corners, [](const auto& corner) { return corner.has_value(); })) return {};
    std::vector<Line> edges;
    for (size_t i = 1; i <= 4; ++i) {
        edges.push_back({*corners[0], *corners[i]});
        edges.push_back({*corners[i], *corners[i % 4 + 1]});
    }
    return edges;
}

Marks marksOf(const std::vector<Person>& people, uint32_t me, const Pose& eye, const Area& area, bool cones) {
    Marks marks;
    for (const Person& person : people) {
        if (cones && person.id != me && person.look)
            for (const Line& edge : coneSeen(*person.look, eye, area))
                if (const auto line = inside(edge, area)) marks.edges.push_back({*line, person.colour});
        const auto at = person.pointer ? seenAt(*person.pointer, eye, area) : std::nullopt;
        if (at && at->x >= area.x && at->y >= area.y && at->x <= area.x + area.width && at->y <= area.y + area.height)
            marks.dots.push_back({*at, person.colour});
    }
    return marks;
}

} // namespace brume::client
