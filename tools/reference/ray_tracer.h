// RayTracer: single scattering along one ray, by closed forms for optical depths and adaptive Gauss-Legendre panels
// for the rest.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "tools/reference/gauss_legendre.h"
#include "tools/reference/geometry.h"
#include "tools/reference/lighting.h"
#include "tools/reference/world.h"

namespace brume::reference {

struct Settings {
    // Relative tolerance of a ray's scattered radiance, and absolute tolerance of the optical depth left out where
    // Gaussians end. In [1e-12, 1e-2]. Panels are split exactly at edges of shadows, faces of tetrahedra, ends of fog
    // and silhouettes of balls. Kinks where balls of a union meet, and where light leaves a fog's sphere and slab at
    // once, are found by halving only: unions are tested down to 1e-7. So are weaker kinks, by edges of tetrahedra
    // on the inside. Precondition: no ray passes through a point light.
    double tolerance = 1e-8;
    bool shadows = true;  // False: every light reaches every point unattenuated
    unsigned threads = 0; // for a picture; 0: as many as the machine has
    // Cells of a distant light's grid along the radius of a mean particle, over 0. Many make it dear to build and rays
    // cheap, for whole pictures; few are for some rays. They change no result.
    double light_cells = 8;
    // Called after each row of a picture, from any thread; empty: nobody wants to know.
    std::function<void()> row_done = {};
};

struct RayResult {
    // By the medium, from lights and ambient light, and what sheets mirror, as sheets before it let it through.
    glm::dvec3 scattered{0};
    // The opaque surface or the sky, through all sheets; black if the ray ends before. In coloured worlds each channel
    // is multiplied by its transmittance over the mean one.
    glm::dvec3 background{0};
    double transmittance = 1; // of the medium in front of it; of coloured worlds the mean over channels
    glm::dvec3 total() const { return scattered + transmittance * background; }
};

struct ChannelStage; // a Stage with its world

// Data that all rays share. `world` must outlive it.
struct Stage {
    Stage(const World& world, const Settings& settings);
    ~Stage();
    const World& world;
    Settings settings;
    double reach; // units of 1/k: the depth lacks less than the tolerance, over all particles
    Lighting lighting;
    const ErfTable& table = ErfTable::shared();
    GaussLegendre rules[3]{GaussLegendre(4), GaussLegendre(8), GaussLegendre(16)};
    std::vector<std::unique_ptr<const ChannelStage>> channels; // of a coloured world: red, green, blue
};

// Each thread has its own. It keeps its memory from ray to ray.
class RayTracer {
public:
    explicit RayTracer(const Stage& stage);
    RayResult trace(const Ray& ray);

private:
    template <typename T>
    using Values = GaussLegendre::Values<T>;

    // One particle on the ray; t in metres.
    struct Crossing {
        const Blob* blob;
        double from_origin; // m, of the centre
        double closest;     // t of the closest approach
        double k;           // 1/m, of the particle along the ray
        double half_line;   // BlobOnLine::half_line
        double across;      // e^(-k^2 b^2)
        double erf_begin;   // erf(k (t - closest)) where the particle, or the ray, begins
        double t0, t1;
    };
    // A piece of the ray that is short enough for the quadrature's nodes.
    struct Panel {
        double t0, t1;
        const GaussLegendre* rule;
        Values<double> depth;          // from the ray's begin
        Values<glm::dvec3> scattering; // sum of albedo * extinction, of media with World::phase
        Values<glm::dvec3> emitted;    // radiance per metre, of everything but fogs
        Values<glm::dvec3> source;     // sum of E p T_L Vis, with that phase function
        glm::dvec3 light, ambient;     // the panel's part of the ray's radiance
        double size, error;            // of light + ambient, channels summed; error: an upper estimate
        double at(int i) const { return (t0 + t1) / 2 + (t1 - t0) / 2 * rule->node(i); }
    };

    RayResult traceChannels(const Ray& ray);
    void gather();
    void findBreaks();
    double endOf(const Fog& fog, Interval part) const;
    double depthFromBegin(double t) const;
    double finest(double t0, double t1, bool& empty) const; // largest k of the particles there
    Panel panelOn(double t0, double t1, double k);
    double fogAt(const Fog& fog, double t) const; // 1/m, where the ray is in it
    void addMedia(Panel& panel) const;
    void layPanels();
    void refine();
    void sumOverlapping(RayResult& result) const;
    void addSheets(RayResult& result) const;
    glm::dvec3 sheetsPass(double t) const; // part of what is at t that the sheets before it let through
    void sumSequential(RayResult& result);
    double crossedDepth(const Crossing& c, double t) const;

    const Stage& stage_;
    const World& world_;
    Ray ray_;
    std::vector<Crossing> crossings_;
    std::vector<Interval> fog_parts_, ball_parts_;
    std::vector<CellPart> cell_parts_;
    std::vector<SheetHit> sheets_;
    double smallest_ball_ = kInfinity; // m
    std::vector<PhaseLobes> phases_;   // that of the world, then those of fogs that differ
    std::vector<size_t> fog_phases_;   // of each fog, in phases_
    std::vector<glm::dvec3> sources_;  // sum of E p T_L Vis with each of phases_
    std::vector<double> breaks_;
    std::vector<Panel> panels_, refined_;
    std::vector<RayTracer> channels_; // of Stage::channels
};

} // namespace brume::reference
