#include "tools/reference/ray_tracer.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace brume::reference {

namespace {

// A panel in a tetrahedron is so wide at least, and has 8 nodes: with 4 the light's kinks cannot be told.
constexpr double kLeastWidth = 0.2;

double sum(glm::dvec3 v) { return v.x + v.y + v.z; }

double reachFor(const World& world, double tolerance) {
    double depth = 0; // if every particle were met through its centre
    for (const Blob& b : world.blobs) depth += 2 * b.half_line;
    return std::sqrt(std::log(std::max(depth, 1.0) / tolerance));
}

} // namespace

struct ChannelStage {
    ChannelStage(const World& of, int channel, const Settings& settings)
        : world(inChannel(of, channel)), stage(world, settings) {}
    const World world;
    const Stage stage;
};

Stage::Stage(const World& w, const Settings& s)
    : world(w), settings(s), reach(reachFor(w, s.tolerance)), lighting(w, reach, s.shadows, s.light_cells) {
    if (!(s.tolerance >= 1e-12 && s.tolerance <= 1e-2)) throw std::invalid_argument("tolerance is in [1e-12, 1e-2]");
    if (w.composition == Composition::sequential &&
        !(w.fogs.empty() && w.balls.balls.empty() && w.tetrahedra.cells.empty() && !w.voxels.volume))
        throw std::invalid_argument("sequential composition is of Gaussian particles alone");
    if (w.composition == Composition::sequential && !w.sheets.empty())
        throw std::invalid_argument("sequential composition is of worlds without glass");
    if (w.cut_light && w.support != Support::tetrahedron)
        throw std::invalid_argument("cut_light needs the support to be the tetrahedron");
    if (!isColoured(w)) return;
    for (int channel = 0; channel < 3; ++channel)
        channels.push_back(std::make_unique<const ChannelStage>(w, channel, s));
}

Stage::~Stage() = default;

RayTracer::RayTracer(const Stage& stage) : stage_(stage), world_(stage.world), phases_{stage.world.phase} {
    for (const Fog& fog : world_.fogs) {
        const auto same = std::find(phases_.begin(), phases_.end(), fog.phase);
        fog_phases_.push_back(size_t(same - phases_.begin()));
        if (same == phases_.end()) phases_.push_back(fog.phase);
    }
    sources_.resize(phases_.size());
    for (const auto& channel : stage.channels) channels_.emplace_back(channel->stage);
}

RayResult RayTracer::traceChannels(const Ray& ray) {
    RayResult all;
    glm::dvec3 transmittances;
    for (int c = 0; c < 3; ++c) {
        const RayResult one = channels_[size_t(c)].trace(ray);
        all.scattered[c] = one.scattered[c], all.background[c] = one.background[c];
        transmittances[c] = one.transmittance;
    }
    all.transmittance = sum(transmittances) / 3;
    all.background *= all.transmittance > 0 ? transmittances / all.transmittance : glm::dvec3(0);
    return all;
}

RayResult RayTracer::trace(const Ray& ray) {
    if (!channels_.empty()) return traceChannels(ray);
    RayResult result;
    ray_ = ray;
    const Hit hit = stage_.lighting.obstacles().nearest(ray);
    ray_.end = std::min(ray.end, hit.t);
    if (hit.object >= 0)
        result.background = throughHaze(world_, stage_.lighting.surface(hit, ray), hit.t, ray.direction);
    else if (std::isinf(ray.end))
        result.background = skyRadiance(world_, ray.direction);
    sheetsOn(world_, ray_, sheets_);
    gather();
    result.transmittance = std::exp(-depthFromBegin(ray_.end));
    findBreaks();
    layPanels();
    refine();
    if (world_.composition == Composition::overlapping)
        sumOverlapping(result);
    else
        sumSequential(result);
    addSheets(result);
    return result;
}

glm::dvec3 RayTracer::sheetsPass(double t) const {
    glm::dvec3 part(1);
    for (const SheetHit& sheet : sheets_)
        if (sheet.t < t) part *= sheet.passes;
    return part;
}

void RayTracer::addSheets(RayResult& result) const {
    for (const SheetHit& sheet : sheets_)
        result.scattered += sheetsPass(sheet.t) * sheet.mirrored * std::exp(-depthFromBegin(sheet.t));
    result.background *= sheetsPass(kInfinity);
}

