// Reads one TOML table strictly: every key is named once with where it goes and what it may be; finish() refuses the
// rest.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>
#include <toml++/toml.h>

#include "common/scene.h"
#include "common/scene_limits.h"

namespace brume {

// The length, m, of a unit: m, cm, mm, um, km, in or ft. Nothing for other names.
std::optional<double> lengthNamed(std::string_view unit);

class TableReader {
public:
    // `path` is how messages name the table ("medium.emitter"), empty for the file's top. Both references must outlive
    // the reader.
    TableReader(const toml::table& table, std::string path, const std::string& file)
        : table_(table), path_(std::move(path)), file_(file) {}

    // Each leaves `out` as it is when the key is absent, and throws SceneError when its value is not allowed.
    void number(std::string_view key, float& out, Limits allowed, std::string_view unit = {});
    void integer(std::string_view key, uint32_t& out, Limits allowed);
    void integer(std::string_view key, uint64_t& out, Limits allowed);
    // The word "auto" gives kAuto.
    void numberOrAuto(std::string_view key, float& out, Limits allowed);
    void numberOrUnit(std::string_view key, float& out, Limits allowed); // m, or a unit's name
    void integerOrAuto(std::string_view key, uint32_t& out, Limits allowed);
    void vector(std::string_view key, glm::vec3& out, Limits allowed); // [x, y, z]
    void vector(std::string_view key, glm::dvec3& out, Limits allowed);
    // World coordinates, within limits::kPlace of `origin`, which is subtracted in double.
    void place(std::string_view key, glm::vec3& out, glm::dvec3 origin); // [x, y, z]
    void height(std::string_view key, float& out, glm::dvec3 origin);    // y
    void range(std::string_view key, Range& out, Limits allowed);        // a number, or [lo, hi]
    void boolean(std::string_view key, bool& out);
    void text(std::string_view key, std::string& out, size_t longest); // not empty
    void texts(std::string_view key, std::vector<std::string>& out);   // ["a", "b"], at most 100, replaces `out`
    // One of a few names: which of them; nothing when the key is absent.
    std::optional<size_t> choice(std::string_view key, std::span<const std::string_view> names);
    // [key]: read(TableReader&) names the keys of the inner table.
    template <class Read>
    void table(std::string_view key, Read read) {
        if (const toml::node* node = find(key)) inner(*node, key, joined(key), read);
    }
    // [[key]]: read(TableReader&, T&), once for each. `out` is replaced when the key is there.
    template <class T, class Read>
    void tables(std::string_view key, std::vector<T>& out, Limits how_many, Read read) {
        const toml::array* list = listOfTables(key, how_many);
        if (!list) return;
        out.assign(list->size(), T{});
        for (size_t i = 0; i < list->size(); ++i)
            inner(*list->get(i), key, joined(key) + '[' + std::to_string(i) + ']',
                  [&](TableReader& r) { read(r, out[i]); });
    }

    // True: the key is the word "auto". Then it counts as read.
    bool isAuto(std::string_view key);
    bool has(std::string_view key) const { return table_.contains(key); }
    // Refuses keys that nobody asked for.
    void finish() const;
    // "file:line: key: problem; allowed: ...", at the key's line, or the table's when the key is absent.
    [[noreturn]] void fail(std::string_view key, const std::string& problem, const std::string& allowed) const;

private:
    const toml::node* find(std::string_view key); // and remembers the key as known
    const toml::array* listOfTables(std::string_view key, Limits how_many);
    glm::dvec3 checkedVector(std::string_view key, const toml::node& node, const Limits (&allowed)[3],
                             const std::string& form) const;
    double checked(std::string_view key, const toml::node& node, Limits allowed, bool whole,
                   const std::string& form) const;
    std::string joined(std::string_view key) const {
        return path_.empty() ? std::string(key) : path_ + '.' + std::string(key);
    }
    static std::string
    shown(const toml::node& node); // a value for a message: "7 is not allowed", "an array is not allowed"

    template <class Read>
    void inner(const toml::node& node, std::string_view key, std::string path, Read read) {
        if (!node.is_table()) fail(key, shown(node), "a table");
        TableReader reader(*node.as_table(), std::move(path), file_);
        read(reader);
        reader.finish();
    }

    const toml::table& table_;
    std::string path_;
    const std::string& file_;
    std::vector<std::string> known_;
};

} // namespace brume
