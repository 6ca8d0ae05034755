// The table of everything that a scene file may set. It drives the loader, `--set`, the commands that change settings,
// the hash of the state, recordings and docs/scenes.md.
#pragma once

#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "common/scene.h"
#include "common/scene_limits.h"

namespace brume {

// The structs that settings lie in. A setting may be read only where its struct is there.
struct SceneParts {
    Scene* scene = nullptr; // for the keys at the file's top
    Medium* medium = nullptr;
    SimulationSettings* simulation = nullptr;
    Light* light = nullptr;
    Fog* fog = nullptr;
    Plane* plane = nullptr;
    Box* box = nullptr;
    Sphere* sphere = nullptr;
    Mesh* mesh = nullptr;
    Glass* glass = nullptr;
    ObjectLayout* objects = nullptr;
    Sky* sky = nullptr;
    SceneCamera* camera = nullptr;
    CameraKey* key = nullptr;
    RenderSettings* render = nullptr;
};

// A setting's member in its struct.
using Member = std::variant<bool*, float*, uint32_t*, uint64_t*, glm::vec3*, glm::dvec3*, Range*, std::string*, Layout*,
                            std::filesystem::path*>;

enum class Form : uint8_t {
    plain,
    or_auto,   // a number, or the word auto, for which kAuto stands
    unit,      // a length, or the name of one: lengthNamed()
    colour,    // a vector of linear red, green and blue
    place,     // a vector in world coordinates: the file's value less the scene's origin
    height,    // the same for y alone
    direction, // a vector of any length, kept as a unit vector
};

// Who may change a setting while the server runs.
enum class ChangedBy : uint8_t { nobody, controllers, operators };

struct SceneSetting {
    std::string_view path; // as for --set: "medium.extinction"; of a list of tables without an index: "box.size"
    Member (*member)(const SceneParts&);
    std::string_view unit; // empty: none
    Limits allowed;        // of each of its numbers; of a text: its length in bytes
    std::string_view help; // one line
    ChangedBy changed_by = ChangedBy::nobody;
    Form form = Form::plain;
    std::span<const std::string_view> choices{}; // the names that are allowed; empty: any
    Limits usual{0, 0};                          // the part of `allowed` that a slider offers; {0, 0}: all of it
    bool in_list = false; // True: it is live in an element of a SceneList, "fog[1].extinction"; false: as it stands

    Limits slider() const { return usual.lo < usual.hi ? usual : allowed; }
    constexpr bool live() const { return changed_by != ChangedBy::nobody; }
    constexpr std::string_view table() const {
        return path.substr(0, path.find_last_of('.') == path.npos ? 0 : path.find_last_of('.'));
    }
    std::string_view key() const { return path.substr(path.find_last_of('.') + 1); } // npos + 1 is 0
};

inline constexpr size_t kLongestName = 64; // bytes

// The settings of one table stand together.
std::span<const SceneSetting> sceneSettings();

// The range of render.isv.steps depends on its quadrature; the table has the widest one.
Limits stepsAllowed(const IsvSettings& isv);

// True: lights of its type have this key, "axis" for example.
bool has(const Light& light, std::string_view key);

// The choice among quadratures that the method of `render` has: the setting render.NAME.quadrature. Null if it has
// none.
const SceneSetting* quadratureSetting(const RenderSettings& render);
// The setting of that kind which allows `quadrature`. Null if none does.
const SceneSetting* quadratureSetting(std::string_view quadrature);

// The value of a live setting. Live settings have one of these types.
using SettingValue = std::variant<bool, float, uint32_t, glm::vec3, std::string>;

// The lists of a scene that commands change: points and spots ([[light]] but the directional one), fogs, and the
// objects that the file lists. Those of [objects] stay as they are.
enum class SceneList : uint8_t { lights, fogs, planes, boxes, spheres };
inline constexpr SceneList kSceneLists[]{SceneList::lights, SceneList::fogs, SceneList::planes, SceneList::boxes,
                                         SceneList::spheres};

inline constexpr uint32_t kNoElement = ~0u;
// An element of a list as paths name it: "fog[1]", or one of its settings, "fog[1].extinction".
struct ElementPath {
    SceneList list;
    uint32_t element;     // counts from 0, in the list as it is now; below 1,000,000
    std::string_view key; // "extinction"; empty: the path names the element
};
// As a scene file calls it: "light", "fog", "plane", "box", "sphere"; and back. Nothing: there is no such list.
std::string_view nameOf(SceneList list);
std::optional<SceneList> sceneList(std::string_view name);
// Nothing: the path names no element of a list.
std::optional<ElementPath> elementPath(std::string_view path);

// All live settings that stand in no list, in the order of the table.
std::span<const SceneSetting* const> liveSettings();
// The live settings of an element, in the order of the table.
std::span<const SceneSetting* const> liveSettings(SceneList list);

// Null if there is no setting of that path, or none that can be changed while the server runs. Settings in lists have
// an element in their paths, which may be any.
const SceneSetting* liveSetting(std::string_view path);
// The setting "fog.extinction" of an element. Null if there is none that is live.
const SceneSetting* elementSetting(SceneList list, std::string_view path);
// Of a live setting. Precondition: its struct is among `parts`.
SettingValue valueOf(const SceneSetting& setting, const SceneParts& parts);
// Structs with the defaults of all live settings. Nobody changes them.
const SceneParts& defaultParts();
SettingValue defaultOf(const SceneSetting& setting);
// The defaults of all live settings, in the order of liveSettings().
std::vector<SettingValue> defaultValues();

// A live setting of a scene and its new value.
struct Change {
    // Throws std::invalid_argument if there is no live setting of that path and type.
    Change(std::string_view path, SettingValue to);
    // Of an element that is added. Throws likewise; `path`: as for elementSetting().
    Change(SceneList list, std::string_view path, SettingValue to);

    std::string path() const; // as it was given

    const SceneSetting* setting;   // never null
    uint32_t element = kNoElement; // of a setting in a list; kNoElement: in the element that is added
    SettingValue value;
};

// Precondition: the setting's struct is among `parts`. Numbers are brought into their range. A value that is not
// finite, a direction without length, and an unknown or too long name change nothing. Allocates nothing where texts
// have room for kLongestName bytes.
void apply(const Change& change, const SceneParts& parts);

} // namespace brume