void RayTracer::gather() {
    crossings_.clear();
    for (size_t i = 0; i < world_.blobs.size(); ++i) {
        const Blob& b = world_.blobs[i];
        const SemiAxes* const axes = axesOf(world_, i);
        const BlobOnLine on = onLine(b, axes, ray_.origin, ray_.direction);
        const double reach = stage_.reach / on.k;
        if (on.b2 >= reach * reach) continue;
        const double half = std::sqrt(reach * reach - on.b2);
        Interval part = common({on.closest - half, on.closest + half}, {ray_.begin, ray_.end});
        if (world_.support == Support::tetrahedron) part = common(part, insideTetrahedron(b, axes, ray_));
        if (part.empty()) continue;
        crossings_.push_back({&b, glm::length(b.centre - ray_.origin), on.closest, on.k, on.half_line,
                              std::exp(-on.k * on.k * on.b2), stage_.table.erf(on.k * (part.begin - on.closest)),
                              part.begin, part.end});
    }
    fog_parts_.clear();
    for (const Fog& fog : world_.fogs) fog_parts_.push_back(common(insideFog(fog, ray_), {ray_.begin, ray_.end}));
    insideUnion(world_.balls, ray_, ball_parts_);
    stage_.lighting.tetrahedra().along(ray_, cell_parts_);
    stage_.lighting.voxels().along(ray_, cell_parts_);
    smallest_ball_ = kInfinity;
    for (const UnionMedium::Ball& ball : world_.balls.balls) smallest_ball_ = std::min(smallest_ball_, ball.radius);
}

double RayTracer::crossedDepth(const Crossing& c, double t) const {
    return c.half_line * c.across * (stage_.table.erf(c.k * (t - c.closest)) - c.erf_begin);
}

double RayTracer::depthFromBegin(double t) const {
    double depth = 0;
    for (const Crossing& c : crossings_)
        if (t > c.t0) depth += crossedDepth(c, std::min(t, c.t1));
    for (const Fog& fog : world_.fogs) depth += depthOn(fog, {ray_.origin, ray_.direction, ray_.begin, t});
    for (const Interval part : ball_parts_)
        depth += world_.balls.sigma_t * std::max(std::min(t, part.end) - part.begin, 0.0);
    for (const CellPart& part : cell_parts_) depth += part.depthTo(t);
    return depth;
}

// Where a fog counts as ended: opaque, or what is left of it is below the tolerance.
double RayTracer::endOf(const Fog& fog, Interval part) const {
    const double whole = depthOn(fog, ray_), opaque = 10 - std::log(stage_.settings.tolerance);
    if (!std::isinf(part.end) && whole <= opaque) return part.end;
    const double depth = std::min(opaque, whole * (1 - 1e-3 * stage_.settings.tolerance));
    return std::min(ray_.begin + distanceOfDepth(fog, ray_, depth), part.end);
}

void RayTracer::findBreaks() {
    breaks_.clear();
    double begin = kInfinity, end = -kInfinity;
    const auto cover = [&](Interval part) {
        begin = std::min(begin, part.begin);
        end = std::max(end, part.end);
        breaks_.insert(breaks_.end(), {part.begin, part.end});
    };
    if (world_.support == Support::tetrahedron) {
        for (const Crossing& c : crossings_) cover({c.t0, c.t1});
    } else { // only where a group of particles begins and ends: inside it Gaussians have no kinks
        std::sort(crossings_.begin(), crossings_.end(),
                  [](const Crossing& a, const Crossing& b) { return a.t0 < b.t0; });
        for (size_t i = 0; i < crossings_.size();) {
            Interval group{crossings_[i].t0, crossings_[i].t1};
            for (; i < crossings_.size() && crossings_[i].t0 <= group.end; ++i)
                group.end = std::max(group.end, crossings_[i].t1);
            cover(group);
        }
    }
    for (const Interval part : ball_parts_) cover(part);
    for (const CellPart& part : cell_parts_) cover({part.begin, part.end});
    for (size_t f = 0; f < world_.fogs.size(); ++f)
        if (const Interval part = fog_parts_[f]; !part.empty()) cover({part.begin, endOf(world_.fogs[f], part)});
    if (!(end > begin)) return;
    stage_.lighting.edges(ray_, breaks_);
    for (const SheetHit& sheet : sheets_) breaks_.push_back(sheet.t);
    std::erase_if(breaks_, [&](double t) { return !(t >= begin && t <= end); });
    std::sort(breaks_.begin(), breaks_.end());
    breaks_.erase(std::unique(breaks_.begin(), breaks_.end()), breaks_.end());
}

double RayTracer::finest(double t0, double t1, bool& empty) const {
    const double t = (t0 + t1) / 2;
    const auto holds = [t](Interval part) { return t > part.begin && t < part.end; };
    empty = std::none_of(fog_parts_.begin(), fog_parts_.end(), holds) &&
            std::none_of(ball_parts_.begin(), ball_parts_.end(), holds);
    double k = 0;
    for (const Crossing& c : crossings_)
        if (c.t0 < t1 && c.t1 > t0) k = std::max(k, c.k);
    if (k > 0) empty = false;
    for (const CellPart& part : cell_parts_) {
        if (!part.holds(t)) continue;
        empty = false;
        k = std::max({k, part.extinction[0], part.extinction[1], kLeastWidth / (t1 - t0)});
    }
    // The light through a union has kinks wherever balls meet: eight times as fine as a ball finds them.
    if (std::any_of(ball_parts_.begin(), ball_parts_.end(), holds)) k = std::max(k, 8 / smallest_ball_);
    return k;
}

