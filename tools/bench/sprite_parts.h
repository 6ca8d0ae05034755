// SpriteParts: what method `sprites` draws, in double precision, with each of its simplifications on or off. Between
// the true union of balls and the method's picture nothing else changes, so differences are of those alone.
#pragma once

#include <span>
#include <vector>

#include "server/methods/sprites/puffs.h"
#include "tools/reference/camera.h"
#include "tools/reference/gauss_legendre.h"
#include "tools/reference/world.h"

namespace brume::bench {

// How a picture differs from the truth, which has none of it.
struct SpriteWay {
    enum class Depth {
        chord, // of the ball on the ray
        mean,  // that of a mean chord, on a disc that faces the camera
        map,   // of the light map's texel, on its square
    };
    // The sun's light is that of each ball's centre, in all of it. Where balls overlap and `over` is false it is the
    // mean of those that cover the place. False: the light of each place.
    bool one_light = false;
    // Balls are drawn one over another, as far as their centres are from the eye. False: their union.
    bool over = false;
    // Depth on a ray. Depth::mean and Depth::map count as parts of the ray in the middle of which the centre's view
    // depth is.
    Depth depth = Depth::chord;
    bool map_light = false; // light is multiplied by that of the six-way maps; overlaps as with `one_light`

    bool operator==(const SpriteWay&) const = default;
};

class SpriteParts {
public:
    // What a ray has by one of the ways.
    struct Seen {
        double light = 0;         // radiance, over albedo * irradiance * phase function
        double transmittance = 1; // of all balls
    };

    // `size`: half a sprite's side, in radii of its ball. `maps` must outlive it.
    SpriteParts(reference::UnionMedium balls, glm::dvec3 to_light, const reference::Camera& camera, double size,
                const methods::sprites::LightMaps& maps);

    Seen at(glm::uvec2 pixel, const SpriteWay& way) const; // along the ray through its centre
    // Part of the sun's light that arrives.
    double lightAt(glm::dvec3 place) const;

private:
    // A ball on the ray, t in m.
    struct Cover {
        reference::Interval part;
        double light, factor; // of the centre; of the maps
        double distance;      // m, of the centre from the eye
    };
    struct Texel {
        double depth, light; // over the mean
    };
    std::vector<Cover> coversOf(const reference::Ray& ray, const SpriteWay& way) const;
    Texel texelAt(size_t ball, glm::dvec2 at) const;
    double scattered(const reference::Ray& ray, reference::Interval part) const;
    Seen overOf(const reference::Ray& ray, const SpriteWay& way) const;
    Seen unionOf(const reference::Ray& ray, const SpriteWay& way) const;

    const reference::UnionMedium balls_;
    const glm::dvec3 to_light_;
    const reference::Camera camera_;
    const double size_;
    const methods::sprites::LightMaps& maps_;
    std::vector<double> lights_; // of each ball's centre
    reference::GaussLegendre rule_{4};
};

} // namespace brume::bench
