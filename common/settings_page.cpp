#include "common/settings_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/settings.h"

namespace brume {
namespace {

constexpr std::string_view kIntroduction = R"(# Scenes

A scene is a TOML file. The server opens one by name (`--scene plume`, from `server/scenes/`) or by path
(`--scene ./mine.toml`). Every key may be left out. An unknown key, a wrong type or a value out of range ends the
start in one line with file, line, key and what is allowed. Those that are shipped have pictures:
[`gallery.md`](gallery.md).

`--set KEY=VALUE` replaces one setting: `--set medium.count=5000 --set render.method=isv`. Of a list of tables it
replaces the setting in every element: `--set 'light.irradiance=[1, 1, 1]'`.

Units are metres, seconds and radians; colours are linear Rec. 709. Places are world coordinates within 50 km of
`origin`. *Live* says which role may change a setting while the server runs; others change with a restart.

Commands name a fog, a point or a spot, a plane, box or sphere by its number in its list as it is now:
`fog[0].extinction`, `light[2].position`, `box[4].centre`. They may add and remove them, too. The directional light does
not count and has no number: `light.to_light`. The objects of `[objects]` have none either: they stay as they are. A
list that has changed is restored by Restart and saved by `/scene.toml`.

This page is printed by `brume-server --print-settings`; a test compares the two.

## Point clouds

With `medium.layout = "file"` the particles are the points of a PLY file. It is ASCII, one row a line, or binary
little-endian. Of its element `vertex`, up to 1000000 rows, these properties are read:

| property | values | unit | what |
|---|---|---|---|
| `x`, `y`, `z` | within 50 km of `origin` | m | Place; `medium.centre` moves all points |
| `scale` | 0.001 to 1000 | m | As `medium.scale`; the standard deviation is 0.1 · scale · falloff |
| `radius` | 0.001 to 1000 | m | Without `scale`: the standard deviation is radius / √5 |
| `sigma_t` | 0 to 10000 | 1/m | Extinction at the particle's centre, instead of extinction · multiplier · 1e-4 |
| `opacity` | float 0 to 1, uchar 0 to 255 |  | Without `sigma_t`: the optical depth through the centre is -ln(1 - opacity) |
| `red`, `green`, `blue`, or `diffuse_red` ... | float 0 to 1, uchar 0 to 255 |  | Albedo, instead of `medium.albedo`; linear: no sRGB curve is applied |

The particle spreads as far as a ball of that `radius`: along an axis, the mean square distance from the ball's centre
is radius² / 5. `opacity` is the part of the light that a ray through the particle's centre loses. An opacity of 1
would need an infinite extinction and counts as 511/512, within half a level of a picture of 8 bits. Files of Gaussian
splatting hold logarithms and logits instead (`scale_0`, `opacity`): convert them first.

Points without a size take `medium.scale`. If the scene does not give it, the spacing of the points decides: the
standard deviation is half the median distance to the 8th neighbour. A point with a number out of range is left out.

Points without `sigma_t` or `opacity` take extinction · multiplier · 1e-4. If the scene does not give the extinction
either, it is chosen for a mean optical depth of 3. A scene that gives no `[camera]` has one that sees all points.

`medium.extinction` and `medium.albedo` are factors of values that came with the points, relative to the scene's start.
Twice the extinction that the scene gives is twice every point's. Relative to a start of 0 nothing changes. Albedos end
at 1, extinctions at 10000 per metre.

At its start, and for `--explain`, the server says in one line what it found: box, sizes, extinctions, colours, and the
properties that it ignored. It warns if the scene's camera sees no point, and says where to put it.

A whole scene with such a file beside it:

```toml
name = "mine"

[medium]
layout = "file"
file = "mine.ply"
scale = 1.5        # m, of points without a size
extinction = 1
multiplier = 1     # extinction · multiplier: 1/m, of points without sigma_t

[[light]]
to_light = [0.8, 0.55, 0.15]
irradiance = [16, 15, 14]

[camera]
position = [0, 6, 26]
target = [0, 0, 0]
```

Files in centimetres: divide places and sizes by 100 first, and multiply `sigma_t` by 100.

## Tetrahedra

With `medium.model = "tetrahedra"` the points of the file are the corners of a mesh of tetrahedra, and the extinction
is linear within each. `medium.layout` is `file`. Beside `vertex` the file has an element `tetrahedron`, up to 2000000
rows. Its list `vertex_indices` or `vertex_index` has four numbers of points, counted from 0, in any order:

```
ply
format ascii 1.0
element vertex 5
property float x
property float y
property float z
property float sigma_t
element tetrahedron 2
property list uchar int vertex_indices
end_header
0 0 0 0
1 0 0 2
0 1 0 0
0 0 1 0.5
1 1 1 0
4 0 1 2 3
4 1 2 3 4
```

Every point has a `sigma_t`, and may have a colour; both are linear in between. Sizes are not read. Where `sigma_t` is 0
at the corners of the outside, the medium ends softly. A point with a number out of range is an error here. Points that
no tetrahedron has are left out, and the server says how many.

Tetrahedra side by side have three points in common. Copies of points do, too, but then every ray looks for each
tetrahedron anew. A face has one or two tetrahedra, which lie on different sides of it. Up to 500000 faces are outside.
A tetrahedron may be flat. Tetrahedra that overlap otherwise are not found, and are drawn wrongly.

A push moves corners, and springs draw them back: the mesh deforms, and the extinction at its corners stays. So a
tetrahedron that is pressed together holds less of the medium. `medium.centre`, `simulation.volume_velocity` and so on
move all corners.

Method `tetrahedra` draws the medium, with one directional light, objects and glass. Fogs, points and spots, and meshes
are refused.

`brume-bench tetrahedra --scene cloud --cells 16 --out cloud.ply` makes such a file of the particles of a scene. The
corners are those of a body-centred cubic lattice. Each has the extinction that all particles have there together.

## A sequence of point clouds

With `medium.layout = "sequence"` the files of a simulation are played. `medium.file` names them, with a # for each
digit of their number: `smoke-####.ply` is `smoke-0000.ply`, `smoke-0001.ply` and so on, up to 10000 files. All are read
and checked at the start, as above; `--memory` bounds their points. The number is the time: in a second `medium.rate`
numbers pass, from the lowest one on. Where a number has no file, the file before lasts longer, and the server says so.
After the last file comes the first, or with `medium.loop = false` it stays.

Where the points of every file have a property `id` of a whole-number type, a point that is in two files one after the
other moves evenly from its place in the one to that in the next. So do its size, extinction and albedo. Points that
are in one of them only come and go with their file. Without ids each file is shown until the next. All files have the
same properties, apart from `id`. Points without sizes have one that follows from the spacing in the first file.

Pause stops the sequence, Restart begins at the first file. `medium.centre`, `simulation.volume_velocity` and so on
move all points. Pushes do not, and are refused.

## Particles of a simulation elsewhere

With `medium.layout = "live"` the scene begins empty. An operator's messages (`SetParticles`,
[`protocol/README.md`](../protocol/README.md)) say where up to `medium.count` particles are, how large and how thick,
and all viewers see them. `medium.centre`, `simulation.volume_velocity` and so on move all of them. Pushes do not, and
are refused. `medium.extinction` and `medium.albedo` are factors, as for point clouds. While the scene is paused,
particles move no further; messages are still taken. Restart empties the scene, and the sender has to send again.

## Fog

`[[fog]]` is a medium without particles, up to four of them. Its extinction is extinction · e^(−falloff · (y − height))
between the heights `lo` and `hi`, and within a ball if it has a `radius`. With `medium.layout = "none"` there is
nothing but fog. It is lit by the sun past itself, the particles and the objects; it hides and shadows what is behind
it. Methods `slabs`, `grid`, `froxels`, `lit`, `gradients` and `march` draw it. `auto` chooses between the first two.

```toml
[[fog]]            # a ground fog that thins out over some 5 m
extinction = 0.05  # 1/m, at height 0
falloff = 0.2      # 1/m
phase = "droplets"

[[fog]]            # smoke in a ball
extinction = 0.8
centre = [0, 3, 0]
radius = 2
albedo = [0.6, 0.6, 0.6]
```

## Points and spots

A `[[light]]` of type `point` or `spot` stands in the scene. It sends intensity / (d² + radius²) to a place d metres
away. A `range` ends it, and saves the time of all pixels that it does not reach. A file that mentions lights, but none
that is directional, has no sun. `slabs`, `grid`, `froxels`, `lit`, `gradients` and `march` draw them.

```toml
[[light]]
type = "spot"
position = [0, 8, 0]
axis = [0.2, -1, 0]
intensity = [700, 500, 300]  # W/sr
inner = 0.2                  # rad
outer = 0.3
range = 20                   # m
```

## Meshes

A `[[mesh]]` is an opaque object made of the triangles of a glTF 2.0 file, `.glb` or `.gltf`. Its buffers lie in the
file or beside it. All nodes of the file's scene are placed with their transforms. Triangles are seen and lit from both
sides, with the base colour factor of their material as albedo.

Textures are ignored, which the server says in a line. Skins, sparse accessors and required extensions, such as
compression, are refused. Animations are ignored: meshes stand still. Particles pass through them. Methods `slabs` and
`grid` draw them.

```toml
[[mesh]]
file = "room.glb"
position = [0, 0, -4]  # of the file's origin
scale = 0.01           # a file in centimetres
yaw = 1.57
```
)";