void RayTracer::layPanels() {
    panels_.clear();
    const double tolerance = stage_.settings.tolerance;
    // Half a panel of 1.6/k leaves 5e-6 of a Gaussian beyond 15 Legendre coefficients, whose square is the rule's
    // error.
    const double in_k = 3.2 * std::pow(tolerance / 1e-8, 1.0 / 12);
    double total = 0;
    for (size_t i = 0; i + 1 < breaks_.size(); ++i) {
        const double t0 = breaks_[i], t1 = breaks_[i + 1];
        bool empty = true;
        const double k = finest(t0, t1, empty);
        if (empty) continue;
        const int count = std::max(1, static_cast<int>(std::ceil((t1 - t0) * k / in_k)));
        for (int p = 0; p < count; ++p) {
            const auto at = [&](int end) {
                return end == count ? t1 : t0 + (t1 - t0) * end / count;
            }; // the ends to the last bit
            panels_.push_back(panelOn(at(p), at(p + 1), k));
            const Panel& last = panels_.back();
            total += last.size;
            if (world_.composition == Composition::overlapping && last.depth[0] > 10 - std::log(tolerance) &&
                last.size <= 1e-3 * tolerance * total)
                return; // nothing is seen behind it
        }
    }
}

double RayTracer::fogAt(const Fog& fog, double t) const {
    return fog.sigma_t * std::exp(-fog.falloff * (ray_.at(t).y - fog.base));
}

void RayTracer::addMedia(Panel& panel) const {
    const int n = panel.rule->size();
    double passed = 0;
    for (const Crossing& c : crossings_) {
        if (c.t0 >= panel.t1) continue;
        const double half = c.half_line * c.across, peak = c.blob->sigma_t * c.across;
        if (c.t1 <= panel.t0) {
            passed += crossedDepth(c, c.t1);
            continue;
        }
        for (int i = 0; i < n; ++i) {
            const ErfTable::Pair pair = stage_.table.at(c.k * (panel.at(i) - c.closest));
            panel.scattering[i] += peak * pair.gauss * c.blob->albedo;
            panel.emitted[i] += peak * pair.gauss * emittedBy(world_, c.blob->albedo);
            panel.depth[i] += half * (pair.erf - c.erf_begin);
        }
    }
    const double middle = (panel.t0 + panel.t1) / 2;
    for (int i = 0; i < n; ++i) {
        const double t = panel.at(i);
        panel.depth[i] += passed;
        for (size_t f = 0; f < world_.fogs.size(); ++f) {
            const Fog& fog = world_.fogs[f];
            panel.depth[i] += depthOn(fog, {ray_.origin, ray_.direction, ray_.begin, t});
            if (fog_phases_[f] == 0 && middle > fog_parts_[f].begin && middle < fog_parts_[f].end)
                panel.scattering[i] += fogAt(fog, t) * fog.albedo;
        }
        for (const Interval part : ball_parts_) {
            panel.depth[i] += world_.balls.sigma_t * std::max(std::min(t, part.end) - part.begin, 0.0);
            if (!(middle > part.begin && middle < part.end)) continue;
            panel.scattering[i] += world_.balls.sigma_t * world_.balls.albedo;
            panel.emitted[i] += world_.balls.sigma_t * emittedBy(world_, world_.balls.albedo);
        }
        for (const CellPart& part : cell_parts_) {
            panel.depth[i] += part.depthTo(t);
            if (!part.holds(middle)) continue;
            panel.scattering[i] += part.extinctionAt(t) * part.albedoAt(t);
            panel.emitted[i] += part.extinctionAt(t) * emittedBy(world_, part.albedoAt(t));
        }
    }
}

