#include "server/viewer/people.h"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "server/viewer/viewer.h"

namespace brume {
namespace {

// sRGB, told apart on a cloud and by most of those who see fewer colours (after Okabe and Ito, and Tol).
constexpr std::array<uint32_t, 12> kColours{0xe69f00, 0x56b4e9, 0x2bb58b, 0xf0e442, 0xd55e00, 0xcc79a7,
                                            0x88ccee, 0xddcc77, 0x9a8cff, 0xff8f8f, 0x99dd55, 0xc8c8c8};

// The code point that begins at text[at], which moves behind it. Nothing: no UTF-8 begins there; it moves by one.
std::optional<uint32_t> nextCodePoint(std::string_view text, size_t& at) {
    const auto byte = [&](size_t i) { return uint32_t(uint8_t(text[i])); };
    const uint32_t first = byte(at++);
    if (first < 0x80) return first;
    const size_t more = first >= 0xf0 ? 3 : first >= 0xe0 ? 2 : 1;
    if (first < 0xc2 || first > 0xf4 || at + more > text.size()) return {};
    uint32_t code = first & (0x3fu >> more);
    for (size_t i = 0; i < more; ++i) {
        if ((byte(at + i) & 0xc0) != 0x80) return {};
        code = code << 6 | (byte(at + i) & 0x3f);
    }
    constexpr uint32_t kLeast[] = {0, 0x80, 0x800, 0x10000};
    if (code < kLeast[more] || code > 0x10ffff || (code >= 0xd800 && code < 0xe000)) return {};
    at += more;
    return code;
}

// Controls, marks of direction and of invisible joins, private use, and what is no character.
bool isLeftOut(uint32_t code) {
    return code < 0x20 || (code >= 0x7f && code < 0xa0) || code == 0xad || code == 0x61c || code == 0x180e ||
           (code >= 0x200b && code <= 0x200f) || (code >= 0x2028 && code <= 0x202e) ||
           (code >= 0x2060 && code <= 0x206f) || (code >= 0xe000 && code < 0xf900) || code == 0xfeff ||
           (code >= 0xfff0 && code <= 0xffff) || code >= 0xe0000;
}

bool isSpace(uint32_t code) {
    return code == ' ' || code == 0xa0 || code == 0x3000 || (code >= 0x2000 && code <= 0x200a);
}

} // namespace

std::string personName(std::string_view wished) {
    std::string name;
    bool space = false; // True: one is due before the next character
    for (size_t at = 0, characters = 0; at < wished.size() && characters < kMostNameCharacters;) {
        const size_t begin = at;
        const std::optional<uint32_t> code = nextCodePoint(wished, at);
        if (!code || isLeftOut(*code)) continue;
        if (isSpace(*code)) {
            space = !name.empty();
            continue;
        }
        if (space && ++characters == kMostNameCharacters) break;
        if (space) name += ' ';
        space = false;
        name += wished.substr(begin, at - begin);
        ++characters;
    }
    return name;
}

// The first of the palette, or of those that the fewest have.
uint32_t People::freeColour() const {
    std::array<size_t, kColours.size()> taken{};
    for (const auto& [id, entry] : entries_)
        ++taken[size_t(std::ranges::find(kColours, entry.person.colour) - kColours.begin()) % kColours.size()];
    return kColours[size_t(std::ranges::min_element(taken) - taken.begin())];
}

std::string People::shownName(const Entry& entry) const {
    if (!entry.token.empty()) return entry.token;
    return entry.person.name.empty() ? fmt::format("Guest {}", entry.person.id) : entry.person.name;
}

void People::join(const std::shared_ptr<Viewer>& viewer, const std::string& token, uint8_t role) {
    const std::scoped_lock lock(mutex_);
    Entry entry;
    entry.viewer = viewer;
    entry.token = personName(token);
    entry.person.id = viewer->id();
    entry.person.known = !entry.token.empty();
    entry.person.colour = freeColour();
    entry.person.role = role;
    entry.own = viewer->pose();
    entry.person.name = shownName(entry);
    entries_[viewer->id()] = std::move(entry);
    order_.push_back(viewer->id());
    ++people_version_;
    settle();
}

void People::leave(uint32_t id) {
    const std::scoped_lock lock(mutex_);
    if (entries_.erase(id) == 0) return;
    std::erase(order_, id);
    if (presenter_ == id) presenter_ = 0;
    for (auto& [other, entry] : entries_)
        if (entry.wanted == id) entry.wanted = 0;
    ++people_version_;
    settle();
}

void People::say(uint32_t id, const Presence& presence) {
    const std::scoped_lock lock(mutex_);
    const auto found = entries_.find(id);
    if (found == entries_.end()) return;
    Entry& entry = found->second;
    entry.person.name = presence.name;
    entry.person.name = shownName(entry);
    const uint32_t wanted = presence.follow != id && entries_.contains(presence.follow) ? presence.follow : 0;
    const bool another = std::exchange(entry.wanted, wanted) != wanted;
    entry.ray = presence.pointer;
    if (entry.ray)
        entry.ray_waits = ++ray_count_;
    else
        entry.ray_waits = 0, entry.person.pointer.reset();
    ++people_version_;
    if (another) settle();
}

bool People::lead(uint32_t id) {
    const std::scoped_lock lock(mutex_);
    if (id != 0 && !entries_.contains(id)) return false;
    presenter_ = id;
    ++people_version_;
    settle();
    return true;
}

// Who follows somebody who follows has the camera of the last of them. Where that is a ring, all in it have their own.
uint32_t People::leaderOf(uint32_t id) const {
    const auto wantedBy = [&](uint32_t one) {
        const Entry& entry = entries_.at(one);
        if (presenter_ != 0 && one != presenter_) return presenter_;
        return one == presenter_ ? 0u : entry.wanted;
    };
    const Entry& entry = entries_.at(id);
    if (entry.own && entry.own->views > 1) return 0; // two eyes that are turned by others make people sick
    uint32_t leader = wantedBy(id);
    for (size_t steps = 0; leader != 0 && steps <= entries_.size(); ++steps) {
        const uint32_t next = wantedBy(leader);
        if (next == 0) return leader;
        leader = next;
    }
    return 0;
}

void People::settle() {
    followers_ = 0;
    for (auto& [id, entry] : entries_) {
        const uint32_t leader = leaderOf(id);
        followers_ += leader != 0;
        if (leader == entry.person.follows) continue;
        const auto viewer = entry.viewer.lock();
        entry.person.follows = leader;
        ++people_version_;
        if (!viewer) continue;
        if (leader == 0) {
            if (entry.own) viewer->look(*entry.own);
        } else if (const auto& own = entries_.at(leader).own) {
            viewer->follow(leader, *own);
        }
    }
}

void People::look(uint32_t id, const PoseRequest& request) {
    const std::scoped_lock lock(mutex_);
    const auto found = entries_.find(id);
    if (found == entries_.end()) return;
    Entry& entry = found->second;
    if (!entry.any_pose && !isNewer(request.seq, entry.own->seq)) return;
    entry.any_pose = false;
    entry.own = request;
    entry.person.look = request.hidden ? std::nullopt : std::optional(request);
    ++camera_version_;
    const uint32_t leader = leaderOf(id);
    const auto viewer = entry.viewer.lock();
    if (viewer && leader == 0) viewer->setPose(request);
    if (viewer && leader != 0) viewer->follow(leader, entries_.at(leader).own.value_or(request), &request);
    if (leader != entry.person.follows) settle(); // it has one eye now, or two
    if (followers_ == 0) return;
    for (auto& [other, follower] : entries_)
        if (other != id && follower.person.follows == id)
            if (const auto follows = follower.viewer.lock()) follows->follow(id, request);
}

People::Now People::now() const {
    const std::scoped_lock lock(mutex_);
    Now now;
    now.count = uint32_t(entries_.size());
    now.presenter = presenter_;
    for (const uint32_t id : order_) {
        const size_t room =
            kMostPeople - (presenter_ != 0 && id != presenter_ ? 1 : 0); // the presenter's place is kept
        const bool told =
            now.people.size() < room ||
            (now.people.size() < kMostPeople &&
             (id == presenter_ || std::ranges::find(now.people, presenter_, &Person::id) != now.people.end()));
        if (told) now.people.push_back(entries_.at(id).person);
    }
    return now;
}

uint64_t People::version(bool cameras) const {
    const std::scoped_lock lock(mutex_);
    return people_version_ + (cameras ? camera_version_ : 0);
}

std::vector<People::Moved> People::takeMoved(size_t most) {
    const std::scoped_lock lock(mutex_);
    std::vector<std::pair<uint64_t, uint32_t>> waiting;
    for (const auto& [id, entry] : entries_)
        if (entry.ray_waits != 0) waiting.emplace_back(entry.ray_waits, id);
    std::ranges::sort(waiting);
    if (waiting.size() > most) waiting.resize(most);
    std::vector<Moved> moved;
    for (const auto& [order, id] : waiting) {
        Entry& entry = entries_.at(id);
        entry.ray_waits = 0;
        moved.push_back({id, *entry.ray});
    }
    return moved;
}

void People::meets(const Moved& moved, const std::optional<glm::vec3>& point) {
    const std::scoped_lock lock(mutex_);
    const auto found = entries_.find(moved.id);
    if (found == entries_.end() || !found->second.ray) return; // it has left, or points no more
    found->second.person.pointer = point;
    ++people_version_;
}

} // namespace brume
