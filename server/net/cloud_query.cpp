#include "server/net/cloud_query.h"

#include <algorithm>
#include <charconv>
#include <optional>

#include <fmt/format.h>

#include "common/scene_limits.h"
#include "common/scene_reader.h"
#include "server/net/uri.h"

namespace brume::net {
namespace {

constexpr char kUploaded[] = "uploaded"; // name of a cloud to which none was given
constexpr size_t kLongestFileName = 40;
constexpr std::string_view kUps[]{"x", "y", "z", "-y"};

// A decimal number within limits, up to a comma or the end; what is left of the text begins behind it.
std::optional<double> takeNumber(std::string_view& text, Limits allowed) {
    double number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || !allowed.holds(number)) return {};
    text.remove_prefix(size_t(end - text.data()));
    return number;
}

std::optional<double> unitOf(std::string_view text) {
    if (const auto named = lengthNamed(text)) return named;
    const auto number = takeNumber(text, limits::kUnit);
    return text.empty() ? number : std::nullopt;
}

std::optional<glm::dvec3> placeOf(std::string_view text) {
    glm::dvec3 place;
    for (int axis = 0; axis < 3; ++axis) {
        if (axis > 0 && !text.starts_with(',')) return {};
        if (axis > 0) text.remove_prefix(1);
        const auto number = takeNumber(text, limits::kOrigin);
        if (!number) return {};
        place[axis] = *number;
    }
    return text.empty() ? std::optional(place) : std::nullopt;
}

// Empty, or what the field may be.
std::string readField(std::string_view key, const std::string& value, SceneWish& out) {
    UploadOptions& options = out.options;
    if (key == "token") return {};
    if (key == "name") {
        out.name = value;
        if (isFileName(value)) return {};
        return fmt::format("a cloud's name has letters, digits, - and _, at most {}: /cloud?name=my-cloud",
                           kLongestFileName);
    }
    if (key == "unit") {
        options.unit = unitOf(value);
        return options.unit ? "" : "unit is m, cm, mm, um, km, in, ft or their length in metres: /cloud?unit=mm";
    }
    if (key == "up") {
        options.up = value;
        return std::ranges::find(kUps, value) != std::end(kUps) ? "" : "up is x, y, z or -y: /cloud?up=z";
    }
    if (key == "origin") {
        if (value == "auto") return {};
        options.origin = placeOf(value);
        return options.origin ? "" : "origin is auto, or three numbers: /cloud?origin=700000,0,-5300000";
    }
    if (key == "far_points") {
        options.keep_far = value == "keep";
        return options.keep_far || value == "drop" ? "" : "far_points is keep or drop: /cloud?far_points=keep";
    }
    return "an upload has name, unit, up, origin and far_points: /cloud?name=my-cloud&unit=mm&up=z";
}

} // namespace

bool isFileName(std::string_view name) {
    return !name.empty() && name.size() <= kLongestFileName && std::all_of(name.begin(), name.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
    });
}

std::variant<SceneWish, std::string> readCloudQuery(std::string_view query) {
    const auto fields = parseQuery(query);
    if (!fields) return "the query is not of the form name=value&name=value";
    SceneWish wish{.name = kUploaded, .upload = {}, .options = {}};
    for (const auto& [key, value] : *fields) {
        if (key == "name" && value.empty()) continue;
        if (std::string wrong = readField(key, value, wish); !wrong.empty()) return wrong;
    }
    return wish;
}

} // namespace brume::net
