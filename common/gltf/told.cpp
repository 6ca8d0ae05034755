#include "common/gltf/told.h"

#include <algorithm>

#include <fmt/format.h>

#include "common/text.h"

namespace brume::gltf {

std::string shortened(std::string text, size_t most) {
    if (text.size() > most) {
        while (most > 0 && (static_cast<unsigned char>(text[most]) & 0xc0) == 0x80) --most;
        text = text.substr(0, most) + "...";
    }
    return oneLine(std::move(text));
}

void Told::add(std::string text, size_t count, const char* unit) {
    if (count == 0) return;
    text = shortened(std::move(text), kLongestTold);
    const auto same = std::ranges::find(notes_, text, &Note::text);
    if (same != notes_.end())
        same->count += count;
    else if (notes_.size() < kMostTold - 1)
        notes_.push_back({std::move(text), count, unit});
    else
        more_ = true;
}

std::vector<std::string> Told::lines() const {
    std::vector<std::string> out;
    for (const Note& note : notes_) {
        const char* const many = note.unit.ends_with("sh") ? "es" : "s"; // meshes
        out.push_back(note.unit.empty()
                          ? note.text
                          : fmt::format("{} ({} {}{})", note.text, note.count, note.unit, note.count == 1 ? "" : many));
    }
    if (more_) out.emplace_back("more than these lines say is left out");
    return out;
}

} // namespace brume::gltf
