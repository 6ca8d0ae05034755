#include "common/scene.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <utility>

#include "common/medium_files.h"
#include "common/meshes.h"
#include "common/numbered_files.h"
#include "common/object_layout.h"
#include "common/plain_file.h"
#include "common/ply/ply.h"
#include "common/scene_camera.h"
#include "common/scene_text.h"
#include "common/setting_reader.h"
#include "common/text.h"
#include "common/toml_text.h"

namespace brume {

namespace {

constexpr size_t kMostTextBytes = 1 << 20; // of a scene file

// True: the file's name has one run of #, of at most as many digits as a number can have.
bool isPattern(const std::string& name) {
    const size_t begin = name.find('#'), end = name.find_last_of('#') + 1;
    return begin != name.npos && end - begin <= 9 && name.find_first_not_of('#', begin) >= end;
}

void readMedium(TableReader& in, const SettingReader& read, Medium& out, const glm::dvec3& origin) {
    const SceneParts parts{.medium = &out};
    read.readOne(in, "medium.layout", parts); // what the centre is depends on it
    const bool sequence = out.layout == Layout::sequence, volume = out.layout == Layout::volume,
               from_file = isFromFiles(out.layout), live = out.layout == Layout::live,
               emitted = out.layout == Layout::emitter;
    read.readTable(in, "medium", parts, from_file || live ? nullptr : &origin);
    in.table("emitter", [&](TableReader& r) { read.readTable(r, "medium.emitter", parts, &origin); });

    out.scale_by_spacing = from_file && !in.has("scale");
    out.extinction_by_depth = from_file && !in.has("extinction");
    if (volume != (out.model == kVolumeMedium) && in.has("model"))
        in.fail("model",
                "\"" + out.model + "\" is not of layout \"" + std::string(volume ? "volume" : "another") + "\"",
                volume ? "\"volume\", or none" : "\"volume\" only with layout = \"volume\"");
    if (volume) out.model = kVolumeMedium;
    const std::string name = out.file.filename().string();
    if ((out.model == kTetrahedraMedium || out.model == kEllipsoidMedium) && out.layout != Layout::file)
        in.fail("model", "\"" + out.model + "\" come from a file", "only with layout = \"file\"");
    if (from_file && out.file.empty())
        in.fail("layout",
                sequence ? "\"sequence\" without files"
                : volume ? "\"volume\" without a file"
                         : "\"file\" without a file",
                sequence ? "with the key file, like \"smoke-####.ply\", beside the scene"
                : volume ? "with the key file, a volume of the format NRRD beside the scene"
                         : "with the key file, a PLY beside the scene");
    if (sequence && !isPattern(name))
        in.fail("file", "\"" + name + "\" is no name of numbered files",
                "a run of 1 to 9 #, one for each digit, like \"smoke-####.ply\"");
    if (!from_file && in.has("file"))
        in.fail("file", "not used by this layout", "only with layout = \"file\", \"sequence\" or \"volume\"");
    for (const char* key : {"unit", "up", "far_points"})
        if (in.has(key) && (!from_file || (volume && key == std::string_view("far_points"))))
            in.fail(key, "not used by this layout", "only with layout = \"file\" or \"sequence\"");
    for (const char* key : {"rate", "loop"})
        if (!sequence && in.has(key)) in.fail(key, "not used by this layout", "only with layout = \"sequence\"");
    if (out.layout == Layout::none && in.has("count"))
        in.fail("count", "not used by this layout", "none: there are no particles");
    if (from_file && in.has("count"))
        in.fail("count", "not used by this layout", "none: the file says how many there are");
    if (!emitted && in.has("emitter")) in.fail("emitter", "not used by this layout", "only with layout = \"emitter\"");
    if (emitted && out.emitter.cooling != glm::vec3(0) && glm::any(glm::greaterThan(out.emitter.albedo, out.albedo)))
        in.fail("emitter", "its albedo is above the medium's", "at most medium.albedo, which its particles have later");
    if (emitted && static_cast<double>(out.emitter.rate) * out.emitter.life > out.count)
        in.fail(in.has("count") ? "count" : "layout", "the pool is smaller than emitter.rate * emitter.life",
                "count from " + std::to_string(static_cast<uint64_t>(out.emitter.rate * out.emitter.life) + 1) +
                    " to " + std::to_string(static_cast<uint64_t>(limits::kCount.hi)));
}

// Near the points of the medium's file.
glm::dvec3 originOf(const TableReader& in, const Medium& medium) {
    if (medium.layout != Layout::file && medium.layout != Layout::sequence)
        in.fail("origin", "\"auto\" is where the points of a file are",
                "only with layout = \"file\" or \"sequence\"; else [x, y, z]");
    const std::filesystem::path file = medium.layout == Layout::sequence ? firstWithPoints(medium.file) : medium.file;
    return originFor(extentOf(file, medium.up), double(medium.unit));
}

// Refuses what is drawn beside a sum of Gaussians only.
void refuseBesides(const TableReader& in, const Scene& scene) {
    if (isMixable(scene.medium)) return;
    const auto fail = [&](const char* key, const std::string& what) {
        in.fail(key, what + " drawn with medium.model = \"" + scene.medium.model + "\"",
                "only with medium.model = \"sum\"");
    };
    if (!scene.fogs.empty()) fail("fog", "is not");
    if (!scene.meshes.empty()) fail("mesh", "is not");
    if (std::ranges::any_of(scene.lights, isLocal)) fail("light", "points and spots are not");
}

// The sky's light goes through the fluxes of particles alone.
void refuseSkyLight(const Scene& scene) {
    if (!scene.sky.lights) return;
    const auto fail = [](const std::string& what) { throw SceneError("sky.lights: true " + what); };
    const Medium& medium = scene.medium;
    if (medium.model == kUnionMedium || medium.model == kVolumeMedium)
        fail("with medium.model = \"" + medium.model +
             "\", in which light scatters once; set sky.ambient in its place");
    if (medium.layout == Layout::none) fail("without particles that it could light; set sky.ambient in its place");
    if (scene.render.scattering != "propagation")
        fail("with render.scattering = \"" + scene.render.scattering +
             "\"; set it to \"propagation\", or sky.ambient in its place");
}

// The method's name is checked by the server, whose list of methods this library does not know.
void readRender(TableReader& in, const SettingReader& read, RenderSettings& out) {
    const SceneParts parts{.render = &out};
    read.readTable(in, "render", parts, nullptr);
    if ((out.shading & (out.shading - 1)) != 0)
        in.fail("shading", std::to_string(out.shading) + " is not allowed", "\"auto\", 1, 2, 4 or 8");
    std::string_view last;
    for (const SceneSetting& setting : sceneSettings()) { // tables of one method each: render.NAME
        const std::string_view table = setting.table();
        if (!table.starts_with("render.") || table == std::exchange(last, table)) continue;
        in.table(table.substr(table.find('.') + 1), [&](TableReader& r) {
            read.readTable(r, table, parts, nullptr);
            if (table == "render.isv") r.integer("steps", out.isv.steps, stepsAllowed(out.isv));
        });
    }
}

void readFog(TableReader& in, const SettingReader& read, Fog& out, const glm::dvec3& origin) {
    read.readTable(in, "fog", {.fog = &out}, &origin);
    if (!(out.lo < out.hi)) in.fail(in.has("hi") ? "hi" : "lo", "the fog ends below where it begins", "lo below hi");
}

// Checks that the light has no keys of other types.
void readLight(TableReader& in, const SettingReader& read, Light& out, const glm::dvec3& origin) {
    read.readTable(in, "light", {.light = &out}, &origin);
    const auto refuse = [&](std::initializer_list<const char*> keys, const char* allowed) {
        for (const char* key : keys)
            if (in.has(key)) in.fail(key, "not used by this type of light", allowed);
    };
    if (isLocal(out))
        refuse({"to_light", "irradiance", "rotate", "rotate_axis"}, "only with type = \"directional\"");
    else
        refuse({"position", "intensity", "range", "radius", "shadows", "orbit", "pivot"},
               "only with type = \"point\" or \"spot\"");
    if (out.type != kSpot) refuse({"axis", "inner", "outer"}, "only with type = \"spot\"");
    if (!(out.inner < out.outer))
        in.fail(in.has("outer") ? "outer" : "inner", "the outer cone is not outside the inner one",
                "inner below outer");
}

void readLights(TableReader& in, const SettingReader& read, std::vector<Light>& out, const glm::dvec3& origin) {
    in.tables("light", out, {0, limits::kLocalLights.hi + 1},
              [&](TableReader& r, Light& light) { readLight(r, read, light, origin); });
    const auto local = size_t(std::ranges::count_if(out, isLocal));
    if (out.size() - local > 1) in.fail("light", "more than one is directional", "one, the others points or spots");
    if (!limits::kLocalLights.holds(double(local)))
        in.fail("light", std::to_string(local) + " points and spots",
                "up to " + std::to_string(int(limits::kLocalLights.hi)));
}

void readScene(TableReader& in, Scene& out, const std::filesystem::path& folder) {
    const SettingReader read(folder);
    const glm::dvec3& origin = out.origin;
    const bool by_points = in.isAuto("origin");
    read.readTable(in, "", {.scene = &out}, nullptr);
    in.table("medium", [&](TableReader& r) { readMedium(r, read, out.medium, origin); });
    if (by_points) out.origin = originOf(in, out.medium);
    in.table("simulation",
             [&](TableReader& r) { read.readTable(r, "simulation", {.simulation = &out.simulation}, nullptr); });
    readLights(in, read, out.lights, origin);
    const auto shadowed = std::ranges::count_if(out.lights, [](const Light& l) { return isLocal(l) && l.shadows; });
    if (out.medium.layout != Layout::none && !limits::kShadowedLights.holds(double(shadowed)))
        in.fail("light", std::to_string(shadowed) + " points and spots with shadows among particles",
                "up to " + std::to_string(int(limits::kShadowedLights.hi)) + ", others with shadows = false");
    in.tables("fog", out.fogs, limits::kFogs, [&](TableReader& r, Fog& fog) { readFog(r, read, fog, origin); });
    in.tables("plane", out.planes, limits::kPlanes,
              [&](TableReader& r, Plane& plane) { read.readTable(r, "plane", {.plane = &plane}, &origin); });
    in.tables("box", out.boxes, limits::kObjects,
              [&](TableReader& r, Box& box) { read.readTable(r, "box", {.box = &box}, &origin); });
    in.tables("sphere", out.spheres, limits::kObjects,
              [&](TableReader& r, Sphere& sphere) { read.readTable(r, "sphere", {.sphere = &sphere}, &origin); });
    in.table("objects", [&](TableReader& r) { read.readTable(r, "objects", {.objects = &out.objects}, &origin); });
    const LaidOut laid_out = layOut(out.objects);
    out.laid_out_boxes = uint32_t(laid_out.boxes.size()), out.laid_out_spheres = uint32_t(laid_out.spheres.size());
    out.boxes.insert(out.boxes.end(), laid_out.boxes.begin(), laid_out.boxes.end());
    out.spheres.insert(out.spheres.end(), laid_out.spheres.begin(), laid_out.spheres.end());
    if (const size_t count = out.boxes.size() + out.spheres.size(); !limits::kObjects.holds(double(count)))
        in.fail(laid_out.boxes.empty() ? "box" : "objects", std::to_string(count) + " boxes and spheres",
                "up to " + std::to_string(int(limits::kObjects.hi)));
    in.tables("mesh", out.meshes, limits::kMeshes, [&](TableReader& r, Mesh& mesh) {
        read.readTable(r, "mesh", {.mesh = &mesh}, &origin);
        if (mesh.file.empty()) r.fail("file", "a mesh without a file", "a .glb or .gltf file beside the scene");
        std::error_code error;
        if (!std::filesystem::is_regular_file(mesh.file, error))
            r.fail("file", mesh.file.string() + " is no file", "a .glb or .gltf file beside the scene");
    });
    out.triangles = trianglesOf(out.meshes);
    in.tables("glass", out.glasses, limits::kGlasses,
              [&](TableReader& r, Glass& glass) { read.readTable(r, "glass", {.glass = &glass}, &origin); });
    refuseBesides(in, out);
    out.tetrahedra = tetrahedraOf(out.medium, origin);
    out.volume = volumeOf(out.medium, origin);
    in.table("sky", [&](TableReader& r) { read.readTable(r, "sky", {.sky = &out.sky}, nullptr); });
    bool camera_by_points = true;
    in.table("camera", [&](TableReader& r) { readCamera(r, read, out, camera_by_points); });
    out.camera_by_points = camera_by_points && !out.medium.file.empty();
    in.table("render", [&](TableReader& r) { readRender(r, read, out.render); });
    if (out.medium.model == kUnionMedium && out.render.scattering != "single")
        throw SceneError("render.scattering: \"" + out.render.scattering + "\"; a union medium needs \"single\"");
    refuseSkyLight(out);
    if (out.render.shadow_map == "fronts" && out.medium.model != kSumMedium)
        throw SceneError("render.shadow_map: \"fronts\"; medium.model = \"" + out.medium.model + "\" needs \"sums\"");
    if (out.render.sprites.maps == "files")
        for (const char* side : {"-positive.png", "-negative.png"})
            if (!std::filesystem::is_regular_file(out.medium.sprite_maps.string() + side))
                throw SceneError("render.sprites.maps: \"files\" without " + out.medium.sprite_maps.string() + side +
                                 "; medium.sprite_maps is the first part of two PNG names");
}

// A value that is not TOML is taken for text: render.method=isv.
toml::table parseOverride(const std::string& text) {
    const size_t equals = text.find('=');
    if (equals != std::string::npos && equals > 0) {
        for (const char* quote : {"", "\""}) {
            try {
                return parseToml(text.substr(0, equals) + '=' + quote + text.substr(equals + 1) + quote);
            } catch (const toml::parse_error&) {
            }
        }
    }
    throw SceneError(
        oneLine("--set " + text + ": not a setting; allowed: key=value as in a scene file, like medium.count=5000"));
}

void replace(toml::table& in, const toml::table& with) {
    for (const auto& [key, value] : with) {
        toml::node* old = in.get(key.str());
        const toml::table* inner = value.as_table();
        toml::array* list = old ? old->as_array() : nullptr;
        if (inner && old && old->is_table()) {
            replace(*old->as_table(), *inner);
        } else if (inner && list && list->is_homogeneous<toml::table>()) {
            for (toml::node& element : *list) replace(*element.as_table(), *inner);
        } else {
            value.visit([&, name = key.str()](const auto& v) { in.insert_or_assign(name, v); });
        }
    }
}

} // namespace

std::string sceneText(const std::filesystem::path& file) {
    std::ifstream in = openPlain(file);
    if (!in) throw SceneError(file.string() + ": cannot be read; give a scene's name or the path of a TOML file");
    std::string text(kMostTextBytes + 1, '\0');
    in.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<size_t>(in.gcount()));
    if (text.size() > kMostTextBytes)
        throw SceneError(file.string() + ": larger than 1 MiB; a scene is a short TOML file");
    return text;
}

Scene loadScene(const std::filesystem::path& file, std::span<const std::string> overrides) {
    return sceneOf(sceneText(file), file, overrides);
}

Scene sceneOf(const std::string& text, const std::filesystem::path& file, std::span<const std::string> overrides) {
    const std::string name = file.string();
    toml::table root;
    try {
        root = parseToml(text, name);
    } catch (const toml::parse_error& error) {
        throw SceneError(oneLine(name + ':' + std::to_string(error.source().begin.line) + ": " + syntaxProblem(error)));
    }
    for (const std::string& text_of_one : overrides) replace(root, parseOverride(text_of_one));
    Scene scene;
    scene.name = file.stem().string();
    scene.lights.resize(1);
    scene.lights[0].to_light = glm::normalize(scene.lights[0].to_light);
    TableReader reader(root, "", name);
    readScene(reader, scene, file.parent_path());
    reader.finish();
    return scene;
}

} // namespace brume
