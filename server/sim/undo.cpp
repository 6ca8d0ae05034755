#include "server/sim/undo.h"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "server/sim/state.h"

namespace brume {
namespace {

constexpr uint64_t kDragTicks = 30; // between two messages of one drag at most

bool sameSettings(const Set& a, const Set& b) {
    return std::ranges::equal(a.changes, b.changes, [](const Change& x, const Change& y) {
        return x.setting == y.setting && x.element == y.element;
    });
}

struct ValueText {
    std::string operator()(bool value) const { return value ? "true" : "false"; }
    std::string operator()(const glm::vec3& v) const { return fmt::format("[{:.4g}, {:.4g}, {:.4g}]", v.x, v.y, v.z); }
    std::string operator()(const std::string& value) const { return value; }
    std::string operator()(uint32_t value) const { return fmt::format("{}", value); }
    std::string operator()(float value) const { return fmt::format("{:.4g}", value); }
};

struct BackText {
    std::string operator()(const MoveBack&) const { return "the medium back to where it was"; }
    std::string operator()(const Remove& c) const {
        return fmt::format("{}[{}] away again", nameOf(c.list), c.element);
    }
    std::string operator()(const PutBack& c) const { return fmt::format("{}[{}] back", nameOf(c.list), c.element); }
    std::string operator()(const Set& c) const {
        const Change& first = c.changes.back(); // the first that was changed
        if (c.changes.size() > 1) return fmt::format("{} and {} more back", first.path(), c.changes.size() - 1);
        return fmt::format("{} back to {}", first.path(), std::visit(ValueText{}, first.value));
    }
};

void exchangeList(StateBytes& bytes, SceneList& list) {
    auto number = static_cast<uint8_t>(list);
    bytes.value(number);
    if (number >= std::size(kSceneLists)) throw StateError("a state with a list that there is none of");
    list = static_cast<SceneList>(number);
}

void exchangeValue(StateBytes& bytes, SettingValue& value) {
    std::visit(
        [&]<class T>(T& one) {
            if constexpr (std::is_same_v<T, std::string>)
                bytes.value(one, kLongestName);
            else
                bytes.value(one);
        },
        value);
}

Change readChange(StateBytes& bytes) {
    std::string path;
    bytes.value(path);
    const SceneSetting* const setting = liveSetting(path);
    if (!setting) throw StateError("a state with a setting that there is none of");
    SettingValue value = defaultOf(*setting);
    exchangeValue(bytes, value);
    return {path, std::move(value)};
}

struct ExchangeBack {
    StateBytes& bytes;

    void operator()(MoveBack& c) const { bytes.value(c.moved); }
    void operator()(Remove& c) const {
        exchangeList(bytes, c.list);
        bytes.value(c.element);
    }
    void operator()(PutBack& c) const {
        exchangeList(bytes, c.list);
        bytes.value(c.element);
        exchange(bytes, c.removed);
        if (c.removed.size(c.list) != 1) throw StateError("a state with a removed element that is not there");
    }
    void operator()(Set& c) const {
        const size_t count = bytes.size(c.changes.size(), kMostUndoneChanges);
        if (count == 0) throw StateError("a state with a change of nothing");
        for (size_t i = 0; i < count; ++i) {
            if (bytes.reads()) {
                c.changes.push_back(readChange(bytes));
            } else {
                std::string path = c.changes[i].path();
                bytes.value(path);
                exchangeValue(bytes, c.changes[i].value);
            }
        }
    }
};

} // namespace

void ChangeStack::keep(Before before, const std::vector<SettingValue>& after) {
    const auto* set = std::get_if<Set>(&before.back);
    if (set && (set->changes.empty() || set->changes.size() > kMostUndoneChanges)) return;
    auto* newest = open_ && !stack_.empty() ? std::get_if<Set>(&stack_.back().back) : nullptr;
    if (set && newest && before.tick - stack_.back().tick <= kDragTicks && sameSettings(*newest, *set)) {
        stack_.back().tick = before.tick;
    } else {
        if (stack_.size() == kMostUndone) stack_.erase(stack_.begin());
        stack_.push_back(std::move(before));
    }
    open_ = true;
    newest = std::get_if<Set>(&stack_.back().back);
    if (newest && std::ranges::equal(newest->changes, after, {}, &Change::value)) stack_.pop_back(); // nothing changed
}

Before ChangeStack::take() {
    Before newest = std::move(stack_.back());
    stack_.pop_back();
    open_ = false;
    return newest;
}

std::string ChangeStack::text() const {
    return stack_.empty() ? std::string() : std::visit(BackText{}, stack_.back().back);
}

void ChangeStack::exchange(StateBytes& bytes) {
    bytes.value(open_);
    const size_t count = bytes.size(stack_.size(), kMostUndone);
    if (bytes.reads()) stack_.assign(count, {});
    for (Before& one : stack_) {
        bytes.value(one.tick);
        bytes.value(one.operators);
        auto kind = static_cast<uint8_t>(one.back.index());
        bytes.value(kind);
        if (kind >= std::variant_size_v<decltype(one.back)>) throw StateError("a state with an unknown change");
        if (bytes.reads()) {
            if (kind == 0) one.back.emplace<0>();
            if (kind == 1) one.back.emplace<1>();
            if (kind == 2) one.back.emplace<2>();
            if (kind == 3) one.back.emplace<3>();
        }
        std::visit(ExchangeBack{bytes}, one.back);
    }
}

// Of the settings that a change would set, as they are now.
Before Simulation::State::before(const Set& c) {
    const auto partsFor = [&](const Change& one) -> std::optional<SceneParts> {
        if (!one.setting->in_list) return partsOf(now);
        const SceneList list = listOf(*one.setting);
        if (one.element >= now.lists.size(list)) return {};
        return partsOf(now.lists, list, one.element);
    };
    const bool operators = std::ranges::any_of(
        c.changes, [](const Change& one) { return one.setting->changed_by == ChangedBy::operators; });
    return {tick, operators, backOf(c, partsFor)};
}

void Simulation::State::keep(Before change) {
    std::vector<SettingValue> after;
    if (const auto* back = std::get_if<Set>(&change.back)) {
        const Before present = before(*back);
        for (const Change& one : std::get<Set>(present.back).changes) after.push_back(one.value);
        std::ranges::reverse(after); // before() goes backwards
    }
    changes.keep(std::move(change), after);
}

std::string Simulation::State::apply(const Undo& c) {
    if (changes.empty()) return "there is nothing to undo: pushes, set particles and restarts stay";
    if (changes.newest().operators && !c.operators)
        return fmt::format("only an operator may undo that: {}", changes.text());
    const Before last = changes.take();
    if (const auto* move = std::get_if<MoveBack>(&last.back)) {
        moved = move->moved;
        ++settings_version;
        return {};
    }
    if (const auto* set = std::get_if<Set>(&last.back)) return give(*set);
    if (const auto* added = std::get_if<Remove>(&last.back))
        return change([&](SceneLists& lists) { return remove(lists, added->list, added->element); });
    const auto& put = std::get<PutBack>(last.back);
    return change([&](SceneLists& lists) { return insert(lists, put.list, put.element, put.removed); });
}

} // namespace brume