struct Table {
    std::string_view name, heading, about;
};
constexpr Table kTables[]{
    {"", "At the top", "Before any table."},
    {"medium", "`[medium]`", "The particles and what they are made of."},
    {"medium.emitter", "`[medium.emitter]`",
     "With layout `emitter` only. Births fall on a horizontal disc. Particles rise, grow, thin and die.\n"
     "`medium.count` must hold all that live at a time: at least rate · life."},
    {"fog", "`[[fog]]`",
     "A medium without particles; up to 4. It fills everything, or what lies between two heights, or a ball. Methods\n"
     "`slabs`, `grid`, `froxels`, `lit`, `gradients` and `march` draw it."},
    {"simulation", "`[simulation]`", "How the particles move."},
    {"light", "`[[light]]`",
     "One that is directional at most, and up to 1,024 points and spots. A file that does not mention lights has a\n"
     "directional one; `light = []` is a scene without. In commands points and spots have numbers, from\n"
     "`light[0]`; `to_light`, `irradiance` and `rotate` are of the directional one, which has none."},
    {"plane", "`[[plane]]`",
     "Horizontal ground, seen from above; up to 64. The albedo can have a structure, as soil and grass have: twenty\n"
     "waves, the longest as long as `structure_size`, the shortest 1/46 of that. Each pixel sees the mean over its\n"
     "footprint. The structure repeats after 64 times `structure_size`."},
    {"box", "`[[box]]`", "Boxes and spheres together: up to 4,096."},
    {"sphere", "`[[sphere]]`", "Boxes and spheres together: up to 4,096."},
    {"mesh", "`[[mesh]]`", "Triangles of a glTF file, see above; up to 64 files with 65,536 triangles together."},
    {"glass", "`[[glass]]`",
     "A thin flat sheet that is seen through, in front of and behind the medium; up to 16. It throws no shadow."},
    {"objects", "`[objects]`",
     "A place of many boxes and spheres, by a seed: `courtyard` (69 × 27 m), `street` (174 m long), `islands` that\n"
     "float (95 m wide), or `atrium` (37 × 23 m, 20 m high). Those of the file are there, too; ground is not."},
    {"sky", "`[sky]`", "What is behind everything."},
    {"camera", "`[camera]`", "Where viewers start; position and target differ by more than 1 mm."},
    {"render", "`[render]`", "How the scene is drawn."},
    {"render.isv", "`[render.isv]`", "Of method `isv` alone."},
    {"render.tetrahedra", "`[render.tetrahedra]`", "Of method `tetrahedra` alone."},
    {"render.tiles", "`[render.tiles]`", "Of method `tiles` alone."},
    {"render.grid", "`[render.grid]`", "Of method `grid` alone."},
    {"render.froxels", "`[render.froxels]`", "Of methods `froxels`, `lit` and `gradients`."},
    {"render.shadow_grid", "`[render.shadow_grid]`", "Of method `froxels`, with `shadows` of `grid` or `hybrid`."},
    {"render.radiance", "`[render.radiance]`", "Of method `gradients`; `spacing` is also of `lit`."},
    {"render.path", "`[render.path]`",
     "Light behind the union of balls: of method `sprites`, of `tiles` with `light` of `path`, and of surfaces."},
    {"render.sprites", "`[render.sprites]`", "Of method `sprites` alone."},
    {"render.march", "`[render.march]`", "Of method `march` alone."},
    {"render.propagation", "`[render.propagation]`", "With `scattering` of `propagation`."},
};

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

std::string settingsPage() {
    Scene scene;
    Light light;
    Plane plane;
    Box box;
    Sphere sphere;
    Mesh mesh;
    Glass glass;
    ObjectLayout objects;
    Fog fog;
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
                              .render = &scene.render};
    std::string page(kIntroduction);
    for (const Table& table : kTables) {
        page +=
            fmt::format("\n## {}\n\n{}\n\n| key | values | unit | default | live | what |\n|---|---|---|---|---|---|\n",
                        table.heading, table.about);
        for (const SceneSetting& setting : sceneSettings()) {
            if (setting.table() != table.name) continue;
            Cells cells{setting};
            std::visit(cells, setting.member(defaults));
            page += fmt::format("| `{}` | {} | {} | {} | {} | {} |\n", setting.key(), cells.values, setting.unit,
                                cells.standard, roleOf(setting.changed_by), setting.help);
        }
    }
    return page;
}

} // namespace brume
