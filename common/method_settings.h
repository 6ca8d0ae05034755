// The settings of one method each, [render.NAME] in a scene: the last part of the table in settings.cpp.
#pragma once

#include "common/setting_rows.h"

namespace brume::setting_rows {

inline constexpr std::string_view kIsvQuadratures[]{"simpson", "transmittance", "analytic", "taylor"};
inline constexpr std::string_view kOrientations[]{"aligned", "random"};
inline constexpr std::string_view kNearPlanes[]{"clip", "drop"};
inline constexpr std::string_view kEarlyReturns[]{"sum", "fixed", "none"};
inline constexpr std::string_view kTilesQuadratures[]{"cached", "hermite"};
inline constexpr std::string_view kTilesLights[]{"fit", "path"};
inline constexpr std::string_view kUnionShadows[]{"exact", "nearest", "binary", "none"};
inline constexpr std::string_view kSpriteLights[]{"path", "none"};
inline constexpr std::string_view kSpriteMaps[]{"baked", "even", "files"};
inline constexpr std::string_view kDithers[]{"none", "white", "bayer4", "bayer8", "ign", "blue"};
inline constexpr std::string_view kJitters[]{"offset", "stratified", "opacity"};
inline constexpr std::string_view kBlurs[]{"none", "row14", "printed", "box8"};
inline constexpr std::string_view kShadowsOfFroxels[]{"none", "map", "ray", "grid", "hybrid"};
inline constexpr std::string_view kVoxelValues[]{"bits", "coverage"};
inline constexpr std::string_view kVoxelLookups[]{"nearest", "linear"};
inline constexpr std::string_view kInterpolations[]{"exact", "rbf", "gradient", "nested"};
inline constexpr std::string_view kQuantities[]{"radiance", "factor"};
inline constexpr std::string_view kSampleWeights[]{"printed", "gaussian"};
inline constexpr std::string_view kCriteria[]{"opacity", "printed"};
inline constexpr std::string_view kFirsts[]{"particles", "strata"};

inline constexpr SceneSetting kMethodSettings[]{
    {"render.isv.quadrature", at<&P::render, &R::isv, &IsvSettings::quadrature>, "", kNone,
     "How the light along a particle's interval is summed", kOperators, Form::plain, kIsvQuadratures},
    {"render.isv.steps", at<&P::render, &R::isv, &IsvSettings::steps>, "", limits::kSteps,
     "Steps of the quadrature; at most 3 for `transmittance`; `analytic` and `taylor` have none", kOperators},
    {"render.isv.fading", at<&P::render, &R::isv, &IsvSettings::fading>, "", kNone,
     "False: all of a tetrahedron has the extinction of its centre", kOperators},
    {"render.isv.soft_shadows", at<&P::render, &R::isv, &IsvSettings::soft_shadows>, "", kNone,
     "True: shadows of objects in the medium are means over 5x5 texels of their map", kOperators},
    {"render.isv.multiple", at<&P::render, &R::isv, &IsvSettings::multiple>, "", limits::kPart,
     "Part of a term for multiple scattering, as printed in the dissertation: it is not physical", kOperators},
    {"render.isv.orientation", at<&P::render, &R::isv, &IsvSettings::orientation>, "", kNone,
     "How tetrahedra are turned: all alike (`aligned`), or each by chance (`random`)", kNobody, Form::plain,
     kOrientations},
    {"render.isv.near", at<&P::render, &R::isv, &IsvSettings::near>, "", kNone,
     "A particle whose ball meets the near plane: what is behind the plane is drawn (`clip`), or nothing (`drop`)",
     kNobody, Form::plain, kNearPlanes},
    {"render.isv.early_return", at<&P::render, &R::isv, &IsvSettings::early_return>, "", kNone,
     "Intervals that are left out: of less optical depth than a particle's share of render.cutoff (`sum`), than 0.001 "
     "(`fixed`), or `none`",
     kNobody, Form::plain, kEarlyReturns},
    {"render.isv.taylor_step", at<&P::render, &R::isv, &IsvSettings::taylor_step>, "m", limits::kTaylorStep,
     "`taylor`: step of its differences; `auto`: 1/16 of the interval", kNobody, Form::or_auto},
    {"render.isv.taylor_shadows", at<&P::render, &R::isv, &IsvSettings::taylor_shadows>, "", kNone,
     "`taylor`. False: objects do not shadow the medium"},
    {"render.tetrahedra.nodes", at<&P::render, &R::tetrahedra, &TetrahedraSettings::nodes>, "",
     limits::kTetrahedraNodes, "Places in each part of a tetrahedron on a ray for which light is looked up",
     kOperators},
    {"render.tiles.quadrature", at<&P::render, &R::tiles, &TilesSettings::quadrature>, "", kNone,
     "Where light is looked up: `cached` on the particles, or `hermite` at two points of each ray", kOperators,
     Form::plain, kTilesQuadratures},
    {"render.tiles.light_tolerance", at<&P::render, &R::tiles, &TilesSettings::light_tolerance>, "",
     limits::kLightTolerance, "With `cached`: how far light may be from linear on a particle, as a part of 1"},
    {"render.tiles.least_transmittance", at<&P::render, &R::tiles, &TilesSettings::least_transmittance>, "",
     limits::kLeastTransmittance, "Where a ray may end; what lies behind counts for no more than this"},
    {"render.tiles.light", at<&P::render, &R::tiles, &TilesSettings::light>, "", kNone,
     "With `cached`: light that is linear on a particle (`fit`), or one value for it, behind the union of balls "
     "(`path`)",
     kOperators, Form::plain, kTilesLights},
    {"render.grid.spacing", at<&P::render, &R::grid, &GridSettings::spacing>, "deviations", limits::kGridSpacing,
     "Distance of the nodes; `auto`: 0.5. Below 0.25 sampling is cubic", kNobody, Form::or_auto},

    usually({4, 16}, {"render.froxels.pixels", at<&P::render, &R::froxels, &FroxelSettings::pixels>, "pixels",
                      limits::kFroxelPixels, "`froxels`, `lit`, `gradients`: pixels between rays", kOperators}),
    usually({16, 256}, {"render.froxels.slices", at<&P::render, &R::froxels, &FroxelSettings::slices>, "",
                        limits::kSlices, "`froxels`, `lit`, `gradients`: slices along every ray", kOperators}),
    {"render.froxels.jitter", at<&P::render, &R::froxels, &FroxelSettings::jitter>, "", kNone,
     "`froxels`. True: samples lie elsewhere within their slices in each tick and for each ray", kOperators},
    {"render.froxels.history", at<&P::render, &R::froxels, &FroxelSettings::history>, "", limits::kHistory,
     "`froxels`: part of a cell's light that a viewer's last picture gives; not in pictures above some 1600x900",
     kOperators},
    {"render.froxels.shadows", at<&P::render, &R::froxels, &FroxelSettings::shadows>, "", kNone,
     "`froxels`: whether objects shadow a place in the medium is asked of a shadow `map`, by a `ray`, from the shared "
     "shadow `grid`, or `hybrid`: from the shadow frustum near the eye, and from the grid behind it. `none`: not asked",
     kOperators, Form::plain, kShadowsOfFroxels},
    {"render.shadow_grid.voxel", at<&P::render, &R::shadow_grid, &ShadowGridSettings::voxel>, "m", limits::kVoxel,
     "Width of a voxel; `auto`: 1/200 of the longest side of what the grid covers", kNobody, Form::or_auto},
    {"render.shadow_grid.values", at<&P::render, &R::shadow_grid, &ShadowGridSettings::values>, "", kNone,
     "What a voxel keeps of a light: `bits`, whether its centre is lit, or `coverage`, the part of it that is lit",
     kNobody, Form::plain, kVoxelValues},
    {"render.shadow_grid.lookup", at<&P::render, &R::shadow_grid, &ShadowGridSettings::lookup>, "", kNone,
     "The voxels that a place reads: the `nearest`, or the eight around it, between which it is `linear`", kNobody,
     Form::plain, kVoxelLookups},
    {"render.shadow_grid.parity", at<&P::render, &R::shadow_grid, &ShadowGridSettings::parity>, "", kNone,
     "True: each update makes every other layer of voxels"},
    {"render.shadow_grid.retrace", at<&P::render, &R::shadow_grid, &ShadowGridSettings::retrace>, "", kNone,
     "True: all voxels are made again every tick, though nothing has moved"},
    {"render.radiance.interpolation", at<&P::render, &R::radiance, &RadianceSettings::interpolation>, "", kNone,
     "Where light is computed: at every node (`exact`), at samples (`rbf`, `gradient`), or on `nested` grids",
     kOperators, Form::plain, kInterpolations},
    {"render.radiance.quantity", at<&P::render, &R::radiance, &RadianceSettings::quantity>, "", kNone,
     "What is interpolated: `radiance`, or the part of it that arrives", kOperators, Form::plain, kQuantities},
    {"render.radiance.weights", at<&P::render, &R::radiance, &RadianceSettings::weights>, "", kNone,
     "`rbf`, `gradient`: weights of samples; as `printed` by Ren et al. (2008) they leave holes", kNobody, Form::plain,
     kSampleWeights},
    usually({0.005, 0.1},
            {"render.radiance.error", at<&P::render, &R::radiance, &RadianceSettings::error>, "", limits::kLightError,
             "Beyond which samples are split: the error of the light, times opacity", kOperators}),
    {"render.radiance.criterion", at<&P::render, &R::radiance, &RadianceSettings::criterion>, "", kNone,
     "`rbf`, `gradient`: what `error` bounds: the light's error times `opacity`, or as `printed` by Ren et al. (2008): "
     "times the cube of the sphere's radius, density, and the transmittance to a viewer",
     kNobody, Form::plain, kCriteria},
    {"render.radiance.levels", at<&P::render, &R::radiance, &RadianceSettings::levels>, "", limits::kLightLevels,
     "Levels of grids that samples are split into; `nested` with 0 or 1: every node is computed"},
    {"render.radiance.spacing", at<&P::render, &R::radiance, &RadianceSettings::spacing>, "m", limits::kVoxel,
     "`gradients`, `lit`: distance of the nodes; `auto`: half a deviation of particles, or without any 1/96 of what "
     "nodes cover",
     kNobody, Form::or_auto},
    {"render.radiance.step", at<&P::render, &R::radiance, &RadianceSettings::step>, "spacings", limits::kLightStep,
     "Step of marches toward lights; `auto`: depths are looked up in the lights' volumes", kNobody, Form::or_auto},
    {"render.radiance.samples", at<&P::render, &R::radiance, &RadianceSettings::samples>, "", limits::kLightSamples,
     "`rbf`, `gradient`: the first ones, at most: the particles, or strata if there are none or too many"},
    {"render.radiance.firsts", at<&P::render, &R::radiance, &RadianceSettings::firsts>, "", kNone,
     "`rbf`, `gradient`: the first samples are the `particles` where they can be, or always in `strata`", kNobody,
     Form::plain, kFirsts},
    {"render.radiance.near", at<&P::render, &R::radiance, &RadianceSettings::near>, "spacings", limits::kLightNear,
     "`gradients`, `lit`: as near to points and spots their light is added exactly, and not kept at nodes"},

    usually({1, 32}, {"render.path.groups", at<&P::render, &R::path, &PathSettings::groups>, "", limits::kPathGroups,
                      "Each tick light behind the union of balls is computed for one of so many groups of particles",
                      kOperators}),
    {"render.path.cutoff", at<&P::render, &R::path, &PathSettings::cutoff>, "", limits::kPathCutoff,
     "A particle from which a ray toward the sun has so many hits, or more, is black; 0: none is", kOperators},
    {"render.path.surfaces", at<&P::render, &R::path, &PathSettings::surfaces>, "", kNone,
     "What surfaces get of the sun's light through a union medium: what is left behind all balls (`exact`), what the "
     "`nearest` ball gets, nothing behind any ball (`binary`), or all of it (`none`)",
     kOperators, Form::plain, kUnionShadows},
    {"render.sprites.light", at<&P::render, &R::sprites, &SpritesSettings::light>, "", kNone,
     "Whether particles shadow each other: behind the union of balls (`path`), or not (`none`)", kOperators,
     Form::plain, kSpriteLights},
    {"render.sprites.maps", at<&P::render, &R::sprites, &SpritesSettings::maps>, "", kNone,
     "Light on a sprite from six sides: made by the server (`baked`), the same everywhere (`even`), or of the "
     "scene's `[medium]` sprite_maps (`files`)",
     kNobody, Form::plain, kSpriteMaps},
    usually({0.5, 2}, {"render.sprites.size", at<&P::render, &R::sprites, &SpritesSettings::size>, "radii",
                       limits::kSpriteSize, "Half a sprite's side, in radii of its ball", kOperators}),
    usually({1, 64}, {"render.march.samples", at<&P::render, &R::march, &MarchSettings::samples>, "",
                      limits::kMarchSamples, "Samples along every ray", kOperators}),
    {"render.march.dither", at<&P::render, &R::march, &MarchSettings::dither>, "", kNone,
     "Pattern that moves the samples of neighbouring pixels along their rays", kOperators, Form::plain, kDithers},
    {"render.march.jitter", at<&P::render, &R::march, &MarchSettings::jitter>, "", kNone,
     "What the pattern moves: all samples of a ray alike (`offset`), each by a number of its own (`stratified`), or "
     "within steps of equal `opacity`",
     kOperators, Form::plain, kJitters},
    {"render.march.blur", at<&P::render, &R::march, &MarchSettings::blur>, "", kNone,
     "Filter across neighbouring pixels: 15 binomial weights (`row14`), the weights `printed` in the thesis, 8 even "
     "ones (`box8`), or `none`",
     kOperators, Form::plain, kBlurs},

    {"render.propagation.cells", at<&P::render, &R::propagation, &PropagationSettings::cells>, "",
     limits::kPropagationCells, "With scattering = \"propagation\": cells along each side of the medium's bounds"},
    {"render.propagation.iterations", at<&P::render, &R::propagation, &PropagationSettings::iterations>, "",
     limits::kIterations, "With scattering = \"propagation\": steps on the finest grid in each tick", kOperators},
    {"render.propagation.surface_parts", at<&P::render, &R::propagation, &PropagationSettings::surface_parts>, "",
     limits::kSurfaceParts,
     "With scattering = \"propagation\": parts along each side of a plane, box or sphere that sends the sun's light "
     "into the medium; 0: none does",
     kOperators},
    {"render.propagation.onto_surfaces", at<&P::render, &R::propagation, &PropagationSettings::onto_surfaces>, "",
     kNone, "With scattering = \"propagation\". True: surfaces get the light that the medium scatters and emits",
     kOperators},
};

} // namespace brume::setting_rows
