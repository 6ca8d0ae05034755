#include "common/settings_tables.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/settings.h"

namespace brume {
namespace {

std::string rangeOf(Limits allowed) { return fmt::format("{} to {}", allowed.lo, allowed.hi); }

// What a setting may be, and its default.
struct Cells {
    const SceneSetting& setting;
    std::string values{}, standard{};

    void operator()(const bool* value) { values = "true or false", standard = fmt::format("{}", *value); }
    void operator()(const float* value) {
        values = setting.form == Form::height ? "a number" : "a number, " + rangeOf(setting.allowed);
        number(*value);
    }
    void operator()(const uint32_t* value) {
        values = "a whole number, " + rangeOf(setting.allowed);
        number(*value);
    }
    void operator()(const uint64_t* value) {
        values = fmt::format("a whole number, {:.0f} to {:.0f}", setting.allowed.lo, setting.allowed.hi);
        standard = fmt::format("{}", *value);
    }
    void operator()(const glm::vec3* value) { vector(*value); }
    void operator()(const glm::dvec3* value) { vector(*value); }
    void operator()(const Range* value) {
        values = "a number or [lowest, highest], " + rangeOf(setting.allowed);
        standard =
            value->lo == value->hi ? fmt::format("{}", value->lo) : fmt::format("[{}, {}]", value->lo, value->hi);
    }
    void operator()(const std::string* value) {
        values = setting.choices.empty() ? fmt::format("text, {} bytes", rangeOf(setting.allowed)) : names();
        standard = code(*value);
    }
    void operator()(const Layout* value) {
        values = names(), standard = code(setting.choices[static_cast<size_t>(*value)]);
    }
    void operator()(const std::filesystem::path*) { values = fmt::format("text, {} bytes", rangeOf(setting.allowed)); }

private:
    template <class Number>
    void number(Number value) {
        if (setting.form == Form::or_auto) values = "`auto`, or " + values;
        standard = setting.form == Form::or_auto && value == kAuto ? "`auto`" : fmt::format("{}", value);
    }
    template <class Vector>
    void vector(const Vector& value) {
        const bool free = setting.form == Form::place || setting.form == Form::direction;
        values = free ? "[x, y, z]" : "[x, y, z], each " + rangeOf(setting.allowed);
        standard = fmt::format("[{}, {}, {}]", value.x, value.y, value.z);
    }
    std::string names() const { return fmt::format("`{}`", fmt::join(setting.choices, "`, `")); }
    static std::string code(std::string_view text) { return text.empty() ? "" : fmt::format("`{}`", text); }
};

std::string_view roleOf(ChangedBy who) {
    switch (who) {
    case ChangedBy::nobody:
        break;
    case ChangedBy::controllers:
        return "controller";
    case ChangedBy::operators:
        return "operator";
    }
    return "";
}

} // namespace

std::string settingsTables() {
    Scene scene;
    Light light;
    Plane plane;
    Box box;
    Sphere sphere;
    Mesh mesh;
    Glass glass;
    ObjectLayout objects;
    Fog fog;
    CameraKey key;
    const SceneParts defaults{.scene = &scene,
                              .medium = &scene.medium,
                              .simulation = &scene.simulation,
                              .light = &light,
                              .fog = &fog,
                              .plane = &plane,
                              .box = &box,
                              .sphere = &sphere,
                              .mesh = &mesh,
                              .glass = &glass,
                              .objects = &objects,
                              .sky = &scene.sky,
                              .camera = &scene.camera,
                              .key = &key,
                              .render = &scene.render};
    std::string text;
    std::string_view table;
    for (const SceneSetting& setting : sceneSettings()) {
        if (text.empty() || setting.table() != table) {
            table = setting.table();
            text += fmt::format("{}<!-- settings: {} -->\n\n| key | values | unit | default | live | what |\n"
                                "|---|---|---|---|---|---|\n",
                                text.empty() ? "" : "\n", table.empty() ? "top" : table);
        }
        Cells cells{setting};
        std::visit(cells, setting.member(defaults));
        text += fmt::format("| `{}` | {} | {} | {} | {} | {} |\n", setting.key(), cells.values, setting.unit,
                            cells.standard, roleOf(setting.changed_by), setting.help);
    }
    return text;
}

} // namespace brume
