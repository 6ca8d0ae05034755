#include "common/scene.h"

#include <algorithm>
#include <fstream>
#include <iterator>

#include "common/scene_reader.h"
#include "common/scene_text.h"
#include "common/text.h"

namespace brume {

namespace {

constexpr size_t kMostBytes = 1 << 20; // of a scene file
constexpr size_t kLongestName = 64, kLongestPath = 4096;

void readEmitter(TableReader& in, Emitter& out, glm::dvec3 origin) {
    in.place("position", out.position, origin);
    in.number("radius", out.radius, limits::kLength);
    in.number("rate", out.rate, limits::kRate);
    in.number("life", out.life, limits::kLife);
    in.vector("velocity", out.velocity, limits::kSpeed);
    in.number("spread", out.spread, {0, limits::kSpeed.hi});
    in.number("growth", out.growth, limits::kGrowth);
    in.number("buoyancy", out.buoyancy, limits::kAcceleration);
    in.vector("wind", out.wind, limits::kSpeed);
    in.number("turbulence", out.turbulence, limits::kTurbulence);
    in.number("eddy", out.eddy, limits::kLength);
}

void readMedium(TableReader& in, Medium& out, glm::dvec3 origin, const std::filesystem::path& folder) {
    in.choice<Layout>("layout", out.layout,
                      {{"cube", Layout::cube},
                       {"tubes", Layout::tubes},
                       {"cumulus", Layout::cumulus},
                       {"emitter", Layout::emitter},
                       {"file", Layout::file}});
    in.integer("count", out.count, limits::kCount);
    if (out.layout == Layout::file) // a displacement, not a place
        in.vector("centre", out.centre, limits::kPlace);
    else
        in.place("centre", out.centre, origin);
    in.number("extent", out.extent, limits::kLength);
    in.range("scale", out.scale, limits::kScale);
    in.number("falloff", out.falloff, limits::kFalloff);
    in.number("extinction", out.extinction, limits::kExtinction);
    in.range("multiplier", out.multiplier, limits::kMultiplier);
    in.vector("albedo", out.albedo, limits::kColour);
    in.number("anisotropy", out.anisotropy, limits::kAnisotropy);
    in.number("asymmetry", out.asymmetry, limits::kAsymmetry);
    in.integer("seed", out.seed, limits::kSeed);
    std::string file;
    in.text("file", file, kLongestPath);
    in.table("emitter", [&](TableReader& r) { readEmitter(r, out.emitter, origin); });

    const bool from_file = out.layout == Layout::file, emitted = out.layout == Layout::emitter;
    if (from_file && file.empty()) in.fail("layout", "\"file\" without a file", "with the key file, a PLY beside the scene");
    if (!from_file && in.has("file")) in.fail("file", "not used by this layout", "only with layout = \"file\"");
    if (from_file && in.has("count")) in.fail("count", "not used by this layout", "none: the file says how many points it has");
    if (!emitted && in.has("emitter")) in.fail("emitter", "not used by this layout", "only with layout = \"emitter\"");
    if (emitted && static_cast<double>(out.emitter.rate) * out.emitter.life > out.count)
        in.fail(in.has("count") ? "count" : "layout", "the pool is smaller than emitter.rate * emitter.life",
                "count from " + std::to_string(static_cast<uint64_t>(out.emitter.rate * out.emitter.life) + 1) + " to " +
                    std::to_string(static_cast<uint64_t>(limits::kCount.hi)));
    if (from_file) out.file = folder / file;
}

void readSimulation(TableReader& in, SimulationSettings& out) {
    in.number("spring", out.spring, limits::kSpring);
    in.number("viscosity", out.viscosity, limits::kViscosity);
    in.number("impulse_radius", out.impulse_radius, limits::kLength);
    in.number("impulse_strength", out.impulse_strength, limits::kImpulseStrength);
    in.vector("volume_velocity", out.volume_velocity, limits::kSpeed);
    in.number("volume_swing", out.volume_swing, {0, limits::kLength.hi});
    in.number("volume_period", out.volume_period, limits::kPeriod);
    in.boolean("paused", out.paused);
}

void readLight(TableReader& in, Light& out) {
    std::string type;
    in.choice<std::string>("type", type, {{"directional", "directional"}});
    in.vector("to_light", out.to_light, limits::kPlace);
    in.vector("irradiance", out.irradiance, limits::kRadiance);
    in.number("rotate", out.rotate, limits::kRotate);
    const float length = glm::length(out.to_light);
    if (!(length > 1e-6f)) in.fail("to_light", "has no direction", "any vector longer than 1e-6");
    out.to_light /= length;
}

void readPlane(TableReader& in, Plane& out, glm::dvec3 origin) {
    in.height("height", out.height, origin);
    in.vector("albedo", out.albedo, limits::kColour);
}

void readBox(TableReader& in, Box& out, glm::dvec3 origin) {
    in.place("centre", out.centre, origin);
    in.vector("size", out.size, limits::kLength);
    in.number("yaw", out.yaw, limits::kAngle);
    in.vector("albedo", out.albedo, limits::kColour);
}

void readSphere(TableReader& in, Sphere& out, glm::dvec3 origin) {
    in.place("centre", out.centre, origin);
    in.number("radius", out.radius, limits::kLength);
    in.vector("albedo", out.albedo, limits::kColour);
}

void readSky(TableReader& in, Sky& out) {
    in.vector("zenith", out.zenith, limits::kRadiance);
    in.vector("horizon", out.horizon, limits::kRadiance);
    in.vector("ambient", out.ambient, limits::kRadiance);
}

void readCamera(TableReader& in, SceneCamera& out, glm::dvec3 origin) {
    in.place("position", out.position, origin);
    in.place("target", out.target, origin);
    in.number("fov_y", out.fov_y, limits::kFovY);
    if (!(glm::distance(out.position, out.target) > 1e-3f))
        in.fail("target", "is where the camera stands", "any place further than 1 mm from camera.position");
}

// The method's name is checked by the server, whose list of methods this library does not know.
void readRender(TableReader& in, RenderSettings& out) {
    in.text("method", out.method, kLongestName);
    in.number("error", out.error, limits::kError);
    in.number("flip", out.flip, limits::kFlip);
    in.choice<std::string>("quadrature", out.quadrature,
                           {{"simpson", "simpson"},
                            {"transmittance", "transmittance"},
                            {"analytic", "analytic"},
                            {"cached", "cached"},
                            {"hermite", "hermite"}});
    in.integer("steps", out.steps, out.quadrature == "transmittance" ? limits::kTransmittanceSteps : limits::kSteps);
    in.integer("rate", out.rate, limits::kRayRate);
    in.integer("slabs", out.slabs, limits::kSlabs);
    in.integer("shading", out.shading, limits::kShading);
    if ((out.shading & (out.shading - 1)) != 0)
        in.fail("shading", std::to_string(out.shading) + " is not allowed", "0, 1, 2, 4 or 8");
    in.number("grid", out.grid, limits::kGridSpacing);
    in.number("merge", out.merge, limits::kMerge);
    in.boolean("shared_order", out.shared_order);
    in.number("exposure", out.exposure, limits::kExposure);
    in.choice<std::string>("tone_map", out.tone_map, {{"filmic", "filmic"}, {"linear", "linear"}});
    in.integerOrZero("shadow_size", out.shadow_size, limits::kShadowSize);
    in.integerOrZero("shadow_slices", out.shadow_slices, limits::kShadowSlices);
    in.number("shadow_error", out.shadow_error, limits::kShadowError);
    in.integer("opaque_shadow_size", out.opaque_shadow_size, limits::kOpaqueShadowSize);
    in.number("cutoff", out.cutoff, limits::kCutoff);
    in.number("light_tolerance", out.light_tolerance, limits::kLightTolerance);
    in.number("least_transmittance", out.least_transmittance, limits::kLeastTransmittance);
}

void readScene(TableReader& in, Scene& out, const std::filesystem::path& folder) {
    const Limits objects{0, 64}; // of a kind: the opaque pass draws each of them
    in.text("name", out.name, kLongestName);
    in.vector("origin", out.origin, limits::kOrigin);
    in.table("medium", [&](TableReader& r) { readMedium(r, out.medium, out.origin, folder); });
    in.table("simulation", [&](TableReader& r) { readSimulation(r, out.simulation); });
    in.tables("light", out.lights, {1, 1}, readLight);
    in.tables("plane", out.planes, objects, [&](TableReader& r, Plane& plane) { readPlane(r, plane, out.origin); });
    in.tables("box", out.boxes, objects, [&](TableReader& r, Box& box) { readBox(r, box, out.origin); });
    in.tables("sphere", out.spheres, objects, [&](TableReader& r, Sphere& sphere) { readSphere(r, sphere, out.origin); });
    in.table("sky", [&](TableReader& r) { readSky(r, out.sky); });
    in.table("camera", [&](TableReader& r) { readCamera(r, out.camera, out.origin); });
    in.table("render", [&](TableReader& r) { readRender(r, out.render); });
}

// A value that is not TOML is taken for text: render.method=isv.
toml::table parseOverride(const std::string& text) {
    const size_t equals = text.find('=');
    if (equals != std::string::npos && equals > 0) {
        for (const char* quote : {"", "\""}) {
            try {
                return toml::parse(text.substr(0, equals) + '=' + quote + text.substr(equals + 1) + quote);
            } catch (const toml::parse_error&) {
            }
        }
    }
    throw SceneError(oneLine("--set " + text + ": not a setting; allowed: key=value as in a scene file, like medium.count=5000"));
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
    std::ifstream in(file, std::ios::binary);
    if (!std::filesystem::is_regular_file(file) || !in)
        throw SceneError(file.string() + ": cannot be read; give a scene's name or the path of a TOML file");
    std::string text(kMostBytes + 1, '\0');
    in.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<size_t>(in.gcount()));
    if (text.size() > kMostBytes) throw SceneError(file.string() + ": larger than 1 MiB; a scene is a short TOML file");
    return text;
}

Scene loadScene(const std::filesystem::path& file, std::span<const std::string> overrides) {
    return sceneOf(sceneText(file), file, overrides);
}

Scene sceneOf(const std::string& text, const std::filesystem::path& file, std::span<const std::string> overrides) {
    const std::string name = file.string();
    toml::table root;
    try {
        root = toml::parse(text, name);
    } catch (const toml::parse_error& error) {
        throw SceneError(oneLine(name + ':' + std::to_string(error.source().begin.line) +
                                 ": syntax: " + std::string(error.description()) + "; allowed: TOML 1.0"));
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

std::filesystem::path findScene(const std::string& name_or_path, const std::filesystem::path& scene_dir) {
    if (name_or_path.find('/') != std::string::npos || name_or_path.ends_with(".toml")) return name_or_path;
    std::filesystem::path found = scene_dir / (name_or_path + ".toml");
    std::error_code ignored; // a folder that cannot be read offers no scenes
    if (std::filesystem::is_regular_file(found, ignored)) return found;
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(scene_dir, ignored))
        if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
    std::sort(names.begin(), names.end());
    std::string list;
    for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
    throw SceneError("no scene \"" + name_or_path + "\" in " + scene_dir.string() +
                     "; there are: " + (list.empty() ? "none" : list) + "; or give the path of a .toml file");
}

} // namespace brume