RayTracer::Panel RayTracer::panelOn(double t0, double t1, double k) {
    const double width = k > 0 ? k * (t1 - t0) : 1e300;
    Panel panel{t0, t1, &stage_.rules[width < 0.15 ? 0 : width < 0.8 ? 1 : 2], {}, {}, {}, {}, {}, {}, 0, 0};
    addMedia(panel);
    const GaussLegendre& rule = *panel.rule;
    const int n = rule.size();
    const double half = (t1 - t0) / 2;
    // Sequential: as if nothing were in front of the panel. Each particle's own integrand is as smooth as their sum.
    const double before = world_.composition == Composition::sequential ? panel.depth[0] : 0;
    Values<double> integrand{};
    for (int i = 0; i < n; ++i) {
        stage_.lighting.scattered(ray_.at(panel.at(i)), ray_.direction, phases_, sources_);
        panel.source[i] = sources_[0];
        glm::dvec3 light = panel.scattering[i] * panel.source[i] + panel.emitted[i], scattering = panel.scattering[i];
        for (size_t f = 0; f < world_.fogs.size(); ++f) {
            const double middle = (t0 + t1) / 2;
            if (!(middle > fog_parts_[f].begin && middle < fog_parts_[f].end)) continue;
            const Fog& fog = world_.fogs[f];
            const double sigma = fogAt(fog, panel.at(i));
            light += sigma * (1.0 - fog.albedo) * fog.emission;
            if (fog_phases_[f] == 0) continue;
            light += sigma * fog.albedo * sources_[fog_phases_[f]];
            scattering += sigma * fog.albedo;
        }
        const double seen = std::exp(before - panel.depth[i]), part = rule.weight(i) * half * seen;
        panel.light += part * light;
        panel.ambient += part * scattering * world_.ambient;
        integrand[i] = sum(seen * (light + scattering * world_.ambient));
    }
    panel.size = sum(panel.light + panel.ambient);
    // The rule errs by coefficients from 2n on: as many again further on, at the rate of the last half.
    const auto largest = [&](int m) {
        return std::abs(rule.coefficient(m, integrand)) + std::abs(rule.coefficient(m + 1, integrand));
    };
    const double late = largest(n - 2), early = largest(n / 2 - 2), rate = early > 0 ? std::min(late / early, 1.0) : 0;
    const bool kinks = !ball_parts_.empty() || !cell_parts_.empty(); // their coefficients fall slowly
    const double decay = kinks ? rate : rate * rate;
    panel.error = 16 * 2 * half * late * decay;
    return panel;
}

// Halves panels until the estimate of each panel's error is below a part of the tolerance.
void RayTracer::refine() {
    // Sequential panels are as bright as if nothing were in front of them: their sum is more than the ray's radiance.
    const double part = world_.composition == Composition::sequential ? 1.0 / 64 : 1.0 / 8;
    for (int sweep = 0; sweep < 50; ++sweep) {
        double total = 0;
        for (const Panel& panel : panels_) total += panel.size;
        const double allowed = stage_.settings.tolerance * part * total;
        refined_.clear();
        bool changed = false;
        for (const Panel& panel : panels_) {
            const double middle = (panel.t0 + panel.t1) / 2;
            if (!(panel.error > allowed) || panel.t1 - panel.t0 < 1e-13 * std::max(1.0, std::abs(middle))) {
                refined_.push_back(panel);
                continue;
            }
            changed = true;
            bool empty;
            const double k = finest(panel.t0, panel.t1, empty);
            refined_.push_back(panelOn(panel.t0, middle, k));
            refined_.push_back(panelOn(middle, panel.t1, k));
        }
        panels_.swap(refined_);
        if (!changed) return;
    }
}

void RayTracer::sumOverlapping(RayResult& result) const {
    for (const Panel& panel : panels_)
        result.scattered += sheetsPass((panel.t0 + panel.t1) / 2) * (panel.light + panel.ambient);
}

// Each particle by itself, from near to far. Panels cover it or do not: what they hold beyond the end of a Gaussian is
// nothing.
void RayTracer::sumSequential(RayResult& result) {
    std::sort(crossings_.begin(), crossings_.end(),
              [](const Crossing& a, const Crossing& b) { return a.from_origin < b.from_origin; });
    double transmittance = 1;
    for (const Crossing& c : crossings_) {
        const double half = c.half_line * c.across, peak = c.blob->sigma_t * c.across;
        glm::dvec3 scattered(0);
        for (const Panel& panel : panels_) {
            if (c.t0 >= panel.t1 || c.t1 <= panel.t0) continue;
            for (int i = 0; i < panel.rule->size(); ++i) {
                const ErfTable::Pair pair = stage_.table.at(c.k * (panel.at(i) - c.closest));
                const double seen = peak * pair.gauss * std::exp(-half * (pair.erf - c.erf_begin));
                scattered += panel.rule->weight(i) * (panel.t1 - panel.t0) / 2 * seen * panel.source[i];
            }
        }
        const double depth = crossedDepth(c, c.t1);
        const glm::dvec3 albedo = c.blob->albedo;
        const glm::dvec3 even = albedo * world_.ambient + emittedBy(world_, albedo);
        result.scattered += transmittance * (albedo * scattered + even * -std::expm1(-depth));
        transmittance *= std::exp(-depth);
    }
}

} // namespace brume::reference
