#include "common/scene_reader.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "common/nearest.h"
#include "common/text.h"

namespace brume {

namespace {

std::string plain(double value) {
    std::ostringstream out;
    out.precision(10);
    out << value;
    return out.str();
}

Limits around(double origin) { return {origin + limits::kPlace.lo, origin + limits::kPlace.hi}; }

bool isTheWordAuto(const toml::node& node) { return node.value_exact<std::string>() == "auto"; }

std::string bounds(Limits allowed) { return "from " + plain(allowed.lo) + " to " + plain(allowed.hi); }

} // namespace

const toml::node* TableReader::find(std::string_view key) {
    known_.emplace_back(key);
    return table_.get(key);
}

bool TableReader::isAuto(std::string_view key) {
    const toml::node* node = find(key);
    return node && isTheWordAuto(*node);
}

void TableReader::fail(std::string_view key, const std::string& problem, const std::string& allowed) const {
    const toml::node* node = key.empty() ? nullptr : table_.get(key);
    const toml::source_region& source = node ? node->source() : table_.source();
    const std::string name = key.empty() ? path_ : joined(key);
    // A node without a file was given by an override.
    const std::string where =
        node && !source.path ? "--set " : file_ + ':' + std::to_string(std::max<unsigned>(source.begin.line, 1)) + ": ";
    throw SceneError(oneLine(where + name + ": " + problem + "; allowed: " + allowed));
}

std::string TableReader::shown(const toml::node& node) {
    std::string value;
    if (const auto text = node.value_exact<std::string>()) value = '"' + text->substr(0, 60) + '"';
    if (const auto* number = node.as_floating_point()) value = plain(number->get());
    if (const auto* number = node.as_integer()) value = std::to_string(number->get());
    if (const auto flag = node.value_exact<bool>()) value = *flag ? "true" : "false";
    if (node.is_array()) value = "an array of " + std::to_string(node.as_array()->size());
    if (node.is_table()) value = "a table";
    return (value.empty() ? "a date or time" : value) + " is not allowed here";
}

double TableReader::checked(std::string_view key, const toml::node& node, Limits allowed, bool whole,
                            const std::string& form) const {
    const bool right_type = whole ? node.is_integer() : node.is_number();
    // A whole number of 64 bits that no double holds has no value<double>().
    const auto* integer = node.as_integer();
    const double value = !right_type ? 0 : integer ? static_cast<double>(integer->get()) : *node.value<double>();
    if (!right_type || !allowed.holds(value)) fail(key, shown(node), form + ' ' + bounds(allowed));
    return value;
}

void TableReader::number(std::string_view key, float& out, Limits allowed, std::string_view unit) {
    const std::string form = unit == "rad" ? "a number of radians" : "a number"; // many take degrees for granted
    if (const toml::node* node = find(key)) out = static_cast<float>(checked(key, *node, allowed, false, form));
}

void TableReader::integer(std::string_view key, uint32_t& out, Limits allowed) {
    if (const toml::node* node = find(key))
        out = static_cast<uint32_t>(checked(key, *node, allowed, true, "a whole number"));
}

void TableReader::integer(std::string_view key, uint64_t& out, Limits allowed) {
    if (const toml::node* node = find(key))
        out = static_cast<uint64_t>(checked(key, *node, allowed, true, "a whole number"));
}

std::optional<double> lengthNamed(std::string_view unit) {
    constexpr std::pair<std::string_view, double> kUnits[]{{"m", 1},    {"cm", 1e-2},   {"mm", 1e-3},  {"um", 1e-6},
                                                           {"km", 1e3}, {"in", 0.0254}, {"ft", 0.3048}};
    for (const auto& [name, length] : kUnits)
        if (name == unit) return length;
    return {};
}

void TableReader::numberOrAuto(std::string_view key, float& out, Limits allowed) {
    if (const toml::node* node = find(key))
        out = isTheWordAuto(*node) ? kAuto
                                   : static_cast<float>(checked(key, *node, allowed, false, "\"auto\", or a number"));
}

void TableReader::numberOrUnit(std::string_view key, float& out, Limits allowed) {
    const toml::node* node = find(key);
    if (!node) return;
    const auto named = lengthNamed(node->value_or(std::string_view()));
    out = named ? static_cast<float>(*named)
                : static_cast<float>(checked(key, *node, allowed, false, "a unit's name like \"mm\", or a number"));
}

void TableReader::integerOrAuto(std::string_view key, uint32_t& out, Limits allowed) {
    if (const toml::node* node = find(key))
        out = isTheWordAuto(*node)
                  ? kAuto
                  : static_cast<uint32_t>(checked(key, *node, allowed, true, "\"auto\", or a whole number"));
}

glm::dvec3 TableReader::checkedVector(std::string_view key, const toml::node& node, const Limits (&allowed)[3],
                                      const std::string& form) const {
    const toml::array* array = node.as_array();
    if (!array || array->size() != 3) fail(key, shown(node), form + ' ' + bounds(allowed[0]));
    glm::dvec3 out;
    for (int i = 0; i < 3; ++i) out[i] = checked(key, *array->get(static_cast<size_t>(i)), allowed[i], false, form);
    return out;
}

void TableReader::vector(std::string_view key, glm::vec3& out, Limits allowed) {
    const toml::node* node = find(key);
    if (node) out = checkedVector(key, *node, {allowed, allowed, allowed}, "[x, y, z], each a number");
}

void TableReader::vector(std::string_view key, glm::dvec3& out, Limits allowed) {
    const toml::node* node = find(key);
    if (node) out = checkedVector(key, *node, {allowed, allowed, allowed}, "[x, y, z], each a number");
}

void TableReader::place(std::string_view key, glm::vec3& out, glm::dvec3 origin) {
    const toml::node* node = find(key);
    if (node)
        out = checkedVector(key, *node, {around(origin.x), around(origin.y), around(origin.z)},
                            "[x, y, z] near the scene's origin (the key at the top), each a number") -
              origin;
}

void TableReader::height(std::string_view key, float& out, glm::dvec3 origin) {
    if (const toml::node* node = find(key))
        out = static_cast<float>(
            checked(key, *node, around(origin.y), false, "a number near the scene's origin (the key at the top)") -
            origin.y);
}

void TableReader::range(std::string_view key, Range& out, Limits allowed) {
    const toml::node* node = find(key);
    if (!node) return;
    const std::string form = "a number, or [lowest, highest], each";
    if (const toml::array* array = node->as_array()) {
        if (array->size() != 2) fail(key, shown(*node), form + ' ' + bounds(allowed));
        out.lo = static_cast<float>(checked(key, *array->get(0), allowed, false, form));
        out.hi = static_cast<float>(checked(key, *array->get(1), allowed, false, form));
        if (out.lo > out.hi)
            fail(key, '[' + plain(out.lo) + ", " + plain(out.hi) + "] is upside down", "the lowest first");
    } else {
        out.lo = out.hi = static_cast<float>(checked(key, *node, allowed, false, form));
    }
}

void TableReader::boolean(std::string_view key, bool& out) {
    const toml::node* node = find(key);
    if (!node) return;
    if (!node->is_boolean()) fail(key, shown(*node), "true or false");
    out = **node->as_boolean();
}

void TableReader::text(std::string_view key, std::string& out, size_t longest) {
    const toml::node* node = find(key);
    if (!node) return;
    const auto value = node->value_exact<std::string>();
    if (!value || value->empty() || value->size() > longest)
        fail(key, shown(*node), "text of 1 to " + std::to_string(longest) + " bytes");
    out = *value;
}

std::optional<size_t> TableReader::choice(std::string_view key, std::span<const std::string_view> names) {
    const toml::node* node = find(key);
    if (!node) return {};
    const auto text = node->value_exact<std::string_view>();
    std::string allowed;
    for (size_t i = 0; i < names.size(); ++i) {
        if (text && *text == names[i]) return i;
        allowed += (allowed.empty() ? "\"" : ", \"") + std::string(names[i]) + '"';
    }
    fail(key, shown(*node), "one of " + allowed);
}

void TableReader::texts(std::string_view key, std::vector<std::string>& out) {
    const toml::node* node = find(key);
    if (!node) return;
    const toml::array* array = node->as_array();
    if (!array || array->size() > 100 || !(array->empty() || array->is_homogeneous<std::string>()))
        fail(key, shown(*node), "a list of at most 100 texts, each in quotes");
    out.clear();
    for (const toml::node& element : *array) out.push_back(*element.value<std::string>());
}

const toml::array* TableReader::listOfTables(std::string_view key, Limits how_many) {
    const toml::node* node = find(key);
    if (!node) return nullptr;
    const toml::array* array = node->as_array();
    const std::string number = how_many.lo == how_many.hi ? plain(how_many.lo) : bounds(how_many);
    if (!array || !how_many.holds(static_cast<double>(array->size())))
        fail(key, shown(*node), "[[" + joined(key) + "]], " + number + " of them");
    return array;
}

void TableReader::finish() const {
    for (const auto& [key, node] : table_) {
        if (std::find(known_.begin(), known_.end(), key.str()) != known_.end()) continue;
        std::vector<std::string> names = known_;
        std::sort(names.begin(), names.end());
        names.erase(std::unique(names.begin(), names.end()), names.end()); // a key may be read twice
        std::string allowed;
        for (const std::string& name : names) allowed += (allowed.empty() ? "" : ", ") + name;
        fail(key.str(), "unknown key" + didYouMean(key.str(), names), allowed);
    }
}

} // namespace brume
