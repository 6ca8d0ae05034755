#include "common/settings.h"

#include <algorithm>
#include <array>

#include "common/method_settings.h"
#include "common/phase_lobes.h"
#include "common/setting_rows.h"

namespace brume {
namespace {

using namespace setting_rows;

constexpr std::string_view kLayouts[]{"cube",     "tubes",  "cumulus", "emitter", "file",
                                      "sequence", "volume", "live",    "none"}; // in the order of Layout
constexpr std::string_view kModels[]{kSumMedium, kEllipsoidMedium, kUnionMedium, kTetrahedraMedium, kVolumeMedium};
constexpr std::string_view kPhases[]{kMixturePhase, kDoublePhase, kRayleighPhase, kDropletPhase};
constexpr std::string_view kUps[]{"y", "z", "x", "-y"}, kFarPoints[]{"keep", "drop"};
constexpr std::string_view kLights[]{kDirectional, kPoint, kSpot};
constexpr std::string_view kPlacesOfObjects[]{kNoObjects, kCourtyard, kStreet, kIslands, kAtrium};
constexpr std::string_view kToneMaps[]{"filmic", "linear"};
constexpr std::string_view kShadowMaps[]{"sums", "fronts"};
constexpr std::string_view kScatterings[]{"single", "octaves", "propagation"};

constexpr SceneSetting kBeforeMethods[]{
    {"name", at<&P::scene, &Scene::name>, "", kNames, "The scene's name; without it the file's"},
    {"origin", at<&P::scene, &Scene::origin>, "m", limits::kOrigin,
     "World coordinates of the point that the server counts places from; give it where the scene is far from zero"},

    listed({"light.type", at<&P::light, &Light::type>, "", kNone, "Kind of light", kNobody, Form::plain, kLights}),
    {"light.to_light", at<&P::light, &Light::to_light>, "", limits::kPlace,
     "Direction to the light, of any length but zero", kControllers, Form::direction},
    usually({0, 40}, {"light.irradiance", at<&P::light, &Light::irradiance>, "W/m²", limits::kRadiance,
                      "Irradiance of each channel on a surface that faces the light", kControllers, Form::colour}),
    usually({-2, 2}, {"light.rotate", at<&P::light, &Light::rotate>, "rad/s", limits::kRotate,
                      "Turning of the light about `rotate_axis`", kControllers}),
    {"light.rotate_axis", at<&P::light, &Light::rotate_axis>, "", limits::kPlace,
     "What the light turns about, of any length but zero; a turn from +x to +y is positive about +z", kNobody,
     Form::direction},
    listed(usually({-30, 30}, {"light.position", at<&P::light, &Light::position>, "m", limits::kPlace,
                               "Point and spot: where it is", kNobody, Form::place})),
    listed(usually({0, 1000}, {"light.intensity", at<&P::light, &Light::intensity>, "W/sr", limits::kIntensity,
                               "Point and spot: radiant intensity of each channel; of a spot within its inner cone",
                               kNobody, Form::colour})),
    listed(usually({0, 100}, {"light.range", at<&P::light, &Light::range>, "m", limits::kLightRange,
                              "Point and spot: where its light ends, by the factor (1 − (d / range)⁴)²; 0: nowhere"})),
    listed(usually({0, 5}, {"light.radius", at<&P::light, &Light::radius>, "m", limits::kLightRadius,
                            "Point and spot: its light falls as 1 / (d² + radius²)"})),
    listed({"light.shadows", at<&P::light, &Light::shadows>, "", kNone,
            "Point and spot. True: objects and particles shadow its light; fog always dims it"}),
    listed(usually({-2, 2}, {"light.orbit", at<&P::light, &Light::orbit>, "rad/s", limits::kRotate,
                             "Point and spot: how fast it goes round the vertical through `pivot`"})),
    listed(usually({-30, 30}, {"light.pivot", at<&P::light, &Light::pivot>, "m", limits::kPlace, "What it goes round",
                               kNobody, Form::place})),
    listed({"light.axis", at<&P::light, &Light::axis>, "", limits::kPlace,
            "Spot: the way that its light goes, of any length but zero", kNobody, Form::direction}),
    listed({"light.inner", at<&P::light, &Light::inner>, "rad", limits::kCone,
            "Spot: angle between the axis and the cone that has all of the intensity"}),
    listed({"light.outer", at<&P::light, &Light::outer>, "rad", limits::kCone,
            "Spot: angle between the axis and the cone outside which there is no light"}),

    {"medium.layout", at<&P::medium, &Medium::layout>, "", kNone, "How the particles are laid out", kNobody,
     Form::plain, kLayouts},
    {"medium.model", at<&P::medium, &Medium::model>, "", kNone,
     "What particles are: Gaussians whose extinctions add up (`sum`), such Gaussians with three axes, which come with "
     "the file's points (`ellipsoids`), balls, with the same extinction wherever at least one of them is (`union`), "
     "or corners of the file's `tetrahedra`, with linear extinction within each. Layout `volume` has no particles: its "
     "model is `volume`",
     kNobody, Form::plain, kModels},
    usually({0.02, 0.5}, {"medium.union_radius", at<&P::medium, &Medium::union_radius>, "", limits::kUnionRadius,
                          "Radius of a ball in relation to its particle's scale", kControllers}),
    usually({0, 4}, {"medium.union_extinction", at<&P::medium, &Medium::union_extinction>, "1/m", limits::kSigmaT,
                     "Extinction wherever a ball is", kControllers}),
    {"medium.count", at<&P::medium, &Medium::count>, "", limits::kCount,
     "Number of particles; of an emitter and with layout `live` the most at a time; not allowed with layouts "
     "`file`, `sequence` and `none`"},
    {"medium.centre", at<&P::medium, &Medium::centre>, "m", limits::kPlace,
     "Centre of the layout; with layouts `file`, `sequence` and `live` what its points are moved by", kNobody,
     Form::place},
    {"medium.extent", at<&P::medium, &Medium::extent>, "m", limits::kLength,
     "Side of the cube, length of a tube, width of the cumulus"},
    {"medium.scale", at<&P::medium, &Medium::scale>, "m", limits::kScale,
     "Size of the particles, from the centre to a vertex of the tetrahedron; a range is uniform, or by the layout. "
     "Left out with layouts `file` and `sequence`: of points without sizes, from their spacing"},
    usually({0, 100}, {"medium.extinction", at<&P::medium, &Medium::extinction>, "", limits::kExtinction,
                       "Extinction at a particle's centre is extinction · multiplier · 1e-4 per metre; "
                       "a factor where points have their own",
                       kControllers}),
    {"medium.falloff", at<&P::medium, &Medium::falloff>, "", limits::kFalloff,
     "How softly a particle fades: its extinction is peak exp(-50 r² / u²) with u = scale · falloff", kControllers},
    {"medium.multiplier", at<&P::medium, &Medium::multiplier>, "", limits::kMultiplier,
     "Factor of each particle, uniform in this range"},
    {"medium.albedo", at<&P::medium, &Medium::albedo>, "", limits::kColour,
     "Single-scattering albedo; a factor where points have their own", kControllers, Form::colour},
    usually({0, 10}, {"medium.emission", at<&P::medium, &Medium::emission>, "W/(m² sr)", limits::kRadiance,
                      "Radiance of glowing soot. The medium emits (1 − albedo) times this; an emitter's particles "
                      "emit (1 − albedo / medium.albedo) times this, so that they cool by `medium.emitter.cooling`",
                      kControllers, Form::colour}),
    {"medium.extinction_colour", at<&P::medium, &Medium::extinction_colour>, "", limits::kColour,
     "Extinction of red, green and blue in relation to each other; the largest of them is the medium's; black is as "
     "white",
     kControllers, Form::colour},
    {"medium.phase", at<&P::medium, &Medium::phase>, "", kNone,
     "Phase function: `mixture` (1 − a) / 4π + a HG(g), `double` (1 − a) HG(h) + a HG(g), `rayleigh`, or `droplets` of "
     "water",
     kControllers, Form::plain, kPhases},
    {"medium.anisotropy", at<&P::medium, &Medium::anisotropy>, "", limits::kAnisotropy,
     "Part a of the scattered light that prefers a direction, with phases `mixture` and `double`", kControllers},
    {"medium.asymmetry", at<&P::medium, &Medium::asymmetry>, "", limits::kAsymmetry,
     "g of its Henyey-Greenstein function: backward (below 0) or forward scattering", kControllers},
    {"medium.second_asymmetry", at<&P::medium, &Medium::second_asymmetry>, "", limits::kAsymmetry,
     "h of the other part's, with phase `double`", kControllers},
    {"medium.droplet", at<&P::medium, &Medium::droplet>, "µm", limits::kDroplet,
     "Diameter of the droplets, with phase `droplets`: a bright rim toward the sun, a fog bow away from it",
     kControllers},
    {"medium.seed", at<&P::medium, &Medium::seed>, "", limits::kSeed, "Seed of all random numbers of the scene"},
    {"medium.file", at<&P::medium, &Medium::file>, "", kPaths,
     "PLY file beside the scene, with layout `file`; with `sequence` files, a # for each digit: `smoke-####.ply`"},
    {"medium.unit", at<&P::medium, &Medium::unit>, "m", limits::kUnit,
     "Length of the file's unit, or its name: `m`, `cm`, `mm`, `um`, `km`, `in` or `ft`; extinctions are per unit",
     kNobody, Form::unit},
    {"medium.up", at<&P::medium, &Medium::up>, "", kNone, "Axis of the file that points up", kNobody, Form::plain,
     kUps},
    {"medium.far_points", at<&P::medium, &Medium::far_points>, "", kNone,
     "Points of the file that are 20 times as far from the middle as 98 % of them: `keep` or `drop`", kNobody,
     Form::plain, kFarPoints},
    {"medium.sprite_maps", at<&P::medium, &Medium::sprite_maps>, "", kPaths,
     "For `render.sprites.maps = \"files\"`: the first part of two PNG names beside the scene, for `NAME-positive.png` "
     "and `NAME-negative.png`"},
    {"medium.rate", at<&P::medium, &Medium::rate>, "1/s", limits::kFileRate,
     "Layout `sequence`: how many numbers of files pass in a second"},
    {"medium.loop", at<&P::medium, &Medium::loop>, "", kNone,
     "Layout `sequence`. True: after the last file comes the first again; false: the last one stays"},

    {"medium.emitter.position", at<&P::medium, &Medium::emitter, &Emitter::position>, "m", limits::kPlace,
     "Middle of the disc that particles are born on", kNobody, Form::place},
    {"medium.emitter.radius", at<&P::medium, &Medium::emitter, &Emitter::radius>, "m", limits::kLength,
     "Radius of that disc"},
    {"medium.emitter.rate", at<&P::medium, &Medium::emitter, &Emitter::rate>, "1/s", limits::kRate,
     "Births per second"},
    {"medium.emitter.life", at<&P::medium, &Medium::emitter, &Emitter::life>, "s", limits::kLife, "Life of a particle"},
    {"medium.emitter.velocity", at<&P::medium, &Medium::emitter, &Emitter::velocity>, "m/s", limits::kSpeed,
     "Velocity at birth"},
    {"medium.emitter.spread",
     at<&P::medium, &Medium::emitter, &Emitter::spread>,
     "m/s",
     {0, limits::kSpeed.hi},
     "Random part of the velocity at birth"},
    {"medium.emitter.growth", at<&P::medium, &Medium::emitter, &Emitter::growth>, "m/s", limits::kGrowth,
     "How fast the scale grows; the optical mass of a particle is conserved"},
    {"medium.emitter.buoyancy", at<&P::medium, &Medium::emitter, &Emitter::buoyancy>, "m/s²", limits::kAcceleration,
     "Upward acceleration, fading over the life"},
    {"medium.emitter.wind", at<&P::medium, &Medium::emitter, &Emitter::wind>, "m/s", limits::kSpeed,
     "Velocity that particles relax to"},
    {"medium.emitter.turbulence", at<&P::medium, &Medium::emitter, &Emitter::turbulence>, "m/s", limits::kTurbulence,
     "RMS of the divergence-free noise velocity"},
    {"medium.emitter.eddy", at<&P::medium, &Medium::emitter, &Emitter::eddy>, "m", limits::kLength,
     "Size of the largest eddies"},
    {"medium.emitter.albedo", at<&P::medium, &Medium::emitter, &Emitter::albedo>, "", limits::kColour,
     "Albedo at birth, at most the medium's; with `cooling`", kNobody, Form::colour},
    {"medium.emitter.cooling", at<&P::medium, &Medium::emitter, &Emitter::cooling>, "s", limits::kCooling,
     "Time of red, green and blue in which the albedo's difference from the medium's falls to 1 / e; 0: it has none"},

    listed(usually({0, 1}, {"fog.extinction", at<&P::fog, &Fog::extinction>, "1/m", limits::kSigmaT,
                            "Extinction at `height`; 0: no fog"})),
    listed(usually({-30, 30}, {"fog.height", at<&P::fog, &Fog::height>, "m", limits::kPlace,
                               "Height at which it has that extinction", kNobody, Form::height})),
    listed(usually({0, 2}, {"fog.falloff", at<&P::fog, &Fog::falloff>, "1/m", limits::kFogFalloff,
                            "How fast the extinction falls with height: as e^(-falloff · y); 0: it does not"})),
    listed(usually({-30, 30}, {"fog.lo", at<&P::fog, &Fog::lo>, "m", limits::kPlace,
                               "Height below which there is none; left out: nowhere", kNobody, Form::height})),
    listed(usually({-30, 30}, {"fog.hi", at<&P::fog, &Fog::hi>, "m", limits::kPlace,
                               "Height above which there is none; left out: nowhere", kNobody, Form::height})),
    listed(usually({-30, 30}, {"fog.centre", at<&P::fog, &Fog::centre>, "m", limits::kPlace,
                               "Centre of the ball that it fills", kNobody, Form::place})),
    listed(usually({0, 50}, {"fog.radius", at<&P::fog, &Fog::radius>, "m", limits::kFogRadius,
                             "Radius of that ball; 0: there is no ball"})),
    listed({"fog.albedo", at<&P::fog, &Fog::albedo>, "", limits::kColour, "Single-scattering albedo", kNobody,
            Form::colour}),
    listed(usually({0, 10}, {"fog.emission", at<&P::fog, &Fog::emission>, "W/(m² sr)", limits::kRadiance,
                             "Fog that nothing is seen through emits (1 − albedo) times this", kNobody, Form::colour})),
    listed({"fog.extinction_colour", at<&P::fog, &Fog::extinction_colour>, "", limits::kColour,
            "Extinction of red, green and blue, as `medium.extinction_colour`", kNobody, Form::colour}),
    listed({"fog.phase", at<&P::fog, &Fog::phase>, "", kNone, "Phase function, as `medium.phase`", kNobody, Form::plain,
            kPhases}),
    listed({"fog.anisotropy", at<&P::fog, &Fog::anisotropy>, "", limits::kAnisotropy, "a, as `medium.anisotropy`"}),
    listed({"fog.asymmetry", at<&P::fog, &Fog::asymmetry>, "", limits::kAsymmetry, "g, as `medium.asymmetry`"}),
    listed({"fog.second_asymmetry", at<&P::fog, &Fog::second_asymmetry>, "", limits::kAsymmetry,
            "h, as `medium.second_asymmetry`"}),
    listed({"fog.droplet", at<&P::fog, &Fog::droplet>, "µm", limits::kDroplet, "Diameter, as `medium.droplet`"}),

    {"simulation.spring", at<&P::simulation, &S::spring>, "1/s²", limits::kSpring,
     "Acceleration toward a particle's home per metre of distance"},
    {"simulation.viscosity", at<&P::simulation, &S::viscosity>, "1/s", limits::kViscosity, "How fast velocities decay"},
    {"simulation.impulse_radius", at<&P::simulation, &S::impulse_radius>, "m", limits::kLength,
     "Reach of a push around its ray"},
    {"simulation.impulse_strength", at<&P::simulation, &S::impulse_strength>, "m/s", limits::kImpulseStrength,
     "Speed that a push of strength 1 gives at its ray"},
    {"simulation.volume_velocity", at<&P::simulation, &S::volume_velocity>, "m/s", limits::kSpeed,
     "Drift of the volume"},
    {"simulation.volume_swing",
     at<&P::simulation, &S::volume_swing>,
     "m",
     {0, limits::kLength.hi},
     "Amplitude of a slow sway along x"},
    {"simulation.volume_period", at<&P::simulation, &S::volume_period>, "s", limits::kPeriod, "Period of that sway"},
    {"simulation.collide", at<&P::simulation, &S::collide>, "", kNone,
     "True: particles stop at planes, boxes, spheres and meshes, and slide along them; not of layouts `sequence` and "
     "`live`"},
    {"simulation.paused", at<&P::simulation, &S::paused>, "", kNone, "True: the particles and the light stand still",
     kControllers},

    listed(usually({-30, 30}, {"plane.height", at<&P::plane, &Plane::height>, "m", limits::kPlace,
                               "Height of the horizontal ground", kNobody, Form::height})),
    listed(
        {"plane.albedo", at<&P::plane, &Plane::albedo>, "", limits::kColour, "Diffuse albedo", kNobody, Form::colour}),
    listed({"plane.structure", at<&P::plane, &Plane::structure>, "", limits::kStructure,
            "How far the albedo varies from place to place, at most, as a part of it; 0: not at all"}),
    listed(usually({0.1, 100}, {"plane.structure_size", at<&P::plane, &Plane::structure_size>, "m", limits::kLength,
                                "Length of the longest waves of the structure"})),
    listed(usually({-30, 30}, {"box.centre", at<&P::box, &Box::centre>, "m", limits::kPlace, "Centre of the box",
                               kNobody, Form::place})),
    listed(usually({0.01, 20}, {"box.size", at<&P::box, &Box::size>, "m", limits::kLength, "Full edge lengths"})),
    listed(
        usually({-3.2, 3.2}, {"box.yaw", at<&P::box, &Box::yaw>, "rad", limits::kAngle, "Angle about the vertical"})),
    listed({"box.albedo", at<&P::box, &Box::albedo>, "", limits::kColour, "Diffuse albedo", kNobody, Form::colour}),
    listed(usually({-30, 30}, {"sphere.centre", at<&P::sphere, &Sphere::centre>, "m", limits::kPlace,
                               "Centre of the sphere", kNobody, Form::place})),
    listed(usually({0.01, 20}, {"sphere.radius", at<&P::sphere, &Sphere::radius>, "m", limits::kLength, "Radius"})),
    listed({"sphere.albedo", at<&P::sphere, &Sphere::albedo>, "", limits::kColour, "Diffuse albedo", kNobody,
            Form::colour}),

    {"objects.layout", at<&P::objects, &ObjectLayout::layout>, "", kNone, "A place made of many boxes and spheres",
     kNobody, Form::plain, kPlacesOfObjects},
    {"objects.count", at<&P::objects, &ObjectLayout::count>, "", limits::kObjects,
     "Boxes and spheres together; a smaller count leaves out details"},
    {"objects.seed", at<&P::objects, &ObjectLayout::seed>, "", limits::kSeed, "Another seed lays out another place"},
    {"objects.centre", at<&P::objects, &ObjectLayout::centre>, "m", limits::kPlace, "The middle of its ground", kNobody,
     Form::place},

    {"mesh.file", at<&P::mesh, &Mesh::file>, "", kPaths, "glTF file beside the scene, `.glb` or `.gltf`"},
    {"mesh.position", at<&P::mesh, &Mesh::position>, "m", limits::kPlace, "Where the file's origin is", kNobody,
     Form::place},
    {"mesh.scale", at<&P::mesh, &Mesh::scale>, "m", limits::kMeshScale, "Length of one unit of the file"},
    {"mesh.yaw", at<&P::mesh, &Mesh::yaw>, "rad", limits::kAngle, "Angle about the vertical"},

    {"glass.centre", at<&P::glass, &Glass::centre>, "m", limits::kPlace, "Middle of a thin sheet that is seen through",
     kNobody, Form::place},
    {"glass.width", at<&P::glass, &Glass::width>, "m", limits::kLength, "Its width"},
    {"glass.height", at<&P::glass, &Glass::height>, "m", limits::kLength, "Its height"},
    {"glass.yaw", at<&P::glass, &Glass::yaw>, "rad", limits::kAngle, "Angle about the vertical; 0: it faces +Z"},
    {"glass.pitch", at<&P::glass, &Glass::pitch>, "rad", limits::kTilt, "Angle that it tips; 0: it is upright"},
    {"glass.transmittance", at<&P::glass, &Glass::transmittance>, "", limits::kPart, "Part of each colour that passes"},
    {"glass.reflectance", at<&P::glass, &Glass::reflectance>, "", limits::kPart,
     "Part of the sky's radiance that it mirrors, straight on"},

    {"sky.zenith", at<&P::sky, &Sky::zenith>, "W/(m² sr)", limits::kRadiance,
     "Radiance straight up; it blends to the horizon's"},
    {"sky.horizon", at<&P::sky, &Sky::horizon>, "W/(m² sr)", limits::kRadiance, "Radiance at the horizon"},
    {"sky.ambient", at<&P::sky, &Sky::ambient>, "W/(m² sr)", limits::kRadiance,
     "Uniform radiance that the medium scatters without shadowing"},
    {"sky.haze", at<&P::sky, &Sky::haze>, "1/m", limits::kHaze,
     "Extinction of clear air: surfaces fade to the sky's radiance, the medium does not"},
    {"sky.lights", at<&P::sky, &Sky::lights>, "", kNone,
     "With render.scattering = \"propagation\". True: zenith and horizon light the medium, which dims and scatters it"},

    {"camera.position", at<&P::camera, &SceneCamera::position>, "m", limits::kPlace, "Where a viewer's camera starts",
     kNobody, Form::place},
    {"camera.target", at<&P::camera, &SceneCamera::target>, "m", limits::kPlace, "What it looks at", kNobody,
     Form::place},
    {"camera.fov_y", at<&P::camera, &SceneCamera::fov_y>, "rad", limits::kFovY, "Its full vertical angle of view"},

    {"camera.key.position", at<&P::key, &CameraKey::position>, "m", limits::kPlace, "Where the camera is", kNobody,
     Form::place},
    {"camera.key.target", at<&P::key, &CameraKey::target>, "m", limits::kPlace, "What it looks at", kNobody,
     Form::place},
    {"camera.key.fov_y", at<&P::key, &CameraKey::fov_y>, "rad", limits::kFovY, "Its full vertical angle of view"},
    {"camera.key.seconds", at<&P::key, &CameraKey::seconds>, "s", limits::kKeySeconds,
     "Time on the way from the key before; the first key has none"},

    {"render.method", at<&P::render, &R::method>, "", kNames,
     "How the medium is rendered: a method's name, or `auto` for the cheapest one within render.error and render.flip",
     kOperators},
    {"render.error", at<&P::render, &R::error>, "", limits::kError,
     "For `auto`: the largest relative RMSE of a picture against the true medium"},
    {"render.flip", at<&P::render, &R::flip>, "", limits::kFlip, "For `auto`: the largest mean FLIP error"},
    {"render.rate", at<&P::render, &R::rate>, "pixels", limits::kRayRate,
     "`slabs`, `grid`: pixels between rays; `auto`: as the medium needs. Other methods draw every 2nd, 4th or 8th "
     "pixel; `auto`: every one",
     kNobody, Form::or_auto},
    {"render.slabs", at<&P::render, &R::slabs>, "", limits::kSlabs,
     "`slabs`, `grid`: slabs along every ray; `auto`: as the medium needs", kNobody, Form::or_auto},
    {"render.shading", at<&P::render, &R::shading>, "pixels", limits::kShading,
     "`slabs`, `grid`: pixels between shaded ones, 1, 2, 4 or 8; `auto`: as the distance of the rays allows", kNobody,
     Form::or_auto},
    {"render.lamp_spacing", at<&P::render, &R::lamp_spacing>, "", limits::kLampSpacing,
     "`slabs`, `grid`: rays hold what particles scatter of points and spots where they are at most so many of the "
     "lengths apart in which it varies; pixels look up the rest; `auto`: 0.25, more under load",
     kNobody, Form::or_auto},
    {"render.soft_edges", at<&P::render, &R::soft_edges>, "", kNone,
     "`slabs`, `grid`. True: edges of shafts and of lamps' light in the medium are smoothed over some four pixels; so "
     "they are under load"},
    {"render.merge", at<&P::render, &R::merge>, "pixels", limits::kMerge,
     "Particles of a large medium that share a cell of at most this size become one; 0: none do"},
    {"render.shared_order", at<&P::render, &R::shared_order>, "", kNone,
     "True: `isv`, `sphere` and `tiles` sort once for the two eyes of a head"},
    {"render.scattering", at<&P::render, &R::scattering>, "", kNone,
     "Light in the medium scatters once (`single`), or more often, as `octaves` of thinner media, or by `propagation` "
     "through cells",
     kOperators, Form::plain, kScatterings},
    usually({0.05, 20}, {"render.exposure", at<&P::render, &R::exposure>, "", limits::kExposure,
                         "Factor before the tone map", kOperators}),
    {"render.tone_map", at<&P::render, &R::tone_map>, "", kNone, "Curve from radiance to the picture", kNobody,
     Form::plain, kToneMaps},
    {"render.shadow_size", at<&P::render, &R::shadow_size>, "texels", limits::kShadowSize,
     "Side of the volumetric shadow map; `auto`: as the medium and render.shadow_error need", kNobody, Form::or_auto},
    {"render.shadow_slices", at<&P::render, &R::shadow_slices>, "", limits::kShadowSlices,
     "Planes of the volumetric shadow map; `auto`: as the medium and render.shadow_error need", kNobody, Form::or_auto},
    {"render.shadow_map", at<&P::render, &R::shadow_map>, "", kNone,
     "What the volumetric shadow map holds: optical depths before each place (`sums`), or whole particles behind their "
     "`fronts`, as printed in the dissertation",
     kNobody, Form::plain, kShadowMaps},
    {"render.shadow_extent", at<&P::render, &R::shadow_extent>, "m", limits::kShadowExtent,
     "Side of the cube around the camera's target that the map covers; `auto`: what holds the medium", kNobody,
     Form::or_auto},
    {"render.shadow_error", at<&P::render, &R::shadow_error>, "", limits::kShadowError,
     "Relative error of the light that a shadow map of automatic size may make"},
    {"render.opaque_shadow_size", at<&P::render, &R::opaque_shadow_size>, "texels", limits::kOpaqueShadowSize,
     "Side of the shadow map of objects"},
    {"render.cutoff", at<&P::render, &R::cutoff>, "", limits::kCutoff,
     "Bound on the optical depth that proxies leave out of any ray"},
};

constexpr auto kSettings = [] {
    std::array<SceneSetting, std::size(kBeforeMethods) + std::size(kMethodSettings)> all{};
    std::ranges::copy(kMethodSettings, std::ranges::copy(kBeforeMethods, all.begin()).out);
    return all;
}();

// The settings that `Holds` is true for.
template <bool (*Holds)(const SceneSetting&)>
constexpr auto kWhere = [] {
    std::array<const SceneSetting*, std::count_if(std::begin(kSettings), std::end(kSettings), Holds)> found{};
    size_t count = 0;
    for (const SceneSetting& setting : kSettings)
        if (Holds(setting)) found[count++] = &setting;
    return found;
}();
constexpr bool standsAlone(const SceneSetting& setting) { return setting.live() && !setting.in_list; }
constexpr bool isOfLights(const SceneSetting& setting) { return setting.in_list && setting.table() == "light"; }
constexpr bool isOfFogs(const SceneSetting& setting) { return setting.table() == "fog"; }
constexpr bool isOfPlanes(const SceneSetting& setting) { return setting.table() == "plane"; }
constexpr bool isOfBoxes(const SceneSetting& setting) { return setting.table() == "box"; }
constexpr bool isOfSpheres(const SceneSetting& setting) { return setting.table() == "sphere"; }
constexpr auto& kLive = kWhere<standsAlone>;

} // namespace

std::span<const SceneSetting> sceneSettings() { return kSettings; }

std::span<const SceneSetting* const> liveSettings() { return kLive; }

std::span<const SceneSetting* const> liveSettings(SceneList list) {
    switch (list) {
    case SceneList::lights:
        return kWhere<isOfLights>;
    case SceneList::fogs:
        return kWhere<isOfFogs>;
    case SceneList::planes:
        return kWhere<isOfPlanes>;
    case SceneList::boxes:
        return kWhere<isOfBoxes>;
    case SceneList::spheres:
        break;
    }
    return kWhere<isOfSpheres>;
}

} // namespace brume
